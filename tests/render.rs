//! Our pictures against Mitsuba's: same scenes, two programs, one expectation.
//!
//! The references and their standard errors are under `reference/images`, with how they were made. Every comparison
//! has a false-positive rate of 1e-3, over all of its pixels and scales; the seeds are fixed. Where one
//! fails, a map of the p-values is left under `target/tmp`.

#[path = "render/agreement.rs"]
mod agreement;

use agreement::{Batches, Reference};
use estimand::hash::{hash, unit};
use estimand::path::bsdf::{Bsdf, Lambertian};
use estimand::path::light::{AreaLights, Environment, Light, NoEnvironment};
use estimand::path::scenes::{self, CORNELL_LIGHT};
use estimand::path::sensor::{Pinhole, Sensor};
use estimand::path::{Adaptive, Allocation, Direct, Ending, Image, Recursive, Share, View};
use estimand::points::{
    Halton, Hammersley, HashedOwen, NRooks, Owen, PointSet, Rescrambled, Skipped, Sobol,
    Stratified, pixel,
};
use estimand::{Average, Estimator, MonteCarlo, NonFinite, each};

fn reference(name: &'static str, size: usize, samples: u64) -> Reference {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/images");
    let read = |suffix| Image::read_exr(format!("{root}/{name}{suffix}.exr")).unwrap();
    let image = read("").with_std_error(read("_std_error")).unwrap();
    Reference {
        name,
        image: image.downsampled(image.width() / size).unwrap(),
        samples,
        batches: 128,
        correlated: 1.0,
    }
}

/// Our picture, in 32 batches.
fn batches<B: Bsdf, L: Light, E: Environment, C: Sensor, T: Estimator>(
    view: &View<B, L, E, C>,
    size: u32,
    spp: u64,
    seed: u64,
    estimator: impl Fn(u64) -> T + Sync,
) -> Batches {
    Batches::new(32, spp, |batch| {
        view.render([size; 2], hash(seed, batch), &estimator)
            .unwrap()
    })
}

/// A point set for each seed.
type Points<'a> = &'a (dyn Fn(u64) -> Box<dyn PointSet> + Sync);

type Room = View<Lambertian, AreaLights, NoEnvironment, Pinhole>;

fn short_paths(segments: u32) -> Room {
    let mut view = scenes::cornell_box();
    view.paths = view.paths.longest(segments).unwrap();
    view
}

#[test]
fn cornell_box() {
    let ours = batches(&scenes::cornell_box(), 128, 12, 1, |seed| {
        MonteCarlo::new(12, seed)
    });
    reference("cornell_box", 128, 4 * 32768)
        .compare(&ours, "monte-carlo")
        .check();
}

#[test]
fn cornell_box_of_eight_segments() {
    let reference = reference("cornell_box_depth_8", 128, 32768);
    let view = short_paths(8);
    let ours = batches(&view, 128, 8, 2, |seed| MonteCarlo::new(8, seed));
    reference.compare(&ours, "monte-carlo").check();
    let check = |name: &str, spp: u64, seed: u64, points: Points<'_>| {
        let ours = batches(&view, 128, spp, seed, |seed| {
            Average::new(points(seed), spp)
        });
        reference.compare(&ours, name).check();
    };
    // A grid of 3 by 3.
    check("stratified", 9, 3, &|seed| {
        Box::new(Stratified::new(9, 2, seed).unwrap())
    });
    check("n-rooks", 8, 11, &|seed| {
        Box::new(NRooks::new(8, seed).unwrap())
    });
    let halton = Halton::new(32).unwrap();
    check("halton", 8, 4, &|seed| {
        Box::new(halton.clone().scrambled(Owen { seed }))
    });
    let hammersley = Hammersley::new(8, 32).unwrap();
    check("hammersley", 8, 12, &|seed| {
        let points = hammersley.clone().offset(unit(hash(seed, 0))).unwrap();
        Box::new(points.scrambled(Owen { seed }))
    });
    let sobol = Sobol::new(32).unwrap();
    check("sobol", 8, 5, &|seed| {
        Box::new(sobol.clone().scrambled(HashedOwen { seed }))
    });
}

/// Pixels with unlike numbers of points, that end their paths late and early.
#[test]
fn cornell_box_of_reused_paths() {
    let reference = reference("cornell_box", 128, 4 * 32768);
    for (number, from) in [(20, 5), (21, 1)] {
        let mut view = scenes::cornell_box();
        view.paths = view.paths.roulette_from(from).reused_by(8).unwrap();
        let picture = |seed| {
            let rows = each(128, |y| {
                let shares: Vec<_> = (0..128)
                    .map(|x| {
                        let position = [x, u32::try_from(y).unwrap()];
                        Share {
                            position,
                            points: Rescrambled::new(4, pixel::seed(position, seed)).unwrap(),
                            count: [4, 9, 16, 11][x as usize % 7 % 4],
                        }
                    })
                    .collect();
                let means = view.averages([128; 2], &shares, NonFinite::Fail);
                means.into_iter().map(|mean| mean.unwrap().mean).collect()
            });
            Image::new(128, rows.into_iter().flat_map(|row: Vec<_>| row).collect()).unwrap()
        };
        let ours = Batches::new(32, 4, |batch| picture(hash(number, batch)));
        let label = format!("reused, roulette from segment {from}");
        reference.compare(&ours, &label).check();
    }
}

#[test]
fn cornell_box_with_mirror_and_glass() {
    let view = scenes::cornell_box_specular();
    let ours = batches(&view, 128, 16, 6, |seed| MonteCarlo::new(16, seed));
    reference("cornell_box_specular", 128, 65536)
        .compare(&ours, "monte-carlo")
        .check();
}

#[test]
fn furnace() {
    let ours = batches(&scenes::furnace(), 64, 32, 7, |seed| {
        MonteCarlo::new(32, seed)
    });
    reference("furnace", 64, 16384)
        .compare(&ours, "monte-carlo")
        .check();
}

#[test]
fn bodies_under_a_sky() {
    let ours = batches(&scenes::environment(), 128, 16, 8, |seed| {
        MonteCarlo::new(16, seed)
    });
    reference("environment", 128, 32768)
        .compare(&ours, "monte-carlo")
        .check();
}

/// Two rays at every surface.
#[test]
fn recursion() {
    let view = scenes::cornell_box();
    let tree = Recursive::new(2, Ending::Roulette(3), Direct::NextEvent).unwrap();
    let ours = Batches::new(32, 6, |batch| {
        Image::of_pixels([128; 2], hash(13, batch), |position, key| {
            let pixel = tree.pixel(view.pixel(position, [128; 2]));
            MonteCarlo::new(6, key).estimate(&pixel)
        })
        .unwrap()
    });
    reference("cornell_box", 128, 4 * 32768)
        .compare(&ours, "recursion")
        .check();
}

/// The samples that decide how many there are have no say in their own number. Few of them, so that a bias would be
/// large.
#[test]
fn adaptive_samples() {
    let view = scenes::cornell_box();
    let adaptive = Adaptive::new(12, 2).unwrap();
    let ours = Batches::new(32, 12, |batch| {
        let plain = |key, count| MonteCarlo::new(count, key);
        let adapted = view.render_adaptive([128; 2], hash(14, batch), adaptive, plain);
        adapted.unwrap().image
    });
    reference("cornell_box", 128, 4 * 32768)
        .compare(&ours, "adaptive")
        .check();
}

/// Nets whose number the first points decide, as above.
#[test]
fn adaptive_nets() {
    let (view, size) = (scenes::cornell_box(), [128; 2]);
    let ours = Batches::new(32, 8, |batch| {
        let seed = hash(20, batch);
        let part = |skip| {
            let points = |key| Ok(Skipped::new(Rescrambled::new(4, key)?, skip));
            view.render_points(size, seed, 1, points, |_| true).unwrap()
        };
        let [one, other] = [part(0), part(1)];
        let differences = one.pixels().iter().zip(other.pixels());
        let errors = differences.map(|(a, b)| (*a - *b).abs()).collect();
        let first = one.with_std_error(Image::new(128, errors).unwrap());
        let counts = Allocation::new(&first.unwrap(), 2).unwrap().powers(8, 2);
        // These points are the first of each pixel.
        Image::of_pixels(size, seed, |[x, y], key| {
            let count = counts[(y * size[0] + x) as usize];
            Average::new(Rescrambled::new(4, key)?, count).estimate(&view.pixel([x, y], size))
        })
        .unwrap()
    });
    reference("cornell_box", 128, 4 * 32768)
        .compare(&ours, "adaptive-nets")
        .check();
}

/// What the comparison is for: that errors of a few parts in a thousand do not pass, with whatever points.
#[test]
fn biased_pictures_do_not_agree() {
    let reference = reference("cornell_box_depth_8", 128, 32768);
    let one_less = short_paths(7);
    let mut brighter =
        scenes::cornell_box_lit(CORNELL_LIGHT.map(|radiance| 1.01 * radiance)).unwrap();
    brighter.paths = brighter.paths.longest(8).unwrap();
    let sobol = Sobol::new(32).unwrap();
    let cases = [
        (&one_less, "one-bounce-less"),
        (&brighter, "brighter-light"),
    ];
    for (view, label) in cases {
        let plain = batches(view, 128, 16, 9, |seed| MonteCarlo::new(16, seed));
        let nets = batches(view, 128, 16, 10, |seed| {
            let points: Box<dyn PointSet> = Box::new(sobol.clone().scrambled(HashedOwen { seed }));
            Average::new(points, 16)
        });
        for (ours, points) in [(plain, "monte-carlo"), (nets, "sobol")] {
            let outcome = reference.compare(&ours, &format!("{label}-{points}"));
            assert!(!outcome.holds(), "{outcome}");
            assert!(outcome.map().exists());
        }
    }
}
