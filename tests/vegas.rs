//! VEGAS where there is nothing to learn from, where one setting is at its least, and where it has to stop.

use std::ops::ControlFlow;

use estimand::estimators::Vegas;
use estimand::integrands::ImportanceMap;
use estimand::{Error, Estimator, Integrand, Progressive, Sampler, Stop, Warning, cube};

fn peak() -> impl estimand::Integrand<Value = f64> {
    cube(|[x, y]: [f64; 2]| (-1e4 * ((x - 0.5).powi(2) + (y - 0.2).powi(2))).exp())
}

/// The tails outside the square are below 1e-170.
const PEAK: f64 = core::f64::consts::PI / 1e4;

#[test]
fn nothing_but_zeros_is_zero_and_trains_nothing() {
    let vegas = Vegas::new(3, 10_000, 1).unwrap();
    let adapted = vegas.run(&cube(|[_, _, _]| 0.0_f64)).unwrap();
    assert_eq!(
        (adapted.estimate.mean, adapted.estimate.std_error),
        (0.0, Some(0.0))
    );
    assert_eq!(adapted.estimate.warnings, [Warning::NoSpread]);
    assert_eq!(adapted.chi_square, Some(0.0));
    let bins = adapted.map.bins();
    assert_eq!(adapted.map, ImportanceMap::identity(3, bins).unwrap());
}

/// The sixth power of the first coordinate above 1/2, where no other is read; below it times the third power of the second.
struct Reluctant;

impl Integrand for Reluctant {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        let x = u.next_1d();
        if x > 0.5 {
            x.powi(6)
        } else {
            x * u.next_1d().powi(3)
        }
    }

    fn dimensions(&self) -> u32 {
        2
    }
}

#[test]
fn coordinates_that_are_not_read_weigh_nothing() {
    let truth = (1.0 - 0.5_f64.powi(7)) / 7.0 + 0.125 / 4.0;
    // Five standard errors: fails in 6e-7 of all choices of each seed.
    for seed in 0..5 {
        let adapted = Vegas::new(2, 100_000, seed)
            .unwrap()
            .run(&Reluctant)
            .unwrap();
        let (mean, error) = (adapted.estimate.mean, adapted.estimate.std_error.unwrap());
        assert!((mean - truth).abs() < 5.0 * error, "{mean} +- {error}");
        assert!(error < 1e-3, "{error}");
    }
}

#[test]
fn one_bin_leaves_the_strata_to_do_the_work() {
    let single = ImportanceMap::identity(2, 1).unwrap();
    let vegas = Vegas::new(2, 100_000, 1).unwrap().map(single.clone());
    let adapted = vegas.run(&peak()).unwrap();
    assert_eq!(adapted.map, single);
    assert!(adapted.estimate.interval(0.9999).unwrap().contains(PEAK));
    // All of them make the estimate, since the map is taken to be trained.
    assert_eq!(adapted.iterations.len(), 10);
    assert_eq!(adapted.estimate.replicates.len(), 10);
}

#[test]
fn one_iteration_is_an_estimate_without_a_chi_square() {
    let vegas = Vegas::new(2, 10_000, 1).unwrap().iterations(1).unwrap();
    let adapted = vegas.run(&cube(|[x, y]| x * y)).unwrap();
    assert_eq!((adapted.iterations.len(), adapted.chi_square), (1, None));
    assert!(!adapted.iterations[0].training);
    assert!(adapted.estimate.interval(0.9999).unwrap().contains(0.25));
}

#[test]
fn the_least_count_is_an_estimate_with_a_warning() {
    let estimate = Vegas::new(2, 40, 1)
        .unwrap()
        .estimate(&cube(|[x, y]| x * y))
        .unwrap();
    assert!(estimate.interval(0.9999).unwrap().contains(0.25));
    assert!(
        estimate
            .warnings
            .contains(&Warning::SmallSample { count: 40 })
    );
}

#[test]
fn components_of_any_scale_train_the_same_map() {
    // gplepage/vegas#27: 1 and 1e60 at once ended in 0 (0) and NaN.
    let f = cube(|[x, y]: [f64; 2]| {
        let value = (-1e4 * ((x - 0.5).powi(2) + (y - 0.2).powi(2))).exp();
        [1e-280 * value, value, 1e280 * value]
    });
    let adapted = Vegas::new(2, 50_000, 1).unwrap().run(&f).unwrap();
    let alone = Vegas::new(2, 50_000, 1).unwrap().run(&peak()).unwrap();
    let error = alone.estimate.std_error.unwrap();
    for (k, scale) in [1e-280, 1.0, 1e280].into_iter().enumerate() {
        let off = adapted.estimate.mean[k] / scale - PEAK;
        let claimed = adapted.estimate.std_error.unwrap()[k] / scale;
        assert!(
            off.abs() < 5.0 * claimed && claimed < 2.0 * error,
            "{scale}: {off}, {claimed}"
        );
    }
    assert!(adapted.chi_square.unwrap() < 5.0);
}

#[test]
fn a_trained_map_is_worth_its_training() {
    let map = Vegas::new(2, 50_000, 1).unwrap().train(&peak()).unwrap();
    let with = Vegas::new(2, 10_000, 2).unwrap().map(map);
    let without = Vegas::new(2, 10_000, 2).unwrap().iterations(1).unwrap();
    let (with, without) = (
        with.estimate(&peak()).unwrap(),
        without.estimate(&peak()).unwrap(),
    );
    assert!(with.interval(0.9999).unwrap().contains(PEAK));
    assert!(with.std_error.unwrap() < 0.1 * without.std_error.unwrap());
}

#[test]
fn iterations_that_contradict_one_another_widen_the_error_to_their_spread() {
    // A peak that some iterations miss: those claim an error of nearly nothing.
    let rare = cube(|[x, y]: [f64; 2]| (-0.5e8 * ((x - 0.3).powi(2) + (y - 0.6).powi(2))).exp());
    let seen = (0..200)
        .map(|seed| Vegas::new(2, 16_384, seed).unwrap().run(&rare).unwrap())
        .filter(|run| {
            let warning = |warning: &Warning| matches!(warning, Warning::Inconsistent { .. });
            run.estimate.warnings.iter().any(warning)
        });
    let mut count = 0;
    for run in seen {
        let means: estimand::Moments<f64> = run.estimate.replicates.iter().copied().collect();
        let error = run.estimate.std_error.unwrap();
        assert!(error.is_finite() && error >= means.std_error().unwrap());
        count += 1;
    }
    assert!(count > 3, "{count} runs contradict themselves");
}

#[test]
fn a_value_that_is_not_finite_is_named_and_ends_it() {
    let f = cube(|[x, y]| if x > 0.999 { f64::NAN } else { x * y });
    let stopped = Vegas::new(2, 100_000, 1).unwrap().estimate(&f).unwrap_err();
    let Error::NonFinite {
        coordinates, value, ..
    } = stopped.reason
    else {
        panic!("another error: {stopped}");
    };
    assert!(coordinates.len() == 2 && coordinates[0] > 0.999 && value[0].is_nan());
}

#[test]
fn a_callback_stops_it_within_an_iteration() {
    let stop_at = |evaluations| {
        let endless = Vegas::new(2, 1 << 40, 1).unwrap();
        let watched = endless.until().watch(move |progress| {
            if progress.used >= evaluations {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        watched.estimate(&peak())
    };
    // Some of the strata of the first iteration.
    let early = stop_at(100_000).unwrap();
    assert!((100_000..4_000_000).contains(&early.used), "{}", early.used);
    assert!(early.replicates.is_empty());
    assert!(matches!(
        early.warnings[..],
        [Warning::Unvisited { .. }, ..]
    ));
    assert!(early.interval(0.9999).unwrap().contains(PEAK));
    // One iteration is complete, or two where the machine was fast.
    let estimate = stop_at(5_000_000).unwrap();
    assert_eq!(estimate.stop, Stop::Cancelled);
    assert!((1..=2).contains(&estimate.replicates.len()));
    assert!(estimate.interval(0.9999).unwrap().contains(PEAK));
}
