//! Where light comes from: one kind of source a file.
//!
//! | part | coordinates per vertex |
//! |---|---|
//! | [`NoLight`] | 0 |
//! | [`AreaLights`] | 2, however many there are |
//! | [`NoEnvironment`], [`Constant`] | 0 |
//!
//! # Writing your own
//!
//! Implement [`Light`] for sources that are shapes of the scene, or [`Environment`] for what is around it.

mod area;
mod environment;

use glam::Vec3A;

use super::Surface;
use super::shape::Primitive;
use crate::{Error, Sampler};

pub use area::AreaLights;
pub use environment::{Constant, Environment, NoEnvironment};

/// All sources of light that are shapes of the scene.
pub trait Light: Sync + Sized {
    /// The lights of a scene, from its emitters.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a number of emitters that this type is not made for.
    fn new(emitters: Vec<Emitter>) -> Result<Self, Error>;

    /// A point of the lights, drawn from the coordinates of `u` so as to light the point `from` well.
    fn sample<S: Sampler>(&self, from: Vec3A, u: &mut S) -> Option<Illumination>;

    /// What the point of an emitter that a ray from `from` has hit emits towards it, and the density with which
    /// [`sample`](Self::sample) would have drawn the point.
    fn emitted(&self, emitter: u32, from: Vec3A, surface: &Surface) -> Emission;
}

/// A shape that emits light from its outer side, the same radiance from every point to every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// The shape.
    pub shape: Primitive,
    /// The radiance in linear red, green and blue.
    pub radiance: Vec3A,
}

/// A point of a light that may be seen from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// The point.
    pub surface: Surface,
    /// The radiance that it emits towards the other.
    pub radiance: Vec3A,
    /// The density with which it was drawn, per solid angle seen from the other; positive.
    pub density: f32,
}

/// What a point of an emitter does for another that sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// The radiance emitted towards it.
    pub radiance: Vec3A,
    /// The density with which the point would have been drawn, per solid angle seen from the other.
    pub density: f32,
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
    fn sample<S: Sampler>(&self, _: Vec3A, _: &mut S) -> Option<Illumination> {
        None
    }

    #[inline]
    fn emitted(&self, _: u32, _: Vec3A, _: &Surface) -> Emission {
        Emission {
            radiance: Vec3A::ZERO,
            density: 0.0,
        }
    }
}
