//! What was refused, with the offending value; and what was computed before an estimate had to stop.

use core::fmt;

use crate::{Estimate, Value};

/// What was refused, with the offending value.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// An argument lies outside its domain.
    Refused {
        /// Which argument, in words.
        name: &'static str,
        /// What it must be.
        domain: &'static str,
        /// What it was.
        value: String,
    },
    /// The integrand returned NaN or an infinity.
    NonFinite {
        /// The index of the point in its set or stream.
        index: u64,
        /// Which replicate the point belongs to; 0 where there is only one.
        replicate: u64,
        /// The coordinates that the integrand read there.
        coordinates: Vec<f64>,
        /// The components of what it returned; where those are finite, times what the point weighs, which are not.
        value: Vec<f64>,
    },
    /// Every value was rejected as not finite, so that there is nothing to average.
    NothingLeft {
        /// How many values were rejected.
        rejected: u64,
    },
    /// It was stopped before there was an estimate.
    TooEarly {
        /// How many evaluations were made by then.
        used: u64,
    },
    /// Two replicates have the same points, so that their spread says nothing about the error.
    IdenticalReplicates {
        /// The first of the two.
        first: u64,
        /// The second of the two.
        second: u64,
    },
}

impl Error {
    /// An argument outside its domain: `name` must be `domain`, it was `value`.
    pub fn refused(name: &'static str, domain: &'static str, value: impl fmt::Display) -> Self {
        Self::Refused {
            name,
            domain,
            value: value.to_string(),
        }
    }
}

impl Error {
    /// A value that is not finite, of the point `index`.
    pub(crate) fn of_value<V: Value>(index: u64, coordinates: Vec<f64>, value: V) -> Self {
        let mut components = Vec::new();
        value.for_each(|component| components.push(component));
        Self::NonFinite {
            index,
            replicate: 0,
            coordinates,
            value: components,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused {
                name,
                domain,
                value,
            } => {
                write!(f, "the {name} must be {domain}; it was {value}")
            }
            Self::NonFinite {
                index,
                replicate,
                coordinates,
                value,
            } => write!(
                f,
                "the integrand returned {value:?} at point {index} of replicate {replicate}, \
                 with the coordinates {coordinates:?}"
            ),
            Self::NothingLeft { rejected } => {
                write!(
                    f,
                    "all {rejected} values of the integrand were NaN or infinite"
                )
            }
            Self::TooEarly { used } => {
                write!(
                    f,
                    "stopped after {used} evaluations, before there was an estimate"
                )
            }
            Self::IdenticalReplicates { first, second } => write!(
                f,
                "the replicates {first} and {second} have the same points: \
                 the randomisation does not use the seed it is given"
            ),
        }
    }
}

impl core::error::Error for Error {}

/// An estimate that had to stop, with what it had computed by then.
#[derive(Clone, Debug, PartialEq)]
pub struct Incomplete<V> {
    /// Why it stopped.
    pub reason: Error,
    /// The estimate from the points before the one that stopped it, in the order of their indices; of replicates, from those
    /// that were complete, if any was; of strata, from those that were visited. `None` if there were none.
    pub so_far: Option<Box<Estimate<V>>>,
}

impl<V> From<Error> for Incomplete<V> {
    fn from(reason: Error) -> Self {
        Self {
            reason,
            so_far: None,
        }
    }
}

impl<V> From<Incomplete<V>> for Error {
    fn from(incomplete: Incomplete<V>) -> Self {
        incomplete.reason
    }
}

impl<V: fmt::Debug> fmt::Display for Incomplete<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.reason)?;
        match &self.so_far {
            Some(estimate) => {
                write!(
                    f,
                    " (the mean of the {} values before it is {:?})",
                    estimate.used, estimate.mean
                )
            }
            None => Ok(()),
        }
    }
}

impl<V: fmt::Debug> core::error::Error for Incomplete<V> {}
