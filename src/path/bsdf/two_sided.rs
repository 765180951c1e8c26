//! One-sided laws on both sides.

use glam::Vec3A;

use super::law::other_side;
use super::{Law, Scattered, Scattering};
use crate::Sampler;

/// A law that knows of the outer side only, on both sides; or one law on each.
///
/// Draws what the law draws. Not for laws that let light through: their inner side is not the outer one of
/// another surface.
///
/// ```
/// use estimand::path::bsdf::{Diffuse, TwoSided};
/// use estimand::path::texture::Uniform;
///
/// let paper = TwoSided::new(Diffuse::new(Uniform::from(0.8))?);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSided<L> {
    outer: L,
    /// None where it is the same.
    inner: Option<L>,
}

impl<L> TwoSided<L> {
    /// The same law on both sides.
    pub fn new(law: L) -> Self {
        Self {
            outer: law,
            inner: None,
        }
    }

    /// One law on the outer side and another on the inner one.
    pub fn different(outer: L, inner: L) -> Self {
        Self {
            outer,
            inner: Some(inner),
        }
    }

    /// The law, if it is the same on both sides.
    #[inline]
    pub(super) fn same(&self) -> Option<&L> {
        self.inner.is_none().then_some(&self.outer)
    }

    #[inline]
    fn inner(&self) -> &L {
        self.inner.as_ref().unwrap_or(&self.outer)
    }
}

impl<L: Law> Law for TwoSided<L> {
    type Place = L::Place;

    fn is_delta(&self) -> bool {
        self.outer.is_delta() && self.inner().is_delta()
    }

    #[inline]
    fn evaluate(&self, place: &L::Place, out: Vec3A, into: Vec3A) -> Scattering {
        if out.z > 0.0 {
            return self.outer.evaluate(place, out, into);
        }
        self.inner()
            .evaluate(place, other_side(out), other_side(into))
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &L::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        if out.z > 0.0 {
            return self.outer.sample(place, out, u);
        }
        let scattered = self.inner().sample(place, other_side(out), u)?;
        Some(Scattered {
            direction: other_side(scattered.direction),
            ..scattered
        })
    }
}
