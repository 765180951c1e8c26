//! One iteration of VEGAS: its points, and what is learned from them.

use rand::rngs::Xoshiro256PlusPlus;

use super::super::monte_carlo::seeded;
use crate::block::Block;
use crate::integrands::{Image, ImportanceMap};
use crate::stratum::{Stratum, apportion};
use crate::{Error, Integrand, Sampler, Stream, Value, hash, reduce};

/// The strata: a grid of equal cells over the first axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Grid {
    axes: usize,
    cells: u64,
    strata: usize,
}

impl Grid {
    /// As many cells as leave eight points to each, and two cells along an axis at least.
    fn new(dimensions: usize, count: u64) -> Self {
        let most = (count / 8).min(1 << 16);
        let mut grid = Self {
            axes: 0,
            cells: 1,
            strata: 1,
        };
        let power = |cells: u64| {
            u32::try_from(dimensions)
                .ok()
                .and_then(|d| cells.checked_pow(d))
        };
        let mut cells = 1;
        while power(cells + 1).is_some_and(|strata| strata <= most) {
            cells += 1;
        }
        if let Some(strata) = power(cells).filter(|_| cells > 1) {
            grid = Self {
                axes: dimensions,
                cells,
                strata: usize::try_from(strata).unwrap_or(1),
            };
        }
        grid
    }

    fn evenly(&self, count: u64) -> Vec<u64> {
        apportion(&vec![1.0; self.strata], count)
    }
}

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
    /// Sums of squares in each bin of each axis.
    squares: Vec<Vec<f64>>,
    hits: Vec<Vec<f64>>,
    largest: V,
    /// How many parts of the iteration are in it.
    parts: u64,
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
        let strata = Grid::new(map.dimensions(), count);
        Self {
            map,
            strata,
            counts: strata.evenly(count),
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
        reduce::in_order(
            end - begun,
            |job| {
                let part = begun + job;
                let range = self.first_of(part)..self.first_of(part + 1);
                self.part(integrand, hash::hash(seed, part), &ends, range)
            },
            |part: Part<V>| {
                if let Some(offender) = part.offender {
                    return Err(offender);
                }
                for (here, there) in pass.strata[part.first..].iter_mut().zip(&part.pass.strata) {
                    here.merge(there);
                }
                for (here, there) in [
                    (&mut pass.squares, &part.pass.squares),
                    (&mut pass.hits, &part.pass.hits),
                ] {
                    for (here, there) in here.iter_mut().flatten().zip(there.iter().flatten()) {
                        *here += there;
                    }
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
        let bins = vec![vec![0.0; self.map.bins()]; self.map.dimensions()];
        Pass {
            strata: vec![Stratum::EMPTY; strata],
            squares: bins.clone(),
            hits: bins,
            largest: V::ZERO,
            parts: 0,
        }
    }

    fn part<I: Integrand>(
        &self,
        integrand: &I,
        seed: u64,
        ends: &[u64],
        range: core::ops::Range<u64>,
    ) -> Part<V>
    where
        I::Value: Value<Wide = V>,
    {
        /// Values that are summed at once.
        const RUN: u64 = 1024;
        let first = ends.partition_point(|&end| end <= range.start);
        let last = ends.partition_point(|&end| end < range.end);
        let mut part = Part {
            first,
            pass: self.empty((last + 1).saturating_sub(first)),
            offender: None,
        };
        let mut stream = Stream(seeded::<Xoshiro256PlusPlus>(seed));
        let width = self.map.dimensions();
        let mut hits = vec![Hit { bin: 0, x: 0.0 }; width];
        let mut values = Vec::new();
        let mut index = range.start;
        let mut stratum = first;
        while index < range.end {
            while ends[stratum] <= index {
                stratum += 1;
            }
            let end = ends[stratum].min(range.end).min(index + RUN);
            let mut block = Block::EMPTY;
            values.clear();
            while index < end {
                let mut u = Trained {
                    inner: &mut stream,
                    state: self,
                    stratum: stratum as u64,
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
                block.push(value);
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
                for (axis, hit) in hits[..read].iter().enumerate() {
                    part.pass.squares[axis][hit.bin] += square;
                    part.pass.hits[axis][hit.bin] += 1.0;
                }
                index += 1;
            }
            let run = block.piece().map_or_else(
                || {
                    let first = values.first().copied().unwrap_or(V::ZERO);
                    Stratum {
                        moments: values.iter().copied().collect(),
                        low: values.iter().fold(first, |low, x| low.zip(*x, f64::min)),
                        high: values.iter().fold(first, |high, x| high.zip(*x, f64::max)),
                    }
                },
                |piece| Stratum {
                    moments: piece.moments,
                    low: piece.low,
                    high: piece.high,
                },
            );
            if !values.is_empty() {
                part.pass.strata[stratum - first].merge(&run);
                let size = run.low.zip(run.high, |low, high| low.abs().max(high.abs()));
                part.pass.largest = part.pass.largest.zip(size, f64::max);
            }
            if part.offender.is_some() {
                break;
            }
        }
        part
    }

    /// Adapts the map to where the squares are, and the numbers of points to where the spread is.
    pub(super) fn learn(&mut self, pass: &Pass<V>, damping: f64, count: u64) {
        /// Points follow the deviation of their stratum to this power: less than 1, because it is uncertain.
        const FOLLOW: f64 = 0.75;
        const EVEN: f64 = 0.2;
        let weights: Vec<Vec<f64>> = pass
            .squares
            .iter()
            .zip(&pass.hits)
            .map(|(squares, hits)| {
                squares
                    .iter()
                    .zip(hits)
                    .map(|(square, hits)| if *hits > 0.0 { square / hits } else { 0.0 })
                    .collect()
            })
            .collect();
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
                f64::powf(square, 0.5 * FOLLOW)
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

/// The images of coordinates in a stratum, each remembered.
struct Trained<'a, S, V> {
    inner: &'a mut S,
    state: &'a Adaptation<V>,
    /// The number of the stratum in what axes are left.
    stratum: u64,
    hits: &'a mut [Hit],
    dimension: usize,
    jacobian: f64,
}

impl<S: Sampler, V> Sampler for Trained<'_, S, V> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let mut u = self.inner.next_1d();
        let dimension = self.dimension;
        self.dimension += 1;
        let grid = self.state.strata;
        if dimension < grid.axes {
            let cell = self.stratum % grid.cells;
            self.stratum /= grid.cells;
            u = (cell as f64 + u) / grid.cells as f64;
        }
        match self.state.map.image(dimension, u) {
            Some(Image { x, jacobian, bin }) => {
                self.jacobian *= jacobian;
                self.hits[dimension] = Hit { bin, x };
                x
            }
            None => u,
        }
    }
}

/// Where a coordinate went.
#[derive(Clone, Copy)]
struct Hit {
    bin: usize,
    x: f64,
}
