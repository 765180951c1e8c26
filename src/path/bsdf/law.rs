//! Laws of scattering in the frame of the surface.

use glam::Vec3A;

use super::{Scattered, Scattering};
use crate::Sampler;
use crate::path::Place;

/// A law of scattering in the frame of the surface, whose third axis is the shading normal, on the outer side.
///
/// All directions have length 1 and point away from the surface, as for [`Bsdf`](super::Bsdf).
///
/// Laws of which part of the light goes to single directions and part of it everywhere are as welcome as the others:
/// [`evaluate`](Self::evaluate) leaves out the single directions, and its density is that of the other ones among all
/// that are drawn; so light that is drawn and light that is met may be weighed against one another.
pub trait Law: Sync {
    /// What of the surface the law depends on beyond the directions.
    type Place: Place;

    /// Whether light is scattered to single directions only, so that [`evaluate`](Self::evaluate) is zero and no
    /// light is worth sampling.
    fn is_delta(&self) -> bool;

    /// The value for a pair of directions, times the cosine of `into`, and the density with which
    /// [`sample`](Self::sample) draws `into`.
    fn evaluate(&self, place: &Self::Place, out: Vec3A, into: Vec3A) -> Scattering;

    /// A direction, drawn from the coordinates of `u`; `None` where nothing is scattered.
    fn sample<S: Sampler>(&self, place: &Self::Place, out: Vec3A, u: &mut S) -> Option<Scattered>;
}

/// `direction` mirrored in the plane of the surface.
#[inline]
pub(super) fn other_side(direction: Vec3A) -> Vec3A {
    Vec3A::new(direction.x, direction.y, -direction.z)
}

/// `out` mirrored in the normal of the frame.
#[inline]
pub(super) fn mirrored(out: Vec3A) -> Vec3A {
    Vec3A::new(-out.x, -out.y, out.z)
}

impl Scattered {
    /// The single direction `direction`, with the weight that the light from there has.
    #[inline]
    pub(super) fn single(direction: Vec3A, weight: Vec3A) -> Self {
        Self {
            direction,
            weight,
            density: f32::INFINITY,
            eta: 1.0,
        }
    }
}
