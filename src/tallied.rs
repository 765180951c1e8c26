//! What the estimators have in common whose state is one tally a source.

use std::time::Instant;

use crate::evaluate::{BLOCK, Source, Tail, Wide, evaluate};
use crate::tally::Tally;
use crate::{Error, Estimate, Incomplete, Integrand, NonFinite, Stop, Value, reduce};

/// The state of the estimators that average over one or more sources of points: count, mean and spread of each.
///
/// See [`Progressive`](crate::Progressive).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tallies<V>(Vec<Tally<V>>);

impl<V: Value> Tallies<V> {
    pub(crate) fn new(sources: usize) -> Self {
        Self(vec![Tally::EMPTY; sources])
    }

    /// That of one source, closed.
    #[cfg(feature = "path")]
    pub(crate) fn of(tally: Tally<V>) -> Self {
        Self(vec![tally])
    }

    /// How many evaluations were made.
    pub fn used(&self) -> u64 {
        self.0.iter().map(Tally::used).sum()
    }

    /// The tallies with the blocks that were begun counted in.
    pub(crate) fn closed(&self) -> Vec<Tally<V>> {
        self.0.iter().map(Tally::closed).collect()
    }
}

/// An estimator whose state is one tally a source.
pub(crate) trait Tallied {
    type Source<'a>: Source
    where
        Self: 'a;

    /// Where the points come from.
    fn sources(&self) -> Result<Vec<Self::Source<'_>>, Error>;

    /// How many points of each source make `evaluations` in all, or the next larger number that there is.
    fn counts(&self, sources: &[Self::Source<'_>], evaluations: u64) -> Vec<u64>;

    /// The number of evaluations that were asked for.
    fn requested(&self) -> u64;

    /// As [`Progressive::next_look`](crate::Progressive::next_look).
    fn next_look(&self, evaluations: u64) -> u64 {
        evaluations.saturating_mul(2)
    }

    fn policy(&self) -> NonFinite;

    /// Whether the values are such as the estimator can take.
    fn check<V: Value>(&self, _: &Tallies<V>) -> Result<(), Error> {
        Ok(())
    }

    /// The estimate that the closed tallies give; `None` if they hold no value that counts.
    fn summary<V: Value>(&self, tallies: &[Tally<V>]) -> Option<Estimate<V>>;
}

/// The estimate from all points at once.
pub(crate) fn run<E: Tallied, I: Integrand>(
    estimator: &E,
    integrand: &I,
) -> Result<Estimate<Wide<I>>, Incomplete<Wide<I>>> {
    let clock = Instant::now();
    let sources = estimator.sources()?;
    let mut tallies = Tallies::new(sources.len());
    let counts = estimator.counts(&sources, estimator.requested());
    let policy = estimator.policy();
    let outcome = evaluate(
        &sources,
        &mut tallies.0,
        &counts,
        Tail::Closed,
        integrand,
        policy,
    );
    finish(estimator, &tallies, outcome, clock.elapsed().as_secs_f64())
}

/// The estimate of a run that ended with `outcome`. Apart, since it does not depend on the integrand.
pub(crate) fn finish<E: Tallied, V: Value>(
    estimator: &E,
    tallies: &Tallies<V>,
    outcome: Result<(), Error>,
    seconds: f64,
) -> Result<Estimate<V>, Incomplete<V>> {
    let outcome = estimator.check(tallies).and(outcome);
    let tallies = tallies.closed();
    let estimate = estimator.summary(&tallies).map(|estimate| Estimate {
        stop: if outcome.is_ok() {
            Stop::Count
        } else {
            Stop::Unfinished
        },
        seconds,
        ..estimate
    });
    match outcome {
        Ok(()) => estimate.ok_or_else(|| {
            Error::NothingLeft {
                rejected: tallies.iter().map(Tally::rejected).sum(),
            }
            .into()
        }),
        Err(reason) => Err(Incomplete {
            reason,
            so_far: estimate.map(Box::new),
        }),
    }
}

/// Goes on with a state up to `evaluations`.
pub(crate) fn grow<E: Tallied, I: Integrand>(
    estimator: &E,
    state: &mut Tallies<Wide<I>>,
    integrand: &I,
    evaluations: u64,
) -> Result<(), Error> {
    let sources = estimator.sources()?;
    if sources.len() != state.0.len() {
        return Err(Error::refused(
            "state",
            "one of this estimator, with as many sources of points",
            state.0.len(),
        ));
    }
    let evaluations = evaluations.min(estimator.requested());
    let counts = estimator.counts(&sources, evaluations);
    let policy = estimator.policy();
    let outcome = evaluate(
        &sources,
        &mut state.0,
        &counts,
        Tail::Open,
        integrand,
        policy,
    );
    estimator.check(state).and(outcome)
}

/// The estimate that a state gives.
pub(crate) fn conclude<E: Tallied, V: Value>(
    estimator: &E,
    state: &Tallies<V>,
) -> Option<Estimate<V>> {
    let sources = estimator.sources().ok()?;
    let whole: u64 = estimator
        .counts(&sources, estimator.requested())
        .iter()
        .sum();
    let estimate = estimator.summary(&state.closed())?;
    let stop = if state.used() >= whole {
        Stop::Count
    } else {
        Stop::Unfinished
    };
    Some(Estimate { stop, ..estimate })
}

/// Where each thread has a source of its own, one evaluation; of a few sources, or of sources one after the other, a block.
pub(crate) fn portion<E: Tallied>(estimator: &E) -> u64 {
    let threads = reduce::number();
    let busy = estimator.sources().map_or(0, |sources| {
        let counts = estimator.counts(&sources, threads as u64);
        counts.into_iter().filter(|&count| count > 0).count()
    });
    if busy < threads { BLOCK } else { 1 }
}

/// Implements the public traits for an estimator that is [`Tallied`].
macro_rules! tallied {
    ([$($generics:tt)*] $estimator:ty) => {
        impl<$($generics)*> $crate::Estimator for $estimator {
            fn estimate<I: $crate::Integrand>(&self, integrand: &I) -> $crate::Outcome<I::Value> {
                $crate::tallied::run(self, integrand)
            }
        }

        impl<$($generics)*> $crate::Progressive for $estimator {
            type State<V: $crate::Value> = $crate::Tallies<V>;

            fn budget(&self) -> u64 {
                $crate::tallied::Tallied::requested(self)
            }

            fn start<V: $crate::Value>(&self) -> Result<$crate::Tallies<V>, $crate::Error> {
                let sources = $crate::tallied::Tallied::sources(self)?;
                Ok($crate::Tallies::new(sources.len()))
            }

            fn used<V: $crate::Value>(&self, state: &$crate::Tallies<V>) -> u64 {
                state.used()
            }

            fn grow<I: $crate::Integrand>(
                &self,
                state: &mut $crate::Tallies<$crate::evaluate::Wide<I>>,
                integrand: &I,
                evaluations: u64,
            ) -> Result<(), $crate::Error> {
                $crate::tallied::grow(self, state, integrand, evaluations)
            }

            fn conclude<V: $crate::Value>(
                &self,
                state: &$crate::Tallies<V>,
            ) -> Option<$crate::Estimate<V>> {
                $crate::tallied::conclude(self, state)
            }

            fn portion(&self) -> u64 {
                $crate::tallied::portion(self)
            }

            fn next_look(&self, evaluations: u64) -> u64 {
                $crate::tallied::Tallied::next_look(self, evaluations)
            }
        }
    };
}

pub(crate) use tallied;
