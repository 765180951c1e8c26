//! The tent filter.

use super::Profile;
use crate::Error;

/// A tent: 1 at the centre, falling linearly to 0 at its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tent {
    radius: f64,
}

impl Tent {
    /// The tent that reaches `radius` pixels far.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a radius outside `(0, 64]`.
    pub fn new(radius: f64) -> Result<Self, Error> {
        if radius > 0.0 && radius <= 64.0 {
            Ok(Self { radius })
        } else {
            Err(Error::refused(
                "radius of a tent filter",
                "in (0, 64] pixels",
                radius,
            ))
        }
    }
}

impl Profile for Tent {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn value(&self, x: f64) -> f64 {
        (1.0 - x.abs() / self.radius).max(0.0)
    }
}
