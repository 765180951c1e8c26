//! Directions near an axis.

use core::f64::consts::{PI, TAU};

use super::{Warp, coordinate, is_unit, turn};
use crate::Error;

/// Directions within an angle of the `z` axis, uniform in solid angle.
///
/// Cones as narrow as 1e-150 radians keep all their digits: nothing is computed as one minus a cosine.
///
/// ```
/// use estimand::warp::{Cone, Warp};
///
/// let sun = Cone::new(0.00465)?;
/// let direction = sun.sample([0.7, 0.2]);
/// assert!(sun.density(direction) > 10_000.0);
/// assert_eq!(sun.density([1.0, 0.0, 0.0]), 0.0);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// One minus the cosine of the angle.
    height: f64,
}

impl Cone {
    /// All directions within `angle` radians of the `z` axis.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an angle outside `[1e-150, pi]`.
    pub fn new(angle: f64) -> Result<Self, Error> {
        if !(1e-150..=PI).contains(&angle) {
            return Err(Error::refused("angle of a cone", "in [1e-150, pi]", angle));
        }
        let half = (0.5 * angle).sin();
        let height = 2.0 * half * half;
        Ok(Self { height })
    }

    /// One minus the cosine of the angle between a direction and the axis, without cancellation.
    fn depth([x, y, z]: [f64; 3]) -> f64 {
        if z > 0.0 {
            (x * x + y * y) / (1.0 + z)
        } else {
            1.0 - z
        }
    }
}

impl Warp<2> for Cone {
    type Point = [f64; 3];

    #[inline]
    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let depth = u * self.height;
        let radius = (depth * (2.0 - depth)).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        [radius * cos, radius * sin, 1.0 - depth]
    }

    #[inline]
    fn density(&self, direction: [f64; 3]) -> f64 {
        // The rim belongs to the cone, and its samples carry rounding.
        if Self::depth(direction) <= self.height * (1.0 + 1e-12) {
            1.0 / (TAU * self.height)
        } else {
            0.0
        }
    }

    fn invert(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let u = Self::depth(direction) / self.height;
        (is_unit(direction) && u <= 1.0 + 1e-6)
            .then(|| [coordinate(u), turn(direction[1], direction[0])])
    }
}
