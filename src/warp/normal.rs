//! The normal distribution.

use core::f64::consts::{PI, SQRT_2};

use super::{Warp, coordinate};
use crate::{Error, quantile};

/// Numbers with the normal distribution, by the inverse of its distribution function.
///
/// One coordinate makes one number, and neighbours stay neighbours; the methods of Box and Muller or of
/// Marsaglia have neither property. For `u = 0`, whose image would be infinite, half the smallest step of 2^-53 is taken.
///
/// ```
/// use estimand::warp::{Normal, Warp};
///
/// let normal = Normal::new(10.0, 2.0)?;
/// assert_eq!(normal.sample([0.5]), 10.0);
/// assert!((normal.sample([0.975]) - 13.919_927_969_080_1).abs() < 1e-12);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    mean: f64,
    std_dev: f64,
}

impl Normal {
    /// The distribution with this mean and standard deviation.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a mean that is not finite, and for a standard deviation outside `[1e-300, 1e300]`.
    pub fn new(mean: f64, std_dev: f64) -> Result<Self, Error> {
        if !mean.is_finite() {
            return Err(Error::refused("mean", "finite", mean));
        }
        if !(1e-300..=1e300).contains(&std_dev) {
            let domain = "in [1e-300, 1e300]";
            return Err(Error::refused("standard deviation", domain, std_dev));
        }
        Ok(Self { mean, std_dev })
    }
}

impl Warp<1> for Normal {
    type Point = f64;

    #[inline]
    fn sample(&self, [u]: [f64; 1]) -> f64 {
        self.mean + self.std_dev * quantile::normal(u.max(f64::EPSILON / 4.0))
    }

    #[inline]
    fn density(&self, x: f64) -> f64 {
        let z = (x - self.mean) / self.std_dev;
        (-0.5 * z * z).exp() / (self.std_dev * (2.0 * PI).sqrt())
    }

    fn invert(&self, x: f64) -> Option<[f64; 1]> {
        let z = (x - self.mean) / self.std_dev;
        if z.is_nan() {
            return None;
        }
        let tail = 0.5 * quantile::erfc(z.abs() / SQRT_2);
        Some([coordinate(if z < 0.0 { tail } else { 1.0 - tail })])
    }
}
