//! Independent points in every cell of a grid, with the variance of each cell.

use crate::evaluate::Wide;
use crate::points::Independent;
use crate::progressive::at_once;
use crate::stratum::{Rows, Stratified, Visited, Walk, apportion, evenly};
use crate::{
    Error, Estimate, Estimator, Integrand, NonFinite, Outcome, Progressive, Stop, Value, hash,
    reduce,
};

mod cell;
mod rounds;

use cell::Cell;
use rounds::Rounds;

/// Stratified sampling: independent points in each of the equal cells of a grid, and an error bar made of the
/// cells' own variances.
///
/// The grid covers the first dimensions; further ones are independent. What varies from cell to cell adds nothing to the
/// variance. With [`neyman`](Self::neyman) the cells get points in proportion to their standard deviations,
/// which is the best there is.[^neyman]
///
/// Points come in rounds: two in each cell, cells in a random order, then four times as many, up to the number that the cell
/// is due. So an estimate that is stopped early is one of all cells with fewer points, or, before the first round is complete,
/// one of a random sample of the cells, with [`Warning::Unvisited`](crate::Warning::Unvisited).
///
/// A cell has at least two points. So there can be at most half as many cells as points; for one point a cell take
/// [`Replicated`](crate::Replicated) with [`points::Stratified`](crate::points::Stratified).
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube, estimators::Strata};
///
/// let f = cube(|[x, y]: [f64; 2]| (5.0 * x * y).exp());
/// let plain = MonteCarlo::new(20_000, 1).estimate(&f)?;
/// let strata = Strata::new(32, 2, 20_000, 1)?.neyman().estimate(&f)?;
/// assert!(strata.std_error.unwrap() < plain.std_error.unwrap() / 20.0);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^neyman]: Neyman, Jerzy (1934). *On the Two Different Aspects of the Representative Method*.
///     <https://doi.org/10.2307/2342192>
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Strata {
    cells: u64,
    dimensions: u32,
    strata: usize,
    count: u64,
    seed: u64,
    neyman: bool,
    non_finite: NonFinite,
}

/// The state of a [`Strata`]; see [`Progressive`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrataState<V> {
    /// Where the points find out how many to take.
    pilot: Phase<V>,
    main: Phase<V>,
}

/// Some rounds of points, and what they have given so far.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Phase<V> {
    visited: Visited<V>,
    /// How many rounds are complete.
    rounds: u32,
}

impl<V: Value> Phase<V> {
    fn new(strata: usize) -> Self {
        Self {
            visited: Visited::new(strata),
            rounds: 0,
        }
    }
}

impl Strata {
    /// About `count` points in the cells of a grid with `cells` of them along each of the first `dimensions` axes.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no cells or dimensions, for more than 2^20 cells in all, and for fewer than two points a cell.
    pub fn new(cells: u64, dimensions: u32, count: u64, seed: u64) -> Result<Self, Error> {
        if cells == 0 || dimensions == 0 {
            let grid = format!("{cells} to the power of {dimensions}");
            return Err(Error::refused("number of strata", "at least 1", grid));
        }
        let strata = cells
            .checked_pow(dimensions)
            .filter(|&strata| strata <= 1 << 20)
            .and_then(|strata| usize::try_from(strata).ok());
        let Some(strata) = strata else {
            let grid = format!("{cells} to the power of {dimensions}");
            return Err(Error::refused("number of strata", "at most 2^20", grid));
        };
        if count / 2 < strata as u64 {
            let domain = "at least two for each stratum";
            return Err(Error::refused("count", domain, count));
        }
        Ok(Self {
            cells,
            dimensions,
            strata,
            count,
            seed,
            neyman: false,
            non_finite: NonFinite::Fail,
        })
    }

    /// The same with points in proportion to the standard deviations of the cells.
    ///
    /// A tenth of the points, but two a cell at least, find the deviations out and are used for nothing else, so that
    /// nothing is biased. One point in ten is still spread evenly: a cell that looked constant may not be.
    pub const fn neyman(mut self) -> Self {
        self.neyman = true;
        self
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }

    /// How many points the pilot has in each cell.
    fn pilot(&self) -> u64 {
        if self.neyman {
            (self.count / 10 / self.strata as u64).max(2)
        } else {
            0
        }
    }

    /// Goes on until about so many `evaluations` were made.
    fn go_on<I: Integrand>(
        &self,
        state: &mut StrataState<Wide<I>>,
        integrand: &I,
        evaluations: u64,
    ) -> Result<(), Error> {
        let StrataState { pilot, main } = state;
        let strata = [&*pilot, &*main].map(|phase| phase.visited.strata().len());
        if strata != [if self.neyman { self.strata } else { 0 }, self.strata] {
            let domain = "one of this estimator, with as many strata";
            return Err(Error::refused("state", domain, strata[1]));
        }
        let each = self.pilot();
        let spent = each * self.strata as u64;
        let ends = if self.neyman {
            let ends: Vec<u64> = (1..=self.strata as u64)
                .map(|strata| each * strata)
                .collect();
            let seed = hash::hash(!self.seed, 0);
            self.walk(pilot, &ends, seed, integrand, evaluations)?;
            if evaluations <= spent {
                return Ok(());
            }
            self.allocate(&pilot.visited, self.count - spent)
        } else {
            evenly(self.strata, self.count)
        };
        self.walk(main, &ends, self.seed, integrand, evaluations - spent)
    }

    /// Goes on with a phase until `evaluations` of its points, or a few more, were evaluated, or all: `ends` are their numbers up to and
    /// with each cell.
    fn walk<I: Integrand>(
        &self,
        phase: &mut Phase<Wide<I>>,
        ends: &[u64],
        seed: u64,
        integrand: &I,
        evaluations: u64,
    ) -> Result<(), Error> {
        /// Coordinates computed ahead at most, beyond those of the grid, and of how many points. The latter must not depend on
        /// what the integrand hints at, for no bit does.
        const WIDEST: u32 = 32;
        const ROWS: usize = 256;
        // A single cell is the cube.
        let axes = if self.cells > 1 { self.dimensions } else { 0 };
        let width = integrand.dimensions().min(WIDEST).max(axes);
        let rounds = Rounds::new(ends);
        let mut before = rounds.before(phase.rounds);
        while phase.rounds < rounds.number() {
            if evaluations <= before {
                break;
            }
            let seed = hash::hash(seed, u64::from(phase.rounds));
            let counts = rounds.counts(phase.rounds);
            let walk = Walk::shuffled(self.strata, counts, seed, LONGEST);
            let rows = Rows {
                points: Independent::new(seed),
                width,
                number: ROWS,
            };
            walk.go_on(
                &mut phase.visited,
                evaluations - before,
                |range| {
                    let mut cell = Cell::new(self.cells, axes, width, integrand);
                    (walk.evaluate(range, &rows, self.non_finite, &mut cell), ())
                },
                |()| (),
            )?;
            if !walk.is_complete(&phase.visited) {
                break;
            }
            before += walk.points();
            phase.visited.again();
            phase.rounds += 1;
        }
        Ok(())
    }

    /// Points in proportion to the standard deviations, two a cell at least, no more than `count` in all: their numbers up to and with each cell.
    fn allocate<V: Value>(&self, pilot: &Visited<V>, count: u64) -> Vec<u64> {
        let deviations: Vec<V> = pilot
            .strata()
            .iter()
            .map(|stratum| stratum.moments.std_dev().unwrap_or(V::ZERO))
            .collect();
        let largest = deviations
            .iter()
            .fold(V::ZERO, |largest, s| largest.zip(*s, f64::max));
        // One number for all components, each on its own scale.
        let score = |deviation: &V| {
            let mut square = 0.0;
            let _ = deviation.zip(largest, |s, largest| {
                if largest > 0.0 {
                    square += (s / largest).powi(2);
                }
                s
            });
            f64::sqrt(square)
        };
        /// This part is spread evenly.
        const EVEN: f64 = 0.1;
        apportion(&deviations, score, EVEN, count)
    }
}

/// Points that are evaluated in one go.
const LONGEST: u64 = 4096;

impl Progressive for Strata {
    type State<V: Value> = StrataState<V>;

    fn budget(&self) -> u64 {
        self.count
    }

    fn start<V: Value>(&self) -> Result<StrataState<V>, Error> {
        if self.neyman && self.count / (self.strata as u64) < self.pilot() + 2 {
            let domain = "at least four for each stratum with a pilot";
            return Err(Error::refused("count", domain, self.count));
        }
        Ok(StrataState {
            pilot: Phase::new(if self.neyman { self.strata } else { 0 }),
            main: Phase::new(self.strata),
        })
    }

    fn used<V: Value>(&self, state: &StrataState<V>) -> u64 {
        state.pilot.visited.used() + state.main.visited.used()
    }

    /// Goes on by parts of rounds.
    fn grow<I: Integrand>(
        &self,
        state: &mut StrataState<Wide<I>>,
        integrand: &I,
        evaluations: u64,
    ) -> Result<(), Error> {
        let mut outcome = Ok(());
        reduce::several(&mut || outcome = self.go_on(state, integrand, evaluations));
        outcome
    }

    fn conclude<V: Value>(&self, state: &StrataState<V>) -> Option<Estimate<V>> {
        let StrataState { pilot, main } = state;
        // All cells with few points are better than a few cells with many.
        let phase = if self.neyman && main.rounds == 0 {
            pilot
        } else {
            main
        };
        let together = Stratified::new(&phase.visited)?;
        let rejected = pilot.visited.rejected() + main.visited.rejected();
        let used = self.used(state);
        Some(Estimate {
            requested: self.count,
            stop: if used < self.count {
                Stop::Unfinished
            } else {
                Stop::Count
            },
            ..together.estimate(used, rejected)
        })
    }
    fn portion(&self) -> u64 {
        LONGEST
    }
}

impl Estimator for Strata {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        at_once(self, integrand)
    }
}
