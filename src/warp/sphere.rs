//! The sphere of all directions.

use core::f64::consts::TAU;

use super::{Warp, coordinate, is_unit, turn};

/// All directions, uniform in solid angle.
///
/// ```
/// use estimand::warp::{Sphere, Warp};
///
/// assert_eq!(Sphere.sample([0.0, 0.0]), [0.0, 0.0, 1.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sphere;

impl Warp<2> for Sphere {
    type Point = [f64; 3];

    #[inline]
    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let radius = 2.0 * (u * (1.0 - u)).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        [radius * cos, radius * sin, 1.0 - 2.0 * u]
    }

    #[inline]
    fn density(&self, _: [f64; 3]) -> f64 {
        0.5 / TAU
    }

    fn invert(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = direction;
        is_unit(direction).then(|| [coordinate(0.5 * (1.0 - z)), turn(y, x)])
    }
}
