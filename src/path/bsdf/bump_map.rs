//! Normals that follow a height field.

use glam::Vec3A;

use super::{Law, Relief, Scattered, Scattering};
use crate::Sampler;
use crate::path::Place;
use crate::path::frame::Frame;
use crate::path::texture::{Parameter, Uniform};

/// A law on a surface that seems displaced by a height field: its normals are those that it would have.[^blinn]
///
/// Draws what the law draws.
///
/// [^blinn]: Blinn, James (1978). *Simulation of Wrinkled Surfaces*. <https://doi.org/10.1145/800248.507101>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap<L, P = Uniform> {
    height: P,
    scale: f32,
    relief: Relief,
    law: L,
}

impl<L, P> BumpMap<L, P> {
    /// The `law` on a surface displaced by `scale` times the number of `height`, in units of the scene.
    pub fn new(height: P, scale: f32, law: L) -> Self {
        Self {
            height,
            scale,
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

impl<L: Law<Place = P::Place>, P: Parameter> BumpMap<L, P> {
    #[inline]
    fn frame(&self, place: &P::Place, out: Vec3A) -> Frame {
        let slope = self.height.slope(place) * self.scale;
        let [du, dv] = place.derivatives();
        let across = Vec3A::new(du.x, du.y, slope.x).cross(Vec3A::new(dv.x, dv.y, slope.y));
        let normal = across.try_normalize().unwrap_or(Vec3A::Z);
        let outer = 1.0_f32.copysign(normal.dot(place.outward()));
        self.relief.frame(normal * outer, du, out)
    }
}

impl<L: Law<Place = P::Place>, P: Parameter> Law for BumpMap<L, P> {
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
