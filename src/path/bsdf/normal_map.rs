//! Normals from a texture.

use glam::Vec3A;

use super::{Law, Relief, Scattered, Scattering};
use crate::Sampler;
use crate::path::frame::Frame;
use crate::path::texture::{Parameter, Uniform};

/// A law on a surface with the normals of a texture: red, green and blue of `(n + 1) / 2`, where `n` is the normal in the
/// frame of the surface, with its first axis in the direction in which `u` grows.
///
/// Draws what the law draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap<L, P = Uniform> {
    normals: P,
    relief: Relief,
    law: L,
}

impl<L, P> NormalMap<L, P> {
    /// The `law` on a surface with these normals.
    pub fn new(normals: P, law: L) -> Self {
        Self {
            normals,
            relief: Relief::default(),
            law,
        }
    }

    /// The same with another rule for normals that the surface does not really have.
    pub fn with(mut self, relief: Relief) -> Self {
        self.relief = relief;
        self
    }
}

impl<L: Law<Place = P::Place>, P: Parameter> NormalMap<L, P> {
    #[inline]
    fn frame(&self, place: &P::Place, out: Vec3A) -> Frame {
        let normal = 2.0 * self.normals.color(place) - 1.0;
        let normal = normal.try_normalize().unwrap_or(Vec3A::Z);
        self.relief.frame(normal, Vec3A::X, out)
    }
}

impl<L: Law<Place = P::Place>, P: Parameter> Law for NormalMap<L, P> {
    type Place = P::Place;

    fn is_delta(&self) -> bool {
        self.law.is_delta()
    }

    #[inline]
    fn evaluate(&self, place: &P::Place, out: Vec3A, into: Vec3A) -> Scattering {
        let frame = self.frame(place, out);
        self.relief.evaluate(&self.law, &frame, place, out, into)
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let frame = self.frame(place, out);
        self.relief.sample(&self.law, &frame, place, out, u)
    }
}
