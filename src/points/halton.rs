//! Halton's points.

use std::sync::Arc;

use super::digits::Base;
use super::scramble::{DigitScramble, Plain};
use super::{Independent, PointSet};
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
/// 32 bytes for a dimension, shared by all clones and scrambled ones.
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
            first: 0,
            scramble: Plain,
        })
    }
}

impl<S> Halton<S> {
    /// The same points, randomised by `scramble` instead.
    pub fn scrambled<T: DigitScramble>(self, scramble: T) -> Halton<T> {
        Halton {
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

    #[expect(clippy::cast_possible_truncation, reason = "at most 2^16 bases")]
    fn dimensions(&self) -> u32 {
        self.bases.len() as u32
    }
}

/// The first `count` prime numbers.
pub(super) fn primes(count: u32) -> Vec<u32> {
    // The n-th prime is below n (ln n + ln ln n) for n > 5 (Rosser and Schoenfeld 1962).
    let n = f64::from(count.max(6));
    #[expect(clippy::cast_possible_truncation, reason = "the count is small")]
    let limit = (n * (n.ln() + n.ln().ln())) as usize + 1;
    let mut composite = vec![false; limit + 1];
    let mut primes = Vec::new();
    for (number, candidate) in (2_u32..).zip(2..=limit) {
        if primes.len() == count as usize {
            break;
        }
        if !composite[candidate] {
            primes.push(number);
            for multiple in (candidate * candidate..=limit).step_by(candidate) {
                composite[multiple] = true;
            }
        }
    }
    primes
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
