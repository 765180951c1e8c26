//! What is rendered.

#[cfg(feature = "mitsuba")]
mod choosing;
mod nearby;
mod parts;
mod surfaces;

#[cfg(feature = "simd")]
use glam::Vec3A;

use super::bsdf::{Bsdf, Material};
use super::geometry::{Geometry, Hit};
#[cfg(feature = "simd")]
use super::light::Emission;
use super::light::{AreaLights, Environment, Light, NoEnvironment};
use super::object::{Instances, Object};
#[cfg(feature = "simd")]
use super::packet::{Emitted, FlatLight, Law, Optics, Packet};
use super::ray::{Ray, Surface};
use super::segment::{End, Segment};
use super::sensor::FarPlane;
use super::{Detail, Shading};
use crate::Error;

#[cfg(feature = "simd")]
use parts::DARK;
use parts::Owner;
pub(crate) use surfaces::Surfaces;

/// A scene: shapes, how they scatter light (`B`), which of them emit it (`L`) and what is around them (`E`).
///
/// A part that a scene lacks is a type without content, [`NoLight`](super::light::NoLight) or [`NoEnvironment`]; a scene
/// of one law of scattering names it. What the type does not name costs no code, no memory and no coordinate.
///
/// ```
/// use estimand::path::bsdf::Lambertian;
/// use estimand::path::light::{Constant, NoLight};
/// use estimand::path::shape::Sphere;
/// use estimand::path::{Object, Scene};
///
/// let ball = Object::new([Sphere::new([0.0; 3], 1.0)?], Lambertian::new([0.5; 3])?);
/// let scene: Scene<Lambertian, NoLight, _> = Scene::new(vec![ball], Constant::new([1.0; 3])?)?;
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Debug)]
pub struct Scene<B = Material, L = AreaLights, E = NoEnvironment> {
    geometry: Geometry,
    /// Of each shape.
    owners: Vec<Owner>,
    bsdfs: Vec<B>,
    lights: L,
    environment: E,
    #[cfg(feature = "simd")]
    packet: Option<Box<Packet>>,
}

/// The point of a scene that a ray has met.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<'a, B: Bsdf> {
    /// The point of the surface, with what its law of scattering needs to know.
    pub surface: Surface<B::Detail>,
    /// How light is scattered there.
    pub bsdf: &'a B,
    /// Which emitter it belongs to, if any.
    pub emitter: Option<u32>,
    geometry: &'a Geometry,
    hit: Hit,
}

impl<B: Bsdf> Vertex<'_, B> {
    /// The parametrisation of the surface, whether its law of scattering needs it or not.
    #[inline]
    pub fn shading(&self) -> Shading {
        self.geometry.shading(&self.hit)
    }

    /// The point of the surface alone.
    #[inline]
    pub fn place(&self) -> &Surface {
        &self.hit.surface
    }
}

impl<B: Bsdf, L: Light, E: Environment> Scene<B, L, E> {
    /// The scene of some objects in an environment.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the lights are of a type for more or fewer of them, for 2^32 shapes or more, and where `f32`
    /// does not tell points apart: see the limits of [`path`](super).
    pub fn new(objects: Vec<Object<B>>, environment: E) -> Result<Self, Error> {
        Self::with_instances(objects, Vec::new(), environment)
    }

    /// The same with instances: objects that are stored once and stand in many places.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); for instances that emit light; and for places that cannot be inverted.
    pub fn with_instances(
        objects: Vec<Object<B>>,
        instances: Vec<Instances<B>>,
        environment: E,
    ) -> Result<Self, Error> {
        Surfaces::new(objects, instances)?.scene(environment)
    }

    /// The scene for many paths at once, if it is one of those.
    #[cfg(feature = "simd")]
    fn packed(&self) -> Option<Packet> {
        let around = match self.environment.as_sky() {
            Some(_) => Some(Vec3A::ZERO),
            None => self.environment.constant().or_else(|| {
                let surroundings = self.environment.as_surroundings()?;
                surroundings.around_in_lanes()
            }),
        };
        let lights = self.lights.as_area_lights();
        let shapes = self.geometry.shapes().len();
        let optics = |part: usize| {
            let owner = self.owners[part];
            let emitted = match (owner.emitter, lights) {
                (DARK, _) => Emitted::Nothing,
                (emitter, Some(lights)) if part < shapes && lights.is_plain(emitter) => {
                    Emitted::Flat(FlatLight {
                        emitter,
                        radiance: lights.radiance(emitter),
                        probability: lights.probability(emitter),
                    })
                }
                _ => Emitted::Asked,
            };
            Optics {
                law: Law::of(&self.bsdfs[owner.bsdf as usize]),
                emitted,
            }
        };
        let smooth = !B::Detail::is_nothing();
        let parts = self.owners.len();
        Packet::new(&self.geometry, parts, optics, lights, around, smooth)
    }

    /// What a point of a light emits towards another point.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn emitted(&self, at: &Hit, from: Vec3A) -> Emission {
        match self.owners[at.part].emitter(at.triangle) {
            Some(emitter) => self.lights.emitted(emitter, from, &at.surface),
            None => Emission::NONE,
        }
    }
}

impl<B: Bsdf, L, E> Scene<B, L, E> {
    /// Where the ray first meets a surface.
    #[inline]
    pub fn meet(&self, ray: &Ray) -> Option<Vertex<'_, B>> {
        Some(self.vertex(self.geometry.nearest(ray)?))
    }

    /// The point of the scene that a hit is.
    #[inline]
    pub(in crate::path) fn vertex(&self, hit: Hit) -> Vertex<'_, B> {
        let owner = self.owners[hit.part];
        let detail = Detail::from_shading(|| self.geometry.shading(&hit));
        Vertex {
            surface: hit.surface.with(detail),
            bsdf: &self.bsdfs[owner.bsdf as usize],
            emitter: owner.emitter(hit.triangle),
            geometry: &self.geometry,
            hit,
        }
    }
}

impl<B: Bsdf, L, E> Scene<B, L, E> {
    /// The same ray from behind the shapes that emit light which it meets first.
    pub(in crate::path) fn past_lights(&self, mut ray: Ray) -> Ray {
        while let Some(vertex) = self.meet(&ray)
            && vertex.emitter.is_some()
        {
            ray.origin = vertex.surface.leave(ray.direction);
        }
        ray
    }
}

impl<B, L, E> Scene<B, L, E> {
    /// The same ray from behind all shapes, if what it meets first is beyond the plane: then all else is too.
    pub(in crate::path) fn past_far(&self, mut ray: Ray, far: &FarPlane) -> Ray {
        if let Some(hit) = self.geometry.nearest(&ray)
            && far.hides(hit.surface.point)
        {
            let [low, high] = self.geometry.bounds();
            // Far out of the ball around their box, whatever rounding does.
            let past = 2.0 * (0.5 * (low + high) - ray.origin).length() + (high - low).length();
            ray.origin += ray.direction * past;
        }
        ray
    }

    /// The shapes that emit light.
    #[inline]
    pub fn lights(&self) -> &L {
        &self.lights
    }

    /// The scene for many paths at once, if it is one of those.
    #[cfg(feature = "simd")]
    #[inline]
    pub(in crate::path) fn packet(&self) -> Option<&Packet> {
        self.packet.as_deref()
    }

    /// All shapes.
    #[cfg(feature = "simd")]
    #[inline]
    pub(in crate::path) fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// What is around the shapes.
    #[inline]
    pub fn environment(&self) -> &E {
        &self.environment
    }

    /// Whether any shape is in the way.
    #[inline]
    pub fn occluded(&self, segment: &Segment) -> bool {
        match segment.end() {
            End::Surface => self.geometry.divided(&segment.ray, segment.length),
            End::Open => self.geometry.occluded(&segment.ray, segment.length),
        }
    }
}
