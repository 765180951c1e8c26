//! Surfaces with holes.

use glam::Vec3A;

use super::{Law, Scattered, Scattering};
use crate::Sampler;
use crate::path::frame::single;
use crate::path::texture::{Parameter, Uniform};

/// A law of which only a fraction is there: the rest of the light goes straight on.
///
/// One coordinate chooses between the two, then the law draws. The opacity is clamped to `[0, 1]`. As with
/// [`Null`](super::Null), light that is drawn behind the surface is hidden by it, and is found by the ray that goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mask<L, P = Uniform> {
    opacity: P,
    law: L,
}

impl<L, P> Mask<L, P> {
    /// The fraction `opacity` of `law`.
    pub fn new(opacity: P, law: L) -> Self {
        Self { opacity, law }
    }
}

impl<L: Law<Place = P::Place>, P: Parameter> Law for Mask<L, P> {
    type Place = P::Place;

    fn is_delta(&self) -> bool {
        self.law.is_delta()
    }

    #[inline]
    fn evaluate(&self, place: &P::Place, out: Vec3A, into: Vec3A) -> Scattering {
        let opacity = self.opacity.number(place).clamp(0.0, 1.0);
        let Scattering { value, density } = self.law.evaluate(place, out, into);
        Scattering {
            value: value * opacity,
            density: density * opacity,
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let opacity = self.opacity.number(place).clamp(0.0, 1.0);
        if single(u.next_1d()) >= opacity {
            return Some(Scattered::single(-out, Vec3A::ONE));
        }
        let scattered = self.law.sample(place, out, u)?;
        Some(Scattered {
            density: scattered.density * opacity,
            ..scattered
        })
    }
}
