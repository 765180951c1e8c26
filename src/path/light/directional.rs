//! Lights that are infinitely far away, without size.

use glam::{DVec3, Vec3A};

use super::Illumination;
use crate::Error;
use crate::path::{Segment, Surface, color};

/// Parallel light, as of a sun without size. Nothing can hit it: it is met by next-event estimation alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    pub(super) toward: Vec3A,
    irradiance: Vec3A,
}

impl DirectionalLight {
    /// Light that travels in `direction`, with the given `irradiance` on a surface that faces it, in linear red, green and
    /// blue.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a vector without direction, and for an irradiance that is negative or not finite.
    pub fn new(direction: [f32; 3], irradiance: [f32; 3]) -> Result<Self, Error> {
        Ok(Self {
            toward: -self::direction(direction)?,
            irradiance: color::radiance(irradiance)?,
        })
    }

    /// The light that arrives at the surface `from` if nothing is in the way; `None` if none does.
    #[inline]
    pub fn illuminate<D>(&self, from: &Surface<D>) -> Option<Illumination> {
        let way = || Some(Segment::along(from, self.toward));
        Illumination::without_size(self.arriving(), way)
    }

    /// The irradiance that a surface would have that faces it.
    #[inline]
    pub(super) fn arriving(&self) -> Vec3A {
        self.irradiance
    }
}

/// The direction of a vector, with length 1.
pub(super) fn direction(vector: [f32; 3]) -> Result<Vec3A, Error> {
    DVec3::from(vector.map(f64::from))
        .try_normalize()
        .map(|direction| direction.as_vec3a())
        .ok_or_else(|| {
            Error::refused(
                "direction of a light",
                "finite and not zero",
                format_args!("{vector:?}"),
            )
        })
}
