//! Our pictures of scene files against Mitsuba's: the same files, two programs, one expectation.
//!
//! The references are under `reference/images`, with how they were made; one for each family of features. Every comparison has a
//! false-positive rate of 1e-3, over all of its pixels and scales; the seeds are fixed. Where one fails, a map of
//! the p-values is left under `target/tmp`.

#[path = "render/agreement.rs"]
mod agreement;

use agreement::{Batches, Reference};
use estimand::hash::hash;
use estimand::mitsuba::{Instance, Loaded, read};
use estimand::path::{Image, Share};
use estimand::points::{
    DigitPermutation, Halton, HashedOwen, Independent, PointSet, Rescrambled, Sobol, pixel,
};
use estimand::{Estimate, each};
use glam::DVec3;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/reference");

const SIZE: u32 = 64;

/// Samples a pixel in each of so many pictures.
const SAMPLES: u64 = 16;
const PICTURES: u64 = 24;

type Points<'a> = &'a (dyn Fn(u64) -> Box<dyn PointSet> + Sync);

fn render(loaded: &Loaded, seed: u64, points: Points<'_>) -> Image {
    let rows = each(SIZE.into(), |y| {
        let y = u32::try_from(y).expect("below the size");
        let sets: Vec<_> = (0..SIZE)
            .map(|x| points(pixel::seed([x, y], seed)))
            .collect();
        let shares: Vec<_> = (0..SIZE)
            .zip(&sets)
            .map(|(x, points)| Share {
                position: [x, y],
                points: &**points,
                count: SAMPLES,
            })
            .collect();
        let estimates = loaded.picture.averages(loaded.size, &shares);
        let mean = |estimate: Result<Estimate<_>, _>| {
            let estimate = estimate.expect("an estimate");
            assert_eq!(estimate.rejected, 0);
            estimate.mean
        };
        estimates.into_iter().map(mean).collect::<Vec<DVec3>>()
    });
    Image::new(SIZE as usize, rows.concat()).expect("whole rows")
}

/// Compares a scene with its reference, for four point sets, and with paths that are reused.
fn compare(name: &'static str) {
    compare_filtered(name, 1.0);
}

/// The same for a film whose filter makes neighbouring pixels of Mitsuba depend on one another; `area` is one over the integral of
/// its square.
fn compare_filtered(name: &'static str, area: f64) {
    let image = |suffix| Image::read_exr(format!("{ROOT}/images/{name}{suffix}.exr")).unwrap();
    let reference = Reference {
        name,
        image: image("").with_std_error(image("_std_error")).unwrap(),
        samples: 128 * 64,
        batches: 128,
        correlated: area,
    };
    let description = read(
        format!("{ROOT}/scenes/{name}.xml"),
        &[("size", &SIZE.to_string())],
    )
    .unwrap();
    let mut loaded = description.load(Instance::Smallest).unwrap();
    assert_eq!(loaded.size, [SIZE; 2]);
    let sobol = Sobol::new(32).unwrap();
    let halton = Halton::new(32).unwrap();
    let rescrambled: Points<'_> = &|seed| Box::new(Rescrambled::new(4, seed).unwrap());
    let sets: [(&str, Points<'_>, u32); 5] = [
        ("independent", &|seed| Box::new(Independent::new(seed)), 1),
        (
            "sobol",
            &|seed| Box::new(sobol.clone().scrambled(HashedOwen { seed })),
            1,
        ),
        (
            "halton",
            &|seed| Box::new(halton.clone().scrambled(DigitPermutation { seed })),
            1,
        ),
        ("rescrambled", rescrambled, 1),
        ("rescrambled, reused by 8", rescrambled, 8),
    ];
    for (number, (label, points, pixels)) in (0..).zip(sets) {
        loaded.picture.reuse_paths(pixels).unwrap();
        let ours = Batches::new(PICTURES, SAMPLES, |batch| {
            render(&loaded, hash(number, batch), points)
        });
        reference.compare(&ours, label).check();
    }
}

#[test]
fn textures() {
    compare("textures");
}

#[test]
fn sky() {
    compare("sky");
}

#[test]
fn rough_metals() {
    compare("rough_metals");
}

#[test]
fn rough_glass() {
    compare("rough_glass");
}

#[test]
fn plastics() {
    compare("plastics");
}

#[test]
fn holes() {
    compare("holes");
}

#[test]
fn meshes() {
    compare("meshes");
}

#[test]
fn instances() {
    compare("instances");
}

#[test]
fn small_lights() {
    compare("small_lights");
}

#[test]
fn relief() {
    compare("relief");
}

#[test]
fn shapes() {
    compare("shapes");
}

#[test]
fn lens() {
    compare("lens");
}

#[test]
fn clipped() {
    compare("clipped");
}

/// A Gaussian with a standard deviation of half a pixel: one over the integral of its square is pi.
#[test]
fn parallel() {
    compare_filtered("parallel", core::f64::consts::PI);
}
