//! The Gaussian filter.

use super::Profile;
use crate::Error;

/// A Gaussian, lowered so as to reach zero at four standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    std_dev: f64,
}

impl Gaussian {
    /// The Gaussian with a standard deviation of `std_dev` pixels.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a standard deviation outside `(0, 16]`.
    pub fn new(std_dev: f64) -> Result<Self, Error> {
        if std_dev > 0.0 && std_dev <= 16.0 {
            Ok(Self { std_dev })
        } else {
            Err(Error::refused(
                "standard deviation of a Gaussian filter",
                "in (0, 16] pixels",
                std_dev,
            ))
        }
    }
}

impl Profile for Gaussian {
    fn radius(&self) -> f64 {
        4.0 * self.std_dev
    }

    fn value(&self, x: f64) -> f64 {
        let x = x / self.std_dev;
        ((-0.5 * x * x).exp() - f64::exp(-8.0)).max(0.0)
    }
}
