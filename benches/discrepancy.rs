//! Times of the discrepancies, and how they grow with the number of points.
//!
//! Each group measures one algorithm at growing counts of Halton's points; criterion prints the times. The slopes in
//! benches/DISCREPANCY.md are fitted to them.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use estimand::discrepancy::{L2, Points, Star};
use estimand::points::Halton;

fn halton(count: u64, dimensions: u32) -> Points<'static> {
    let set = Halton::new(dimensions).expect("few dimensions");
    Points::from_set(&set, 0..count, dimensions).expect("points of the unit cube")
}

fn exact_star(criterion: &mut Criterion) {
    let cases: [(u32, &[u64]); 6] = [
        (1, &[1000, 10_000, 100_000]),
        (2, &[1000, 10_000, 100_000]),
        (3, &[125, 250, 500, 1000]),
        (4, &[50, 100, 200, 400]),
        (5, &[25, 50, 100, 200]),
        (7, &[13, 25, 50]),
    ];
    let star = Star::default().work(u64::MAX);
    for (dimensions, counts) in cases {
        let mut group = criterion.benchmark_group(format!("Star::exact, d = {dimensions}"));
        for &count in counts {
            let points = halton(count, dimensions);
            group.throughput(Throughput::Elements(count));
            group.bench_function(BenchmarkId::from_parameter(count), |bench| {
                bench.iter(|| star.exact(black_box(&points)));
            });
        }
    }
}

fn l2(criterion: &mut Criterion) {
    let kinds = [
        L2::Star,
        L2::Centred,
        L2::WrapAround,
        L2::Mixture,
        L2::Symmetric,
        L2::Extreme,
        L2::Diaphony,
    ];
    for kind in kinds {
        let mut group = criterion.benchmark_group(format!("L2::{kind:?}, d = 8"));
        for count in [1250, 2500, 5000, 10_000] {
            let points = halton(count, 8);
            group.throughput(Throughput::Elements(count));
            group.bench_function(BenchmarkId::from_parameter(count), |bench| {
                bench.iter(|| kind.squared(black_box(&points)));
            });
        }
    }
}

fn division(criterion: &mut Criterion) {
    for dimensions in [2, 3, 4] {
        let mut group =
            criterion.benchmark_group(format!("L2::Star by division, d = {dimensions}"));
        for count in [10_000, 40_000, 160_000] {
            let points = halton(count, dimensions);
            group.throughput(Throughput::Elements(count));
            group.bench_function(BenchmarkId::from_parameter(count), |bench| {
                bench.iter(|| L2::Star.squared(black_box(&points)));
            });
        }
    }
}

fn short() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(500))
        .without_plots()
}

criterion_group!(name = benches; config = short(); targets = exact_star, l2, division);
criterion_main!(benches);
