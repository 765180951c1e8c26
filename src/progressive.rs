//! Estimates that grow: stopped, saved and gone on with, to the same bits.

use std::time::Instant;

use crate::evaluate::Wide;
use crate::{Error, Estimate, Estimator, Incomplete, Integrand, Outcome, Value};

/// An estimator whose work can be interrupted and gone on with.
///
/// The state of the work is a value of its own. No evaluation is made twice, and however the work was cut into
/// pieces the estimate is to the bit that of [`Estimator::estimate`]. With the feature `serde` a state can be saved;
/// choose a format that keeps every bit of a number, as `serde_json` does with its feature
/// `float_roundtrip`.
///
/// [`until`](Self::until) puts stop rules on top: tolerances, time, and a callback.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, Progressive, cube};
///
/// let square = cube(|[x]| x * x);
/// let estimator = MonteCarlo::new(10_000, 1);
///
/// let mut state = estimator.start()?;
/// estimator.grow(&mut state, &square, 777)?;
/// let so_far = estimator.conclude(&state).unwrap();
/// assert_eq!(so_far.used, 777);
/// estimator.grow(&mut state, &square, 10_000)?;
///
/// assert_eq!(estimator.conclude(&state).unwrap(), estimator.estimate(&square)?);
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait Progressive: Estimator {
    /// What the work has given so far, for values whose wide form is `V`.
    type State<V: Value>: Clone;

    /// How many evaluations a complete estimate takes.
    fn budget(&self) -> u64;

    /// The state before any work.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the estimator cannot be run as it was set up.
    fn start<V: Value>(&self) -> Result<Self::State<V>, Error>;

    /// How many evaluations the state holds.
    fn used<V: Value>(&self, state: &Self::State<V>) -> u64;

    /// Goes on until `evaluations` have been made in all, or a few more where they come only in some numbers, or
    /// the [budget](Self::budget) is used up. Those that the state holds already are not made again.
    ///
    /// `integrand` must be the one that the state was begun with.
    ///
    /// # Errors
    ///
    /// [`Error::NonFinite`] as [`Estimator::estimate`]; the state then holds the points before. [`Error::Refused`] for
    /// a state of another estimator.
    fn grow<I: Integrand>(
        &self,
        state: &mut Self::State<Wide<I>>,
        integrand: &I,
        evaluations: u64,
    ) -> Result<(), Error>;

    /// The estimate that the work so far gives; `None` if there is no value yet, or no whole set where only whole ones count.
    fn conclude<V: Value>(&self, state: &Self::State<V>) -> Option<Estimate<V>>;

    /// How many evaluations one thread makes at a time, at the most: fewer than that for each thread may leave some idle.
    fn portion(&self) -> u64;

    /// The number of evaluations at which a test of the error is worth while, after one at `evaluations`.
    ///
    /// Points that are best in powers of two double.
    fn next_look(&self, evaluations: u64) -> u64 {
        evaluations.saturating_mul(2)
    }

    /// The same with rules when to stop.
    ///
    /// ```
    /// use std::time::Duration;
    /// use estimand::{Estimator, MonteCarlo, Progressive, Stop, cube};
    ///
    /// let square = cube(|[x]| x * x);
    /// let estimate = MonteCarlo::new(1 << 40, 1)
    ///     .until()
    ///     .relative(1e-2)?
    ///     .time(Duration::from_secs(60))
    ///     .estimate(&square)?;
    /// assert_eq!(estimate.stop, Stop::Tolerance);
    /// assert!((estimate.mean - 1.0 / 3.0).abs() < 2.0 * 1e-2 / 3.0);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    fn until(self) -> crate::estimators::Until<Self>
    where
        Self: Sized,
    {
        crate::estimators::Until::new(self)
    }
}

/// The complete estimate of an estimator that grows.
pub(crate) fn at_once<E: Progressive, I: Integrand>(
    estimator: &E,
    integrand: &I,
) -> Outcome<I::Value> {
    let clock = Instant::now();
    let mut state = estimator.start()?;
    let outcome = estimator.grow(&mut state, integrand, u64::MAX);
    let estimate = estimator.conclude(&state).map(|estimate| Estimate {
        seconds: clock.elapsed().as_secs_f64(),
        ..estimate
    });
    match outcome {
        Ok(()) => estimate.ok_or_else(|| {
            let rejected = estimator.used(&state);
            Error::NothingLeft { rejected }.into()
        }),
        Err(reason) => Err(Incomplete {
            reason,
            so_far: estimate.map(Box::new),
        }),
    }
}
