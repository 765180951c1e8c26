//! Paths per second, scene by scene and set by set.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use estimand::path::bsdf::Bsdf;
use estimand::path::light::{Environment, Light};
use estimand::path::sensor::Pinhole;
use estimand::path::{View, scenes};
use estimand::points::{Halton, HashedOwen, NRooks, Owen, Sobol, Stratified};
use estimand::{Average, Estimator, MonteCarlo};

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

criterion_group!(
    path,
    scenes_with_independent_points,
    sets_in_the_cornell_box
);
criterion_main!(path);
