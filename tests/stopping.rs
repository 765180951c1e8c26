//! Estimates that are cut into pieces, saved, stopped: always to the bit what one run gives.

use core::ops::ControlFlow;
use std::time::Duration;

use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::points::{Independent, NRooks, PointSet, Stratified};
use estimand::{
    Average, Error, Estimate, Estimator, Integrand, Moments, MonteCarlo, NonFinite, Progressive,
    Replicated, Sampler, Stop, Value, Warning, cube,
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

/// All of one type, for which every estimator is compiled once.
type Function = fn([f64; 2]) -> f64;

const PRODUCT: Function = |[x, y]| (x * y).exp();

/// The integral of the product.
const TRUTH: f64 = 1.317_902_151_454_404;

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

/// With the feature `parallel` every piece is evaluated by another number of threads than the one before.
fn in_pieces<E: Progressive + Sync, I: Integrand>(estimator: &E, integrand: &I, cuts: &[u64])
where
    E::State<<I::Value as Value>::Wide>: Send,
    <I::Value as Value>::Wide: PartialEq,
{
    let direct = on_threads(0, || estimator.estimate(integrand)).unwrap();
    let mut state = estimator.start().unwrap();
    let all = cuts.iter().chain(&[u64::MAX]);
    for (piece, &cut) in all.enumerate() {
        on_threads(piece + 1, || estimator.grow(&mut state, integrand, cut)).unwrap();
        assert!(estimator.used(&state) >= cut.min(direct.used));
    }
    assert_eq!(estimator.conclude(&state).unwrap(), direct);
}

/// Runs `work` on one, two or five threads.
#[cfg(feature = "parallel")]
fn on_threads<T: Send>(which: usize, work: impl FnOnce() -> T + Send) -> T {
    use rayon::{ThreadPool, ThreadPoolBuilder};
    static POOLS: std::sync::LazyLock<[ThreadPool; 3]> = std::sync::LazyLock::new(|| {
        [1, 2, 5].map(|threads| {
            ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap()
        })
    });
    POOLS[which % 3].install(work)
}

#[cfg(not(feature = "parallel"))]
fn on_threads<T>(_: usize, work: impl FnOnce() -> T) -> T {
    work()
}

/// Has limits, and values that are not finite.
struct Holes;

impl Integrand for Holes {
    type Value = [f64; 2];
    fn evaluate<S: Sampler>(&self, u: &mut S) -> [f64; 2] {
        let [x, y, z] = std::array::from_fn(|_| u.next_1d());
        if x < 0.1 && y < 0.3 || x + y > 1.6 {
            [f64::NAN, x]
        } else {
            [x * y, (5.0 * z).sin()]
        }
    }
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
        let rejecting = NonFinite::Reject;
        let vegas = Vegas::new(2, count + 40, seed).unwrap();
        in_pieces(&vegas, &Walk, &cuts);
        in_pieces(&vegas.non_finite(rejecting), &Holes, &cuts);
        let strata = Strata::new(1 + count % 7, 2, count + 200, seed).unwrap();
        in_pieces(&strata, &Walk, &cuts);
        in_pieces(&strata.neyman(), &Walk, &cuts);
        in_pieces(&strata.non_finite(rejecting), &Holes, &cuts);
        in_pieces(&strata.neyman().non_finite(rejecting), &Holes, &cuts);
        let bounded = Bounded::new(count + 1, seed, -1.0, 1.0).unwrap().non_finite(rejecting);
        in_pieces(&bounded, &Holes, &cuts);
        in_pieces(&Replicated::new(6, count, Independent::new).seed(seed).median(), &Walk, &cuts);
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
    saved_and_restored(&Bounded::new(12_345, 3, 0.0, 1e301).unwrap(), &cuts);
    let strata = Strata::new(5, 3, 12_345, 3).unwrap();
    saved_and_restored(&strata, &cuts);
    saved_and_restored(&strata.neyman(), &cuts);
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
    let strata = Strata::new(3, 2, 1000, 1).unwrap();
    let mut state = strata.start().unwrap();
    for other in [strata.neyman(), Strata::new(2, 3, 1000, 1).unwrap()] {
        let refused = other.grow(&mut state, &Walk, 5).unwrap_err();
        assert!(matches!(refused, Error::Refused { name: "state", .. }));
    }
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
    let f = cube(PRODUCT);
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
    let rare: Function = |[x, _]| if x < 1e-9 { 1.0 } else { 0.0 };
    let rare = cube(rare);
    let run = MonteCarlo::new(1 << 16, 3).until().absolute(0.1).unwrap();
    let estimate = run.estimate(&rare).unwrap();
    assert_eq!(estimate.stop, Stop::Count);
    assert_eq!(estimate.warnings, [Warning::NoSpread]);
}

#[test]
fn time_and_callback_stop() {
    let f: Function = |[x, _]| x;
    let f = cube(f);
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

/// What is left if it is stopped after about `evaluations`.
fn stopped<E: Progressive, I: Integrand>(
    estimator: E,
    integrand: &I,
    evaluations: u64,
) -> Estimate<<I::Value as Value>::Wide> {
    let watched = estimator.until().watch(move |progress| {
        if progress.used >= evaluations {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    watched.estimate(integrand).unwrap()
}

#[test]
fn whatever_was_evaluated_before_a_stop_gives_an_estimate() {
    let f = cube(PRODUCT);
    let check = |name: &str, estimate: Estimate<f64>| {
        assert_eq!(estimate.stop, Stop::Cancelled, "{name}");
        let interval = estimate.interval(0.9999).expect(name);
        assert!(interval.contains(TRUTH), "{name}: {estimate:?}");
    };
    let huge = 1 << 40;
    for evaluations in [20, 500, 20_000] {
        check("plain", stopped(MonteCarlo::new(huge, 1), &f, evaluations));
        let bounded = Bounded::new(huge, 1, 0.0, 3.0).unwrap();
        check("bounded", stopped(bounded, &f, evaluations));
        let strata = Strata::new(300, 2, huge, 1).unwrap();
        check("strata", stopped(strata, &f, evaluations));
        check("neyman", stopped(strata.neyman(), &f, evaluations));
        let vegas = Vegas::new(2, huge, 1).unwrap();
        check("vegas", stopped(vegas, &f, evaluations));
        let replicated = Replicated::new(8, huge, Independent::new);
        check("replicated", stopped(replicated, &f, evaluations));
    }
}

#[test]
fn finite_sets_are_taken_one_after_the_other() {
    let f = cube(PRODUCT);
    let set = |seed| Stratified::new(1024, 2, seed).unwrap();
    let size = set(0).size().unwrap();
    let replicated = |replicates| Replicated::new(replicates, size, set);
    let estimate = stopped(replicated(1 << 10), &f, 20 * size);
    let replicates = estimate.replicates.len() as u64;
    assert!((20..1 << 10).contains(&replicates), "{replicates}");
    assert_eq!(estimate.used, replicates * size);
    // No more and no less than these say on their own.
    let alone = replicated(replicates).estimate(&f).unwrap();
    assert_eq!(
        (estimate.mean, estimate.std_error),
        (alone.mean, alone.std_error)
    );
    assert!(estimate.interval(0.9999).unwrap().contains(TRUTH));
    // A part of one says nothing: it may be all in one place.
    let part = replicated(8).until().watch(|_| ControlFlow::Break(()));
    let early = part.estimate(&f).unwrap_err();
    assert!(matches!(early.reason, Error::TooEarly { used } if used < size));
    assert_eq!(early.so_far, None);
    // Two are the first to have an error.
    for least in [2, size, 2 * size] {
        let tolerant = replicated(64).until().absolute(1.0).unwrap().least(least);
        assert_eq!(tolerant.estimate(&f).unwrap().used, 2 * size);
        let median = replicated(64).median().until().absolute(1.0).unwrap();
        let used = median.least(least).estimate(&f).unwrap().used;
        assert!(used < 64 * size && used.is_multiple_of(size), "{used}");
    }
}

#[test]
fn strata_that_were_not_visited_are_told_of() {
    let f = cube(PRODUCT);
    let strata = Strata::new(100, 2, 1 << 30, 1).unwrap();
    let some = |estimate: &Estimate<f64>| {
        let [Warning::Unvisited { visited, strata }] = estimate.warnings[..] else {
            panic!("other warnings: {:?}", estimate.warnings);
        };
        assert!(visited < strata);
        [visited, strata]
    };
    let estimate = stopped(strata, &f, 1000);
    assert_eq!(some(&estimate), [estimate.used / 2, 10_000]);
    // All of them with few points have a much smaller error than some.
    let all = stopped(strata, &f, 20_000);
    assert!(all.warnings.is_empty());
    assert!(all.std_error.unwrap() < 0.05 * estimate.std_error.unwrap());
    // A pilot of all cells is better than the first few cells of the main points.
    let neyman = Strata::new(100, 2, 400_000, 1).unwrap().neyman();
    some(&stopped(neyman, &f, 1000));
    let mut state = neyman.start().unwrap();
    for evaluations in [20_000, 40_000, 41_000, 400_000] {
        neyman.grow(&mut state, &f, evaluations).unwrap();
        let estimate: Estimate<f64> = neyman.conclude(&state).unwrap();
        assert!(estimate.warnings.is_empty(), "{estimate:?}");
    }
    // Sixteen of its strata, so few that one of them may decide; that is told as well.
    let vegas = stopped(Vegas::new(2, 1 << 40, 1).unwrap(), &f, 1000);
    let told = |warning: &Warning| {
        matches!(
            warning,
            Warning::Unvisited {
                visited: 2..1000,
                strata: 60_000..
            }
        )
    };
    assert!(vegas.warnings.iter().any(told), "{:?}", vegas.warnings);
}

#[test]
fn errors_of_some_strata_are_the_true_ones() {
    // Means over 400 seeds: the mean square error is that which is claimed, to 6 standard deviations of a chi-square.
    let f = cube(PRODUCT);
    let check = |name: &str, estimate: &dyn Fn(u64) -> Estimate<f64>| {
        let (mut means, mut claims) = (Moments::new(), Moments::new());
        for seed in 0..400 {
            let estimate = estimate(seed);
            means.push(estimate.mean);
            claims.push(estimate.std_error.unwrap().powi(2));
        }
        let off = (means.mean() - TRUTH) / means.std_error().unwrap();
        assert!(
            off.abs() < 4.5,
            "{name}: {off} standard errors from the truth"
        );
        let ratio = claims.mean() / means.variance().unwrap();
        assert!(
            (ratio - 1.0).abs() < 6.0 * (2.0_f64 / 400.0).sqrt(),
            "{name}: {ratio}"
        );
    };
    check("strata", &|seed| {
        let strata = Strata::new(64, 2, 1 << 20, seed).unwrap();
        let mut state = strata.start().unwrap();
        strata.grow(&mut state, &f, 300).unwrap();
        strata.conclude(&state).unwrap()
    });
    check("vegas", &|seed| {
        let vegas = Vegas::new(2, 1 << 22, seed).unwrap();
        let mut state = vegas.start().unwrap();
        vegas.grow(&mut state, &f, 900).unwrap();
        vegas.conclude(&state).unwrap()
    });
}

#[test]
fn strata_stop_at_tolerances() {
    let f = cube(PRODUCT);
    for neyman in [false, true] {
        let strata = Strata::new(16, 2, 1 << 40, 3).unwrap();
        let strata = if neyman { strata.neyman() } else { strata };
        let run = strata.until().relative(1e-4).unwrap();
        let estimate = run.estimate(&f).unwrap();
        assert_eq!(estimate.stop, Stop::Tolerance);
        // Plain points would take (1.96 * 0.27 / 1e-4)^2, some 28 million.
        assert!(estimate.used < 1 << 19, "{}", estimate.used);
        assert!((estimate.mean / TRUTH - 1.0).abs() < 3e-4);
    }
    let bounded = Bounded::new(1 << 40, 3, 0.0, 3.0).unwrap();
    let estimate = bounded
        .until()
        .relative(1e-2)
        .unwrap()
        .estimate(&f)
        .unwrap();
    assert_eq!(estimate.stop, Stop::Tolerance);
}

#[test]
fn a_slow_integrand_does_not_outlast_its_time_by_much() {
    // A millisecond each: an iteration of VEGAS, or a round of strata, would take more than an hour.
    let slow: Function = |[x, _]| {
        std::thread::sleep(Duration::from_millis(1));
        x
    };
    let slow = cube(slow);
    let time = Duration::from_millis(100);
    let check = |name: &str, estimate: Estimate<f64>| {
        assert_eq!(estimate.stop, Stop::Time, "{name}");
        assert!(estimate.seconds < 5.0, "{name}: {}", estimate.seconds);
        assert!(estimate.interval(0.9999).unwrap().contains(0.5), "{name}");
    };
    let vegas = Vegas::new(1, 1 << 40, 1).unwrap().until().time(time);
    check("vegas", vegas.estimate(&slow).unwrap());
    let strata = Strata::new(1 << 16, 1, 1 << 40, 1).unwrap();
    check("strata", strata.until().time(time).estimate(&slow).unwrap());
    check(
        "neyman",
        strata.neyman().until().time(time).estimate(&slow).unwrap(),
    );
    let plain = MonteCarlo::new(1 << 40, 1).until().time(time);
    check("plain", plain.estimate(&slow).unwrap());
}

#[test]
fn senseless_rules_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(MonteCarlo::new(1, 1).until().absolute(bad).is_err());
        assert!(MonteCarlo::new(1, 1).until().relative(bad).is_err());
        assert!(MonteCarlo::new(1, 1).until().level(bad).is_err());
    }
}
