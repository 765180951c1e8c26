//! What is kept of the estimates of a picture, also where one of them has to stop; and what is refused.

use estimand::path::bsdf::{Dielectric, Lambertian};
use estimand::path::filter::BoxFilter;
use estimand::path::light::Emission;
use estimand::path::light::{AreaLights, LightTree, NoEnvironment, NoLight};
use estimand::path::sensor::{Pinhole, Sensor};
use estimand::path::shape::{Flat, Sphere};
use estimand::path::{Image, Object, Paths, Pixel, Ray, Scene, View, scenes};
use estimand::points::{Rescrambled, Stratified, pixel};
use estimand::{Average, Error, Estimator, MonteCarlo, NonFinite, Sampler};
use glam::{DVec3, Vec3A};

use crate::camera;

#[test]
fn parts_must_fit_their_types() {
    let ball = || {
        Object::<Lambertian>::new(
            [Sphere::new([0.0; 3], 1.0).unwrap()],
            Lambertian::new([0.5; 3]).unwrap(),
        )
    };
    let lamp = || ball().emitting([1.0; 3]).unwrap();
    let refused = |result: Result<(), estimand::Error>| result.unwrap_err().to_string();
    // No lights are lights too; but a tree has a root.
    assert!(Scene::<_, AreaLights, _>::new(vec![ball()], NoEnvironment).is_ok());
    let dark = Scene::<_, LightTree, _>::new(vec![ball()], NoEnvironment).map(drop);
    assert!(refused(dark).contains("number of emitters"));
    let bright = Scene::<_, NoLight, _>::new(vec![lamp()], NoEnvironment).map(drop);
    assert!(refused(bright).contains("number of emitters must be 0"));
    assert!(refused(Lambertian::new([0.5, f32::NAN, 0.5]).map(drop)).contains("NaN"));
    assert!(Sphere::new([0.0; 3], -1.0).is_err());
    assert!(Sphere::new([f32::INFINITY, 0.0, 0.0], 1.0).is_err());
    assert!(Flat::triangle([[0.0; 3], [1.0; 3], [2.0; 3]]).is_err());
    assert!(Flat::parallelogram([0.0; 3], [f32::NAN; 3], [1.0; 3]).is_err());
    assert!(Dielectric::new(0.0, 1.0).is_err());
    assert!(ball().emitting([-1.0; 3]).is_err());
    assert!(Pinhole::look_at([0.0; 3], [0.0; 3], [0.0, 1.0, 0.0], 40.0, 1.0).is_err());
    assert!(Paths::default().longest(0).is_err());
    let nothing = Scene::<Lambertian, NoLight, _>::new(Vec::new(), NoEnvironment);
    let view = View {
        scene: nothing.unwrap(),
        sensor: camera([1.0; 3], [0.0; 3]),
        filter: BoxFilter,
        paths: Paths::default(),
    };
    let picture: Image = view
        .render([2, 3], 1, |seed| MonteCarlo::new(2, seed))
        .unwrap();
    assert_eq!((picture.height(), picture.mean().x), (3, 0.0));
}

#[test]
fn pictures_without_pixels_are_refused() {
    let view = scenes::cornell_box();
    for size in [[0, 5], [5, 0], [0, 0]] {
        let refused = view.render(size, 1, |seed| MonteCarlo::new(2, seed));
        let unfinished = refused.unwrap_err();
        assert!(matches!(unfinished.reason, Error::Refused { .. }));
        assert!(unfinished.image.is_none() && unfinished.position.is_none());
        let [width, height] = size;
        let message = unfinished.to_string();
        assert!(
            message.contains(&format!("{width} x {height}")),
            "{message}"
        );
    }
}

/// Also without the feature `parallel`: the bits are those of one thread there.
#[cfg(feature = "parallel")]
#[test]
fn a_picture_has_the_same_bits_with_any_number_of_threads() {
    let picture = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            scenes::cornell_box()
                .render([16; 2], seed, |seed| MonteCarlo::new(32, seed))
                .unwrap()
        })
    };
    let one = picture(1, 7);
    assert_eq!(one, picture(2, 7));
    assert_eq!(one, picture(5, 7));
    assert_ne!(one, picture(1, 8));
}

#[test]
fn a_picture_that_is_stopped_keeps_its_rows() {
    let view = scenes::cornell_box();
    let plain = |seed| MonteCarlo::new(4, seed);
    let whole = view.render([8; 2], 1, plain).unwrap();
    let part = view.render_while([8; 2], 1, plain, |row| row < 5).unwrap();
    let (kept, left_out) = part.pixels().split_at(5 * 8);
    assert_eq!(kept, &whole.pixels()[..5 * 8]);
    assert!(left_out.iter().all(|pixel| *pixel == DVec3::ZERO));
    // Nothing is known of the rows left out; the others know what they would know in the whole picture.
    let (errors, known) = (part.std_error().unwrap(), whole.std_error().unwrap());
    let (kept, left_out) = errors.pixels().split_at(5 * 8);
    assert_eq!(kept, &known.pixels()[..5 * 8]);
    assert!(left_out.iter().all(|error| *error == DVec3::INFINITY));
    assert_eq!((part.used(), whole.used()), (5 * 8 * 4, 8 * 8 * 4));
    let none = view.render_while([8; 2], 1, plain, |_| false).unwrap();
    assert_eq!((none.used(), none.std_error()), (0, None));
}

#[test]
fn a_picture_of_points_keeps_what_was_before_the_refused_ones() {
    let view = scenes::cornell_box();
    let size = [5, 6];
    let points = |seed| Rescrambled::new(4, seed);
    let refused = pixel::seed([3, 4], 1);
    let picky = |seed| match seed == refused {
        true => Err(Error::NothingLeft { rejected: 7 }),
        false => points(seed),
    };
    let unfinished = view.render_points(size, 1, 3, picky, |_| true).unwrap_err();
    assert_eq!(unfinished.position, Some([3, 4]));
    assert_eq!(unfinished.reason, Error::NothingLeft { rejected: 7 });
    let whole = view.render_points(size, 1, 3, points, |_| true).unwrap();
    let (part, before) = (unfinished.image.unwrap(), 4 * 5 + 3);
    assert_eq!(part.pixels()[..before], whole.pixels()[..before]);
    assert!(
        part.pixels()[before..]
            .iter()
            .all(|pixel| *pixel == DVec3::ZERO)
    );
    let singly = view.render(size, 1, |seed| Average::new(points(seed).unwrap(), 3));
    assert_eq!(whole, singly.unwrap());
    // More than go together, and a finite set.
    for count in [1500, 7] {
        let points = |seed| Stratified::new(count, 2, seed);
        let together = view.render_points(size, 1, count, points, |_| true);
        let singly = view.render(size, 1, |seed| Average::new(points(seed).unwrap(), count));
        assert_eq!(together.unwrap(), singly.unwrap());
    }
    let rows = view
        .render_points(size, 1, 3, points, |row| row < 4)
        .unwrap();
    assert_eq!(rows.pixels()[..20], whole.pixels()[..20]);
    assert_eq!(rows.used(), 20 * 3);
}

#[test]
fn pictures_count_evaluations() {
    // The grid nearest to 7 points has 9 or 6 cells.
    let picture = scenes::furnace()
        .render([4, 3], 1, |seed| {
            Average::new(Stratified::new(7, 2, seed).unwrap(), 7)
        })
        .unwrap();
    let cells = Stratified::new(7, 2, 0).unwrap();
    let cells = cells.cells(0) * cells.cells(1);
    assert_ne!(cells, 7);
    assert_eq!((picture.requested(), picture.used()), (12 * 7, 12 * cells));
    assert_eq!((picture.rejected(), picture.std_error()), (0, None));
}

#[test]
fn a_pixel_can_be_computed_again() {
    let view = scenes::cornell_box();
    let (size, position, seed) = ([6, 4], [5, 2], 9);
    let picture = view
        .render(size, seed, |key| MonteCarlo::new(8, key))
        .unwrap();
    let again = Pixel {
        scene: &view.scene,
        sensor: &view.sensor,
        filter: &view.filter,
        paths: view.paths,
        position,
        size,
    };
    let again = MonteCarlo::new(8, pixel::seed(position, seed))
        .estimate(&again)
        .unwrap();
    assert_eq!(picture.pixels()[2 * 6 + 5], again.mean);
    let errors = picture.std_error().unwrap();
    assert_eq!(Some(errors.pixels()[2 * 6 + 5]), again.std_error);
}

/// A camera that is broken at some points of its film: rays from nowhere.
struct Broken<F>(F);

impl<F: Fn([f64; 2]) -> bool + Sync> Sensor for Broken<F> {
    fn ray<S: Sampler>(&self, film: [f64; 2], _: &mut S) -> Ray {
        let broken = if (self.0)(film) { f32::NAN } else { 1.0 };
        Ray {
            origin: Vec3A::ZERO,
            direction: Vec3A::new(0.0, 0.0, broken),
        }
    }
}

/// As bright as the direction is long, and not finite where it is broken.
struct Sky;

impl estimand::path::light::Environment for Sky {
    fn emitted(&self, direction: Vec3A) -> Emission {
        Emission {
            radiance: Vec3A::splat(direction.z),
            density: 0.0,
        }
    }
}

fn broken<F: Fn([f64; 2]) -> bool + Sync>(film: F) -> View<Lambertian, NoLight, Sky, Broken<F>> {
    View {
        scene: Scene::new(Vec::new(), Sky).unwrap(),
        sensor: Broken(film),
        filter: BoxFilter,
        paths: Paths::default(),
    }
}

#[test]
fn a_pixel_that_stops_leaves_the_pixels_before_it() {
    // Rows 5 and 7 of 8 stop, from column 3 and 1 on: whichever thread is first, pixel (3, 5) is.
    let view = broken(|[x, y]| {
        let row = (8.0 * y).floor();
        row == 5.0 && x >= 3.0 / 8.0 || row == 7.0 && x >= 1.0 / 8.0
    });
    let unfinished = view
        .render([8; 2], 1, |seed| MonteCarlo::new(4, seed))
        .unwrap_err();
    assert!(matches!(
        unfinished.reason,
        Error::NonFinite { index: 0, .. }
    ));
    assert_eq!(unfinished.position, Some([3, 5]));
    assert!(unfinished.to_string().starts_with("pixel (3, 5): "));
    assert_eq!(unfinished.so_far, None);
    let image = unfinished.image.unwrap();
    assert_eq!((image.width(), image.height()), (8, 8));
    let (whole, missing) = image.pixels().split_at(5 * 8 + 3);
    assert!(whole.iter().all(|pixel| *pixel == DVec3::ONE));
    assert!(missing.iter().all(|pixel| *pixel == DVec3::ZERO));
    assert_eq!(image.used(), (5 * 8 + 3) * 4);
    let errors = image.std_error().unwrap();
    assert_eq!(errors.pixels()[5 * 8 + 2], DVec3::ZERO);
    assert_eq!(errors.pixels()[5 * 8 + 3], DVec3::INFINITY);
}

#[test]
fn what_a_pixel_rejects_is_counted() {
    // The left half of each pixel of the upper row.
    let view = broken(|[x, y]| y < 0.5 && (2.0 * x).fract() < 0.5);
    let stopped = view
        .render([2; 2], 1, |seed| MonteCarlo::new(1000, seed))
        .unwrap_err();
    assert_eq!(stopped.position, Some([0, 0]));
    let picture = view
        .render([2; 2], 1, |seed| {
            MonteCarlo::new(1000, seed).non_finite(NonFinite::Reject)
        })
        .unwrap();
    assert_eq!(picture.used(), 4000);
    // 1000 of 2000, with a standard deviation of 22; 6 of them are exceeded with a probability of 2e-9.
    assert!(picture.rejected().abs_diff(1000) < 6 * 22);
    assert_eq!(picture.mean(), DVec3::ONE);
}
