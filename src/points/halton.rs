//! Halton's points.

use core::ops::Range;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use super::block::{Aligned, Block, Rows, TOGETHER, vectorised};
use super::digits::{Base, CHUNK, CHUNKS};
use super::scramble::{DigitScramble, Plain};
use super::{Independent, PointSet, fill_singly};
use crate::Error;

/// Halton's points: the coordinate in dimension `d` is the radical inverse of the index in the base that is the prime
/// number `d`, counted from 0.[^halton]
///
/// A sequence: any count is good, any first index too. Use it when the count is not known beforehand or no power
/// of two, in few dimensions; in many its large bases need long to fill the space, and plain coordinates are
/// correlated until then, visibly from about the eighth dimension on: scramble them, with
/// [`DigitPermutation`](super::DigitPermutation) say. [`Sobol`](super::Sobol) is the better one where powers of two
/// will do.
///
/// In up to 65536 dimensions. Dimensions past those asked for are independent hashed
/// coordinates, selected by the seed of the scramble.
///
/// # Indices
///
/// Coordinates are within 2^-51 of the exact fraction, relatively, for every index; points are distinct as long as
/// the fractions are further apart than that. [`radical_inverse`](super::radical_inverse) is exact to
/// the last bit.
///
/// # Memory
///
/// 56 bytes for a dimension, shared by all clones. Blocks of points make a table of up to 8.3 KiB for each dimension whose base
/// is below 1024, which clones share; for larger bases a table lives as long as its block is filled.
///
/// ```
/// use estimand::points::{Halton, PointSet};
///
/// let points = Halton::new(2)?;
/// let coordinates = [points.coordinate(1, 0), points.coordinate(1, 1)];
/// assert_eq!(coordinates, [1.0 / 2.0, 1.0 / 3.0]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^halton]: Halton, John (1960). *On the efficiency of certain quasi-random sequences of points in evaluating
///     multi-dimensional integrals*. <https://doi.org/10.1007/BF01386213>
#[derive(Clone, Debug)]
#[must_use]
pub struct Halton<S = Plain> {
    bases: Arc<[Base]>,
    /// What the first digits make, made when a block first needs it.
    tables: Arc<[OnceLock<Box<[f64]>>]>,
    first: u64,
    scramble: S,
}

/// How many dimensions there are at most.
const DIMENSIONS: u32 = 1 << 16;

impl Halton {
    /// The plain points in `dimensions` dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no dimensions, or more than 65536.
    pub fn new(dimensions: u32) -> Result<Self, Error> {
        if !(1..=DIMENSIONS).contains(&dimensions) {
            return Err(Error::refused(
                "number of Halton dimensions",
                "1 to 65536",
                dimensions,
            ));
        }
        Ok(Self {
            bases: primes(dimensions).into_iter().map(Base::new).collect(),
            tables: (0..dimensions).map(|_| OnceLock::new()).collect(),
            first: 0,
            scramble: Plain,
        })
    }
}

impl<S> Halton<S> {
    /// The same points, randomised by `scramble` instead.
    pub fn scrambled<T: DigitScramble>(self, scramble: T) -> Halton<T> {
        Halton {
            tables: self.bases.iter().map(|_| OnceLock::new()).collect(),
            bases: self.bases,
            first: self.first,
            scramble,
        }
    }

    /// The sequence from the point `first` on: index 0 is that point. Past [`u64::MAX`] it starts again.
    pub fn starting_at(self, first: u64) -> Self {
        Self { first, ..self }
    }
}

impl<S: DigitScramble> Halton<S> {
    /// What selects the randomisation.
    pub(super) fn seed(&self) -> u64 {
        self.scramble.seed()
    }
}

impl<S: DigitScramble> PointSet for Halton<S> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let index = index.wrapping_add(self.first);
        match self.bases.get(dimension as usize) {
            Some(base) => base.inverse(&self.scramble, self.scramble.key(dimension), index),
            None => Independent::past(self.seed()).coordinate(index, dimension),
        }
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let Some(start) = self.start_of_block(first, out.len()) else {
            return fill_singly(self, first, dimensions, out);
        };
        let mut block = Block::new(start, dimensions, out, self.dimensions(), self.seed());
        let inside = block.dimensions.clone();
        self.fill_columns(&mut block, inside, 0);
    }

    #[expect(clippy::cast_possible_truncation, reason = "at most 2^16 bases")]
    fn dimensions(&self) -> u32 {
        self.bases.len() as u32
    }
}

/// Points whose coordinates are computed before they are put in their places.
const POINTS: usize = CHUNKS * CHUNK;

impl<S: DigitScramble> Halton<S> {
    /// The index that the point `first` of a block of `length` coordinates has in the whole sequence, if blocks are worth it.
    pub(super) fn start_of_block(&self, first: u64, length: usize) -> Option<u64> {
        let start = self.first.checked_add(first)?;
        // A wrapped index would break the runs of indices.
        let contiguous = start.checked_add(length as u64).is_some();
        (contiguous && !S::NESTED).then_some(start)
    }

    /// Writes the coordinates in `dimensions` into the columns of the block from `start` on.
    pub(super) fn fill_columns(&self, block: &mut Block<'_>, dimensions: Range<u32>, start: usize) {
        let end = dimensions.end;
        for (tile, start) in dimensions
            .step_by(TOGETHER)
            .zip((start..).step_by(TOGETHER))
        {
            let count = TOGETHER.min((end - tile) as usize);
            vectorised(
                #[inline(always)]
                || self.fill_tile(block, tile, start..start + count),
            );
        }
    }

    /// The table of what the first digits make in one dimension, if there is one or `count` points are worth one. Tables of
    /// large bases are not kept.
    fn table(&self, dimension: usize, key: u64, count: usize) -> Option<Cow<'_, [f64]>> {
        /// The most entries of a table that is kept.
        const KEPT: usize = 1024;
        let (base, table) = (&self.bases[dimension], &self.tables[dimension]);
        let make = || base.table(&self.scramble, key);
        if let Some(table) = table.get() {
            Some(Cow::Borrowed(table))
        } else if base.power() > 2 * count {
            None
        } else if base.power() > KEPT {
            Some(Cow::Owned(make()))
        } else {
            Some(Cow::Borrowed(table.get_or_init(|| make().into())))
        }
    }

    /// Writes the coordinates in the dimensions from `dimension` on into `columns` of the block, [`TOGETHER`] at most.
    #[inline(always)]
    fn fill_tile(&self, block: &mut Block<'_>, dimension: u32, columns: Range<usize>) {
        let count = block.count();
        let mut room = Aligned([[[0.0; CHUNK]; CHUNKS]; TOGETHER]);
        let mut side_by_side = Rows::new();
        let mut keys = [0; TOGETHER];
        let mut tables = [const { None }; TOGETHER];
        let places = dimension as usize..dimension as usize + columns.len();
        for (lane, (place, dimension)) in places.clone().zip(dimension..).enumerate() {
            keys[lane] = self.scramble.key(dimension);
            tables[lane] = self.table(place, keys[lane], count);
        }
        let mut index = block.first;
        for out in block.out.chunks_mut(POINTS * block.width) {
            let points = out.len() / block.width;
            for (lane, place) in places.clone().enumerate() {
                let (base, key) = (&self.bases[place], keys[lane]);
                let column = &mut room.0[lane];
                if let Some(table) = &tables[lane] {
                    base.inverses(&self.scramble, key, table, index, points, column);
                } else {
                    for (place, u) in (0..).zip(&mut column.as_flattened_mut()[..points]) {
                        *u = base.inverse(&self.scramble, key, index.wrapping_add(place));
                    }
                }
            }
            let mut rows = out.chunks_exact_mut(block.width);
            for chunk in 0..points.div_ceil(CHUNK) {
                let coordinates = room.0.each_ref().map(|column| &column[chunk]);
                side_by_side.write(coordinates, 0, rows.by_ref().take(CHUNK), columns.clone());
            }
            index += points as u64;
        }
    }
}

/// The first `count` prime numbers.
fn primes(count: u32) -> Vec<u32> {
    // The n-th prime is below n (ln n + ln ln n) for n > 5 (Rosser and Schoenfeld 1962).
    let n = f64::from(count.max(6));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number below 2^20"
    )]
    let limit = (n * (n.ln() + n.ln().ln())) as u32 + 1;
    primes_up_to(limit).take(count as usize).collect()
}

/// The prime numbers up to `limit`, in order, by the sieve of Eratosthenes.
pub(super) fn primes_up_to(limit: u32) -> impl Iterator<Item = u32> {
    let length = limit as usize + 1;
    let mut composite = vec![false; length];
    (2..=limit).zip(2..).filter_map(move |(number, place)| {
        if composite[place] {
            return None;
        }
        let multiples = (place * place..length).step_by(place);
        multiples.for_each(|multiple| composite[multiple] = true);
        Some(number)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{DigitPermutation, DigitalShift, Owen, radical_inverse};

    #[test]
    fn primes_are_the_primes() {
        assert_eq!(primes(10), [2, 3, 5, 7, 11, 13, 17, 19, 23, 29]);
        // The primes number 1000, 1024 and 10000 (OEIS A000040).
        let many = primes(10_000);
        assert_eq!((many[999], many[1023], many[9999]), (7919, 8161, 104_729));
        assert_eq!(primes(DIMENSIONS).len(), 1 << 16);
    }

    #[test]
    fn plain_points_are_radical_inverses() {
        let points = Halton::new(1024).unwrap();
        let bases = primes(1024);
        for index in (0..3000).chain([u64::from(u32::MAX), 1 << 32, 1 << 53, u64::MAX]) {
            for dimension in (0..40).chain((40..1024).step_by(41)) {
                let exact = radical_inverse(bases[dimension as usize], index);
                let u = points.coordinate(index, dimension);
                assert!((0.0..1.0).contains(&u));
                assert!(
                    (u - exact).abs() <= 2.0 * f64::EPSILON * exact,
                    "{index} {dimension}"
                );
            }
        }
    }

    #[test]
    fn any_first_index() {
        let points = Halton::new(3).unwrap();
        let later = points.clone().starting_at(1000);
        for dimension in 0..5 {
            assert_eq!(
                later.coordinate(7, dimension),
                points.coordinate(1007, dimension)
            );
        }
    }

    #[test]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the numbers of strata are small"
    )]
    fn scrambles_keep_the_strata_of_one_dimension() {
        fn check(points: &impl PointSet) {
            for (dimension, base) in (0..12).zip(primes(12)) {
                for strata in [base, base * base] {
                    let mut seen: Vec<u64> = (0..strata)
                        .map(|index| points.coordinate(index.into(), dimension))
                        .map(|u| (u * f64::from(strata)).floor() as u64)
                        .collect();
                    seen.sort_unstable();
                    assert!(seen.into_iter().eq(0..u64::from(strata)), "{base}");
                }
            }
        }
        let points = Halton::new(12).unwrap();
        check(&points.clone().scrambled(DigitalShift { seed: 3 }));
        check(&points.clone().scrambled(DigitPermutation { seed: 3 }));
        check(&points.clone().scrambled(Owen { seed: 3 }));
    }

    #[test]
    fn too_many_dimensions_are_refused() {
        assert!(Halton::new(0).is_err());
        assert!(Halton::new(65_537).is_err());
    }
}
