//! Points from orthogonal arrays.

use core::ops::Range;

use super::finite::{self, CHUNK, Column, Finite};
use super::halton::primes_up_to;
use super::multi_jittered::rounded_root;
use super::permutation::Permutation;
use super::strata::{Divisor, within, write_within};
use super::{Independent, PointSet};
use crate::Error;
use crate::hash::{hash, hash_prepared, permute, prepare, unit};

/// Points from an orthogonal array of strength 2: `p^2` points with one in every cell of the `p` by `p` grid of every pair of
/// dimensions, and one in every one of the `p^2` strata of each axis.[^owen] [^tang]
///
/// The array is Bose's, for a prime `p`, in up to `p + 1` dimensions; its levels and the strata inside them are shuffled
/// by hashing, in constant memory.[^jarosz] It removes what functions of two coordinates each contribute to the variance,
/// in many dimensions, where a [`Stratified`](super::Stratified) grid cannot have enough cells and
/// [`NRooks`](super::NRooks) only reach single coordinates.
///
/// An index at or past the size belongs to another, independent set. Dimensions past those asked for are
/// independent hashed coordinates.
///
/// ```
/// use estimand::points::{OrthogonalArray, PointSet};
///
/// let points = OrthogonalArray::new(1000, 8, 1)?;
/// assert_eq!(points.size(), Some(31 * 31));
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^owen]: Owen, Art (1992). *Orthogonal Arrays for Computer Experiments, Integration and Visualization*.
///     <https://www.jstor.org/stable/24304869>
///
/// [^tang]: Tang, Boxin (1993). *Orthogonal Array-Based Latin Hypercubes*. <https://doi.org/10.1080/01621459.1993.10476423>
///
/// [^jarosz]: Jarosz, Wojciech; Enayet, Afnan; Kensler, Andrew; Kilpatrick, Charlie; Christensen, Per (2019). *Orthogonal
///     Array Sampling for Monte Carlo Rendering*. <https://doi.org/10.1111/cgf.13777>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct OrthogonalArray {
    /// The prime number of levels.
    levels: u64,
    dimensions: u32,
    seed: u64,
}

impl OrthogonalArray {
    /// The array in `dimensions` dimensions whose size is nearest to `count`, among those whose prime is no less than
    /// `dimensions - 1`; with the points that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points or more than 2^48, no dimensions or more than 65536.
    pub fn new(count: u64, dimensions: u32, seed: u64) -> Result<Self, Error> {
        if !(1..=1 << 48).contains(&count) {
            return Err(Error::refused(
                "count of points of an orthogonal array",
                "1 to 2^48",
                count,
            ));
        }
        if !(1..=1 << 16).contains(&dimensions) {
            return Err(Error::refused(
                "number of dimensions of an orthogonal array",
                "1 to 65536",
                dimensions,
            ));
        }
        let fewest = (dimensions - 1).max(2);
        // There is a prime between a number and its double (Chebyshev), so that the nearest is below the double.
        let root = u32::try_from(rounded_root(count)).unwrap_or(u32::MAX);
        let levels = primes_up_to(2 * root.max(fewest))
            .filter(|&prime| prime >= fewest)
            .map(u64::from)
            .min_by_key(|prime| (prime * prime).abs_diff(count))
            .expect("a prime lies between a number and its double");
        Ok(Self {
            levels,
            dimensions,
            seed,
        })
    }
}

impl PointSet for OrthogonalArray {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        if dimension >= self.dimensions {
            return Independent::past(self.seed).coordinate(index, dimension);
        }
        let p = self.levels;
        let count = p * p;
        let (set, index) = (index / count, index % count);
        let key = hash(hash(self.seed, set), u64::from(dimension));
        // The columns of the array are the lines a x + b over the field of p numbers, one for each x, and the
        // upright one. Points of one level are told apart by a, or on the upright line by b.
        let (a, b) = (index / p, index % p);
        let x = u64::from(dimension);
        let (level, rank) = if x < p { ((a * x + b) % p, a) } else { (a, b) };
        let level = permute(level, p, key);
        // Each level has an order of its own for its points.
        let line = Line::new(hash(key, level), p);
        let rank = (line.slope * rank + line.start) % p;
        within(level * p + rank, count, unit(hash(!key, index)))
    }

    fn size(&self) -> Option<u64> {
        Some(self.levels * self.levels)
    }

    fn dimensions(&self) -> u32 {
        self.dimensions
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        finite::fill(self, first, dimensions, out);
    }
}

impl Finite for OrthogonalArray {
    type Column = Lines;

    fn column(&self, set: u64, dimension: u32) -> Lines {
        let key = hash(hash(self.seed, set), u64::from(dimension));
        Lines {
            levels: self.levels,
            x: u64::from(dimension),
            order: Permutation::new(self.levels, key),
            ranks: prepare(key),
            offsets: prepare(!key),
        }
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}

/// A random order of the numbers below a prime: `slope * number + start`, modulo the prime.
///
/// Such lines bring any two of the numbers to all pairs of places equally often, as all orders together do; variances do not tell
/// them apart.
struct Line {
    /// Not 0.
    slope: u64,
    start: u64,
}

impl Line {
    /// The one that a well mixed word selects, for a prime below 2^32.
    #[inline(always)]
    const fn new(word: u64, prime: u64) -> Self {
        Self {
            slope: 1 + (((word >> 32) * (prime - 1)) >> 32),
            start: ((word & 0xffff_ffff) * prime) >> 32,
        }
    }
}

/// What the points of one set have in common in one dimension.
pub(super) struct Lines {
    levels: u64,
    x: u64,
    /// That of the levels.
    order: Permutation,
    ranks: u64,
    offsets: u64,
}

impl Column for Lines {
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the squared number of levels is at most 2^32"
    )]
    fn write(&self, places: &[u32; CHUNK], out: &mut [f64; CHUNK]) {
        let (levels, x) = (self.levels as u32, self.x as u32);
        let divisor = Divisor::new(self.levels);
        let mut ranks = places.map(|place| divisor.divide(place).whole);
        let mut strata = places.map(|place| divisor.divide(place).rest);
        if self.x < self.levels {
            for (level, &a) in strata.iter_mut().zip(&ranks) {
                *level = divisor.divide(a * x + *level).rest;
            }
        } else {
            core::mem::swap(&mut ranks, &mut strata);
        }
        self.order.apply(&mut strata);
        for (stratum, rank) in strata.iter_mut().zip(ranks) {
            let line = Line::new(hash_prepared(self.ranks, (*stratum).into()), self.levels);
            let rank = divisor
                .divide(line.slope as u32 * rank + line.start as u32)
                .rest;
            *stratum = *stratum * levels + rank;
        }
        write_within(
            &strata,
            self.levels * self.levels,
            self.offsets,
            places,
            out,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_prime_square_is_taken() {
        for (count, dimensions, size) in
            [(1, 1, 4), (9, 4, 9), (16, 2, 9), (40, 3, 49), (16, 8, 49)]
        {
            let points = OrthogonalArray::new(count, dimensions, 1).unwrap();
            assert_eq!(points.size(), Some(size), "{count} {dimensions}");
        }
    }

    #[test]
    fn lines_order_pairs_evenly() {
        // Over 100 000 words all ordered pairs of places must come equally often. Chi-square with n (n - 1) - 1 degrees of freedom; the
        // mean and 6 standard deviations are passed with a probability of 3e-4 at one degree of freedom, less at more, in each of 6 cases.
        const WORDS: u64 = 100_000;
        for (prime, i, j) in [
            (2, 0_u64, 1_u64),
            (3, 0, 2),
            (5, 4, 1),
            (13, 0, 1),
            (31, 30, 0),
            (61, 7, 20),
        ] {
            let mut histogram = vec![0_u32; usize::try_from(prime * prime).unwrap()];
            for word in 0..WORDS {
                let line = Line::new(hash(8, word), prime);
                let [i, j] = [i, j].map(|rank| (line.slope * rank + line.start) % prime);
                histogram[usize::try_from(i * prime + j).unwrap()] += 1;
            }
            let pairs = (prime * (prime - 1)) as f64;
            let expected = WORDS as f64 / pairs;
            let chi2: f64 = (0..prime * prime)
                .filter(|cell| cell / prime != cell % prime)
                .map(|cell| usize::try_from(cell).unwrap())
                .map(|cell| (f64::from(histogram[cell]) - expected).powi(2) / expected)
                .sum();
            let bound = pairs - 1.0 + 6.0 * (2.0 * pairs).sqrt();
            assert!(chi2 < bound, "{prime}: {chi2} >= {bound}");
        }
    }

    #[test]
    fn bad_arguments_are_refused() {
        for (count, dimensions) in [(0, 2), ((1 << 48) + 1, 2), (9, 0), (9, 65_537)] {
            assert!(OrthogonalArray::new(count, dimensions, 1).is_err());
        }
    }
}
