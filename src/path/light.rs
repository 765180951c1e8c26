//! Where light comes from: one kind of source a file.
//!
//! | part | coordinates per vertex |
//! |---|---|
//! | [`NoLight`] | 0 |
//! | [`AreaLights`], [`LightTree`] | 2, however many there are |
//! | [`NoEnvironment`], [`Constant`] | 0 |
//! | [`Sky`] | 2 |
//! | [`Surroundings`]: [`PointLight`], [`SpotLight`], [`ProjectorLight`], [`DirectionalLight`] and a background | 0 to 3 |
//!
//! # Writing your own
//!
//! Implement [`Light`] for sources that are shapes of the scene, or [`Environment`] for all that are not: what is
//! around it, and points. At every vertex each of the two draws one sample.

mod area;
mod directional;
mod environment;
mod point;
mod projector;
mod sky;
mod slide;
mod spot;
mod surroundings;
mod tree;

use glam::{Affine2, Vec3A};

use super::shape::{Primitive, Shape};
use super::texture::Texture;
use super::{Segment, Surface};
use crate::{Error, Sampler};

pub use area::AreaLights;
pub use directional::DirectionalLight;
pub use environment::{Constant, Environment, NoEnvironment};
pub use point::PointLight;
pub use projector::ProjectorLight;
#[cfg(feature = "simd")]
pub(in crate::path) use sky::Seen;
pub use sky::Sky;
pub use spot::SpotLight;
#[cfg(feature = "simd")]
pub(in crate::path) use surroundings::Chosen;
pub use surroundings::{Background, Source, Surroundings};
pub use tree::LightTree;

/// All sources of light that are shapes of the scene.
pub trait Light: Sync + Sized {
    /// The lights of a scene, from its emitters.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a number of emitters that this type is not made for.
    fn new(emitters: Vec<Emitter>) -> Result<Self, Error>;

    /// The lights as [`AreaLights`], if they are that, perhaps none: where many paths are traced at once, they are drawn at once,
    /// and others are asked one by one. `None` unless implemented.
    fn as_area_lights(&self) -> Option<&AreaLights> {
        None
    }

    /// The way to a point of the lights, drawn from the coordinates of `u` so as to light the surface `from` well.
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination>;

    /// What the point `surface` of an emitter that a ray from `from` has hit emits towards it, and the density with
    /// which [`sample`](Self::sample) would have drawn the point.
    fn emitted(&self, emitter: u32, from: Vec3A, surface: &Surface) -> Emission;
}

/// A shape that emits light from its outer side, from each point the same to every direction. The outer side is that of
/// the true normals, whatever the normals that a mesh interpolates.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitter {
    /// The shape.
    pub shape: Primitive,
    /// The radiance in linear red, green and blue; of a picture the mean.
    pub radiance: Vec3A,
    /// What varies over the shape, if anything does.
    pub picture: Option<Picture>,
}

/// Radiance that varies over a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The radiance at texture coordinates.
    pub texture: Texture,
    /// From the texture coordinates of the shape to those of the picture.
    pub place: Affine2,
}

impl Emitter {
    /// The radiance that the point `surface` of the shape emits.
    #[inline]
    pub fn radiance_at(&self, surface: &Surface) -> Vec3A {
        match &self.picture {
            None => self.radiance,
            Some(Picture { texture, place }) => {
                let uv = self.shape.shading(surface).uv;
                texture.color_at(place.transform_point2(uv))
            }
        }
    }

    /// Whether it is flat and shines the same all over.
    pub(in crate::path) fn is_plain(&self) -> bool {
        self.picture.is_none() && matches!(self.shape, Primitive::Flat(_))
    }

    /// Draws its points by solid angle for what is near, where there is a closed form.
    pub(in crate::path) fn by_solid_angle(&mut self) {
        if let Primitive::Flat(flat) = &mut self.shape {
            *flat = flat.by_solid_angle();
        }
    }

    /// How much light it emits in all, up to a factor that is the same for all emitters.
    pub(in crate::path) fn power(&self) -> f64 {
        f64::from(self.shape.area()) * self.radiance.as_dvec3().element_sum()
    }
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

impl Illumination {
    /// Of a source without size the irradiance on a surface that faces it, if there is any.
    #[inline]
    fn without_size(weight: Vec3A, way: impl FnOnce() -> Option<Segment>) -> Option<Self> {
        if weight == Vec3A::ZERO {
            return None;
        }
        Some(Self {
            way: way()?,
            weight,
            density: f32::INFINITY,
        })
    }
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

    fn as_area_lights(&self) -> Option<&AreaLights> {
        static NONE: AreaLights = AreaLights::NONE;
        Some(&NONE)
    }

    #[inline]
    fn sample<D, S: Sampler>(&self, _: &Surface<D>, _: &mut S) -> Option<Illumination> {
        None
    }

    #[inline]
    fn emitted(&self, _: u32, _: Vec3A, _: &Surface) -> Emission {
        Emission::NONE
    }
}
