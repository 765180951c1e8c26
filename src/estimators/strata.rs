//! Independent points in every cell of a grid, with the variance of each cell.

use core::ops::Range;
use std::time::Instant;

use rand::rngs::Xoshiro256PlusPlus;

use super::monte_carlo::Streams;
use crate::block::smaller;
use crate::evaluate::{Source, Tail, Visit, Wide, evaluate};
use crate::stratum::{Stratified, Stratum, apportion};
use crate::tally::Tally;
use crate::{
    Error, ErrorBar, Estimate, Estimator, Incomplete, Integrand, NonFinite, Outcome, Sampler, Stop,
    Value, hash,
};

/// Stratified sampling: independent points in each of the equal cells of a grid, and an error bar made of the
/// cells' own variances.
///
/// The grid covers the first dimensions; further ones are independent. What varies from cell to cell adds nothing to the
/// variance. With [`neyman`](Self::neyman) the cells get points in proportion to their standard deviations,
/// which is the best there is.[^neyman]
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

    /// Evaluates `counts[k]` points in stratum `k`.
    fn run<I: Integrand>(
        &self,
        seed: u64,
        counts: &[u64],
        integrand: &I,
    ) -> (Vec<Tally<Wide<I>>>, Result<(), Error>) {
        let cells: Vec<Cell> = (0..)
            .zip(counts)
            .map(|(index, _)| Cell {
                grid: *self,
                index,
                streams: Streams::new(hash::hash(seed, index)),
            })
            .collect();
        let mut tallies = vec![Tally::EMPTY; cells.len()];
        let policy = NonFinite::Fail;
        let outcome = evaluate(
            &cells,
            &mut tallies,
            counts,
            Tail::Closed,
            integrand,
            policy,
        );
        (tallies.iter().map(Tally::closed).collect(), outcome)
    }

    /// Points in proportion to the standard deviations, two a cell at least, no more than `count` in all.
    fn allocate<V: Value>(&self, pilot: &[Tally<V>], count: u64) -> Vec<u64> {
        let deviations: Vec<V> = pilot
            .iter()
            .map(|tally| tally.moments().std_dev().unwrap_or(V::ZERO))
            .collect();
        let largest = deviations
            .iter()
            .fold(V::ZERO, |largest, s| largest.zip(*s, f64::max));
        // One number for all components, each on its own scale.
        let scores: Vec<f64> = deviations
            .iter()
            .map(|deviation| {
                let mut square = 0.0;
                let _ = deviation.zip(largest, |s, largest| {
                    if largest > 0.0 {
                        square += (s / largest).powi(2);
                    }
                    s
                });
                f64::sqrt(square)
            })
            .collect();
        // One point in ten is spread evenly.
        let sum: f64 = scores.iter().sum();
        let even = sum / self.strata as f64;
        let scores: Vec<f64> = scores
            .iter()
            .map(|score| 0.1 * even + 0.9 * score)
            .collect();
        apportion(&scores, count)
    }

    fn summary<V: Value>(&self, tallies: &[Tally<V>]) -> Option<Estimate<V>> {
        let strata: Vec<_> = tallies.iter().map(Stratum::of).collect();
        let stratified = Stratified::new(&strata)?;
        Some(Estimate {
            std_error: Some(stratified.std_error),
            error_bar: ErrorBar::Strata {
                freedom: stratified.freedom,
            },
            requested: self.count,
            warnings: stratified.warnings(),
            ..Estimate::new(stratified.mean, tallies.iter().map(Tally::used).sum())
        })
    }
}

impl Estimator for Strata {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        let clock = Instant::now();
        let strata = self.strata as u64;
        let mut spent = 0;
        let counts = if self.neyman {
            let each = (self.count / 10 / strata).max(2);
            if self.count < strata * (each + 2) {
                let domain = "at least four for each stratum with a pilot";
                return Err(Error::refused("count", domain, self.count).into());
            }
            let seed = hash::hash(!self.seed, 0);
            let (pilot, outcome) = self.run(seed, &vec![each; self.strata], integrand);
            outcome?;
            spent = each * strata;
            self.allocate(&pilot, self.count - spent)
        } else {
            apportion(&vec![1.0; self.strata], self.count)
        };
        let (tallies, outcome) = self.run(self.seed, &counts, integrand);
        let estimate = self.summary(&tallies).map(|estimate| Estimate {
            used: estimate.used + spent,
            seconds: clock.elapsed().as_secs_f64(),
            ..estimate
        });
        match (outcome, estimate) {
            (Ok(()), Some(estimate)) => Ok(estimate),
            (Ok(()), None) => Err(Error::NothingLeft { rejected: 0 }.into()),
            (Err(reason), so_far) => Err(Incomplete {
                reason,
                so_far: so_far.map(|estimate| {
                    Box::new(Estimate {
                        stop: Stop::Unfinished,
                        ..estimate
                    })
                }),
            }),
        }
    }
}

/// Independent points of one cell.
struct Cell {
    grid: Strata,
    index: u64,
    streams: Streams<Xoshiro256PlusPlus>,
}

impl Source for Cell {
    fn points(&self, indices: Range<u64>, drawn: u64, _: u32, visit: &mut impl Visit) {
        let Strata {
            cells, dimensions, ..
        } = self.grid;
        let mut index = self.index;
        let corner: Vec<f64> = (0..dimensions)
            .map(|_| {
                let place = index % cells;
                index /= cells;
                place as f64
            })
            .collect();
        let mut u = Confined {
            inner: self.streams.stream(indices.start, drawn),
            cells: cells as f64,
            corner: &corner,
            left: &corner,
        };
        visit.stream(indices, &mut u, |u| u.left = u.corner);
    }
}

/// The first coordinates of each point confined to a cell.
struct Confined<'a, S> {
    inner: S,
    /// How many cells there are along an axis.
    cells: f64,
    /// Which of them it is, axis by axis.
    corner: &'a [f64],
    /// The same for the axes that the point has not read.
    left: &'a [f64],
}

impl<S> Confined<'_, S> {
    /// A coordinate of the whole axis moved to the `place`-th of its cells.
    #[inline]
    fn confine(&self, u: f64, place: f64) -> f64 {
        const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
        smaller((place + u) / self.cells, ALMOST_ONE)
    }
}

impl<S: Sampler> Sampler for Confined<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let u = self.inner.next_1d();
        let Some((&place, left)) = self.left.split_first() else {
            return u;
        };
        self.left = left;
        self.confine(u, place)
    }

    /// Draws first and confines then, several at once.
    #[inline]
    fn next_nd(&mut self, out: &mut [f64]) {
        self.inner.next_nd(out);
        let (here, left) = self.left.split_at(out.len().min(self.left.len()));
        self.left = left;
        for (u, &place) in out.iter_mut().zip(here) {
            *u = self.confine(*u, place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cursor;
    use crate::points::Independent;

    #[test]
    fn coordinates_are_the_same_one_by_one_and_at_once() {
        let points = Independent::new(5);
        let corner = [2.0, 0.0, 6.0];
        let confined = |index| Confined {
            inner: Cursor::new(&points, index),
            cells: 7.0,
            corner: &corner,
            left: &corner,
        };
        for index in 0..100 {
            let (mut singly, mut together) = (confined(index), confined(index));
            let mut out = [0.0; 5];
            // Within the confined axes, across their end, and past it.
            let (first, rest) = out.split_at_mut(2);
            together.next_nd(first);
            together.next_nd(rest);
            assert_eq!(out, core::array::from_fn(|_| singly.next_1d()));
            assert_eq!(together.next_1d(), singly.next_1d());
            assert!((2.0 / 7.0..3.0 / 7.0).contains(&out[0]) && (6.0 / 7.0..1.0).contains(&out[2]));
        }
    }
}
