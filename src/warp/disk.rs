//! The unit disk.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

use super::{Warp, coordinate};

/// The unit disk, uniform: squares around the centre become circles.[^shirley]
///
/// Areas that are compact in the square are compact in the disk.
///
/// ```
/// use estimand::warp::{Disk, Warp};
///
/// assert_eq!(Disk.sample([0.5, 0.5]), [0.0, 0.0]);
/// assert_eq!(Disk.sample([0.0, 0.5]), [-1.0, 0.0]);
/// ```
///
/// [^shirley]: Shirley, Peter; Chiu, Kenneth (1997). *A Low Distortion Map Between Disk and Square*.
///     <https://doi.org/10.1080/10867651.1997.10487479>
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disk;

impl Warp<2> for Disk {
    type Point = [f64; 2];

    #[inline]
    fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        let [a, b] = u.map(|u| 2.0 * u - 1.0);
        if a == 0.0 && b == 0.0 {
            return [0.0, 0.0];
        }
        let (radius, angle) = if a.abs() > b.abs() {
            (a, FRAC_PI_4 * (b / a))
        } else {
            (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
        };
        if angle == FRAC_PI_2 {
            // The cosine of the nearest number to pi / 2 is not zero.
            return [0.0, radius];
        }
        let (sin, cos) = angle.sin_cos();
        [radius * cos, radius * sin]
    }

    #[inline]
    fn density(&self, [x, y]: [f64; 2]) -> f64 {
        if x * x + y * y <= 1.0 { FRAC_1_PI } else { 0.0 }
    }

    fn invert(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let radius = x.hypot(y);
        if radius.is_nan() || radius > 1.0 + 1e-6 {
            return None;
        }
        let angle = y.atan2(x);
        let angle = if angle < -FRAC_PI_4 {
            angle + 2.0 * PI
        } else {
            angle
        };
        // Along the side that the point lies on, relative to the middle of the side.
        let side = |middle: f64| (angle - middle) * radius / FRAC_PI_4;
        let [a, b] = if angle < FRAC_PI_4 {
            [radius, side(0.0)]
        } else if angle < 3.0 * FRAC_PI_4 {
            [-side(FRAC_PI_2), radius]
        } else if angle < 5.0 * FRAC_PI_4 {
            [-radius, -side(PI)]
        } else {
            [side(3.0 * FRAC_PI_2), -radius]
        };
        Some([a, b].map(|a| coordinate(0.5 * (a + 1.0))))
    }
}
