//! Surfaces that are none.

use glam::Vec3A;

use super::{Law, Scattered, Scattering};
use crate::Sampler;

/// Nothing happens to the light: it goes straight on.
///
/// Draws no coordinates. It still is a surface: light that is drawn behind it is hidden by it, and is found by
/// the ray that goes on; and the way through it is one more segment of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Null;

impl Law for Null {
    type Place = ();

    #[inline]
    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn evaluate(&self, (): &(), _: Vec3A, _: Vec3A) -> Scattering {
        Scattering::NONE
    }

    #[inline]
    fn sample<S: Sampler>(&self, (): &(), out: Vec3A, _: &mut S) -> Option<Scattered> {
        Some(Scattered::single(-out, Vec3A::ONE))
    }
}
