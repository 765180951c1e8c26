//! Kronecker's sequences.

use std::sync::Arc;

use super::{Independent, PointSet};
use crate::Error;
use crate::hash::unit;

/// Kronecker's sequence, also Weyl's: coordinate `d` is the fractional part of `index * step_d`.[^niederreiter]
///
/// One multiplication a coordinate, any count. With the steps of Roberts' R sequence, the powers of a generalised golden
/// ratio, it is hard to beat in one and two dimensions; the more dimensions, the weaker it is, and there are no elementary
/// intervals to rely on: take it for up to five or so. [`Shifted`](super::Shifted) randomises it.
///
/// The steps are fractions of 2^64, and so are the coordinates, of which the first 53 binary digits are kept: the sequence is
/// exactly that of its rational steps, without rounding, and repeats after 2^64 points. It follows the irrational steps that
/// are meant up to `index * 2^-62`. Dimensions past those asked for are independent hashed coordinates.
///
/// # Memory
///
/// 8 bytes for a dimension, shared by all clones.
///
/// ```
/// use estimand::points::{Kronecker, PointSet};
///
/// let golden = Kronecker::r(1)?;
/// assert!((golden.coordinate(1, 0) - 0.618_033_988_749_894_8).abs() < 1e-15);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^niederreiter]: Niederreiter, Harald (1992). *Random Number Generation and Quasi-Monte Carlo Methods*.
///     <https://doi.org/10.1137/1.9781611970081>
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct Kronecker {
    steps: Arc<[u64]>,
}

impl Kronecker {
    /// The sequence with these steps, of which the fractional parts count, one for each dimension.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no steps, or one that is NaN or infinite.
    pub fn new(steps: &[f64]) -> Result<Self, Error> {
        if steps.is_empty() {
            return Err(Error::refused("steps", "one for each dimension", "none"));
        }
        let fraction = |&step: &f64| {
            if !step.is_finite() {
                return Err(Error::refused("step", "finite", step));
            }
            // The fractional part of a number is a number, and so is its product with a power of two.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "in [0, 2^64]; 2^64, from a tiny negative step, saturates"
            )]
            let fraction = (step.rem_euclid(1.0) * 18_446_744_073_709_551_616.0) as u64;
            Ok(fraction)
        };
        Ok(Self {
            steps: steps.iter().map(fraction).collect::<Result<_, _>>()?,
        })
    }

    /// Roberts' R sequence: the steps are `g^-1, g^-2, .. g^-dimensions` with the root `g` of `g^(dimensions + 1) = g + 1`
    /// above 1; in one dimension that is the golden ratio.[^roberts]
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no dimensions, or more than 1024.
    ///
    /// [^roberts]: Roberts, Martin (2018). *The Unreasonable Effectiveness of Quasirandom Sequences*.
    ///     <https://extremelearning.com.au/unreasonable-effectiveness-of-quasirandom-sequences/>
    pub fn r(dimensions: u32) -> Result<Self, Error> {
        if !(1..=1024).contains(&dimensions) {
            return Err(Error::refused(
                "number of Kronecker dimensions",
                "1 to 1024",
                dimensions,
            ));
        }
        // The step y = 1 / g is the root of y^dimensions + y^(dimensions + 1) = 1 in (1/2, 1), found bit by bit.
        let too_large = |y: u64| {
            let power = power(y, dimensions);
            power.checked_add(times(power, y)).is_none()
        };
        let y = (0..64).rev().fold(0, |y, bit| {
            let trial = y | 1 << bit;
            if too_large(trial) { y } else { trial }
        });
        Ok(Self {
            // Odd steps have the whole period.
            steps: (1..=dimensions).map(|k| power(y, k) | 1).collect(),
        })
    }
}

/// The product of two fractions of 2^64, rounded down.
fn times(a: u64, b: u64) -> u64 {
    ((u128::from(a) * u128::from(b)) >> 64) as u64
}

/// The power of a fraction of 2^64, with an exponent of 1 at least.
fn power(base: u64, exponent: u32) -> u64 {
    (1..exponent).fold(base, |power, _| times(power, base))
}

impl PointSet for Kronecker {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        match self.steps.get(dimension as usize) {
            Some(step) => unit(index.wrapping_mul(*step)),
            None => Independent::past(0).coordinate(index, dimension),
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "more steps do not fit into memory"
    )]
    fn dimensions(&self) -> u32 {
        self.steps.len() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_those_of_roberts() {
        // The values on Roberts' page: golden ratio 1.61803398874989484820458683436563, plastic number
        // 1.32471795724474602596090885447809, and 1.2207440846057596 in three dimensions.
        for (dimensions, g) in [
            (1_u32, 1.618_033_988_749_895_f64),
            (2, 1.324_717_957_244_746),
            (3, 1.220_744_084_605_759_5),
        ] {
            let points = Kronecker::r(dimensions).unwrap();
            for dimension in 0..dimensions {
                let step = g.powi(-(i32::try_from(dimension).unwrap() + 1));
                assert!((points.coordinate(1, dimension) - step).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn steps_are_taken_modulo_one() {
        let points = Kronecker::new(&[0.25, -0.25, 3.5, -1e-300]).unwrap();
        let third: Vec<f64> = (0..3).map(|d| points.coordinate(3, d)).collect();
        assert_eq!(third, [0.75, 0.25, 0.5]);
        assert!(points.coordinate(1, 3) < 1.0);
        for bad in [&[][..], &[f64::NAN], &[0.5, f64::INFINITY]] {
            assert!(Kronecker::new(bad).is_err());
        }
        assert!(Kronecker::r(0).is_err() && Kronecker::r(1025).is_err());
        assert!(Kronecker::r(1024).is_ok());
    }
}
