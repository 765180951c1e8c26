//! One iteration of VEGAS: its points, and what is learned from them.

use core::ops::Range;

use rand::rngs::Xoshiro256PlusPlus;

use super::super::monte_carlo::seeded;
use super::grid::{Axis, Grid, advance};
use crate::block::Block;
use crate::integrands::{Bin, ImportanceMap};
use crate::points::{Independent, PointSet};
use crate::stratum::{Stratum, apportion};
use crate::{Cursor, Error, Integrand, Sampler, Stream, Value, hash, reduce};

/// What is adapted from iteration to iteration.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Adaptation<V> {
    pub(super) map: ImportanceMap,
    strata: Grid,
    counts: Vec<u64>,
    /// The largest absolute values seen, per component: all components train the map on the same scale.
    pub(super) scale: V,
}

/// What one iteration has given so far.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Pass<V> {
    pub(super) strata: Vec<Stratum<V>>,
    /// The squares of the values in each bin, axis by axis.
    squares: Vec<Squares>,
    largest: V,
    /// How many parts of the iteration are in it.
    parts: u64,
}

/// Squares of values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Squares {
    sum: f64,
    count: f64,
}

/// A part of an iteration: the points `range`, counted through all strata.
struct Part<V> {
    first: usize,
    pass: Pass<V>,
    offender: Option<Error>,
}

impl<V: Value> Adaptation<V> {
    /// Iterations of about `count` points, beginning with `map`.
    pub(super) fn new(map: ImportanceMap, count: u64) -> Self {
        let strata = Grid::new(map.dimensions(), count, map.bins());
        Self {
            map,
            counts: strata.evenly(count),
            strata,
            scale: V::ZERO,
        }
    }

    /// How many points the next iteration has.
    pub(super) fn points(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// An iteration with no points yet. Its seed must stay the same until it is complete.
    pub(super) fn begin<I: Integrand>(&mut self, integrand: &I, seed: u64) -> Pass<V>
    where
        I::Value: Value<Wide = V>,
    {
        if self.largest_is_zero() {
            self.look(integrand, seed);
        }
        self.empty(self.counts.len())
    }

    /// The index of the first point of a part of the iteration.
    fn first_of(&self, part: u64) -> u64 {
        let (total, parts) = (self.points(), self.parts());
        // Products that would not fit into a word do not fit into a day either.
        total / parts * part + (total % parts).min(part)
    }

    /// The parts that an iteration is evaluated in, each with its own sums for every bin.
    fn parts(&self) -> u64 {
        const MOST: u64 = 64;
        const SHORTEST: u64 = 4096;
        self.points().div_ceil(SHORTEST).clamp(1, MOST)
    }

    /// How many points of the iteration were evaluated.
    pub(super) fn used(&self, pass: &Pass<V>) -> u64 {
        self.first_of(pass.parts)
    }

    /// Goes on with an iteration until `count` of its points, or a few more, are evaluated, or all.
    pub(super) fn go_on<I: Integrand>(
        &self,
        pass: &mut Pass<V>,
        integrand: &I,
        seed: u64,
        count: u64,
    ) -> Result<(), Error>
    where
        I::Value: Value<Wide = V>,
    {
        let mut ends = Vec::with_capacity(self.counts.len());
        let mut total = 0;
        for count in &self.counts {
            total += count;
            ends.push(total);
        }
        let begun = pass.parts;
        let end = (begun..self.parts())
            .find(|&part| self.first_of(part) >= count)
            .unwrap_or(self.parts());
        let bins = self.map.table();
        reduce::in_order(
            end - begun,
            |job| {
                let part = begun + job;
                let range = self.first_of(part)..self.first_of(part + 1);
                self.part(integrand, seed, &bins, &ends, range)
            },
            |part: Part<V>| {
                if let Some(offender) = part.offender {
                    return Err(offender);
                }
                for (here, there) in pass.strata[part.first..].iter_mut().zip(&part.pass.strata) {
                    here.merge(there);
                }
                for (here, there) in pass.squares.iter_mut().zip(&part.pass.squares) {
                    here.sum += there.sum;
                    here.count += there.count;
                }
                pass.largest = pass.largest.zip(part.pass.largest, f64::max);
                pass.parts += 1;
                Ok(())
            },
        )
    }

    fn largest_is_zero(&self) -> bool {
        let mut zero = true;
        self.scale.for_each(|scale| zero &= scale == 0.0);
        zero
    }

    /// Finds the scale of the components from a few points that are used for nothing else.
    fn look<I: Integrand>(&mut self, integrand: &I, seed: u64)
    where
        I::Value: Value<Wide = V>,
    {
        let mut stream = Stream(seeded::<Xoshiro256PlusPlus>(hash::hash(!seed, 0)));
        for _ in 0..self.counts.iter().sum::<u64>().min(256) {
            let value = integrand.evaluate(&mut stream).widen();
            if value.is_finite() {
                self.scale = self.scale.zip(value, |scale, x| scale.max(x.abs()));
            }
        }
    }

    fn empty(&self, strata: usize) -> Pass<V> {
        Pass {
            strata: vec![Stratum::EMPTY; strata],
            squares: vec![Squares::default(); self.map.bins() * self.map.dimensions()],
            largest: V::ZERO,
            parts: 0,
        }
    }

    /// The points `range`; `ends` are the numbers of points up to and with each stratum.
    fn part<I: Integrand>(
        &self,
        integrand: &I,
        seed: u64,
        bins: &[Bin],
        ends: &[u64],
        range: Range<u64>,
    ) -> Part<V>
    where
        I::Value: Value<Wide = V>,
    {
        /// Coordinates computed ahead.
        const AHEAD: usize = 4096;
        let first = ends.partition_point(|&end| end <= range.start);
        let last = ends.partition_point(|&end| end < range.end);
        let mut part = Part {
            first,
            pass: self.empty((last + 1).saturating_sub(first)),
            offender: None,
        };
        let points = Independent::new(seed);
        let width = self.map.dimensions();
        let dimensions = u32::try_from(width).expect("the number of axes is a u32");
        // A map without axes needs rows all the same, if empty ones.
        let stride = width.max(1);
        let rows = (AHEAD / stride).max(1);
        let mut ahead = vec![0.0; rows * stride];
        let mut filled = range.start..range.start;
        let mut hits = vec![Hit { bin: 0, x: 0.0 }; width];
        let mut values = Vec::new();
        let mut index = range.start;
        let mut stratum = first;
        let mut place = self.strata.place(first, self.map.bins());
        while index < range.end {
            if index == filled.end {
                let left = range.end - index;
                let count = usize::try_from(left).map_or(rows, |left| left.min(rows));
                points.fill(index, 0..dimensions, &mut ahead[..count * width]);
                filled = index..index + count as u64;
            }
            while ends[stratum] <= index {
                stratum += 1;
                advance(&mut place);
            }
            let end = ends[stratum].min(filled.end);
            let row = usize::try_from(index - filled.start).expect("it is in memory");
            let prefixes = ahead[row * stride..].chunks_exact(stride);
            values.clear();
            for (index, prefix) in (index..end).zip(prefixes) {
                let mut u = Trained {
                    inner: Cursor::with_prefix(&points, index, &prefix[..width]),
                    bins,
                    number: self.map.bins(),
                    place: &place,
                    hits: &mut hits,
                    dimension: 0,
                    jacobian: 1.0,
                };
                let value = integrand.evaluate(&mut u).widen();
                let (read, jacobian) = (u.dimension.min(width), u.jacobian);
                let value = value.map(|value| value * jacobian);
                if !value.is_finite() {
                    let mut components = Vec::new();
                    value.for_each(|component| components.push(component / jacobian));
                    part.offender = Some(Error::NonFinite {
                        index,
                        replicate: 0,
                        coordinates: hits[..read].iter().map(|hit| hit.x).collect(),
                        value: components,
                    });
                    break;
                }
                values.push(value);
                let mut square = 0.0;
                let _ = value.zip(self.scale, |value, scale| {
                    if scale > 0.0 {
                        // Capped: the scale may be that of points that all missed the peak.
                        let relative = (value / scale).abs().min(1e140);
                        square += relative * relative;
                    }
                    value
                });
                for hit in &hits[..read] {
                    let squares = &mut part.pass.squares[hit.bin];
                    squares.sum += square;
                    squares.count += 1.0;
                }
            }
            if let Some(run) = summed(&values) {
                part.pass.strata[stratum - first].merge(&run);
                let size = run.low.zip(run.high, |low, high| low.abs().max(high.abs()));
                part.pass.largest = part.pass.largest.zip(size, f64::max);
            }
            if part.offender.is_some() {
                break;
            }
            index = end;
        }
        part
    }

    /// Adapts the map to where the squares are, and the numbers of points to where the spread is.
    pub(super) fn learn(&mut self, pass: &Pass<V>, damping: f64, count: u64) {
        const EVEN: f64 = 0.2;
        let bins = self.map.bins();
        let weights: Vec<_> = pass.squares.chunks_exact(bins).map(means).collect();
        self.map.refine(&weights, damping);
        self.scale = pass.largest;
        let scores: Vec<f64> = pass
            .strata
            .iter()
            .map(|stratum| {
                let deviation = stratum.moments.std_dev().unwrap_or(V::ZERO);
                let mut square = 0.0;
                let _ = deviation.zip(pass.largest, |deviation, largest| {
                    if largest > 0.0 {
                        square += (deviation / largest).powi(2);
                    }
                    deviation
                });
                // The deviation to the power of 3/4: less than 1, because it is uncertain.
                let root = f64::sqrt(square).sqrt();
                root * root.sqrt()
            })
            .collect();
        // A part is spread evenly: a stratum that looked constant may not be.
        let even = scores.iter().sum::<f64>() / scores.len() as f64;
        let scores: Vec<f64> = scores
            .iter()
            .map(|score| EVEN * even + (1.0 - EVEN) * score)
            .collect();
        self.counts = apportion(&scores, count);
    }
}

/// The mean squares of the bins of an axis. Of a bin without points nothing is known: it has the mean of the nearest
/// bins with points, so that nothing is learned where nothing was seen.
fn means(axis: &[Squares]) -> Vec<f64> {
    let known = |squares: &Squares| (squares.count > 0.0).then(|| squares.sum / squares.count);
    (0..axis.len())
        .map(|bin| {
            let below = axis[..=bin].iter().rev().find_map(known);
            let above = axis[bin..].iter().find_map(known);
            match (below, above) {
                (Some(below), Some(above)) => 0.5 * (below + above),
                (one, other) => one.or(other).unwrap_or(0.0),
            }
        })
        .collect()
}

/// What the values of a run of points are together; `None` if there are none.
fn summed<V: Value>(values: &[V]) -> Option<Stratum<V>> {
    let &first = values.first()?;
    let mut block = Block::EMPTY;
    block.extend(values, |value| value);
    Some(match block.piece() {
        Some(piece) => Stratum {
            moments: piece.moments,
            low: piece.low,
            high: piece.high,
        },
        None => Stratum {
            moments: values.iter().copied().collect(),
            low: values.iter().fold(first, |low, x| low.zip(*x, f64::min)),
            high: values.iter().fold(first, |high, x| high.zip(*x, f64::max)),
        },
    })
}

/// The images of coordinates in a stratum, each remembered.
struct Trained<'a, S> {
    inner: S,
    bins: &'a [Bin],
    /// How many bins an axis has.
    number: usize,
    place: &'a [Axis],
    hits: &'a mut [Hit],
    dimension: usize,
    jacobian: f64,
}

impl<S: Sampler> Sampler for Trained<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let u = self.inner.next_1d();
        let dimension = self.dimension;
        self.dimension += 1;
        let Some(axis) = self.place.get(dimension) else {
            return u;
        };
        let scaled = (axis.cell + u) * axis.scale;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "below the number of bins"
        )]
        let bin = (scaled as usize).min(self.number - 1);
        let within = scaled - bin as f64;
        let bin = dimension * self.number + bin;
        let x = self.bins[bin].image(within);
        self.jacobian *= self.bins[bin].jacobian;
        self.hits[dimension] = Hit { bin, x };
        x
    }
}

/// Where a coordinate went.
#[derive(Clone, Copy)]
struct Hit {
    /// Its bin, counted through all axes.
    bin: usize,
    x: f64,
}
