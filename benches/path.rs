//! Paths per second, scene by scene and set by set.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
#[cfg(feature = "mitsuba")]
use estimand::mitsuba::{self, Instance};
use estimand::path::bsdf::Bsdf;
use estimand::path::light::{Environment, Light};
use estimand::path::sensor::Pinhole;
use estimand::path::{View, scenes};
use estimand::points::{Halton, HashedOwen, NRooks, Owen, Sobol, Stratified};
use estimand::{Average, Estimator, MonteCarlo};
#[cfg(feature = "mitsuba")]
use estimand::{
    each,
    points::{Rescrambled, pixel},
};

const SIZE: u32 = 32;
const SPP: u64 = 16;

/// One benchmark: pictures of `view` with the estimator that `estimator` makes of a pixel's seed.
fn pictures<B: Bsdf, L: Light, E: Environment, T: Estimator>(
    criterion: &mut Criterion,
    name: BenchmarkId,
    view: &View<B, L, E, Pinhole>,
    estimator: impl Fn(u64) -> T + Sync,
) {
    let mut group = criterion.benchmark_group("path");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .throughput(Throughput::Elements(u64::from(SIZE * SIZE) * SPP));
    let mut seed = 0;
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            seed += 1;
            black_box(view.render([SIZE; 2], seed, &estimator).unwrap())
        });
    });
    group.finish();
}

fn scenes_with_independent_points(criterion: &mut Criterion) {
    let plain = |seed| MonteCarlo::new(SPP, seed);
    let id = |scene| BenchmarkId::new(scene, "monte-carlo");
    // The setting of Mitsuba's own function `cornell_box`.
    let mut short = scenes::cornell_box();
    short.paths = short.paths.longest(8).expect("more than 0");
    let specular = scenes::cornell_box_specular();
    pictures(criterion, id("cornell_box_depth_8"), &short, plain);
    pictures(criterion, id("cornell_box"), &scenes::cornell_box(), plain);
    pictures(criterion, id("cornell_box_specular"), &specular, plain);
    pictures(criterion, id("environment"), &scenes::environment(), plain);
    pictures(criterion, id("furnace"), &scenes::furnace(), plain);
}

fn sets_in_the_cornell_box(criterion: &mut Criterion) {
    let view = scenes::cornell_box();
    let id = |set| BenchmarkId::new("cornell_box", set);
    pictures(criterion, id("stratified"), &view, |seed| {
        Average::new(Stratified::new(SPP, 2, seed).expect("a grid"), SPP)
    });
    pictures(criterion, id("n-rooks"), &view, |seed| {
        Average::new(NRooks::new(SPP, seed).expect("some rooks"), SPP)
    });
    let halton = Halton::new(32).expect("few dimensions");
    pictures(criterion, id("halton"), &view, |seed| {
        Average::new(halton.clone().scrambled(Owen { seed }), SPP)
    });
    let sobol = Sobol::new(32).expect("few dimensions");
    pictures(criterion, id("sobol"), &view, |seed| {
        Average::new(sobol.clone().scrambled(HashedOwen { seed }), SPP)
    });
}

/// The type that can render every scene beside the smallest that is enough for this one.
#[cfg(feature = "mitsuba")]
fn specialised(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("path/specialised");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .throughput(Throughput::Elements(u64::from(SIZE * SIZE) * SPP));
    for scene in ["cornell_box", "environment", "sky", "meshes"] {
        let file = format!(
            "{}/reference/scenes/{scene}.xml",
            env!("CARGO_MANIFEST_DIR")
        );
        let description = mitsuba::read(&file, &[]).expect("a scene of the references");
        for (name, instance) in [
            ("general", Instance::General),
            ("smallest", Instance::Smallest),
        ] {
            let picture = description
                .load(instance)
                .expect("it can be loaded")
                .picture;
            let mut seed = 0;
            group.bench_function(BenchmarkId::new(scene, name), |bencher| {
                bencher.iter(|| {
                    seed += 1;
                    black_box(each(u64::from(SIZE * SIZE), |pixel| {
                        let position = [pixel % u64::from(SIZE), pixel / u64::from(SIZE)];
                        let position = position.map(|x| u32::try_from(x).expect("below the size"));
                        let points = Rescrambled::new(4, pixel::seed(position, seed));
                        let points = points.expect("few dimensions");
                        picture
                            .average(position, [SIZE; 2], &points, SPP)
                            .expect("finite")
                            .mean
                    }))
                });
            });
        }
    }
    group.finish();
}

/// Scene files are read with the feature `mitsuba` only.
#[cfg(not(feature = "mitsuba"))]
fn specialised(_: &mut Criterion) {}

criterion_group!(
    path,
    scenes_with_independent_points,
    sets_in_the_cornell_box,
    specialised
);
criterion_main!(path);
