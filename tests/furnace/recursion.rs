//! Recursion where its result has a closed form, with and without the bias of its ending.

use estimand::path::filter::Centre;
use estimand::path::{Direct, Ending, Image, Recursive, View, scenes};
use estimand::{Estimator, MonteCarlo};
use glam::DVec3;

use crate::LIMIT;

/// Everything emits and reflects one half: the light of paths of at most `n` segments is `1 - 2^-n`.
fn mean(rays: u32, ending: Ending, direct: Direct) -> (f64, f64) {
    let (view, size) = (scenes::furnace(), [16, 16]);
    let tree = Recursive::new(rays, ending, direct).unwrap();
    let picture = Image::of_pixels(size, 1, |position, key| {
        MonteCarlo::new(64, key).estimate(&tree.pixel(view.pixel(position, size)))
    });
    let picture = picture.unwrap();
    let errors = picture.std_error().unwrap();
    let square: f64 = errors.pixels().iter().map(|e| e.x * e.x).sum();
    (
        picture.mean().x,
        square.sqrt() / picture.pixels().len() as f64,
    )
}

/// Eleven tests at 4e-6 each.
#[test]
fn recursion_ends_as_it_says() {
    for direct in [Direct::NextEvent, Direct::Chance] {
        for (rays, ending, expected) in [
            (1, Ending::Roulette(1), 1.0),
            (3, Ending::Roulette(2), 1.0),
            (1, Ending::Depth(1), 0.5),
            (1, Ending::Depth(4), 0.9375),
            (3, Ending::Depth(3), 0.875),
        ] {
            let (mean, error) = mean(rays, ending, direct);
            let z = (mean - expected) / error.hypot(1e-6);
            assert!(
                z.abs() < LIMIT,
                "{rays} {ending:?} {direct:?}: {mean}, z = {z}"
            );
        }
    }
    // What carries less than a tenth ends: one half to the fourth power does. Four segments are left.
    let cut = Ending::Threshold(0.1);
    let (by_chance, error) = mean(1, cut, Direct::Chance);
    assert!(
        (by_chance - 0.9375).abs() < LIMIT * error.hypot(1e-6),
        "{by_chance}"
    );
    // Next-event estimation at the last surface adds a part of the light of the fifth.
    let (next_event, error) = mean(1, cut, Direct::NextEvent);
    let room = LIMIT * error;
    assert!(
        (0.9375 - room..0.968_75 + room).contains(&next_event),
        "{next_event}"
    );
    // Three rays carry a third of it each: two segments are left.
    let (three, error) = mean(3, cut, Direct::Chance);
    assert!((three - 0.75).abs() < LIMIT * error.hypot(1e-6), "{three}");
}

#[test]
fn recursion_refuses_what_never_ends_or_never_begins() {
    let refused = |rays, ending| Recursive::new(rays, ending, Direct::Chance).is_err();
    assert!(refused(0, Ending::Depth(1)) && refused(1, Ending::Depth(0)));
    assert!(refused(1, Ending::Threshold(0.0)) && refused(1, Ending::Threshold(f32::NAN)));
    assert!(!refused(1, Ending::Threshold(1.0)));
}

/// Along the edge of a ball, the mean over a pixel is between light and dark; at its centre it is one or the other.
#[test]
fn centres_see_edges_as_steps() {
    use estimand::path::bsdf::Lambertian;
    use estimand::path::shape::Sphere;
    use estimand::path::{Object, Paths};

    let black = || {
        let ball = Sphere::new([0.0; 3], 1.0).unwrap();
        vec![Object::<Lambertian>::new(
            [ball],
            Lambertian::new([0.0; 3]).unwrap(),
        )]
    };
    let view = crate::under_a_sky(black(), 1.0);
    let grey = |image: &Image| {
        let between = |pixel: &&DVec3| pixel.x > 0.0 && pixel.x < 1.0;
        image.pixels().iter().filter(between).count()
    };
    let mean = view
        .render([16, 16], 1, |key| MonteCarlo::new(64, key))
        .unwrap();
    let centred = View {
        scene: view.scene,
        sensor: view.sensor,
        filter: Centre,
        paths: Paths::default(),
    };
    let centre = centred
        .render([16, 16], 1, |key| MonteCarlo::new(64, key))
        .unwrap();
    assert!(grey(&mean) > 10, "{}", grey(&mean));
    assert_eq!(grey(&centre), 0);
}
