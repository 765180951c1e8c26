//! Lights without size that shine everywhere.

use glam::Vec3A;

use super::Illumination;
use crate::Error;
use crate::path::{Segment, Surface, color};

/// A point that shines equally in all directions. Nothing can hit it: it is met by next-event estimation alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    pub(super) position: Vec3A,
    pub(super) intensity: Vec3A,
}

impl PointLight {
    /// The point with the given `intensity`: power per solid angle, in linear red, green and blue.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a position that is not finite, and for an intensity that is negative or not finite.
    pub fn new(position: [f32; 3], intensity: [f32; 3]) -> Result<Self, Error> {
        Ok(Self {
            position: place(position)?,
            intensity: color::radiance(intensity)?,
        })
    }

    /// The light that arrives at the surface `from` if nothing is in the way; `None` if none does.
    #[inline]
    pub fn illuminate<D>(&self, from: &Surface<D>) -> Option<Illumination> {
        let way = || Segment::to_point(from, self.position);
        Illumination::without_size(self.arriving(from.point), way)
    }

    /// The irradiance that a surface at `point` would have that faces it.
    #[inline]
    pub(super) fn arriving(&self, point: Vec3A) -> Vec3A {
        from_point(point, self.position, self.intensity)
    }
}

/// A position with finite coordinates.
pub(super) fn place(position: [f32; 3]) -> Result<Vec3A, Error> {
    let place = Vec3A::from(position);
    if place.is_finite() {
        Ok(place)
    } else {
        Err(Error::refused(
            "position of a light",
            "finite",
            format_args!("{position:?}"),
        ))
    }
}

/// What arrives at a point from another one, which has the given intensity towards it.
#[inline]
pub(super) fn from_point(point: Vec3A, position: Vec3A, intensity: Vec3A) -> Vec3A {
    let squared = (position - point).length_squared();
    let weight = intensity / squared;
    // A surface at the point itself, or so near that nothing finite can be said, is not lit.
    if squared > 0.0 && weight.is_finite() {
        weight
    } else {
        Vec3A::ZERO
    }
}
