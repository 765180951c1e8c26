//! What varies over a surface: one kind of texture a file.
//!
//! | texture | value at `(u, v)` |
//! |---|---|
//! | [`Uniform`] | the same everywhere |
//! | [`Bitmap`] | that of an image, interpolated or not, repeated, mirrored or continued |
//! | [`Checkerboard`] | one of two textures in turn |
//! | [`Attribute`] | what a mesh has there |
//! | [`Texture`] | as any of them |
//!
//! Laws of scattering take any [`Parameter`]. With [`Uniform`] ones they ask for no texture coordinates and look nothing
//! up; with [`Texture`] ones every parameter may vary.
//!
//! # Writing your own
//!
//! Implement [`Parameter`].

mod attribute;
mod bitmap;
mod checkerboard;
mod uniform;

use std::sync::Arc;

use glam::{Vec2, Vec3A};

use super::place::{Place, Spot};
use crate::Error;

pub use attribute::Attribute;
pub use bitmap::{Bitmap, Encoding, Filter, Wrap};
pub use checkerboard::Checkerboard;
pub use uniform::Uniform;

/// A parameter of a law of scattering: one value, or one that varies over the surface.
pub trait Parameter: Clone + Sync + From<Uniform> {
    /// What of a place the value depends on: `()` if it is the same everywhere.
    type Place: Place;

    /// The value as linear red, green and blue.
    fn color(&self, place: &Self::Place) -> Vec3A;

    /// The value as a number, such as a roughness or an opacity.
    fn number(&self, place: &Self::Place) -> f32;

    /// The derivatives of the number by `u` and `v`.
    fn slope(&self, place: &Self::Place) -> Vec2;

    /// The mean number, by which lobes are weighed when one of them is drawn.
    fn mean(&self) -> f32;

    /// The least and the greatest component that any place has.
    fn range(&self) -> [f32; 2];
}

/// Any of the textures of this module.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Uniform(Uniform),
    /// An image.
    Bitmap(Arc<Bitmap>),
    /// Two textures in turn.
    Checkerboard(Arc<Checkerboard>),
    /// Values of a mesh.
    Attribute(Arc<Attribute>),
}

impl From<Uniform> for Texture {
    fn from(uniform: Uniform) -> Self {
        Self::Uniform(uniform)
    }
}

impl From<Bitmap> for Texture {
    fn from(bitmap: Bitmap) -> Self {
        Self::Bitmap(Arc::new(bitmap))
    }
}

impl From<Checkerboard> for Texture {
    fn from(checkerboard: Checkerboard) -> Self {
        Self::Checkerboard(Arc::new(checkerboard))
    }
}

impl From<Attribute> for Texture {
    fn from(attribute: Attribute) -> Self {
        Self::Attribute(Arc::new(attribute))
    }
}

impl Texture {
    /// The value at the texture coordinates `uv` as linear red, green and blue.
    #[inline]
    pub fn color_at(&self, uv: Vec2) -> Vec3A {
        self.color(&Spot::new(uv))
    }

    /// The value at the texture coordinates `uv` as a number: of three components in an image the luminance, of three
    /// given ones the mean, as Mitsuba has it.
    #[inline]
    pub fn number_at(&self, uv: Vec2) -> f32 {
        self.number(&Spot::new(uv))
    }

    /// The derivatives of the number at `uv` by `u` and `v`.
    #[inline]
    pub fn slope_at(&self, uv: Vec2) -> Vec2 {
        self.slope(&Spot::new(uv))
    }
}

impl Parameter for Texture {
    type Place = Spot;

    #[inline]
    fn color(&self, place: &Spot) -> Vec3A {
        match self {
            Self::Uniform(uniform) => uniform.color(&()),
            Self::Bitmap(bitmap) => bitmap.color_at(place.uv),
            Self::Checkerboard(checkerboard) => checkerboard.color(place),
            Self::Attribute(attribute) => attribute.color_at(place.facet),
        }
    }

    #[inline]
    fn number(&self, place: &Spot) -> f32 {
        match self {
            Self::Uniform(uniform) => uniform.number(&()),
            Self::Bitmap(bitmap) => bitmap.number_at(place.uv),
            Self::Checkerboard(checkerboard) => checkerboard.number(place),
            Self::Attribute(attribute) => attribute.number_at(place.facet),
        }
    }

    /// That of an attribute of a mesh is zero: it knows no texture coordinates.
    #[inline]
    fn slope(&self, place: &Spot) -> Vec2 {
        match self {
            Self::Uniform(_) | Self::Attribute(_) => Vec2::ZERO,
            Self::Bitmap(bitmap) => bitmap.slope_at(place.uv),
            Self::Checkerboard(checkerboard) => checkerboard.slope(place),
        }
    }

    fn mean(&self) -> f32 {
        match self {
            Self::Uniform(uniform) => uniform.mean(),
            Self::Bitmap(bitmap) => bitmap.mean(),
            Self::Checkerboard(checkerboard) => checkerboard.mean(),
            Self::Attribute(attribute) => attribute.mean(),
        }
    }

    fn range(&self) -> [f32; 2] {
        match self {
            Self::Uniform(uniform) => uniform.range(),
            Self::Bitmap(bitmap) => bitmap.range(),
            Self::Checkerboard(checkerboard) => checkerboard.range(),
            Self::Attribute(attribute) => attribute.range(),
        }
    }
}

/// A parameter whose components are fractions in `[0, 1]`.
pub(in crate::path) fn fraction<P: Parameter>(name: &'static str, value: P) -> Result<P, Error> {
    let [low, high] = value.range();
    if low >= 0.0 && high <= 1.0 {
        return Ok(value);
    }
    Err(Error::refused(
        name,
        "in [0, 1] in every component",
        format_args!("from {low} to {high}"),
    ))
}

/// A parameter whose components are finite, zero or more.
pub(in crate::path) fn finite<P: Parameter>(name: &'static str, value: P) -> Result<P, Error> {
    let [low, high] = value.range();
    if low >= 0.0 && high <= f32::MAX {
        return Ok(value);
    }
    Err(Error::refused(
        name,
        "finite and not negative in every component",
        format_args!("from {low} to {high}"),
    ))
}
