//! The camera with a lens.

use glam::{DVec3, Vec3A};

use super::Sensor;
use super::projection::{Plane, Projection};
use crate::path::Ray;
use crate::warp::{Disk, Warp};
use crate::{Error, Sampler};

/// A camera with a thin lens: what is at the distance of focus is sharp, all else blurred.
///
/// Draws two coordinates, for a point of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    origin: Vec3A,
    /// The upper left corner of the film in the plane of focus, from the origin; then the way to the upper right and to the
    /// lower left corner.
    corner: Vec3A,
    across: Vec3A,
    down: Vec3A,
    /// The radii of the lens along the first two axes of the camera.
    radii: [Vec3A; 2],
    /// The near distance over that of focus.
    near: f32,
}

impl ThinLens {
    /// The camera that a projection describes, with a lens of the given radius that is focussed at `focus_distance` along the axis.
    ///
    /// # Errors
    ///
    /// As [`Pinhole::new`](super::Pinhole::new), and for a radius or a distance that is not positive and finite.
    pub fn new(projection: &Projection, radius: f64, focus_distance: f64) -> Result<Self, Error> {
        for (name, length) in [
            ("radius of the lens", radius),
            ("distance of focus", focus_distance),
        ] {
            if !(length > 0.0 && length.is_finite()) {
                return Err(Error::refused(name, "positive and finite", length));
            }
        }
        let Plane {
            corner,
            across,
            down,
        } = projection.perspective()?;
        let axis = |axis| projection.to_world.transform_vector3(axis) * radius;
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let near = (projection.near / focus_distance) as f32;
        Ok(Self {
            origin: projection.origin().as_vec3a(),
            corner: (corner * focus_distance).as_vec3a(),
            across: (across * focus_distance).as_vec3a(),
            down: (down * focus_distance).as_vec3a(),
            radii: [DVec3::X, DVec3::Y].map(|x| axis(x).as_vec3a()),
            near,
        })
    }
}

impl Sensor for ThinLens {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn ray<S: Sampler>(&self, [x, y]: [f64; 2], u: &mut S) -> Ray {
        let [a, b] = Disk.sample(u.next_2d());
        let lens = self.radii[0] * a as f32 + self.radii[1] * b as f32;
        let focus = self.corner + self.across * x as f32 + self.down * y as f32;
        let way = focus - lens;
        Ray {
            origin: self.origin + (lens + way * self.near),
            direction: way.normalize(),
        }
    }
}
