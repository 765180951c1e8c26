//! Panes of a transparent medium.

use glam::Vec3A;

use super::law::mirrored;
use super::{Law, Scattered, Scattering, Tint, fresnel};
use crate::path::frame::single;
use crate::path::texture::{Parameter, Uniform};
use crate::{Error, Sampler};

/// A pane of a transparent medium, so thin that light leaves it where it came in: it is mirrored, or goes straight
/// on. What is reflected to and fro inside is part of both.
///
/// One coordinate chooses between the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<P = Uniform> {
    eta: f32,
    tint: Tint<P>,
}

impl ThinDielectric {
    /// The pane with the index of refraction `inside`, on both sides of which it is `outside`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as for [`Dielectric::new`](super::Dielectric::new).
    pub fn new(inside: f32, outside: f32) -> Result<Self, Error> {
        Ok(Self {
            eta: fresnel::quotient(inside, outside)?,
            tint: Tint::default(),
        })
    }
}

impl<P: Parameter> ThinDielectric<P> {
    /// The same, with some of the light left out.
    pub fn tinted<Q: Parameter>(self, tint: Tint<Q>) -> ThinDielectric<Q> {
        ThinDielectric {
            eta: self.eta,
            tint,
        }
    }
}

impl<P: Parameter> Law for ThinDielectric<P> {
    type Place = P::Place;

    #[inline]
    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn evaluate(&self, _: &P::Place, _: Vec3A, _: Vec3A) -> Scattering {
        Scattering::NONE
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let once = fresnel::refraction(out.z.abs(), self.eta).reflected;
        // r + t^2 r + t^2 r^3 + ... with t = 1 - r.
        let reflected = 2.0 * once / (1.0 + once);
        Some(if single(u.next_1d()) < reflected {
            Scattered::single(mirrored(out), self.tint.reflected(place))
        } else {
            Scattered::single(-out, self.tint.transmitted(place))
        })
    }
}
