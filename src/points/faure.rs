//! Faure's points.

use core::ops::Range;

use super::block::Block;
use super::digits::Base;
use super::halton::primes_up_to;
use super::scramble::{DigitScramble, Plain};
use super::{Independent, PointSet, fill_singly};
use crate::Error;

/// Faure's points: a digital sequence in the smallest prime base that is no less than the number of
/// dimensions.[^faure]
///
/// The first `base^m` points, and every aligned block of as many, have one point in every elementary interval of volume
/// `base^-m`, in all dimensions at once: the best such balance there is. It shows from `base^2` points or so
/// on. Use it in few dimensions, with powers of the base as counts, or for comparison; a scrambled [`Sobol`](super::Sobol) is
/// the better choice nearly everywhere else.
///
/// Dimensions past those asked for are independent hashed coordinates, selected by the seed of the scramble. Coordinates
/// are within 2^-51 of the exact fraction, relatively, for every index. A coordinate takes of the order of the squared
/// number of digits of the index; no tables are kept. In a block of points, where digits are not nested, this is done
/// once for as many points as the base has digits.
///
/// ```
/// use estimand::points::{Faure, PointSet};
///
/// let points = Faure::new(3)?;
/// assert_eq!(points.base(), 3);
/// let ninths: Vec<f64> = (0..3).map(|d| (9.0 * points.coordinate(3, d)).round()).collect();
/// assert_eq!(ninths, [1.0, 4.0, 7.0]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^faure]: Faure, Henri (1982). *Discrépance de suites associées à un système de numération (en dimension s)*.
///     <https://doi.org/10.4064/aa-41-4-337-351>
#[derive(Clone, Debug)]
#[must_use]
pub struct Faure<S = Plain> {
    base: Base,
    dimensions: u32,
    scramble: S,
}

impl Faure {
    /// The plain points in `dimensions` dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no dimensions, or more than 65536.
    pub fn new(dimensions: u32) -> Result<Self, Error> {
        if !(1..=1 << 16).contains(&dimensions) {
            return Err(Error::refused(
                "number of Faure dimensions",
                "1 to 65536",
                dimensions,
            ));
        }
        // There is a prime between a number and its double (Chebyshev).
        let base = primes_up_to(2 * dimensions)
            .find(|&prime| prime >= dimensions)
            .expect("2 is a prime up to 2, and larger numbers have one before their double");
        Ok(Self {
            base: Base::new(base),
            dimensions,
            scramble: Plain,
        })
    }
}

impl<S> Faure<S> {
    /// The base: powers of it are the counts to take.
    pub fn base(&self) -> u32 {
        self.base.base()
    }

    /// The same points, randomised by `scramble` instead.
    pub fn scrambled<T: DigitScramble>(self, scramble: T) -> Faure<T> {
        Faure {
            base: self.base,
            dimensions: self.dimensions,
            scramble,
        }
    }
}

impl<S: DigitScramble> PointSet for Faure<S> {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        if dimension >= self.dimensions {
            return Independent::past(self.scramble.seed()).coordinate(index, dimension);
        }
        let mut digits = Digits::of(index, self.base());
        digits.translate(dimension);
        let key = self.scramble.key(dimension);
        let digits = digits.places.into_iter().take(digits.count);
        self.base.fraction(&self.scramble, key, digits)
    }

    fn radix(&self) -> Option<u32> {
        Some(self.base())
    }

    fn dimensions(&self) -> u32 {
        self.dimensions
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let count = out.len().checked_div(dimensions.len()).unwrap_or(0);
        if S::NESTED || count < self.base() as usize {
            return fill_singly(self, first, dimensions, out);
        }
        let (last, seed) = (self.dimensions, self.scramble.seed());
        let block = Block::new(first, dimensions, out, last, seed);
        let columns: Vec<Column> = block
            .dimensions
            .map(|dimension| {
                let key = self.scramble.key(dimension);
                let firsts = self.base.firsts(&self.scramble, key).collect();
                Column {
                    dimension,
                    key,
                    firsts,
                }
            })
            .collect();
        // All points whose indices differ in the first digit only, after one another.
        let base = u64::from(self.base());
        let (mut index, mut out) = (first, block.out);
        while !out.is_empty() {
            let (run, digit) = (index / base, index % base);
            let left = to_place(base - digit);
            let (now, later) = out.split_at_mut(out.len().min(left * block.width));
            let digits = Digits::of(run * base, self.base());
            for (place, column) in columns.iter().enumerate() {
                self.write(
                    column,
                    digits,
                    digit,
                    now[place..].iter_mut().step_by(block.width),
                );
            }
            index = index.wrapping_add(base - digit);
            out = later;
        }
    }
}

/// What all points have in common in one dimension.
struct Column {
    dimension: u32,
    key: u64,
    /// What the possible first digits make.
    firsts: Box<[f64]>,
}

impl<S: DigitScramble> Faure<S> {
    /// Writes the coordinates of points with the same `digits` but for the first, which counts from `first` on.
    ///
    /// The first digit of the index reaches the first of the coordinate only, where it is added.
    fn write<'a>(
        &self,
        column: &Column,
        mut digits: Digits,
        first: u64,
        out: impl Iterator<Item = &'a mut f64>,
    ) {
        digits.translate(column.dimension);
        let places = digits.places.into_iter().take(digits.count).skip(1);
        let later = self.base.later(&self.scramble, column.key, places);
        let start = (digits.places[0] + first) % u64::from(self.base());
        let firsts = column.firsts.iter().cycle().skip(to_place(start));
        for (u, &first) in out.zip(firsts) {
            *u = self.base.joined(first, later);
        }
    }
}

fn to_place(digit: u64) -> usize {
    usize::try_from(digit).expect("a digit is at most the base, a u32")
}

/// The digits of an index, lowest first.
#[derive(Clone, Copy)]
struct Digits {
    base: u64,
    places: [u64; 64],
    count: usize,
}

impl Digits {
    fn of(index: u64, base: u32) -> Self {
        let mut digits = Self {
            base: base.into(),
            places: [0; 64],
            count: 0,
        };
        let mut rest = index;
        while rest != 0 {
            digits.places[digits.count] = rest % digits.base;
            digits.count += 1;
            rest /= digits.base;
        }
        digits
    }

    /// As the coefficients of a polynomial `p`, those of `x -> p(x + by)` modulo the base: this is what Pascal's
    /// matrix to the power `by` does. By repeated synthetic division.
    fn translate(&mut self, by: u32) {
        if by == 0 {
            return;
        }
        let coefficients = &mut self.places[..self.count];
        for lowest in 0..coefficients.len().saturating_sub(1) {
            for place in (lowest..coefficients.len() - 1).rev() {
                coefficients[place] =
                    (coefficients[place] + u64::from(by) * coefficients[place + 1]) % self.base;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Sobol;

    #[test]
    fn the_smallest_sufficient_prime_is_the_base() {
        for (dimensions, base) in [
            (1, 2),
            (2, 2),
            (3, 3),
            (4, 5),
            (8, 11),
            (30, 31),
            (65_536, 65_537),
        ] {
            assert_eq!(Faure::new(dimensions).unwrap().base(), base);
        }
        assert!(Faure::new(0).is_err() && Faure::new(65_537).is_err());
    }

    #[test]
    fn in_two_dimensions_the_points_are_those_of_sobol() {
        let (faure, sobol) = (Faure::new(2).unwrap(), Sobol::new(2).unwrap());
        for index in (0..300).chain([u64::from(u32::MAX), (1 << 53) - 1]) {
            for dimension in 0..2 {
                assert_eq!(
                    faure.coordinate(index, dimension),
                    sobol.coordinate(index, dimension)
                );
            }
        }
    }

    #[test]
    fn translation_is_a_power_of_pascals_matrix() {
        // (x + 2)^3 = x^3 + 6 x^2 + 12 x + 8, modulo 7.
        let mut cube = Digits::of(7_u64.pow(3), 7);
        cube.translate(2);
        assert_eq!((cube.count, &cube.places[..4]), (4, &[1, 5, 6, 1][..]));
    }
}
