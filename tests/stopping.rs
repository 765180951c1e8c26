//! Estimates that are cut into pieces, saved, stopped: always to the bit what one run gives.

use core::ops::ControlFlow;
use std::time::Duration;

use estimand::estimators::Vegas;
use estimand::points::{Independent, NRooks, Stratified};
use estimand::{
    Average, Error, Estimator, Integrand, MonteCarlo, NonFinite, Progressive, Replicated, Sampler,
    Stop, Warning, cube,
};
use proptest::prelude::*;

/// Reads a number of coordinates that depends on them: the hardest to take up in the middle.
struct Walk;

impl Integrand for Walk {
    type Value = [f64; 2];
    fn evaluate<S: Sampler>(&self, u: &mut S) -> [f64; 2] {
        let (mut sum, mut steps) = (0.0, 0.0);
        while sum <= 1.0 {
            sum += u.next_1d();
            steps += 1.0;
        }
        [steps, 1e300 * sum]
    }
}

/// Some points are NaN, some blocks constant, some full of tiny values.
struct Rough;

impl Integrand for Rough {
    type Value = f64;
    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        let x = u.next_1d();
        if x < 1e-3 {
            f64::NAN
        } else if x < 0.5 {
            1e-200 * u.next_1d()
        } else {
            1.0
        }
    }
}

fn in_pieces<E: Progressive, I: Integrand>(estimator: &E, integrand: &I, cuts: &[u64])
where
    <I::Value as estimand::Value>::Wide: PartialEq,
{
    let mut state = estimator.start().unwrap();
    let direct = estimator.estimate(integrand).unwrap();
    for &cut in cuts {
        estimator.grow(&mut state, integrand, cut).unwrap();
        assert!(estimator.used(&state) >= cut.min(direct.used));
    }
    estimator.grow(&mut state, integrand, u64::MAX).unwrap();
    assert_eq!(estimator.conclude(&state).unwrap(), direct);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..Default::default() })]

    #[test]
    fn pieces_are_one_run(
        count in 1_u64..6000,
        mut cuts in prop::collection::vec(0_u64..12_000, 0..6),
        seed: u64,
    ) {
        cuts.sort_unstable();
        in_pieces(&MonteCarlo::new(count, seed), &Walk, &cuts);
        in_pieces(&MonteCarlo::new(count, seed).non_finite(NonFinite::Reject), &Rough, &cuts);
        in_pieces(&Average::new(Independent::new(seed), count), &Walk, &cuts);
        in_pieces(&Vegas::new(2, count + 40, seed).unwrap(), &Walk, &cuts);
        in_pieces(
            &Replicated::new(3, count, Independent::new).seed(seed).non_finite(NonFinite::Reject),
            &Rough,
            &cuts,
        );
        in_pieces(&Replicated::new(3, count, |seed| NRooks::new(100, seed).unwrap()), &Walk, &cuts);
        in_pieces(&Average::new(Stratified::new(count, 2, seed).unwrap(), count), &Walk, &cuts);
    }
}

/// Saves and restores the state between any two pieces of work.
#[cfg(feature = "serde")]
fn saved_and_restored<E: Progressive>(estimator: &E, cuts: &[u64])
where
    E::State<[f64; 2]>: serde::Serialize + serde::de::DeserializeOwned + PartialEq,
{
    let mut state = estimator.start::<[f64; 2]>().unwrap();
    for &cut in cuts {
        estimator.grow(&mut state, &Walk, cut).unwrap();
        let saved = serde_json::to_string(&state).unwrap();
        let restored = serde_json::from_str(&saved).unwrap();
        assert!(state == restored, "at {cut}");
        state = restored;
    }
    let estimate = estimator.conclude(&state).unwrap();
    assert_eq!(estimate, estimator.estimate(&Walk).unwrap());
    let saved = serde_json::to_string(&estimate).unwrap();
    let restored = serde_json::from_str(&saved).unwrap();
    assert_eq!(estimate, restored, "estimates can be saved too");
}

#[cfg(feature = "serde")]
#[test]
fn a_saved_state_goes_on_as_if_it_had_not_been_saved() {
    let cuts = [1, 700, 5000, 11_111, u64::MAX];
    saved_and_restored(&MonteCarlo::new(12_345, 3), &cuts);
    saved_and_restored(&Average::new(Independent::new(3), 12_345), &cuts);
    let rooks = Replicated::new(4, 3000, |seed| NRooks::new(3000, seed).unwrap());
    saved_and_restored(&rooks, &cuts);
    let replicated = Replicated::new(4, 3000, Independent::new).non_finite(NonFinite::Reject);
    saved_and_restored(&replicated, &cuts);
    saved_and_restored(&replicated.median(), &cuts);
    saved_and_restored(&Vegas::new(2, 12_345, 3).unwrap(), &cuts);
    // Iterations of several parts, cut within.
    let long = Vegas::new(2, 30_000, 3).unwrap().iterations(2).unwrap();
    saved_and_restored(&long, &[1, 5000, 9000, 20_000, u64::MAX]);
}

#[test]
fn the_state_of_another_estimator_is_refused() {
    let mut state = MonteCarlo::new(10, 1).start().unwrap();
    let other = Replicated::new(4, 10, Independent::new);
    let refused = other.grow(&mut state, &Walk, 5).unwrap_err();
    assert!(matches!(refused, Error::Refused { name: "state", .. }));
}

#[test]
fn a_stopped_state_holds_the_points_before_and_stops_again() {
    let estimator = MonteCarlo::new(10_000, 5);
    let mut state = estimator.start().unwrap();
    let first = estimator.grow(&mut state, &Rough, 10_000).unwrap_err();
    let Error::NonFinite { index, .. } = first else {
        panic!("stopped by {first}");
    };
    assert_eq!(estimator.used(&state), index);
    let again = estimator.grow(&mut state, &Rough, 10_000).unwrap_err();
    // As text, because NaN is not equal to itself.
    assert_eq!(again.to_string(), first.to_string());
    let incomplete = estimator.estimate(&Rough).unwrap_err();
    let so_far = incomplete.so_far.unwrap();
    assert_eq!((so_far.used, so_far.stop), (index, Stop::Unfinished));
}

#[test]
fn tolerances_stop_early_and_say_so() {
    let f = cube(|[x, y]: [f64; 2]| (x * y).exp());
    let run = MonteCarlo::new(1 << 24, 3).until().relative(1e-2).unwrap();
    let estimate = run.estimate(&f).unwrap();
    assert_eq!(estimate.stop, Stop::Tolerance);
    assert!(estimate.used < 1 << 16);
    // The same evaluations without the rule.
    let direct = MonteCarlo::new(estimate.used, 3).estimate(&f).unwrap();
    assert_eq!(direct.mean, estimate.mean);

    let missed = MonteCarlo::new(5000, 3).until().absolute(1e-9).unwrap();
    let missed = missed.estimate(&f).unwrap();
    assert_eq!((missed.stop, missed.used), (Stop::Count, 5000));
}

#[test]
fn an_event_that_was_never_seen_meets_no_tolerance() {
    let rare = cube(|[x]| if x < 1e-9 { 1.0 } else { 0.0 });
    let run = MonteCarlo::new(1 << 16, 3).until().absolute(0.1).unwrap();
    let estimate = run.estimate(&rare).unwrap();
    assert_eq!(estimate.stop, Stop::Count);
    assert_eq!(estimate.warnings, [Warning::NoSpread]);
}

#[test]
fn time_and_callback_stop() {
    let f = cube(|[x]| x);
    let endless = MonteCarlo::new(u64::MAX, 3);
    let timed = endless.until().time(Duration::from_millis(20));
    let estimate = timed.estimate(&f).unwrap();
    assert_eq!(estimate.stop, Stop::Time);
    assert!(estimate.seconds >= 0.02 && estimate.seconds < 5.0);
    let direct = MonteCarlo::new(estimate.used, 3).estimate(&f).unwrap();
    assert_eq!(direct.mean, estimate.mean);

    let watched = Replicated::new(8, u64::MAX / 8, Independent::new)
        .until()
        .watch(|progress| {
            if progress.used >= 1000 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    let estimate = watched.estimate(&f).unwrap();
    assert_eq!(estimate.stop, Stop::Cancelled);
    assert!(estimate.used >= 1000 && estimate.used < 10_000_000);
}

#[test]
fn senseless_rules_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(MonteCarlo::new(1, 1).until().absolute(bad).is_err());
        assert!(MonteCarlo::new(1, 1).until().relative(bad).is_err());
        assert!(MonteCarlo::new(1, 1).until().level(bad).is_err());
    }
}
