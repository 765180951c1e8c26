//! Sobol' points.

use core::ops::Range;

use super::block::{Aligned, Block, vectorised};
use super::scramble::{BinaryScramble, Columns, DigitOrder, Plain};
use super::{Independent, PointSet};
use crate::Error;
use crate::hash::unit;

mod directions;

pub use directions::DIMENSIONS;
use directions::Matrices;
pub(super) use directions::{generator, table, van_der_corput};

/// Sobol' points[^sobol] with the direction numbers of Joe and Kuo.[^joe]
///
/// A digital sequence in base 2, in natural order: the first `2^m` points, and every aligned block of as many, are a
/// net, which puts the right number of points into every elementary interval that is large enough. So take a power of two
/// of points, from the first on; the error of an average over other counts falls as `1/count` at best.
///
/// The set of choice for smooth integrands in few or many dimensions, and for scrambled replicates. Dimensions are
/// the better the earlier they come: give the first ones to what matters most. Plain points are regular to the
/// eye, and in late dimensions correlated for small counts: scramble them.
///
/// In up to [`DIMENSIONS`] dimensions. Dimensions past those asked for are independent hashed
/// coordinates, selected by the seed of the scramble.
///
/// # Indices
///
/// The generator matrices have 64 columns and digits, of which a coordinate keeps the first 53, truncated. So the
/// first 2^53 points are exact, and in each dimension distinct. Later points are exact to 53 binary digits: each
/// aligned block of 2^53 points has every coordinate once, in each dimension.
///
/// # Memory
///
/// 512 bytes for a dimension, of the next power of two of dimensions and of 32 at least: a table that is made once and
/// that all sets of the program share, with another one for all that are scrambled by [`HashedOwen`](super::HashedOwen).
/// So a set is made, cloned and scrambled in no time, unless [`LinearMatrix`](super::LinearMatrix) changes the matrices: then
/// its clones share 512 bytes for a dimension of their own.
///
/// ```
/// use estimand::points::{PointSet, Sobol};
///
/// let points = Sobol::new(3)?;
/// let mut three = [0.0; 9];
/// points.fill(1, 0..3, &mut three);
/// assert_eq!(three, [0.5, 0.5, 0.5, 0.25, 0.75, 0.75, 0.75, 0.25, 0.25]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^sobol]: Sobol', Ilya (1967). *On the distribution of points in a cube and the approximate evaluation of
///     integrals*. <https://doi.org/10.1016/0041-5553(67)90144-9>
///
/// [^joe]: Joe, Stephen; Kuo, Frances (2008). *Constructing Sobol sequences with better two-dimensional projections*.
///     <https://doi.org/10.1137/070709359>
#[derive(Clone, Debug)]
#[must_use]
pub struct Sobol<S = Plain> {
    matrices: Matrices,
    scramble: S,
}

impl Sobol {
    /// The plain points in `dimensions` dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no dimensions, or more than [`DIMENSIONS`].
    pub fn new(dimensions: u32) -> Result<Self, Error> {
        if !(1..=DIMENSIONS).contains(&dimensions) {
            let domain = if cfg!(feature = "sobol-full") {
                "1 to 21201"
            } else {
                "1 to 1024 (to 21201 with the feature `sobol-full`)"
            };
            return Err(Error::refused(
                "number of Sobol' dimensions",
                domain,
                dimensions,
            ));
        }
        Ok(Self {
            matrices: Matrices::Table(table(dimensions, DigitOrder::FirstHighest)),
            scramble: Plain,
        })
    }
}

impl Sobol {
    /// The same points, randomised by `scramble`.
    pub fn scrambled<T: BinaryScramble>(self, scramble: T) -> Sobol<T> {
        let table = table(self.dimensions(), T::ORDER);
        let mut changed = Vec::new();
        for (dimension, place) in (0..).zip(0..table.len()) {
            if let Some(matrix) = scramble.prepare(scramble.key(dimension), &table[place]) {
                if changed.is_empty() {
                    changed.extend_from_slice(table);
                }
                changed[place] = matrix;
            }
        }
        let matrices = if changed.is_empty() {
            Matrices::Table(table)
        } else {
            Matrices::Changed(changed.into())
        };
        Sobol { matrices, scramble }
    }
}

/// The generator matrix times the bits of `index`: the digits of a coordinate before they are scrambled.
#[inline]
pub(super) fn multiplied(columns: &Columns, index: u64) -> u64 {
    let mut digits = 0;
    let mut rest = index;
    while rest != 0 {
        digits ^= columns[rest.trailing_zeros() as usize % 64];
        rest &= rest - 1;
    }
    digits
}

impl<S: BinaryScramble> PointSet for Sobol<S> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let Some(columns) = self.matrices.get(dimension as usize) else {
            return Independent::past(self.scramble.seed()).coordinate(index, dimension);
        };
        let key = self.scramble.key(dimension);
        unit(self.scramble.scramble(key, multiplied(columns, index)))
    }

    fn radix(&self) -> Option<u32> {
        Some(2)
    }

    #[expect(clippy::cast_possible_truncation, reason = "21201 at most")]
    fn dimensions(&self) -> u32 {
        self.matrices.len() as u32
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(
            first,
            dimensions,
            out,
            self.dimensions(),
            self.scramble.seed(),
        );
        let inside = block.dimensions.clone();
        let start = inside.start;
        for tile in inside.clone().step_by(LANES) {
            let dimensions = tile..inside.end.min(tile + TILE);
            vectorised(
                #[inline(always)]
                || self.fill_tile(&mut block, dimensions, (tile - start) as usize),
            );
        }
    }
}

/// Coordinates that are computed side by side at most.
const LANES: usize = TILE as usize;
const TILE: u32 = 64;

/// Rows of lanes that share all but the low bits of their indices.
const STEPS: usize = 8;

/// Levels of bits above those whose changes are kept: others change once in 2^9 rows.
const LEAPS: usize = 6;

/// A word for every lane.
type Lanes = Aligned<[u64; LANES]>;

impl<S: BinaryScramble> Sobol<S> {
    /// Writes the coordinates in `dimensions`, [`LANES`] at most, into the columns of the block from `start` on.
    ///
    /// The lanes are the coordinates of `2^k` consecutive points, where that many rows lie side by side, or of one. From one
    /// row of lanes to the next their digits change by the same columns: the rows of an aligned block of [`STEPS`] have
    /// the digits of its first row, changed by what the low bits of the index add.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "remainders of a division by small numbers"
    )]
    fn fill_tile(&self, block: &mut Block<'_>, dimensions: Range<u32>, start: usize) {
        let (width, stride) = (dimensions.len(), block.width);
        let together = if width == stride {
            1 << (LANES / width).ilog2()
        } else {
            1
        };
        let lanes = together * width;
        let bits = together.trailing_zeros();
        // Single points until the first aligned one, and after the last whole row of lanes.
        let misaligned = block.first.wrapping_neg() % together as u64;
        let head = block.count().min(misaligned as usize);
        let whole = (block.count() - head) / together;
        let tail = head + whole * together;
        for row in (0..head).chain(tail..block.count()) {
            for (column, dimension) in (start..).zip(dimensions.clone()) {
                let index = block.first + row as u64;
                block.out[row * stride + column] = self.coordinate(index, dimension);
            }
        }
        if whole == 0 {
            return;
        }

        let matrices = &self.matrices[dimensions.start as usize..][..width];
        // The number of the row of lanes: its first index without the bits that tell its points apart.
        let first = (block.first + head as u64) >> bits;
        let base = (first & !(STEPS as u64 - 1)) << bits;
        let mut keys = Aligned([0; LANES]);
        let mut digits = Aligned([0; LANES]);
        for (lane, dimension) in dimensions.enumerate() {
            keys.0[lane] = self.scramble.key(dimension);
            digits.0[lane] = multiplied(&matrices[lane], base);
        }
        for bit in 0..bits {
            let (done, next) = (width << bit, width << (bit + 1));
            keys.0.copy_within(..done, done);
            digits.0.copy_within(..done, done);
            toggle(&mut digits.0[done..next], matrices, bit, 1);
        }
        let mut steps = [Aligned([0; LANES]); STEPS];
        for bit in 0..STEPS.trailing_zeros() {
            let (done, next) = steps.split_at_mut(1 << bit);
            for (done, next) in done.iter().zip(next) {
                *next = *done;
                toggle(&mut next.0[..lanes], matrices, bits + bit, 1);
            }
        }
        let lowest = bits + STEPS.trailing_zeros();
        let mut leaps = [Aligned([0; LANES]); LEAPS];
        let mut made = 0;

        let span = lanes + (stride - width) * usize::from(together == 1);
        let rows = block.out[head * stride + start..]
            .chunks_mut(span)
            .take(whole);
        for (number, row) in (first..=u64::MAX).zip(rows) {
            if number.is_multiple_of(STEPS as u64) && number > first {
                // The bits that counting up has changed, above those of the steps.
                let level = (number / STEPS as u64).trailing_zeros() as usize;
                while made <= level && made < LEAPS {
                    leaps[made] = leaps[made.saturating_sub(1)];
                    toggle(
                        &mut leaps[made].0[..lanes],
                        matrices,
                        lowest + made as u32,
                        1,
                    );
                    made += 1;
                }
                if let Some(leap) = leaps.get(level) {
                    for (digits, leap) in digits.0.iter_mut().zip(&leap.0) {
                        *digits ^= leap;
                    }
                } else {
                    toggle(&mut digits.0[..lanes], matrices, lowest, level as u32 + 1);
                }
            }
            let step = &steps[number as usize % STEPS];
            // All lanes in any case: their number is one that the compiler knows.
            if let (LANES, Some(row)) = (lanes, row.first_chunk_mut()) {
                self.write(&keys, &digits, step, row);
            } else {
                let mut all = [0.0; LANES];
                self.write(&keys, &digits, step, &mut all);
                row[..lanes].copy_from_slice(&all[..lanes]);
            }
        }
    }
}

impl<S: BinaryScramble> Sobol<S> {
    #[inline(always)]
    fn write(&self, keys: &Lanes, digits: &Lanes, step: &Lanes, row: &mut [f64; LANES]) {
        let words = step.0.iter().zip(&keys.0).zip(&digits.0);
        for (u, ((step, &key), digits)) in row.iter_mut().zip(words) {
            *u = unit(self.scramble.scramble(key, digits ^ step));
        }
    }
}

/// Changes the digits of all lanes by `count` columns from `lowest` on; there are none past the last, and no points
/// either.
#[inline(always)]
fn toggle(digits: &mut [u64], matrices: &[Columns], lowest: u32, count: u32) {
    let mut changes = [0; LANES];
    let last = u64::BITS.min(lowest + count);
    for (change, columns) in changes.iter_mut().zip(matrices) {
        for bit in lowest..last {
            *change ^= columns[bit as usize];
        }
    }
    for digits in digits.chunks_exact_mut(matrices.len()) {
        for (digits, change) in digits.iter_mut().zip(&changes) {
            *digits ^= change;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{DigitalShift, HashedOwen, LinearMatrix, Owen};

    #[test]
    fn points_agree_with_joe_and_kuo() {
        // The first ten points in three dimensions as the authors' page prints them, in Gray-code order, where
        // place k holds the point with the index k ^ (k >> 1).
        let expected = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
            [0.1875, 0.3125, 0.9375],
            [0.6875, 0.8125, 0.4375],
        ];
        let points = Sobol::new(3).unwrap();
        for (place, point) in (0_u64..).zip(expected) {
            let index = place ^ (place >> 1);
            for (dimension, coordinate) in (0..).zip(point) {
                assert_eq!(points.coordinate(index, dimension), coordinate, "{place}");
            }
        }
    }

    #[test]
    fn the_last_indices_are_in_the_cube() {
        let points = Sobol::new(DIMENSIONS).unwrap();
        for index in [u64::from(u32::MAX), 1 << 32, 1 << 53, u64::MAX] {
            for dimension in (0..DIMENSIONS).step_by(17) {
                let u = points.coordinate(index, dimension);
                assert!((0.0..1.0).contains(&u), "{index} {dimension} {u}");
            }
        }
    }

    #[test]
    fn scrambles_keep_the_strata_of_one_dimension() {
        fn check(points: &impl PointSet) {
            for dimension in 0..8 {
                let mut strata: Vec<u64> = (0..256)
                    .map(|index| {
                        (points.coordinate(index, dimension) * 256.0)
                            .floor()
                            .to_bits()
                    })
                    .collect();
                strata.sort_unstable();
                strata.dedup();
                assert_eq!(strata.len(), 256);
            }
        }
        let points = Sobol::new(8).unwrap();
        check(&points);
        check(&points.clone().scrambled(DigitalShift { seed: 3 }));
        check(&points.clone().scrambled(LinearMatrix { seed: 3 }));
        check(&points.clone().scrambled(Owen { seed: 3 }));
        check(&points.clone().scrambled(HashedOwen { seed: 3 }));
    }

    #[test]
    fn too_many_dimensions_are_refused() {
        assert!(Sobol::new(0).is_err());
        assert!(Sobol::new(DIMENSIONS).is_ok());
        let refused = Sobol::new(DIMENSIONS + 1).unwrap_err().to_string();
        assert!(refused.contains(&(DIMENSIONS + 1).to_string()), "{refused}");
    }
}
