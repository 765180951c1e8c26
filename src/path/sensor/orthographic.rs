//! The camera without perspective.

use glam::{DVec3, Vec3A};

use super::Sensor;
use super::projection::{Plane, Projection};
use crate::path::Ray;
use crate::{Error, Sampler};

/// A camera whose rays are parallel: things are as large far away as nearby. Draws no coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    corner: Vec3A,
    across: Vec3A,
    down: Vec3A,
    direction: Vec3A,
}

impl Orthographic {
    /// The camera that a projection describes. Its film spans from -1 to 1 across in the camera's coordinates: the matrix
    /// scales it to the size of the scene.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a matrix that cannot be inverted, and for other numbers that are not finite.
    pub fn new(projection: &Projection) -> Result<Self, Error> {
        let Plane {
            corner,
            across,
            down,
        } = projection.plane(1.0)?;
        let axis = projection.to_world.transform_vector3(DVec3::Z);
        Ok(Self {
            corner: (projection.origin() + corner + axis * (projection.near - 1.0)).as_vec3a(),
            across: across.as_vec3a(),
            down: down.as_vec3a(),
            direction: axis.normalize().as_vec3a(),
        })
    }
}

impl Sensor for Orthographic {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn ray<S: Sampler>(&self, [x, y]: [f64; 2], _: &mut S) -> Ray {
        Ray {
            origin: self.corner + self.across * x as f32 + self.down * y as f32,
            direction: self.direction,
        }
    }
}
