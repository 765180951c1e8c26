//! Laws on surfaces whose normals a texture turns.

use glam::Vec3A;

use super::{Law, Scattered, Scattering};
use crate::Sampler;
use crate::path::Place;
use crate::path::frame::Frame;

/// What is done about normals that the surface does not really have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Relief {
    /// Whether a normal that faces away from who looks is turned around.
    turned: bool,
    /// Whether facets shadow one another.
    shadowed: bool,
}

impl Default for Relief {
    /// Normals are turned to who looks, and shadowed.
    fn default() -> Self {
        Self {
            turned: true,
            shadowed: true,
        }
    }
}

impl Relief {
    /// Normals that face away from who looks stay as they are: the surface is black there.
    pub fn unturned(mut self) -> Self {
        self.turned = false;
        self
    }

    /// The light that comes from near the horizon is not dimmed, so that bumps end in the dark at once.
    pub fn unshadowed(mut self) -> Self {
        self.shadowed = false;
        self
    }

    /// The frame around the normal, of length 1, given in the frame of the surface, with its first axis along `tangent`.
    #[inline]
    pub(super) fn frame(self, normal: Vec3A, tangent: Vec3A, out: Vec3A) -> Frame {
        let away = self.turned && out.z * out.dot(normal) <= 0.0;
        let normal = if away {
            Vec3A::new(-normal.x, -normal.y, normal.z)
        } else {
            normal
        };
        Frame::along(normal, tangent)
    }

    /// The fraction of light from `into` that reaches the facets around the given normal.[^estevez]
    ///
    /// [^estevez]: Estevez, Alejandro Conty; Lecocq, Pascal; Stein, Clifford (2019). *A Microfacet-Based Shadowing Function
    ///     to Solve the Bump Terminator Problem*. Ray Tracing Gems, chapter 12.
    ///     <https://doi.org/10.1007/978-1-4842-4427-2_12>
    #[inline]
    fn lit(self, normal: Vec3A, into: Vec3A) -> f32 {
        if !self.shadowed {
            return 1.0;
        }
        let squared_tangent = |v: Vec3A| (1.0 - v.z * v.z).max(0.0) / (v.z * v.z);
        let squared_alpha = (0.125 * squared_tangent(normal)).min(1.0);
        if squared_alpha == 0.0 {
            return 1.0;
        }
        2.0 / (1.0 + (1.0 + squared_alpha * squared_tangent(into)).sqrt())
    }

    /// What `law` in another frame says.
    #[inline]
    pub(super) fn evaluate<L: Law>(
        self,
        law: &L,
        frame: &Frame,
        place: &L::Place,
        out: Vec3A,
        into: Vec3A,
    ) -> Scattering {
        let there = frame.local(into);
        if !(into.z * there.z > 0.0) {
            return Scattering::NONE;
        }
        let Scattering { value, density } =
            law.evaluate(&place.within(frame), frame.local(out), there);
        Scattering {
            value: value * self.lit(frame.normal(), into),
            density,
        }
    }

    /// What `law` draws in another frame.
    #[inline]
    pub(super) fn sample<L: Law, S: Sampler>(
        self,
        law: &L,
        frame: &Frame,
        place: &L::Place,
        out: Vec3A,
        u: &mut S,
    ) -> Option<Scattered> {
        let scattered = law.sample(&place.within(frame), frame.local(out), u)?;
        let direction = frame.out(scattered.direction).normalize();
        if !(direction.z * scattered.direction.z > 0.0) {
            return None;
        }
        Some(Scattered {
            direction,
            weight: scattered.weight * self.lit(frame.normal(), direction),
            ..scattered
        })
    }
}
