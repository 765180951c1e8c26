//! Where light comes from: one kind of source a file.
//!
//! | part | coordinates per vertex |
//! |---|---|
//! | [`NoLight`] | 0 |
//! | [`AreaLights`] | 2, however many there are |
//! | [`NoEnvironment`], [`Constant`] | 0 |
//! | [`Sky`] | 2 |
//! | [`Surroundings`]: [`PointLight`], [`SpotLight`], [`DirectionalLight`] and a background | 0 to 3 |
//!
//! # Writing your own
//!
//! Implement [`Light`] for sources that are shapes of the scene, or [`Environment`] for all that are not: what is
//! around it, and points. At every vertex each of the two draws one sample.

mod area;
mod directional;
mod environment;
mod point;
mod sky;
mod spot;
mod surroundings;

use glam::Vec3A;

use super::shape::Primitive;
use super::{Segment, Shading, Surface};
use crate::{Error, Sampler};

pub use area::AreaLights;
pub use directional::DirectionalLight;
pub use environment::{Constant, Environment, NoEnvironment};
pub use point::PointLight;
pub use sky::Sky;
pub use spot::SpotLight;
pub use surroundings::{Background, Source, Surroundings};

/// All sources of light that are shapes of the scene.
pub trait Light: Sync + Sized {
    /// The lights of a scene, from its emitters.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a number of emitters that this type is not made for.
    fn new(emitters: Vec<Emitter>) -> Result<Self, Error>;

    /// The way to a point of the lights, drawn from the coordinates of `u` so as to light the surface `from` well.
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination>;

    /// What the point `surface` of an emitter that a ray from `from` has hit emits towards it, and the density with
    /// which [`sample`](Self::sample) would have drawn the point. `shading` tells more of the point where that
    /// matters.
    fn emitted(
        &self,
        emitter: u32,
        from: Vec3A,
        surface: &Surface,
        shading: impl FnOnce() -> Shading,
    ) -> Emission;
}

/// A shape that emits light from its outer side, the same radiance from every point to every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// The shape.
    pub shape: Primitive,
    /// The radiance in linear red, green and blue.
    pub radiance: Vec3A,
}

/// Light that may arrive at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// The way to where it comes from.
    pub way: Segment,
    /// The radiance that comes along it, over the density with which it was drawn. Of a source without size: what takes
    /// its place, the irradiance on a surface that faces it.
    pub weight: Vec3A,
    /// The density with which the way was drawn, per solid angle; positive. Infinite for a source without size, which
    /// no ray can hit.
    pub density: f32,
}

/// What a source does for a point that sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// The radiance emitted towards it.
    pub radiance: Vec3A,
    /// The density with which the way to it would have been drawn, per solid angle; zero if it never is.
    pub density: f32,
}

impl Emission {
    /// Nothing is emitted.
    pub const NONE: Self = Self {
        radiance: Vec3A::ZERO,
        density: 0.0,
    };
}

/// No shape emits light. Takes no memory, no time and no coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoLight;

impl Light for NoLight {
    fn new(emitters: Vec<Emitter>) -> Result<Self, Error> {
        if emitters.is_empty() {
            Ok(Self)
        } else {
            Err(Error::refused(
                "number of emitters",
                "0 in a scene without lights",
                emitters.len(),
            ))
        }
    }

    #[inline]
    fn sample<D, S: Sampler>(&self, _: &Surface<D>, _: &mut S) -> Option<Illumination> {
        None
    }

    #[inline]
    fn emitted(&self, _: u32, _: Vec3A, _: &Surface, _: impl FnOnce() -> Shading) -> Emission {
        Emission::NONE
    }
}
