//! The exponential distribution.

use super::{Warp, coordinate};
use crate::Error;

/// Numbers in `[0, inf)` with the density `rate exp(-rate x)`.
///
/// The largest sample is about `36.7 / rate`: beyond lies a probability of 2^-53, less than the coordinates can
/// tell.
///
/// ```
/// use estimand::warp::{Exponential, Warp};
///
/// let decay = Exponential::new(3.0)?;
/// assert_eq!(decay.sample([0.0]), 0.0);
/// assert_eq!(decay.density(0.0), 3.0);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    rate: f64,
}

impl Exponential {
    /// The distribution with the mean `1 / rate`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a rate outside `[1e-300, 1e300]`.
    pub fn new(rate: f64) -> Result<Self, Error> {
        if !(1e-300..=1e300).contains(&rate) {
            return Err(Error::refused("rate", "in [1e-300, 1e300]", rate));
        }
        Ok(Self { rate })
    }
}

impl Warp<1> for Exponential {
    type Point = f64;

    #[inline]
    fn sample(&self, [u]: [f64; 1]) -> f64 {
        // Not -0.0 for u = 0.
        (-u).ln_1p().abs() / self.rate
    }

    #[inline]
    fn density(&self, x: f64) -> f64 {
        if x >= 0.0 {
            self.rate * (-self.rate * x).exp()
        } else {
            0.0
        }
    }

    fn invert(&self, x: f64) -> Option<[f64; 1]> {
        (x >= 0.0).then(|| [coordinate(-(-self.rate * x).exp_m1())])
    }
}
