//! Adaptive importance sampling and adaptive stratification.

use std::time::Instant;

use crate::evaluate::Wide;
use crate::integrands::ImportanceMap;
use crate::stratum::Stratified;
use crate::warning::Warning;
use crate::{
    Error, ErrorBar, Estimate, Estimator, Incomplete, Integrand, NonFinite, Outcome, Progressive,
    Stop, Value, hash, reduce,
};

mod adaptation;
mod grid;
mod images;
mod iterations;
mod learner;
mod squares;

use adaptation::{Adaptation, Order, Pass, longest_part};
use iterations::Together;

pub use iterations::Iteration;

/// Adaptive integration of peaked and badly scaled integrands: an [`ImportanceMap`] that learns from iteration to
/// iteration, and a grid of strata whose numbers of points follow their variances.[^lepage]
///
/// The first half of the iterations, five at most, only trains and is then forgotten. The others go on learning, each
/// less than the one before, so that what they learn is averaged; each is unbiased whatever was learned before it. In their mean all weigh
/// the same: weights by their claimed errors would bias it. An estimate that is stopped before is made of what training iterations there are, and in the first of them
/// of a random sample of its strata, with [`Warning::Unvisited`]. A few points at the very beginning only find out how large the values are.
///
/// A peak that no point of the first iterations hits is not there for it: the estimate then comes with
/// [`Warning::NoSpread`] or [`Warning::FewValues`]. Peaks along diagonals gain little. The maps of all axes are learned with
/// some noise, which multiplies: in hundreds of dimensions they do more harm than good. For smooth
/// integrands a trained map under scrambled nets ([`Mapped`](crate::integrands::Mapped)) is better by far.
///
/// Below 1000 evaluations the variances of the strata are known from too few points: intervals hold the integral less often
/// than they claim, and [`Warning::SmallSample`] says so.
///
/// All values zero: the map stays as it is, and the estimate is zero. One iteration: it is not trained, and
/// there is no chi-square.
///
/// ```
/// use estimand::{Estimator, cube, estimators::Vegas};
///
/// let peak = cube(|[x, y]: [f64; 2]| (-1e4 * ((x - 0.5).powi(2) + (y - 0.2).powi(2))).exp());
/// let estimate = Vegas::new(2, 100_000, 1)?.estimate(&peak)?;
/// let truth = std::f64::consts::PI / 1e4;
/// assert!(estimate.interval(0.9999).unwrap().contains(truth));
/// assert!(estimate.std_error.unwrap() < 1e-3 * truth);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^lepage]: Lepage, Peter (2021). *Adaptive Multidimensional Integration: VEGAS Enhanced*.
///     <https://doi.org/10.1016/j.jcp.2021.110386>
#[derive(Clone, Debug)]
#[must_use]
pub struct Vegas {
    count: u64,
    iterations: u32,
    seed: u64,
    damping: f64,
    map: ImportanceMap,
    trained: bool,
    non_finite: NonFinite,
}

/// Evaluations of an iteration from which on its variances can be relied on.
const ENOUGH: u64 = 1000;

/// The state of a [`Vegas`]; see [`Progressive`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VegasState<V> {
    adaptation: Adaptation<V>,
    /// How many points only looked for the scale of the values.
    looked: u64,
    /// How many of their values were not finite.
    rejected: u64,
    iterations: Vec<Iteration<V>>,
    /// The iteration that was begun.
    open: Option<Pass<V>>,
}

/// All that a [`Vegas`] found out.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Adapted<V> {
    /// The estimate, from the iterations that did not only train.
    pub estimate: Estimate<V>,
    /// The iterations, in their order.
    pub iterations: Vec<Iteration<V>>,
    /// How much the iterations of the estimate differ, as chi-square per degree of freedom: the largest of the
    /// components, near 1 if their errors can be trusted. `None` for fewer than two of them.
    pub chi_square: Option<f64>,
    /// The map as the last iteration left it.
    pub map: ImportanceMap,
}

impl Vegas {
    /// About `count` evaluations in ten iterations, or in fewer of a thousand each, or in more of four million each, adapting
    /// to the first `dimensions` coordinates; further coordinates are independent. `seed` selects the points.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no dimensions, and for fewer than 40 evaluations.
    pub fn new(dimensions: u32, count: u64, seed: u64) -> Result<Self, Error> {
        if dimensions == 0 {
            let domain = "at least 1";
            return Err(Error::refused("number of dimensions", domain, dimensions));
        }
        if count < 40 {
            return Err(Error::refused("count", "at least 40", count));
        }
        /// Evaluations of an iteration past which there is nothing to be gained: the next one has learned more.
        const MOST: u64 = 1 << 22;
        let iterations = (count / ENOUGH).clamp(2, 10).max(count / MOST);
        let iterations = u32::try_from(iterations).unwrap_or(u32::MAX);
        let each = count / u64::from(iterations);
        /// The fewest points of an iteration that a bin should learn from: with fewer the map follows chance, and intervals
        /// on narrow peaks hold the truth too seldom.
        const LEARN: u64 = 60;
        // Narrow bins follow the integrand, wide ones have many points to learn from: as many points a bin as bins.
        let bins = usize::try_from(each.isqrt().min(each / LEARN)).unwrap_or(usize::MAX);
        Ok(Self {
            count,
            iterations,
            seed,
            damping: 0.5,
            map: ImportanceMap::identity(dimensions, bins.clamp(1, 1000))?,
            trained: false,
            non_finite: NonFinite::Fail,
        })
    }

    /// The same in another number of iterations.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no iterations, and for fewer than four evaluations an iteration.
    pub fn iterations(mut self, iterations: u32) -> Result<Self, Error> {
        if iterations == 0 || self.count / u64::from(iterations) < 4 {
            let domain = "at least 1, with four evaluations each";
            return Err(Error::refused("number of iterations", domain, iterations));
        }
        self.iterations = iterations;
        Ok(self)
    }

    /// The same beginning with a map that was trained before: no iteration only trains, all make the estimate.
    pub fn map(mut self, map: ImportanceMap) -> Self {
        self.map = map;
        self.trained = true;
        self
    }

    /// The same with another exponent of damping in `[0, 2]`: 0 learns nothing, the default is 0.5, much more than 1 swings.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an exponent outside `[0, 2]`.
    pub fn damping(mut self, exponent: f64) -> Result<Self, Error> {
        if !(0.0..=2.0).contains(&exponent) {
            return Err(Error::refused("damping", "in [0, 2]", exponent));
        }
        self.damping = exponent;
        Ok(self)
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }

    /// The map that all evaluations together train.
    ///
    /// # Errors
    ///
    /// As [`Estimator::estimate`].
    pub fn train<I: Integrand>(&self, integrand: &I) -> Result<ImportanceMap, Error> {
        Ok(self.run(integrand)?.map)
    }

    /// The estimate with all that was found out on the way.
    ///
    /// # Errors
    ///
    /// As [`Estimator::estimate`].
    pub fn run<I: Integrand>(
        &self,
        integrand: &I,
    ) -> Result<Adapted<Wide<I>>, Incomplete<Wide<I>>> {
        let clock = Instant::now();
        let mut state = self.start()?;
        let outcome = self.grow(&mut state, integrand, u64::MAX);
        let (estimate, chi_square) = self.estimate_of(&state).unzip();
        let estimate = estimate.map(|estimate| Estimate {
            seconds: clock.elapsed().as_secs_f64(),
            ..estimate
        });
        if let Err(reason) = outcome {
            return Err(Incomplete {
                reason,
                so_far: estimate.map(Box::new),
            });
        }
        let rejected = self.rejected(&state);
        Ok(Adapted {
            estimate: estimate.ok_or(Error::NothingLeft { rejected })?,
            iterations: state.iterations,
            chi_square: chi_square.flatten(),
            map: state.adaptation.map,
        })
    }

    /// How many of the iterations only train.
    fn training(&self) -> usize {
        const MOST: usize = 5;
        if self.trained {
            0
        } else {
            (self.iterations as usize / 2).min(MOST)
        }
    }

    /// Evaluations in each iteration.
    fn each(&self) -> u64 {
        self.count / u64::from(self.iterations)
    }

    /// Goes on until about so many `evaluations` were made.
    fn go_on<I: Integrand>(
        &self,
        state: &mut VegasState<Wide<I>>,
        integrand: &I,
        evaluations: u64,
    ) -> Result<(), Error> {
        let VegasState {
            adaptation,
            looked,
            rejected,
            iterations,
            open,
        } = state;
        if adaptation.map.dimensions() != self.map.dimensions() {
            let domain = "one of this estimator, with as many dimensions";
            let value = adaptation.map.dimensions();
            return Err(Error::refused("state", domain, value));
        }
        let policy = self.non_finite;
        if *looked == 0 && evaluations > 0 {
            let seed = hash::hash(self.seed, u64::MAX);
            [*looked, *rejected] = adaptation.look(integrand, seed, self.each(), policy)?;
        }
        let mut room = None;
        let mut whole = *looked + iterations.iter().map(|one| one.used).sum::<u64>();
        while iterations.len() < self.iterations as usize {
            // The first points of all come with those that looked, so that there is always an estimate.
            let least = u64::from(iterations.is_empty() && evaluations > 0);
            let count = evaluations.saturating_sub(whole).max(least);
            if count == 0 {
                break;
            }
            let seed = hash::hash(self.seed, iterations.len() as u64);
            let pass = open.get_or_insert_with(|| match room.take() {
                Some(room) => Pass::cleared(room),
                None => adaptation.begin(),
            });
            // Only the first is part of an estimate before it is complete.
            let order = if iterations.is_empty() {
                Order::Random
            } else {
                Order::Number
            };
            if !adaptation.go_on(pass, integrand, seed, count, order, policy)? {
                break;
            }
            let points = adaptation.points();
            let Some(alone) = Stratified::new(&pass.visited) else {
                let rejected = pass.visited.rejected();
                return Err(Error::NothingLeft { rejected });
            };
            whole += points;
            iterations.push(Iteration {
                mean: alone.mean,
                std_error: alone.std_error,
                freedom: alone.freedom,
                share: alone.share,
                stratum_share: alone.stratum_share,
                used: points,
                rejected: pass.visited.rejected(),
                training: iterations.len() < self.training(),
            });
            // The first half of the iterations finds the place, a half of the way each; the others average what they
            // learn.
            let settled = iterations.len().saturating_sub(self.training()) + 2;
            adaptation.learn(pass, alone.size, self.damping / settled as f64, self.each());
            room = open.take();
        }
        Ok(())
    }

    /// The estimate from the iterations that did not only train, and their chi-square.
    fn estimate_of<V: Value>(&self, state: &VegasState<V>) -> Option<(Estimate<V>, Option<f64>)> {
        let trained = state.iterations.partition_point(|one| one.training);
        let (training, main) = state.iterations.split_at(trained);
        let main = if main.is_empty() { training } else { main };
        if main.is_empty() {
            return Some((self.unfinished(state)?, None));
        }
        let together = Together::of(main, state.adaptation.scale);
        let chi_square = together.chi_square;
        let rejected = self.rejected(state);
        let mut estimate = Estimate {
            std_error: Some(together.std_error),
            error_bar: ErrorBar::Strata {
                freedom: together.freedom,
            },
            replicates: main.iter().map(|one| one.mean).collect(),
            requested: self.count,
            stop: if state.iterations.len() < self.iterations as usize {
                Stop::Unfinished
            } else {
                Stop::Count
            },
            ..together.strata.estimate(self.used(state), rejected)
        };
        let warnings = &mut estimate.warnings;
        if self.count < ENOUGH {
            let count = self.count;
            warnings.push(Warning::SmallSample { count });
        }
        // Iterations that differ by rounding alone contradict nothing.
        let rounding = |warning: &Warning| matches!(warning, Warning::Rounding { .. });
        if let Some(chi_square) = together.contradiction()
            && !warnings.iter().any(rounding)
        {
            warnings.push(Warning::Inconsistent { chi_square });
        }
        Some((estimate, chi_square))
    }

    /// The estimate from the part of the first iteration that there is.
    fn unfinished<V: Value>(&self, state: &VegasState<V>) -> Option<Estimate<V>> {
        let together = Stratified::new(&state.open.as_ref()?.visited)?;
        let (used, rejected) = (self.used(state), self.rejected(state));
        let mut estimate = together.estimate(used, rejected);
        estimate.requested = self.count;
        estimate.stop = Stop::Unfinished;
        if used < ENOUGH {
            let count = used;
            estimate.warnings.push(Warning::SmallSample { count });
        }
        Some(estimate)
    }

    fn rejected<V: Value>(&self, state: &VegasState<V>) -> u64 {
        let whole: u64 = state.iterations.iter().map(|one| one.rejected).sum();
        let open = state.open.as_ref();
        state.rejected + whole + open.map_or(0, |pass| pass.visited.rejected())
    }
}

impl Progressive for Vegas {
    type State<V: Value> = VegasState<V>;

    fn budget(&self) -> u64 {
        self.count
    }

    fn start<V: Value>(&self) -> Result<VegasState<V>, Error> {
        Ok(VegasState {
            adaptation: Adaptation::new(self.map.clone(), self.each()),
            looked: 0,
            rejected: 0,
            iterations: Vec::new(),
            open: None,
        })
    }

    fn used<V: Value>(&self, state: &VegasState<V>) -> u64 {
        let whole: u64 = state.iterations.iter().map(|one| one.used).sum();
        state.looked + whole + state.open.as_ref().map_or(0, Pass::used)
    }

    /// Goes on by parts of iterations. An iteration that is not complete is not part of the estimate yet.
    fn grow<I: Integrand>(
        &self,
        state: &mut VegasState<Wide<I>>,
        integrand: &I,
        evaluations: u64,
    ) -> Result<(), Error> {
        let mut outcome = Ok(());
        reduce::several(&mut || outcome = self.go_on(state, integrand, evaluations));
        outcome
    }

    fn conclude<V: Value>(&self, state: &VegasState<V>) -> Option<Estimate<V>> {
        Some(self.estimate_of(state)?.0)
    }

    fn portion(&self) -> u64 {
        longest_part(self.each())
    }

    /// The end of the next iteration.
    fn next_look(&self, evaluations: u64) -> u64 {
        evaluations.saturating_add(self.each())
    }
}

impl Estimator for Vegas {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        Ok(self.run(integrand)?.estimate)
    }
}
