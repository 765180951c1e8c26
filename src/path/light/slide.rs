//! Pictures that a point throws.

use glam::{Vec2, Vec3A};

use super::directional::direction;
use crate::Error;
use crate::path::texture::{self, Texture};

/// A picture across the axis of a light, thrown from a point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slide {
    picture: Texture,
    /// Where the light shines, and where the picture's first and second texture coordinate grow.
    axis: Vec3A,
    across: Vec3A,
    down: Vec3A,
    /// Half the width and half the height of the unit square of texture coordinates, at distance 1 along the axis.
    half: Vec2,
}

impl Slide {
    /// The picture whose texture coordinates grow along `across` and `down`.
    pub(super) fn new(
        picture: Texture,
        axis: Vec3A,
        [across, down]: [[f32; 3]; 2],
        half: Vec2,
    ) -> Result<Self, Error> {
        if !(half.min_element() > 0.0 && half.is_finite()) {
            return Err(Error::refused(
                "half size of a slide",
                "positive and finite",
                half,
            ));
        }
        Ok(Self {
            picture: texture::finite("picture", picture)?,
            axis,
            across: direction(across)?,
            down: direction(down)?,
            half,
        })
    }

    /// The texture coordinates in a direction that is not across the axis; within the unit square on the slide.
    #[inline]
    pub(super) fn place(&self, toward: Vec3A) -> Vec2 {
        let plane = Vec2::new(toward.dot(self.across), toward.dot(self.down));
        plane / (self.half * (2.0 * toward.dot(self.axis))) + Vec2::splat(0.5)
    }

    #[inline]
    pub(super) fn color(&self, place: Vec2) -> Vec3A {
        self.picture.color_at(place)
    }
}
