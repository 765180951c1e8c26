//! Why an error bar may be wrong, or an error larger than it need be.

use core::fmt;

use crate::Value;
use crate::points::PointSet;
use crate::tally::Tally;

/// Why an error bar may be wrong, or an error larger than it need be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Warning {
    /// In some component all values are alike, so that the error bar is zero: either the integrand is constant,
    /// or all points missed what matters.
    NoSpread,
    /// A single value makes up a large share of the variance, as it does when the integrand is a narrow peak, a
    /// rare event or has no variance at all. The error may be many times the error bar.
    FewValues {
        /// The largest share of one value in the sum of squared deviations.
        share: f64,
    },
    /// One value of each replicate, its largest or its smallest, makes up most of the variance between them, as it does where
    /// points that are even meet a singularity. The means of the replicates are then as skewed as single values, whatever the number
    /// of points: intervals hold the integral less often than they claim.
    Singular {
        /// The share of that value.
        share: f64,
    },
    /// Most strata show no variance, and what there is comes from a few of them, as it does in the search for a narrow peak or a
    /// rare event. Where a stratum that matters showed nothing, the error may be many times the error bar.
    FewStrata {
        /// How many strata it comes from, as many as would each have an equal share of it.
        deciding: f64,
    },
    /// The largest values fall off so slowly that the variance may be infinite. Intervals hold the integral
    /// less often than they claim.
    HeavyTail {
        /// Hill's estimate of the tail's exponent: below 2 there is no variance.
        exponent: f64,
    },
    /// Fewer than 30 independent values, or fewer than 1000 of an adaptive estimator: the interval relies
    /// on more.
    SmallSample {
        /// How many there were.
        count: u64,
    },
    /// Fewer than 8 replicates.
    FewReplicates {
        /// How many there were.
        replicates: u64,
    },
    /// The replicates around a median take few values, as counts of a rare event do: their median is not their mean, and
    /// the interval holds the median.
    Tied {
        /// How many values the replicates take.
        distinct: u64,
    },
    /// Values that were not finite were left out: the estimate is the mean over the rest.
    Rejected {
        /// How many.
        rejected: u64,
    },
    /// The error bar is below what rounding alone does to values of this size.
    Rounding {
        /// The largest absolute value.
        largest: f64,
    },
    /// The number of points is no power of the [radix](crate::points::PointSet::radix) of their set, so that they are less
    /// even than a power would be: the error is larger than it need be. It says nothing against the error bar.
    NoPower {
        /// How many points of a set there were.
        count: u64,
        /// The radix.
        radix: u32,
    },
    /// Not all strata were visited before it was stopped. Those that were are a random sample of all, and the error bar is
    /// that of this sample: right, but much larger than that of all strata.
    Unvisited {
        /// How many strata have points.
        visited: u64,
        /// How many there are.
        strata: u64,
    },
    /// The iterations of an adaptive estimator contradict one another.
    Inconsistent {
        /// Their chi-square per degree of freedom, which should be near 1.
        chi_square: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSpread => f.write_str(
                "all values are alike: the integrand is constant or every point missed what matters",
            ),
            Self::FewValues { share } => write!(
                f,
                "one value makes up {:.0} % of the variance: the error may be far above the error bar",
                100.0 * share
            ),
            Self::Singular { share } => write!(
                f,
                "one value of each replicate makes up {:.0} % of the variance between them, as at a singularity: \
                 intervals hold less often than they claim",
                100.0 * share
            ),
            Self::FewStrata { deciding } => write!(
                f,
                "the variance comes from about {deciding:.0} strata, and most have none: others may have been missed"
            ),
            Self::HeavyTail { exponent } => write!(
                f,
                "the largest values have a tail with exponent {exponent:.2}: below 2 the variance is \
                 infinite"
            ),
            Self::SmallSample { count } => {
                write!(f, "only {count} independent values")
            }
            Self::FewReplicates { replicates } => write!(f, "only {replicates} replicates"),
            Self::Tied { distinct } => write!(
                f,
                "the replicates take only {distinct} values, whose median is not their mean"
            ),
            Self::Rejected { rejected } => {
                write!(f, "{rejected} values were not finite and left out")
            }
            Self::Rounding { largest } => write!(
                f,
                "the error bar is below the rounding of values as large as {largest:e}"
            ),
            Self::NoPower { count, radix } => write!(
                f,
                "{count} points are no power of {radix}: a power spreads them more evenly"
            ),
            Self::Unvisited { visited, strata } => write!(
                f,
                "stopped after {visited} of {strata} strata: the error is that of a random sample of them"
            ),
            Self::Inconsistent { chi_square } => write!(
                f,
                "the iterations contradict one another: chi-square per degree of freedom {chi_square:.1}"
            ),
        }
    }
}

impl Warning {
    pub(crate) fn of_rejected(rejected: u64) -> Vec<Self> {
        (rejected > 0)
            .then_some(Self::Rejected { rejected })
            .into_iter()
            .collect()
    }

    pub(crate) fn of_sample(count: u64) -> Option<Self> {
        (count < 30).then_some(Self::SmallSample { count })
    }

    /// `size` is the largest absolute value, per component.
    pub(crate) fn of_rounding<V: Value>(std_error: V, size: V) -> Option<Self> {
        let mut largest = 0.0_f64;
        let _ = size.zip(std_error, |size, error| {
            if error > 0.0 && error < f64::EPSILON * size {
                largest = largest.max(size);
            }
            size
        });
        (largest > 0.0).then_some(Self::Rounding { largest })
    }

    /// For the first `count` points of `points`.
    pub(crate) fn of_power(points: &impl PointSet, count: u64) -> Option<Self> {
        let radix = points.radix().filter(|_| points.size().is_none())?;
        let mut rest = count;
        while rest > 1 && rest.is_multiple_of(u64::from(radix)) {
            rest /= u64::from(radix);
        }
        (rest > 1).then_some(Self::NoPower { count, radix })
    }

    pub(crate) fn of_replicates(replicates: u64) -> Option<Self> {
        (replicates < 8).then_some(Self::FewReplicates { replicates })
    }
}

/// What the values themselves say against an error bar. The tally must be closed.
pub(crate) fn diagnose<V: Value>(tally: &Tally<V>, std_error: Option<V>) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let (Some(std_error), Some(&high), Some(&low)) =
        (std_error, tally.highest().first(), tally.lowest().first())
    else {
        return warnings;
    };
    let mean = tally.moments().mean();
    let root = tally.moments().root();
    let count = tally.moments().count() as f64;

    let mut alike = false;
    std_error.for_each(|error| alike |= error == 0.0);
    if alike {
        warnings.push(Warning::NoSpread);
    }

    let deviation = high
        .zip(mean, |high, mean| high - mean)
        .zip(low.zip(mean, |low, mean| low + mean), f64::max);
    let mut share = 0.0_f64;
    let _ = deviation.zip(root, |deviation, root| {
        if root > 0.0 {
            share = share.max((deviation / root).powi(2).min(1.0));
        }
        0.0
    });
    if share > usual_share(count) {
        warnings.push(Warning::FewValues { share });
    }

    let gamma = hill(tally.highest(), mean).max(hill(tally.lowest(), mean.map(|mean| -mean)));
    if tally.blocks() >= 4 * FEWEST as u64 && gamma > HEAVY {
        let exponent = 1.0 / gamma;
        warnings.push(Warning::HeavyTail { exponent });
    }

    let size = high.zip(low, |high, low| high.abs().max(low.abs()));
    warnings.extend(Warning::of_rounding(std_error, size));
    warnings
}

/// The share of the largest of `count` values in their variance that raises no doubt: 5 %, and for small
/// counts what the largest of so many normal values reaches once in a thousand times.
fn usual_share(count: f64) -> f64 {
    ((2.0 * count.ln() + 12.0) / count).max(0.05)
}

/// The fewest extremes that a tail is judged by.
const FEWEST: usize = 8;

/// The reciprocal exponent from which on a tail is called heavy: a variance asks for less than 1/2, and the
/// estimate from 16 extremes has a standard error of a quarter of its value, so that this is one below. At a million values the tail of a
/// normal distribution has about 0.05, that of an exponential one 0.08.
const HEAVY: f64 = 0.375;

/// Hill's estimate of the reciprocal of the tail's exponent, from the largest deviations; the largest of
/// all components.[^hill]
///
/// [^hill]: Hill, Bruce (1975). *A Simple General Approach to Inference About the Tail of a Distribution*.
///     <https://doi.org/10.1214/aos/1176343247>
fn hill<V: Value>(extremes: &[V], centre: V) -> f64 {
    let [above @ .., last] = extremes else {
        return 0.0;
    };
    if above.len() + 1 < FEWEST {
        return 0.0;
    }
    let least = last.zip(centre, |last, centre| last - centre);
    let sum = above.iter().fold(V::ZERO, |sum, extreme| {
        extreme
            .zip(centre, |extreme, centre| extreme - centre)
            .zip(least, |deviation, least| {
                if least > 0.0 {
                    (deviation / least).ln()
                } else {
                    0.0
                }
            })
            .zip(sum, |logarithm, sum| sum + logarithm)
    });
    let mut gamma = 0.0_f64;
    sum.for_each(|sum| gamma = gamma.max(sum / above.len() as f64));
    gamma
}
