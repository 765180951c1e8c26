//! The pinhole camera.

use glam::{DVec3, Vec3A};

use super::Sensor;
use crate::path::Ray;
use crate::{Error, Sampler};

/// A pinhole camera: everything is in focus. Draws no coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    origin: Vec3A,
    /// The direction to the upper left corner of the film, at distance 1 along the axis.
    corner: Vec3A,
    /// From there to the upper right and to the lower left corner.
    across: Vec3A,
    down: Vec3A,
}

impl Pinhole {
    /// The camera at `origin` that looks at `target`, with `up` upwards in the picture, for a picture with the given
    /// `aspect`, width over height, that spans `width_degrees` across. Pictures of another aspect are stretched.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for coordinates that are not finite or do not fix an orientation, an angle outside
    /// `(0, 180)`, and an aspect that is not positive and finite.
    pub fn look_at(
        origin: [f32; 3],
        target: [f32; 3],
        up: [f32; 3],
        width_degrees: f64,
        aspect: f64,
    ) -> Result<Self, Error> {
        if !(width_degrees > 0.0 && width_degrees < 180.0) {
            return Err(Error::refused(
                "field of view",
                "in (0, 180) degrees",
                width_degrees,
            ));
        }
        if !(aspect > 0.0 && aspect.is_finite()) {
            return Err(Error::refused("aspect", "positive and finite", aspect));
        }
        let [eye, target, up] = [origin, target, up].map(|v| DVec3::from(v.map(f64::from)));
        let axis = (target - eye).normalize();
        let right = axis.cross(up).normalize();
        if !right.is_finite() {
            return Err(Error::refused(
                "view",
                "finite, with the target away from the origin and up not along the axis",
                format_args!("from {eye} to {target} with {up} up"),
            ));
        }
        let half_width = (0.5 * width_degrees).to_radians().tan();
        let across = right * (2.0 * half_width);
        let down = axis.cross(right) * (2.0 * half_width / aspect);
        Ok(Self {
            origin: Vec3A::from(origin),
            corner: (axis - 0.5 * (across + down)).as_vec3a(),
            across: across.as_vec3a(),
            down: down.as_vec3a(),
        })
    }
}

impl Sensor for Pinhole {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn ray<S: Sampler>(&self, [x, y]: [f64; 2], _: &mut S) -> Ray {
        let direction = self.corner + self.across * x as f32 + self.down * y as f32;
        Ray {
            origin: self.origin,
            direction: direction.normalize(),
        }
    }
}
