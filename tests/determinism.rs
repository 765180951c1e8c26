//! The same seed gives the same bits for any number of threads.
//!
//! That the feature `parallel` changes nothing either is checked in `.ci/run`, which compares what a
//! program prints with and without it.
#![cfg(feature = "parallel")]

use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::points::{Independent, NRooks, Stratified};
use estimand::{Average, Estimate, Estimator, MonteCarlo, Replicated, cube, each};

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(run)
}

fn estimates() -> Vec<Estimate<[f64; 2]>> {
    // Values that do not add up exactly, so that another order of summation would be seen.
    let f = cube(|[x, y, z]| [(x * y).exp() / 3.0, (7.0 * z).sin() * 1e8]);
    vec![
        MonteCarlo::new(100_000, 1).estimate(&f).unwrap(),
        Average::new(Independent::new(2), 100_000)
            .estimate(&f)
            .unwrap(),
        Average::new(Stratified::new(100_000, 3, 3).unwrap(), 100_000)
            .estimate(&f)
            .unwrap(),
        Replicated::new(8, 12_345, |seed| NRooks::new(12_345, seed).unwrap())
            .estimate(&f)
            .unwrap(),
        Bounded::new(100_000, 4, -1e9, 1e9)
            .unwrap()
            .estimate(&f)
            .unwrap(),
        Strata::new(7, 3, 100_000, 5).unwrap().estimate(&f).unwrap(),
        Strata::new(7, 3, 100_000, 6)
            .unwrap()
            .neyman()
            .estimate(&f)
            .unwrap(),
        Vegas::new(3, 300_000, 7).unwrap().estimate(&f).unwrap(),
    ]
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let one = on_threads(1, estimates);
    for threads in [2, 3, 8] {
        assert_eq!(one, on_threads(threads, estimates), "{threads} threads");
    }
}

#[test]
fn families_of_estimates_come_in_order() {
    let family = || {
        each(3000, |k| {
            MonteCarlo::new(50, k)
                .estimate(&cube(|[x]| x))
                .unwrap()
                .mean
        })
    };
    assert_eq!(on_threads(1, family), on_threads(4, family));
}

#[test]
fn another_seed_gives_other_bits() {
    let f = cube(|[x]| x);
    let mean = |seed| MonteCarlo::new(10_000, seed).estimate(&f).unwrap().mean;
    assert_ne!(mean(1), mean(2));
    let replicated = |seed| {
        Replicated::new(4, 100, Independent::new)
            .seed(seed)
            .estimate(&f)
            .unwrap()
    };
    assert_ne!(replicated(1).mean, replicated(2).mean);
}
