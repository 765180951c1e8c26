//! Independent randomisations of a point set; the error bar is their spread's.

use core::fmt;

use super::Median;
use super::average::whole;
use crate::points::PointSet;
use crate::tallied::{Tallied, tallied};
use crate::tally::Tally;
use crate::warning::{Warning, diagnose};
use crate::{Error, ErrorBar, Estimate, Moments, NonFinite, Value, hash};

/// The mean of several averages over independently randomised point sets, with the standard error of their
/// spread.
///
/// This is the honest error bar of quasi-Monte Carlo: whatever the points do among themselves, the averages
/// of independent randomisations are independent. With few replicates it is itself uncertain, and follows
/// Student's t with `replicates - 1` degrees of freedom: 8 are a good least, 16 or 32 better.[^lecuyer]
///
/// ```
/// use estimand::{Estimator, Replicated, cube, points::NRooks};
///
/// let f = cube(|[x, y]| (x * y).exp());
/// let estimate = Replicated::new(16, 1 << 10, |seed| NRooks::new(1 << 10, seed).unwrap()).estimate(&f)?;
/// assert!((estimate.mean - 1.317_902_151_454_404).abs() < 4.0 * estimate.std_error.unwrap());
/// assert_eq!(estimate.used, 1 << 14);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors of the estimate
///
/// - [`Error::Refused`] for fewer than two replicates or a count of 0.
/// - [`Error::IdenticalReplicates`] if two replicates have the same first points, as they do when the
///   closure does not use its seed: their spread would be an error bar of zero.
/// - See also [`Estimator::estimate`](crate::Estimator::estimate).
///
/// [^lecuyer]: L'Ecuyer, Pierre; Nakayama, Marvin; Owen, Art; Tuffin, Bruno (2023). *Confidence Intervals for
///     Randomized Quasi-Monte Carlo Estimators*. <https://doi.org/10.1109/WSC60868.2023.10408613>
#[derive(Clone, Copy)]
#[must_use]
pub struct Replicated<F> {
    replicates: u64,
    count: u64,
    points: F,
    seed: u64,
    non_finite: NonFinite,
}

impl<P: PointSet, F: Fn(u64) -> P> Replicated<F> {
    /// `replicates` averages over the first `count` points of a set each, or over the whole of a finite set.
    ///
    /// Finite sets are taken one after the other by a run that may be [stopped](crate::estimators::Until): it has an estimate once one is whole, and an error
    /// once two are.
    ///
    /// `points` makes the set of a replicate from the replicate's seed, a well mixed word.
    pub const fn new(replicates: u64, count: u64, points: F) -> Self {
        Self {
            replicates,
            count,
            points,
            seed: 0,
            non_finite: NonFinite::Fail,
        }
    }

    /// The median of the averages in the place of their mean.
    pub const fn median(self) -> Median<F> {
        Median::new(self)
    }

    /// The same with other seeds for the replicates; the default is 0.
    pub const fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }
}

impl<P: PointSet, F: Fn(u64) -> P> Tallied for Replicated<F> {
    type Source<'a>
        = P
    where
        F: 'a;

    fn sources(&self) -> Result<Vec<P>, Error> {
        if !(2..=MOST_REPLICATES).contains(&self.replicates) {
            let domain = "2 to 2^24";
            return Err(Error::refused(
                "number of replicates",
                domain,
                self.replicates,
            ));
        }
        if self.count == 0 {
            return Err(Error::refused("count", "at least 1", 0));
        }
        let sets: Vec<P> = (0..self.replicates)
            .map(|replicate| (self.points)(hash::hash(self.seed, replicate)))
            .collect();
        distinct(&sets)?;
        Ok(sets)
    }

    fn counts(&self, sets: &[P], evaluations: u64) -> Vec<u64> {
        let sizes: Option<Vec<u64>> = sets.iter().map(PointSet::size).collect();
        if let Some(sizes) = sizes.filter(|_| evaluations < self.requested()) {
            // One whole set after the other: some have an error to tell before all have.
            let mut left = evaluations;
            let taken = sizes.iter().map(|&size| {
                let count = size.min(left);
                left -= count;
                count
            });
            return taken.collect();
        }
        let count = evaluations.div_ceil(self.replicates).min(self.count);
        sets.iter().map(|set| whole(set, count)).collect()
    }

    fn requested(&self) -> u64 {
        self.replicates.saturating_mul(self.count)
    }

    /// Of finite sets where as many are whole.
    fn next_look(&self, evaluations: u64) -> u64 {
        let size = (self.points)(hash::hash(self.seed, 0)).size().unwrap_or(1);
        let whole = evaluations / size.max(1);
        whole.saturating_mul(2).max(2).saturating_mul(size)
    }

    fn policy(&self) -> NonFinite {
        self.non_finite
    }

    fn summary<V: Value>(&self, tallies: &[Tally<V>]) -> Option<Estimate<V>> {
        // Replicates that were cut short are worth less than the others: they count only if they are all there
        // is.
        let most = tallies.iter().map(Tally::used).max()?;
        let set = (self.points)(hash::hash(self.seed, 0));
        if set.size().is_some_and(|size| most < size) {
            // A part of a finite set may be all in one place.
            return None;
        }
        let whole = tallies.iter().filter(|tally| tally.used() == most);
        // Those of which every value was left out have no mean.
        let known: Vec<&Tally<V>> = whole
            .clone()
            .filter(|tally| tally.moments().count() > 0)
            .collect();
        let means: Vec<V> = known.iter().map(|tally| tally.moments().mean()).collect();
        if means.is_empty() {
            return None;
        }
        let moments: Moments<V> = means.iter().copied().collect();
        let mut all = Tally::EMPTY;
        whole.for_each(|tally| all.merge(tally));
        let std_error = moments.std_error();
        let mut warnings = diagnose(&all, std_error);
        warnings.extend(singular(&known, moments.root()));
        warnings.extend(Warning::of_replicates(moments.count()));
        warnings.extend(Warning::of_rejected(all.rejected()));
        warnings.extend(Warning::of_power(&set, most));
        Some(Estimate {
            std_error,
            error_bar: ErrorBar::Replicates,
            replicates: means,
            requested: self.requested(),
            rejected: all.rejected(),
            warnings,
            ..Estimate::new(moments.mean(), all.used())
        })
    }
}

tallied!([P: PointSet, F: Fn(u64) -> P] Replicated<F>);

/// Warns where one value of each replicate makes up most of the variance between them, in some component. `root` is that of the sum of
/// squared deviations of their means.
///
/// At a singularity the other points of a replicate are even, and its mean follows the point closest to it.
fn singular<V: Value>(replicates: &[&Tally<V>], root: V) -> Option<Warning> {
    /// Of so few points one may make up a large share without that.
    const POINTS: u64 = 16;
    /// So few replicates may show a large share by chance.
    const REPLICATES: usize = 8;
    /// The share of singularities is almost 1; that of others, known from few replicates, may come out as a half.
    const MOST: f64 = 0.8;
    let few = |tally: &&Tally<V>| tally.moments().count() < POINTS;
    if replicates.len() < REPLICATES || replicates.iter().any(few) {
        return None;
    }
    let without = |value: fn(&Tally<V>) -> V| {
        let rest: Moments<V> = replicates
            .iter()
            .map(|tally| {
                let weight = 1.0 / tally.moments().count() as f64;
                let mean = tally.moments().mean();
                mean.zip(value(tally), |mean, value| mean - weight * value)
            })
            .collect();
        rest.root()
    };
    let highest = without(|tally| tally.highest()[0]);
    let lowest = without(|tally| tally.lowest()[0].map(|low| -low));
    let mut share = 0.0_f64;
    let _ = root.zip(highest.zip(lowest, f64::min), |all, rest| {
        if all > 0.0 {
            share = share.max(1.0 - (rest / all).powi(2));
        }
        0.0
    });
    (share > MOST).then_some(Warning::Singular { share })
}

/// More sets than this are an argument gone wrong, not a plan.
const MOST_REPLICATES: u64 = 1 << 24;

/// Refuses two replicates that begin with the same points.
fn distinct<P: PointSet>(sets: &[P]) -> Result<(), Error> {
    // A few coordinates tell randomised sets apart: two that are independent agree in a coordinate
    // with a probability of about 2^-53.
    const POINTS: u64 = 3;
    const DIMENSIONS: u32 = 4;
    let mut fingerprints: Vec<(u64, u64)> = (0..)
        .zip(sets)
        .map(|(replicate, set)| {
            let fingerprint = (0..POINTS.min(set.size().unwrap_or(POINTS)))
                .flat_map(|index| (0..DIMENSIONS.min(set.dimensions())).map(move |d| (index, d)))
                .fold(0, |word, (index, d)| {
                    hash::hash(word, set.coordinate(index, d).to_bits())
                });
            (fingerprint, replicate)
        })
        .collect();
    fingerprints.sort_unstable();
    let set = |replicate: u64| &sets[usize::try_from(replicate).expect("it is in memory")];
    let identical =
        |pair: &&[(u64, u64)]| pair[0].0 == pair[1].0 && alike(set(pair[0].1), set(pair[1].1));
    match fingerprints.windows(2).find(identical) {
        Some(pair) => Err(Error::IdenticalReplicates {
            first: pair[0].1,
            second: pair[1].1,
        }),
        None => Ok(()),
    }
}

/// Whether two sets of which a few coordinates agree agree in many: coarse coordinates may do so by chance.
fn alike<P: PointSet>(a: &P, b: &P) -> bool {
    const POINTS: u64 = 64;
    const DIMENSIONS: u32 = 8;
    (0..POINTS.min(a.size().unwrap_or(POINTS))).all(|index| {
        (0..DIMENSIONS.min(a.dimensions()))
            .all(|d| a.coordinate(index, d) == b.coordinate(index, d))
    })
}

impl<F> fmt::Debug for Replicated<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Replicated")
            .field("replicates", &self.replicates)
            .field("count", &self.count)
            .field("seed", &self.seed)
            .field("non_finite", &self.non_finite)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{DigitalShift, HashedOwen, Independent, Sobol};
    use crate::{Estimator, Integrand, cube};

    fn share(replicates: u64, count: u64, seed: u64, f: &impl Integrand) -> Option<f64> {
        let sobol = Sobol::new(1).unwrap();
        let set = |seed| sobol.clone().scrambled(HashedOwen { seed });
        let replicated = Replicated::new(replicates, count, set).seed(seed);
        share_of(&replicated.estimate(f).unwrap().warnings)
    }

    fn share_of(warnings: &[Warning]) -> Option<f64> {
        warnings.iter().find_map(|warning| match warning {
            Warning::Singular { share } => Some(*share),
            _ => None,
        })
    }

    /// The point closest to zero is uniform in the first of `n` cells, so that the mean varies by `n^-0.6` times what `u^-0.4` does,
    /// which is `1/0.2 - 1/0.6^2 = 2.22`; the cells after it add `(i + u)^-0.4`, together 0.007. The largest value has 99.7 %.
    #[test]
    fn a_singularity_is_told_of_in_any_component() {
        let singular = cube(|[x]: [f64; 1]| x.powf(-0.4));
        let below = cube(|[x]: [f64; 1]| [1.0, -x.powf(-0.4)]);
        let smooth = cube(|[x]: [f64; 1]| [x.exp(), 1.0]);
        for seed in 0..50 {
            assert!(share(16, 1 << 12, seed, &singular).is_some(), "{seed}");
            assert!(share(16, 1 << 12, seed, &below).is_some(), "{seed}");
            assert_eq!(share(16, 1 << 12, seed, &smooth), None, "{seed}");
            // Of few points, or few replicates, nothing is said.
            assert_eq!(share(16, 15, seed, &singular), None, "{seed}");
            assert_eq!(share(7, 1 << 12, seed, &singular), None, "{seed}");
        }
    }

    /// Under one shift of all digits every point has the same place in its cell: the largest value says what the mean is, and yet
    /// it is one of many that do.
    #[test]
    fn points_that_move_together_decide_together() {
        let f = cube(|[x]: [f64; 1]| x.exp());
        let sobol = Sobol::new(1).unwrap();
        for seed in 0..50 {
            let set = |seed| sobol.clone().scrambled(DigitalShift { seed });
            let replicated = Replicated::new(16, 1 << 10, set).seed(seed);
            let warnings = replicated.estimate(&f).unwrap().warnings;
            assert_eq!(share_of(&warnings), None, "{seed}");
        }
    }

    #[test]
    fn replicates_without_a_value_are_counted_all_the_same() {
        let f = cube(|[x]: [f64; 1]| if x < 0.5 { f64::NAN } else { x });
        let estimate = Replicated::new(400, 1, Independent::new)
            .non_finite(NonFinite::Reject)
            .estimate(&f)
            .unwrap();
        assert_eq!(estimate.used, 400);
        // Half of them, to five standard deviations.
        assert!((150..250).contains(&estimate.rejected));
        assert_eq!(estimate.replicates.len() as u64, 400 - estimate.rejected);
        let rejected = estimate.rejected;
        assert!(estimate.warnings.contains(&Warning::Rejected { rejected }));
    }
}
