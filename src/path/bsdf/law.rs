//! Laws of scattering in the frame of the surface.

use glam::Vec3A;

use super::{Bsdf, Scattered, Scattering};
use crate::Sampler;
use crate::path::{Frame, Place, Surface};

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

/// A [`Law`] as the law of a whole scene.
///
/// ```
/// use estimand::path::bsdf::{Framed, Plastic};
/// use estimand::path::light::{Constant, NoLight};
/// use estimand::path::shape::Sphere;
/// use estimand::path::texture::Uniform;
/// use estimand::path::{Object, Scene};
///
/// let plastic = Plastic::new(Uniform::from([0.1, 0.3, 0.5]), 1.49, 1.0)?;
/// let ball = Object::new([Sphere::new([0.0; 3], 1.0)?], plastic);
/// let scene: Scene<Framed<Plastic>, NoLight, _> =
///     Scene::new(vec![ball], Constant::new([1.0; 3])?)?;
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framed<L>(pub L);

impl<L: Law> From<L> for Framed<L> {
    fn from(law: L) -> Self {
        Self(law)
    }
}

impl<L: Law> Bsdf for Framed<L> {
    type Detail = <L::Place as Place>::Detail;

    #[inline]
    fn is_delta(&self) -> bool {
        self.0.is_delta()
    }

    #[inline]
    fn evaluate(&self, at: &Surface<Self::Detail>, out: Vec3A, into: Vec3A) -> Scattering {
        evaluate(&self.0, at, out, into)
    }

    #[inline]
    fn sample<S: Sampler>(
        &self,
        at: &Surface<Self::Detail>,
        out: Vec3A,
        u: &mut S,
    ) -> Option<Scattered> {
        sample(&self.0, at, out, u)
    }
}

/// What `law` says of directions that are given in the world.
#[inline]
pub(super) fn evaluate<L: Law>(
    law: &L,
    at: &Surface<<L::Place as Place>::Detail>,
    out: Vec3A,
    into: Vec3A,
) -> Scattering {
    let frame: Frame = L::Place::frame(at);
    let place = L::Place::of(at, &frame);
    law.evaluate(&place, frame.local(out), frame.local(into))
}

/// What `law` draws, in the world.
#[inline]
pub(super) fn sample<L: Law, S: Sampler>(
    law: &L,
    at: &Surface<<L::Place as Place>::Detail>,
    out: Vec3A,
    u: &mut S,
) -> Option<Scattered> {
    let frame: Frame = L::Place::frame(at);
    let place = L::Place::of(at, &frame);
    let scattered = law.sample(&place, frame.local(out), u)?;
    Some(Scattered {
        direction: frame.out(scattered.direction).normalize(),
        ..scattered
    })
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
