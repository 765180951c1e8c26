//! What an estimator costs beside the loop that one would write by hand on the same points.
//!
//! Run with `RAYON_NUM_THREADS=1` for a fair comparison: the loops by hand have one thread. For instruction counts, which do
//! not depend on what else the machine does, run one case alone:
//!
//! `ESTIMATORS_ONCE=monte_carlo/library RAYON_NUM_THREADS=1 valgrind --tool=callgrind target/release/deps/estimators-*`

#![expect(clippy::cast_possible_truncation, reason = "small numbers")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput};
use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::hash::hash;
use estimand::integrands::Roulette;
use estimand::points::{HashedOwen, PointSet, Sobol};
use estimand::{Average, Estimator, MonteCarlo, Replicated, Sampler, Stream, cube};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};

const COUNT: u64 = 1 << 18;
const DIMENSIONS: usize = 5;

fn function(x: [f64; DIMENSIONS]) -> f64 {
    let square: f64 = x.iter().map(|x| (x - 0.5) * (x - 0.5)).sum();
    (-25.0 * square).exp()
}

/// Mean and standard error of shifted values, as one writes them by hand.
fn by_hand(count: u64, mut value: impl FnMut(u64) -> f64) -> [f64; 2] {
    let first = value(0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 1..count {
        let d = value(index) - first;
        sum += d;
        squares += d * d;
    }
    let n = count as f64;
    [
        first + sum / n,
        ((squares - sum * sum / n) / (n - 1.0) / n).sqrt(),
    ]
}

/// By hand on the points of a set, a block of coordinates at a time.
fn by_hand_on(points: &impl PointSet, count: u64) -> [f64; 2] {
    const ROWS: usize = 512;
    let mut ahead = vec![0.0; ROWS * DIMENSIONS];
    let dimensions = 0..DIMENSIONS as u32;
    by_hand(count, |index| {
        let row = index as usize % ROWS;
        if row == 0 {
            points.fill(index, dimensions.clone(), &mut ahead);
        }
        let x = &ahead[row * DIMENSIONS..][..DIMENSIONS];
        function(x.try_into().expect("five coordinates"))
    })
}

type Case = (&'static str, Box<dyn Fn()>);

fn cases() -> Vec<Case> {
    let f = || cube(function);
    let sobol = || Sobol::new(DIMENSIONS as u32).expect("five dimensions");
    let owen = move |seed| sobol().scrambled(HashedOwen { seed });
    vec![
        (
            "monte_carlo/by_hand",
            Box::new(|| {
                let mut stream = Stream(Xoshiro256PlusPlus::seed_from_u64(1));
                black_box(by_hand(COUNT, |_| {
                    function(std::array::from_fn(|_| stream.next_1d()))
                }));
            }),
        ),
        (
            "monte_carlo/library",
            Box::new(move || drop(black_box(MonteCarlo::new(COUNT, 1).estimate(&f())))),
        ),
        (
            "average/by_hand",
            Box::new(move || {
                black_box(by_hand_on(&owen(1), COUNT));
            }),
        ),
        (
            "average/library",
            Box::new(move || drop(black_box(Average::new(owen(1), COUNT).estimate(&f())))),
        ),
        (
            "replicated/by_hand",
            Box::new(move || {
                let means: Vec<f64> = (0..16)
                    .map(|replicate| by_hand_on(&owen(hash(0, replicate)), COUNT / 16)[0])
                    .collect();
                black_box(by_hand(16, |index| means[index as usize]));
            }),
        ),
        (
            "replicated/library",
            Box::new(move || {
                drop(black_box(
                    Replicated::new(16, COUNT / 16, owen).estimate(&f()),
                ));
            }),
        ),
        (
            "roulette/by_hand",
            Box::new(|| {
                let mut stream = Stream(Xoshiro256PlusPlus::seed_from_u64(1));
                black_box(by_hand(COUNT, |_| {
                    if stream.next_1d() < 0.5 {
                        2.0 * function(std::array::from_fn(|_| stream.next_1d()))
                    } else {
                        0.0
                    }
                }));
            }),
        ),
        (
            "roulette/library",
            Box::new(move || {
                let roulette = Roulette::new(f(), 0.5).expect("a probability");
                drop(black_box(MonteCarlo::new(COUNT, 1).estimate(&roulette)));
            }),
        ),
        (
            "bounded/library",
            Box::new(move || {
                let bounded = Bounded::new(COUNT, 1, 0.0, 1.0).expect("bounds");
                drop(black_box(bounded.estimate(&f())));
            }),
        ),
        (
            "strata/library",
            Box::new(move || {
                let strata = Strata::new(8, 3, COUNT, 1).expect("valid").neyman();
                drop(black_box(strata.estimate(&f())));
            }),
        ),
        (
            "vegas/library",
            Box::new(move || {
                let vegas = Vegas::new(DIMENSIONS as u32, COUNT, 1).expect("valid");
                drop(black_box(vegas.estimate(&f())));
            }),
        ),
    ]
}

fn main() {
    if let Some(name) = std::env::var_os("ESTIMATORS_ONCE") {
        let cases = cases();
        let case = cases.iter().find(|(case, _)| name == *case);
        case.expect("the name of a case").1();
        return;
    }
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("estimators");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
        .throughput(Throughput::Elements(COUNT));
    for (name, case) in cases() {
        group.bench_function(name, |bencher| bencher.iter(&case));
    }
    group.finish();
    criterion.final_summary();
}
