//! What VEGAS adapts, and how it learns.

use super::grid::Grid;
use super::learner::Learner;
use super::squares::Squares;
use crate::evaluate::Wide;
use crate::integrands::ImportanceMap;
use crate::points::{Independent, PointSet};
use crate::recorder::Recorder;
use crate::stratum::{Rows, Stratum, Visited, Walk, apportion, between};
use crate::{Error, Integrand, NonFinite, Value, hash, reduce};

/// What is adapted from iteration to iteration.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Adaptation<V> {
    pub(super) map: ImportanceMap,
    pub(super) strata: Grid,
    /// The numbers of points up to and with each stratum.
    ends: Vec<u64>,
    /// The largest absolute values seen, per component: all components train the map on the same scale.
    pub(super) scale: V,
}

/// How an iteration goes through the strata.
#[derive(Clone, Copy, Debug)]
pub(super) enum Order {
    /// Those that were visited first are a random sample of all.
    Random,
    /// By their numbers, which takes less time.
    Number,
}

/// What one iteration has given so far.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Pass<V> {
    pub(super) visited: Visited<V>,
    /// The squares of the values in each bin, axis by axis.
    squares: Vec<Squares>,
}

impl<V: Value> Pass<V> {
    /// How many points were evaluated.
    pub(super) fn used(&self) -> u64 {
        self.visited.used()
    }

    /// Another iteration with no points yet, in the same room.
    pub(super) fn cleared(mut self) -> Self {
        self.visited.clear();
        self.squares.fill(Squares::default());
        self
    }
}

impl<V: Value> Adaptation<V> {
    /// Iterations of about `count` points, beginning with `map`. The first has those less that are for
    /// [looking](Self::look).
    pub(super) fn new(map: ImportanceMap, count: u64) -> Self {
        let strata = Grid::new(map.dimensions(), count, map.bins());
        Self {
            map,
            ends: strata.evenly(count - looks(count)),
            strata,
            scale: V::ZERO,
        }
    }

    /// How many points the next iteration has.
    pub(super) fn points(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// An iteration with no points yet.
    pub(super) fn begin(&self) -> Pass<V> {
        Pass {
            visited: Visited::new(0),
            squares: vec![Squares::default(); self.map.bins() * self.map.dimensions()],
        }
    }

    /// Finds the scale of the components from a few points that are used for nothing else. How many they were, of iterations of
    /// `count` points, and how many of their values were not finite.
    pub(super) fn look<I: Integrand>(
        &mut self,
        integrand: &I,
        seed: u64,
        count: u64,
        policy: NonFinite,
    ) -> Result<[u64; 2], Error>
    where
        I::Value: Value<Wide = V>,
    {
        let points = Independent::new(hash::hash(!seed, 0));
        let number = looks(count);
        let mut rejected = 0;
        for index in 0..number {
            let value: Wide<I> = integrand.evaluate(&mut points.point(index)).widen();
            if value.is_finite() {
                self.scale = self.scale.zip(value, |scale, x| scale.max(x.abs()));
            } else if policy == NonFinite::Reject {
                rejected += 1;
            } else {
                let mut coordinates = Vec::new();
                let inner = points.point(index);
                let _ = integrand.evaluate(&mut Recorder {
                    inner,
                    coordinates: &mut coordinates,
                });
                return Err(Error::of_value(index, coordinates, value));
            }
        }
        Ok([number, rejected])
    }

    /// Goes on with an iteration until `count` of its points, or a few more, are evaluated, or all; whether all are. `seed` must
    /// stay the same until they are.
    pub(super) fn go_on<I: Integrand>(
        &self,
        pass: &mut Pass<V>,
        integrand: &I,
        seed: u64,
        count: u64,
        order: Order,
        policy: NonFinite,
    ) -> Result<bool, Error>
    where
        I::Value: Value<Wide = V>,
    {
        /// Coordinates computed ahead, and of how many points at most.
        const AHEAD: usize = 4096;
        const ROWS: usize = 256;
        let longest = longest_part(self.points());
        let walk = match order {
            Order::Random => {
                let counts = |stratum| between(&self.ends, stratum);
                Walk::shuffled(self.ends.len(), counts, seed, longest)
            }
            Order::Number => Walk::in_turn(&self.ends, longest),
        };
        let bins = self.map.table();
        let dimensions = self.map.dimensions();
        let rows = Rows {
            points: Independent::new(seed),
            width: u32::try_from(dimensions).expect("the number of axes is a u32"),
            number: (AHEAD / dimensions.max(1)).clamp(1, ROWS),
        };
        let Pass { visited, squares } = pass;
        walk.go_on(
            visited,
            count,
            |range| {
                let mut learner = Learner::new(self, integrand, &bins);
                let part = walk.evaluate(range, &rows, policy, &mut learner);
                (part, learner.squares())
            },
            |part: Vec<Squares>| {
                for (here, there) in squares.iter_mut().zip(&part) {
                    here.add(there);
                }
            },
        )?;
        Ok(walk.is_complete(visited))
    }

    /// Adapts the map to where the squares are, and the numbers of points to where the spread is; the `largest` absolute values
    /// are the scale.
    pub(super) fn learn(&mut self, pass: &Pass<V>, largest: V, damping: f64, count: u64) {
        /// This part is spread evenly: a stratum that looked constant may not be.
        const EVEN: f64 = 0.2;
        let score = |stratum: &Stratum<V>| {
            let deviation = stratum.moments.std_dev().unwrap_or(V::ZERO);
            let mut square = 0.0;
            let _ = deviation.zip(largest, |deviation, largest| {
                if largest > 0.0 {
                    square += (deviation / largest).powi(2);
                }
                deviation
            });
            // The deviation to the power of 3/4: less than 1, because it is uncertain.
            let root = f64::sqrt(square).sqrt();
            root * root.sqrt()
        };
        let bins = self.map.bins();
        (self.map, self.ends) = reduce::both(
            || {
                let weights: Vec<_> = pass.squares.chunks_exact(bins).map(means).collect();
                self.map.refined(&weights, damping)
            },
            || apportion(pass.visited.strata(), score, EVEN, count),
        );
        self.scale = largest;
    }
}

/// The longest part of an iteration of `count` points: each has its own sums for every bin, so that it is not to be short.
pub(super) fn longest_part(count: u64) -> u64 {
    (count / 16).clamp(4096, 16_384).next_power_of_two()
}

/// How many of `count` points look for the scale.
fn looks(count: u64) -> u64 {
    (count / 8).clamp(1, 256)
}

/// The mean squares of the bins of an axis. Of a bin without points nothing is known: it has the mean of the nearest
/// bins with points, so that nothing is learned where nothing was seen.
fn means(axis: &[Squares]) -> Vec<f64> {
    /// Of each bin, or of the last one before it that has any.
    fn last_known<'a>(bins: impl Iterator<Item = &'a Squares>) -> Vec<Option<f64>> {
        bins.scan(None, |known, bin| {
            *known = bin.mean().or(*known);
            Some(*known)
        })
        .collect()
    }
    let below = last_known(axis.iter());
    let above = last_known(axis.iter().rev());
    let both = below.into_iter().zip(above.into_iter().rev());
    both.map(|pair| match pair {
        (Some(below), Some(above)) => 0.5 * (below + above),
        (one, other) => one.or(other).unwrap_or(0.0),
    })
    .collect()
}
