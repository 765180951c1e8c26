//! The tent.

use super::{Warp, coordinate};
use crate::Error;

/// Numbers in `[-radius, radius)` whose density falls linearly from the middle to the ends.
///
/// ```
/// use estimand::warp::{Tent, Warp};
///
/// let tent = Tent::new(2.0)?;
/// assert_eq!(tent.sample([0.5]), 0.0);
/// assert_eq!(tent.density(0.0), 0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tent {
    radius: f64,
}

impl Tent {
    /// The tent over `[-radius, radius)`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a radius outside `[1e-150, 1e150]`.
    pub fn new(radius: f64) -> Result<Self, Error> {
        if !(1e-150..=1e150).contains(&radius) {
            return Err(Error::refused("radius", "in [1e-150, 1e150]", radius));
        }
        Ok(Self { radius })
    }
}

impl Warp<1> for Tent {
    type Point = f64;

    #[inline]
    fn sample(&self, [u]: [f64; 1]) -> f64 {
        if u < 0.5 {
            self.radius * ((2.0 * u).sqrt() - 1.0)
        } else {
            self.radius * (1.0 - (2.0 * (1.0 - u)).sqrt())
        }
    }

    #[inline]
    fn density(&self, x: f64) -> f64 {
        (1.0 - (x / self.radius).abs()).max(0.0) / self.radius
    }

    fn invert(&self, x: f64) -> Option<[f64; 1]> {
        let t = x / self.radius;
        if !(-1.0..=1.0).contains(&t) {
            return None;
        }
        let tail = 0.5 * (1.0 - t.abs()) * (1.0 - t.abs());
        Some([coordinate(if t < 0.0 { tail } else { 1.0 - tail })])
    }
}
