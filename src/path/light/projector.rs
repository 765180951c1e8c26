//! Lights without size that throw a picture.

use core::f32::consts::PI;

use glam::{Vec2, Vec3A};

use super::Illumination;
use super::directional::direction;
use super::point::{from_point, place};
use super::slide::Slide;
use crate::Error;
use crate::path::texture::Texture;
use crate::path::{Segment, Surface};

/// A point that throws a picture into a pyramid: the reverse of a [`Pinhole`](crate::path::sensor::Pinhole) camera.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectorLight {
    pub(super) position: Vec3A,
    axis: Vec3A,
    scale: f32,
    slide: Slide,
}

impl ProjectorLight {
    /// The light at `position` that shines along `axis`. Where a white plane across the axis is at distance 1, its radiance is
    /// `picture` times `scale`, in linear red, green and blue: the texture coordinates grow along `across` and `down`,
    /// and the picture's half width and half height there are `half`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a position that is not finite, vectors without direction, a scale or a picture that is negative or not
    /// finite, and half sizes that are not positive and finite.
    pub fn new(
        position: [f32; 3],
        axis: [f32; 3],
        [across, down]: [[f32; 3]; 2],
        half: [f32; 2],
        picture: Texture,
        scale: f32,
    ) -> Result<Self, Error> {
        if !(0.0..=f32::MAX).contains(&scale) {
            let name = "scale of a projector";
            return Err(Error::refused(name, "finite and not negative", scale));
        }
        let axis = direction(axis)?;
        Ok(Self {
            position: place(position)?,
            axis,
            scale,
            slide: Slide::new(picture, axis, [across, down], Vec2::from(half))?,
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
        let toward = (point - self.position).normalize_or_zero();
        let cosine = self.axis.dot(toward);
        if !(cosine > 0.0) {
            return Vec3A::ZERO;
        }
        let place = self.slide.place(toward);
        let within = place.cmpge(Vec2::ZERO).all() && place.cmple(Vec2::ONE).all();
        if !within {
            return Vec3A::ZERO;
        }
        // As the pyramid widens, so the intensity falls.
        let intensity = self.slide.color(place) * (PI * self.scale / (cosine * cosine * cosine));
        from_point(point, self.position, intensity)
    }
}
