//! The pinhole camera.

use glam::{DMat4, DVec3, Vec3A};

use super::Sensor;
use super::projection::{Plane, Projection};
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
    near: f32,
}

impl Pinhole {
    /// The camera that a projection describes.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an angle outside `(0, 180)`, for a matrix that cannot be inverted or that scales, and for
    /// other numbers that are not finite.
    pub fn new(projection: &Projection) -> Result<Self, Error> {
        let Plane {
            corner,
            across,
            down,
        } = projection.perspective()?;
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let near = projection.near as f32;
        Ok(Self {
            origin: projection.origin().as_vec3a(),
            corner: corner.as_vec3a(),
            across: across.as_vec3a(),
            down: down.as_vec3a(),
            near,
        })
    }

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
        let [eye, target, up] = [origin, target, up].map(|v| DVec3::from(v.map(f64::from)));
        let axis = (target - eye).normalize();
        let left = up.cross(axis).normalize();
        if !left.is_finite() {
            return Err(Error::refused(
                "view",
                "finite, with the target away from the origin and up not along the axis",
                format_args!("from {eye} to {target} with {up} up"),
            ));
        }
        Self::new(&Projection {
            to_world: DMat4::from_cols(
                left.extend(0.0),
                axis.cross(left).extend(0.0),
                axis.extend(0.0),
                eye.extend(1.0),
            ),
            width_degrees,
            aspect,
            ..Projection::default()
        })
    }
}

impl Sensor for Pinhole {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn ray<S: Sampler>(&self, [x, y]: [f64; 2], _: &mut S) -> Ray {
        let direction = self.corner + self.across * x as f32 + self.down * y as f32;
        Ray {
            origin: self.origin + direction * self.near,
            direction: direction.normalize(),
        }
    }
}
