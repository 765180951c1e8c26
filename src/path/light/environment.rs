//! What is around a scene.

use glam::Vec3A;

use crate::Error;
use crate::path::color;

/// The light that comes from outside, along the rays that leave the scene.
///
/// It is met by the directions that surfaces draw. For a constant one nothing does better: the light that a
/// diffuse surface receives is then drawn in proportion to what it is worth, but for shadows.
pub trait Environment: Sync {
    /// The radiance seen in `direction`, of length 1.
    fn radiance(&self, direction: Vec3A) -> Vec3A;
}

/// Nothing is around the scene. Takes no memory, no time and no coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoEnvironment;

impl Environment for NoEnvironment {
    #[inline]
    fn radiance(&self, _: Vec3A) -> Vec3A {
        Vec3A::ZERO
    }
}

/// The same radiance from every direction. Draws no coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    radiance: Vec3A,
}

impl Constant {
    /// The environment with the given radiance in linear red, green and blue.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component that is negative or not finite.
    pub fn new(radiance: [f32; 3]) -> Result<Self, Error> {
        Ok(Self {
            radiance: color::radiance(radiance)?,
        })
    }
}

impl Environment for Constant {
    #[inline]
    fn radiance(&self, _: Vec3A) -> Vec3A {
        self.radiance
    }
}
