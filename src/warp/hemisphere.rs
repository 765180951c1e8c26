//! The hemisphere of directions with `z >= 0`.

use core::f64::consts::{FRAC_1_PI, TAU};

use super::{Disk, Warp, coordinate, is_unit, turn};

/// Directions of the hemisphere with `z >= 0`, uniform in solid angle.
///
/// ```
/// use estimand::warp::{Hemisphere, Warp};
///
/// assert_eq!(Hemisphere.density([0.0, 0.0, 1.0]), 0.5 / std::f64::consts::PI);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hemisphere;

impl Warp<2> for Hemisphere {
    type Point = [f64; 3];

    #[inline]
    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let radius = ((1.0 - u) * (1.0 + u)).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        [radius * cos, radius * sin, u]
    }

    #[inline]
    fn density(&self, direction: [f64; 3]) -> f64 {
        if direction[2] >= 0.0 { 1.0 / TAU } else { 0.0 }
    }

    fn invert(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = direction;
        (is_unit(direction) && z >= 0.0).then(|| [coordinate(z), turn(y, x)])
    }
}

/// Directions of the hemisphere with `z >= 0`, with the density `z / pi` per solid angle: what a surface receives.
///
/// The density is zero on the rim, where samples may land in the rounding of the last digit.
///
/// ```
/// use estimand::warp::{CosineHemisphere, Warp};
///
/// assert_eq!(CosineHemisphere.sample([0.5, 0.5]), [0.0, 0.0, 1.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CosineHemisphere;

impl Warp<2> for CosineHemisphere {
    type Point = [f64; 3];

    #[inline]
    fn sample(&self, u: [f64; 2]) -> [f64; 3] {
        let [x, y] = Disk.sample(u);
        [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
    }

    #[inline]
    fn density(&self, direction: [f64; 3]) -> f64 {
        direction[2].max(0.0) * FRAC_1_PI
    }

    fn invert(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = direction;
        if !is_unit(direction) || z < 0.0 {
            return None;
        }
        Disk.invert([x, y])
    }
}
