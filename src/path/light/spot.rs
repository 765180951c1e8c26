//! Lights without size that shine into a cone.

use core::f32::consts::TAU;

use glam::{Vec2, Vec3A};

use super::Illumination;
use super::point::{from_point, place};
use super::slide::Slide;
use crate::Error;
use crate::path::frame::turns;
use crate::path::texture::Texture;
use crate::path::{Segment, Surface, color};

/// A point that shines into a cone: with full intensity near the axis, from there falling linearly with the angle.
#[derive(Clone, Debug, PartialEq)]
pub struct SpotLight {
    pub(super) position: Vec3A,
    pub(super) axis: Vec3A,
    pub(super) intensity: Vec3A,
    /// The angle, in radians, at which the light ends.
    pub(super) cutoff: f32,
    /// The cosine of the angle up to which it is full, and of that at which it ends.
    pub(super) full_cosine: f32,
    pub(super) cutoff_cosine: f32,
    /// One over the width of the transition, in radians; 0 where there is none.
    pub(super) per_radian: f32,
    pub(super) slide: Option<Slide>,
}

impl SpotLight {
    /// The light at `position` that shines along `axis` with the given `intensity`: power per solid angle, in linear
    /// red, green and blue. It is full up to `full_degrees` from the axis and ends at `cutoff_degrees`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a position that is not finite, an axis without direction, an intensity that is negative or not
    /// finite, and angles that are not `0 <= full <= cutoff <= 180`.
    pub fn new(
        position: [f32; 3],
        axis: [f32; 3],
        intensity: [f32; 3],
        full_degrees: f32,
        cutoff_degrees: f32,
    ) -> Result<Self, Error> {
        if !(0.0 <= full_degrees && full_degrees <= cutoff_degrees && cutoff_degrees <= 180.0) {
            return Err(Error::refused(
                "angles of a spot light",
                "0 <= full <= cutoff <= 180 degrees",
                format_args!("{full_degrees} and {cutoff_degrees}"),
            ));
        }
        let (full, cutoff) = (full_degrees.to_radians(), cutoff_degrees.to_radians());
        Ok(Self {
            position: place(position)?,
            axis: super::directional::direction(axis)?,
            intensity: color::radiance(intensity)?,
            cutoff,
            full_cosine: full.cos(),
            cutoff_cosine: cutoff.cos(),
            per_radian: if cutoff > full {
                (cutoff - full).recip()
            } else {
                0.0
            },
            slide: None,
        })
    }

    /// The same through a slide: times `picture`, whose texture coordinates grow along `across` and `down`. The cone touches the
    /// edges of their unit square.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for vectors without direction, for a picture that is negative or not finite, and for a cone that ends at
    /// a right angle to its axis or beyond.
    pub fn projecting(
        mut self,
        picture: Texture,
        across: [f32; 3],
        down: [f32; 3],
    ) -> Result<Self, Error> {
        let half = Vec2::splat(self.cutoff.tan());
        self.slide = Some(Slide::new(picture, self.axis, [across, down], half)?);
        Ok(self)
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
        let toward = (point - self.position).normalize_or_zero();
        let cosine = self.axis.dot(toward);
        if cosine <= self.cutoff_cosine {
            return Vec3A::ZERO;
        }
        let falloff = if cosine >= self.full_cosine {
            1.0
        } else {
            let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
            let angle = TAU * turns(sine, cosine);
            ((self.cutoff - angle) * self.per_radian).clamp(0.0, 1.0)
        };
        let mut intensity = self.intensity * falloff;
        if let Some(slide) = &self.slide {
            intensity *= slide.color(slide.place(toward));
        }
        from_point(point, self.position, intensity)
    }
}
