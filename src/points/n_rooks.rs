//! N rooks that do not attack one another.

use core::ops::Range;

use super::block::{Block, vectorised};
use super::radical_inverse::BELOW_ONE;
use super::{PointSet, rows};
use crate::Error;
use crate::hash::{Bijection, FEW, ROUNDS, hash, permute, unit};

/// N-rooks points, also Latin hypercube samples: with `count` points, every one of `count` equal strata of every
/// axis holds exactly one.[^shirley] [^mckay]
///
/// Any count, any number of dimensions, constant memory: each axis is shuffled by a hash, not by a table.
///
/// Removes the part of the variance that is a sum of functions of one coordinate each, and never does much
/// worse than independent points: the variance is at most `count / (count - 1)` times theirs.[^owen] It does
/// nothing for what two coordinates do together; a [`Stratified`](super::Stratified) grid does, in few dimensions.
///
/// An index at or past the count belongs to another, independent set of `count` points.
///
/// ```
/// use estimand::points::{NRooks, PointSet};
///
/// let rooks = NRooks::new(9, 1)?;
/// let mut columns: Vec<u32> = (0..9).map(|rook| (rooks.coordinate(rook, 1) * 9.0) as u32).collect();
/// columns.sort();
/// assert_eq!(columns, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^shirley]: Shirley, Peter (1991). *Discrepancy as a Quality Measure for Sample Distributions*. Eurographics '91.
///     <https://doi.org/10.2312/egtp.19911013>
/// [^mckay]: McKay, Michael; Beckman, Richard; Conover, William (1979). *A Comparison of Three Methods for
///     Selecting Values of Input Variables in the Analysis of Output from a Computer Code*.
///     <https://doi.org/10.1080/00401706.1979.10489755>
/// [^owen]: Owen, Art (1997). *Monte Carlo Variance of Scrambled Net Quadrature*.
///     <https://doi.org/10.1137/S0036142994277468>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct NRooks {
    count: u64,
    seed: u64,
}

impl NRooks {
    /// A set of `count` points that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a count of 0.
    pub fn new(count: u64, seed: u64) -> Result<Self, Error> {
        if count == 0 {
            return Err(Error::refused(
                "count of N-rooks points",
                "at least 1",
                count,
            ));
        }
        Ok(Self { count, seed })
    }
}

impl NRooks {
    /// What selects the order of the strata in `dimension` of the set number `set`.
    #[inline]
    fn key(&self, set: u64, dimension: u32) -> u64 {
        hash(hash(self.seed, set), u64::from(dimension))
    }
}

impl PointSet for NRooks {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let (set, index) = (index / self.count, index % self.count);
        let key = self.key(set, dimension);
        let stratum = permute(index, self.count, key);
        within(stratum, self.count, unit(hash(!key, index)))
    }

    fn size(&self) -> Option<u64> {
        Some(self.count)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        if self.count <= FEW || self.count > 1 << 32 {
            for (index, row) in rows(first, &dimensions, out) {
                for (dimension, coordinate) in dimensions.clone().zip(row) {
                    *coordinate = self.coordinate(index, dimension);
                }
            }
            return;
        }
        let block = Block::new(first, dimensions, out, u32::MAX, 0);
        let (width, mut index) = (block.width, block.first);
        // The rows of one set after the other.
        let mut out = block.out;
        while !out.is_empty() {
            let (set, place) = (index / self.count, index % self.count);
            let left = usize::try_from(self.count - place).unwrap_or(usize::MAX);
            let (now, later) = out.split_at_mut(out.len().min(left.saturating_mul(width)));
            for start in (0..width).step_by(LANES) {
                let dimensions = block.dimensions.clone().skip(start).take(LANES);
                vectorised(
                    #[inline(always)]
                    || {
                        let columns = Columns::new(dimensions.map(|d| self.key(set, d)));
                        for (index, row) in (place..).zip(now.chunks_exact_mut(width)) {
                            columns.write(self.count, index, &mut row[start..]);
                        }
                    },
                );
            }
            index = index.wrapping_add(left as u64);
            out = later;
        }
    }
}

/// Dimensions that are computed side by side.
const LANES: usize = 64;

/// The keys of some dimensions, and their bijections of words of up to 32 bits.
struct Columns {
    keys: [u64; LANES],
    summands: [[u32; LANES]; ROUNDS],
    multipliers: [[u32; LANES]; ROUNDS],
    last: [u32; LANES],
}

impl Columns {
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "arithmetic modulo 2^32 needs no more"
    )]
    fn new(keys: impl Iterator<Item = u64>) -> Self {
        let mut columns = Self {
            keys: [0; LANES],
            summands: [[0; LANES]; ROUNDS],
            multipliers: [[0; LANES]; ROUNDS],
            last: [0; LANES],
        };
        for (lane, key) in keys.enumerate() {
            let bijection = Bijection::new(key);
            columns.keys[lane] = key;
            columns.last[lane] = bijection.last as u32;
            for round in 0..ROUNDS {
                columns.summands[round][lane] = bijection.summands[round] as u32;
                columns.multipliers[round][lane] = bijection.multipliers[round] as u32;
            }
        }
        columns
    }

    /// Writes the coordinates of the point `index` of a set of `count`: as many as `row` has, [`LANES`] at most.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the count is at most 2^32")]
    fn write(&self, count: u64, index: u64, row: &mut [f64]) {
        let bits = u64::BITS - (count - 1).leading_zeros();
        let (mask, half) = (u32::MAX >> (u32::BITS - bits), bits.div_ceil(2));
        let mut images = [0; LANES];
        for (lane, image) in images[..row.len().min(LANES)].iter_mut().enumerate() {
            let mut word = index as u32;
            for round in 0..ROUNDS {
                word = word.wrapping_add(self.summands[round][lane]);
                word = word.wrapping_mul(self.multipliers[round][lane]) & mask;
                word ^= word >> half;
            }
            *image = word.wrapping_add(self.last[lane]) & mask;
        }
        // Images past the count walk on along their cycles.
        if !count.is_power_of_two() {
            for (&key, image) in self.keys.iter().zip(&mut images).take(row.len()) {
                if u64::from(*image) >= count {
                    let bijection = Bijection::new(key);
                    while u64::from(*image) >= count {
                        *image = bijection.apply((*image).into(), bits) as u32;
                    }
                }
            }
        }
        for ((u, &image), &key) in row.iter_mut().zip(&images).zip(&self.keys) {
            *u = within(image.into(), count, unit(hash(!key, index)));
        }
    }
}

/// The point at the fraction `offset`, in `[0, 1)`, of the stratum `stratum` of `count` equal ones.
///
/// In `[0, 1)`: the quotient is rounded once, from a number below 1; where it rounds to 1.0, as it can past
/// 2^52 strata, the largest number below is taken.
#[inline]
pub(super) fn within(stratum: u64, count: u64, offset: f64) -> f64 {
    ((stratum as f64 + offset) / count as f64).min(BELOW_ONE)
}
