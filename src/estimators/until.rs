//! Rules when to stop.

use core::fmt;
use core::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::evaluate::Wide;
use crate::{
    Error, Estimate, Estimator, Incomplete, Integrand, Outcome, Progressive, Stop, Value, Warning,
    reduce,
};

mod pace;

use pace::Pace;

/// An estimator with rules when to stop: the first that applies ends it. Made by [`Progressive::until`].
///
/// [`Estimate::stop`] tells which rule it was. Without a rule it runs until the
/// [budget](Progressive::budget) is used up, as without this adaptor.
///
/// # Tolerances
///
/// The error is half the width of the interval at the level (95 % if [`level`](Self::level) does not say otherwise). It
/// must be at most the absolute tolerance or at most the relative one times the mean, in every component.
///
/// The error is looked at after [`least`](Self::least) evaluations and then each time that their number has about doubled (of finite
/// sets: the number of those that are whole), so that few looks give few chances to stop by luck; the level is that of each look. An error bar of zero,
/// or one that hangs on a few values ([`Warning::FewValues`]) or strata ([`Warning::FewStrata`]), meets no tolerance: a rare event that was not
/// seen yet looks like that. At a singularity ([`Warning::Singular`]) it may be met by an interval that holds less often than it claims.
///
/// # Time and callback
///
/// Both are asked in between, some twenty times a second, as far as the integrand allows: where that would leave threads idle, which make
/// [so many](Progressive::portion) evaluations at a time, once a second at the least; and where one evaluation takes
/// longer, after each, or after a part of those that come in parts. What they stop is still a
/// full estimate, of the evaluations made by then, or of the finite sets that are whole, [`Error::TooEarly`] if none is; which they are depends on the machine, unlike everything else
/// in this crate.
#[must_use]
pub struct Until<E> {
    estimator: E,
    absolute: f64,
    relative: f64,
    level: f64,
    least: u64,
    time: Option<Duration>,
    watch: Option<Watch>,
}

type Watch = Box<dyn Fn(&Progress) -> ControlFlow<()> + Send + Sync>;

/// How far an estimate has come, as told to the callback of [`Until::watch`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Evaluations made so far.
    pub used: u64,
    /// Evaluations at most.
    pub budget: u64,
    /// Seconds since the start.
    pub seconds: f64,
}

impl<E: Progressive> Until<E> {
    pub(crate) fn new(estimator: E) -> Self {
        Self {
            estimator,
            absolute: 0.0,
            relative: 0.0,
            level: 0.95,
            least: 1 << 12,
            time: None,
            watch: None,
        }
    }

    /// Stops when the error is at most `tolerance`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a tolerance that is not above zero or not finite.
    pub fn absolute(mut self, tolerance: f64) -> Result<Self, Error> {
        self.absolute = positive("absolute tolerance", tolerance)?;
        Ok(self)
    }

    /// Stops when the error is at most `tolerance` times the absolute value of the mean.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a tolerance that is not above zero or not finite.
    pub fn relative(mut self, tolerance: f64) -> Result<Self, Error> {
        self.relative = positive("relative tolerance", tolerance)?;
        Ok(self)
    }

    /// The same with another level of confidence for the tolerances; the default is 0.95.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a level outside `(0, 1)`.
    pub fn level(mut self, level: f64) -> Result<Self, Error> {
        if !(level > 0.0 && level < 1.0) {
            return Err(Error::refused("level of confidence", "in (0, 1)", level));
        }
        self.level = level;
        Ok(self)
    }

    /// The same with another least number of evaluations before a tolerance is looked at; the default is 4096.
    pub fn least(mut self, evaluations: u64) -> Self {
        self.least = evaluations.max(2);
        self
    }

    /// Stops when `time` has passed.
    pub fn time(mut self, time: Duration) -> Self {
        self.time = Some(time);
        self
    }

    /// Calls `watch` now and then, and stops when it breaks.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use estimand::{Estimator, MonteCarlo, Progressive, Stop, cube};
    ///
    /// let estimate = MonteCarlo::new(1 << 40, 1)
    ///     .until()
    ///     .watch(|progress| {
    ///         if progress.used > 10_000 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    ///     })
    ///     .estimate(&cube(|[x]| x * x))?;
    /// assert_eq!(estimate.stop, Stop::Cancelled);
    /// assert!(estimate.used > 10_000 && estimate.interval(0.9999).unwrap().contains(1.0 / 3.0));
    /// # Ok::<(), estimand::Error>(())
    /// ```
    pub fn watch(
        mut self,
        watch: impl Fn(&Progress) -> ControlFlow<()> + Send + Sync + 'static,
    ) -> Self {
        self.watch = Some(Box::new(watch));
        self
    }

    /// Goes on with `state` until a rule applies.
    ///
    /// # Errors
    ///
    /// As [`Estimator::estimate`].
    pub fn resume<I: Integrand>(
        &self,
        state: &mut E::State<Wide<I>>,
        integrand: &I,
    ) -> Outcome<I::Value> {
        let clock = Instant::now();
        let outcome = self.advance(state, integrand, &clock);
        let finish = |stop: Stop| {
            self.estimator.conclude(state).map(|estimate| Estimate {
                stop,
                seconds: clock.elapsed().as_secs_f64(),
                ..estimate
            })
        };
        match outcome {
            Ok(stop) => {
                let used = self.estimator.used(state);
                let nothing = match stop {
                    Stop::Count => Error::NothingLeft { rejected: used },
                    _ => Error::TooEarly { used },
                };
                finish(stop).ok_or_else(|| nothing.into())
            }
            Err(reason) => Err(Incomplete {
                reason,
                so_far: finish(Stop::Unfinished).map(Box::new),
            }),
        }
    }

    fn advance<I: Integrand>(
        &self,
        state: &mut E::State<Wide<I>>,
        integrand: &I,
        clock: &Instant,
    ) -> Result<Stop, Error> {
        let budget = self.estimator.budget();
        let tolerant = self.absolute > 0.0 || self.relative > 0.0;
        let asking = self.time.is_some() || self.watch.is_some();
        let mut used = self.estimator.used(state);
        // Portions are not always found out at once.
        let mut pace = asking.then(|| Pace::new(self.estimator.portion(), reduce::number()));
        let mut look = if tolerant { self.least } else { budget };
        while look <= used {
            if tolerant && self.reached(state) {
                return Ok(Stop::Tolerance);
            }
            if used >= budget {
                return Ok(Stop::Count);
            }
            look = self.estimator.next_look(look).max(look + 1);
        }
        loop {
            let target = match &pace {
                Some(pace) => look.min(used.saturating_add(pace.stride)),
                None => look,
            };
            let target = target.min(budget);
            let before = clock.elapsed().as_secs_f64();
            self.estimator.grow(state, integrand, target)?;
            let seconds = clock.elapsed().as_secs_f64();
            let grown = self.estimator.used(state);
            if let Some(pace) = &mut pace {
                let (asked, made) = (target.saturating_sub(used), grown.saturating_sub(used));
                let end = self.time.map_or(f64::INFINITY, |time| time.as_secs_f64());
                pace.adapt(asked, made, seconds - before, end - seconds);
            }
            let complete = grown >= budget || grown == used;
            used = grown;
            if used >= look || complete {
                if tolerant && self.reached(state) {
                    return Ok(Stop::Tolerance);
                }
                look = self
                    .estimator
                    .next_look(look)
                    .max(used + 1)
                    .min(budget.max(used + 1));
            }
            if complete {
                return Ok(Stop::Count);
            }
            if self.time.is_some_and(|time| seconds >= time.as_secs_f64()) {
                return Ok(Stop::Time);
            }
            let progress = Progress {
                used,
                budget,
                seconds,
            };
            if let Some(watch) = &self.watch
                && watch(&progress).is_break()
            {
                return Ok(Stop::Cancelled);
            }
        }
    }

    fn reached<V: Value>(&self, state: &E::State<V>) -> bool {
        let Some(estimate) = self.estimator.conclude(state) else {
            return false;
        };
        let doubtful = estimate.warnings.iter().any(|warning| {
            matches!(
                warning,
                Warning::FewValues { .. } | Warning::FewStrata { .. } | Warning::NoSpread
            )
        });
        let Some(half) = estimate.half_width(self.level) else {
            return false;
        };
        let mut reached = !doubtful;
        let _ = half.zip(estimate.mean, |half, mean| {
            reached &= half <= self.absolute.max(self.relative * mean.abs());
            half
        });
        reached
    }
}

impl<E: Progressive> Estimator for Until<E> {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        let mut state = self.estimator.start()?;
        self.resume(&mut state, integrand)
    }
}

impl<E: fmt::Debug> fmt::Debug for Until<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Until")
            .field("estimator", &self.estimator)
            .field("absolute", &self.absolute)
            .field("relative", &self.relative)
            .field("level", &self.level)
            .field("least", &self.least)
            .field("time", &self.time)
            .finish_non_exhaustive()
    }
}

fn positive(name: &'static str, tolerance: f64) -> Result<f64, Error> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::refused(name, "above zero and finite", tolerance));
    }
    Ok(tolerance)
}
