//! What is around a scene.

use glam::Vec3A;

use super::{Emission, Illumination, Sky, Surroundings};
use crate::path::{Surface, color};
use crate::{Error, Sampler};

/// The light that no shape of the scene emits: what comes from outside, along the rays that leave the scene, and from
/// points.
pub trait Environment: Sync {
    /// The radiance seen in `direction`, of length 1, and the density with which [`sample`](Self::sample) draws that
    /// direction.
    fn emitted(&self, direction: Vec3A) -> Emission;

    /// The radiance, if it is the same from everywhere and [`sample`](Self::sample) draws nothing: where many paths are traced at
    /// once, it is known to all, and other environments are asked one by one. `None` unless implemented.
    fn constant(&self) -> Option<Vec3A> {
        None
    }

    /// The picture of a sky, if [`emitted`](Self::emitted) and [`sample`](Self::sample) are those of that sky in every
    /// respect: where many paths are traced at once, the sky is asked for all of them. `None` unless implemented.
    fn as_sky(&self) -> Option<&Sky> {
        None
    }

    /// The environment as [`Surroundings`], if [`emitted`](Self::emitted) and [`sample`](Self::sample) are theirs in every
    /// respect: where many paths are traced at once, up to 16 sources without pictures are seen from all of them at once, unless a sky is behind
    /// them. `None` unless implemented.
    fn as_surroundings(&self) -> Option<&Surroundings> {
        None
    }

    /// A way to the light, drawn from the coordinates of `u` so as to light the surface `from` well. Draws nothing, and
    /// no coordinate, unless it is implemented: the light is then met by the directions that surfaces draw.
    #[inline]
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination> {
        let _ = (from, u);
        None
    }
}

/// Nothing is around the scene. Takes no memory, no time and no coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoEnvironment;

impl Environment for NoEnvironment {
    fn constant(&self) -> Option<Vec3A> {
        Some(Vec3A::ZERO)
    }

    #[inline]
    fn emitted(&self, _: Vec3A) -> Emission {
        Emission::NONE
    }
}

/// The same radiance from every direction. Draws no coordinate: the directions that a surface draws meet it, and nothing
/// does better. The light that a diffuse surface receives is then drawn in proportion to what it is worth, but for
/// shadows.
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
    fn constant(&self) -> Option<Vec3A> {
        Some(self.radiance)
    }

    #[inline]
    fn emitted(&self, _: Vec3A) -> Emission {
        Emission {
            radiance: self.radiance,
            density: 0.0,
        }
    }
}
