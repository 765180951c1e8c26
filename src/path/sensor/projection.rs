//! How a film lies in front of a camera.

use glam::{DMat4, DVec3};

use crate::Error;

/// Where a camera stands, and which part of its film the picture is.
///
/// In the camera's own coordinates it looks along the third axis, the second is up in the picture, the first to its left.
///
/// ```
/// use estimand::path::sensor::{Pinhole, Projection};
/// use glam::{DMat4, DVec3};
///
/// let camera = Pinhole::new(&Projection {
///     to_world: DMat4::from_translation(DVec3::new(0.0, 1.0, -5.0)),
///     width_degrees: 60.0,
///     aspect: 16.0 / 9.0,
///     ..Projection::default()
/// })?;
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// From the camera's coordinates to those of the scene.
    pub to_world: DMat4,
    /// The angle that the whole film spans across, in `(0, 180)` degrees. An orthographic camera has none: its film
    /// spans from -1 to 1 across.
    pub width_degrees: f64,
    /// Width over height of the whole film.
    pub aspect: f64,
    /// The upper left and the lower right corner of the picture, where the whole film spans from 0 to 1.
    pub window: [[f64; 2]; 2],
    /// How far the film is moved against the axis, in widths and heights of it.
    pub principal_point_offset: [f64; 2],
    /// The distance along the axis, zero or more, before which nothing is seen.
    pub near: f64,
}

impl Default for Projection {
    /// A square film of 45 degrees at the origin.
    fn default() -> Self {
        Self {
            to_world: DMat4::IDENTITY,
            width_degrees: 45.0,
            aspect: 1.0,
            window: [[0.0; 2], [1.0; 2]],
            principal_point_offset: [0.0; 2],
            near: 0.0,
        }
    }
}

/// The picture in the plane at distance 1 along the axis, in coordinates of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// From the camera to the upper left corner.
    pub(super) corner: DVec3,
    /// From there to the upper right corner.
    pub(super) across: DVec3,
    /// From there to the lower left corner.
    pub(super) down: DVec3,
}

impl Projection {
    /// The picture, half of whose whole film spans `half_width` in the plane at distance 1.
    pub(super) fn plane(&self, half_width: f64) -> Result<Plane, Error> {
        if !(self.aspect > 0.0 && self.aspect.is_finite()) {
            return Err(Error::refused("aspect", "positive and finite", self.aspect));
        }
        self.check_near()?;
        let [low, high] = self.window;
        if !((0..2).all(|axis| low[axis] < high[axis])
            && low.iter().chain(&high).all(|x| x.is_finite()))
        {
            return Err(Error::refused(
                "window of the film",
                "finite and of some size",
                format_args!("{low:?} to {high:?}"),
            ));
        }
        self.check_placing()?;
        let extent = [half_width, half_width / self.aspect];
        let start: [f64; 2] = core::array::from_fn(|axis| {
            (1.0 - 2.0 * (low[axis] + self.principal_point_offset[axis])) * extent[axis]
        });
        let size: [f64; 2] =
            core::array::from_fn(|axis| -2.0 * (high[axis] - low[axis]) * extent[axis]);
        let vector = |x, y, z| self.to_world.transform_vector3(DVec3::new(x, y, z));
        Ok(Plane {
            corner: vector(start[0], start[1], 1.0),
            across: vector(size[0], 0.0, 0.0),
            down: vector(0.0, size[1], 0.0),
        })
    }

    /// The same by the angle that the film spans. The axes must have length 1, for distances to be those of the scene.
    pub(super) fn perspective(&self) -> Result<Plane, Error> {
        if !(self.width_degrees > 0.0 && self.width_degrees < 180.0) {
            return Err(Error::refused(
                "field of view",
                "in (0, 180) degrees",
                self.width_degrees,
            ));
        }
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let length = self.to_world.transform_vector3(axis).length();
            if !((length - 1.0).abs() < 1e-3) {
                return Err(Error::refused(
                    "placing of the camera",
                    "without scaling",
                    format_args!("an axis of length {length}"),
                ));
            }
        }
        self.plane((0.5 * self.width_degrees).to_radians().tan())
    }

    pub(super) fn check_near(&self) -> Result<(), Error> {
        if !(self.near >= 0.0 && self.near.is_finite()) {
            return Err(Error::refused(
                "near distance",
                "zero or more and finite",
                self.near,
            ));
        }
        Ok(())
    }

    pub(super) fn check_placing(&self) -> Result<(), Error> {
        let determinant = self.to_world.determinant();
        if !(self.to_world.is_finite() && determinant != 0.0 && determinant.is_finite()) {
            return Err(Error::refused(
                "placing of the camera",
                "a finite matrix that can be inverted",
                self.to_world,
            ));
        }
        Ok(())
    }

    /// The origin of the camera in the scene.
    pub(super) fn origin(&self) -> DVec3 {
        self.to_world.transform_point3(DVec3::ZERO)
    }
}
