//! Where on a surface light is scattered, as far as laws and textures ask.

use glam::{Vec2, Vec3A};

use super::{Detail, Facet, Frame, Shading, Surface};

/// What a law of scattering knows of the point of a surface, in the frame that the law works in: its third
/// axis is the shading normal.
///
/// `()` is a place like any other: the laws that are the same everywhere need no more, and it costs nothing.
pub trait Place: Copy {
    /// What must be known of the surface to know the place.
    type Detail: Detail;

    /// The frame of laws of scattering at a point of a surface.
    fn frame(at: &Surface<Self::Detail>) -> Frame;

    /// The place that a point of a surface is, in that frame.
    fn of(at: &Surface<Self::Detail>, frame: &Frame) -> Self;

    /// How the position changes with the texture coordinates `u` and `v`.
    fn derivatives(&self) -> [Vec3A; 2];

    /// The normal of the surface itself, of length 1, where the shading normal may be another.
    fn outward(&self) -> Vec3A;

    /// The same place in another frame, whose axes are given in the present one.
    fn within(&self, frame: &Frame) -> Self;
}

impl Place for () {
    type Detail = ();

    #[inline]
    fn frame(at: &Surface) -> Frame {
        Frame::around(at.normal)
    }

    #[inline]
    fn of(_: &Surface, _: &Frame) -> Self {}

    #[inline]
    fn derivatives(&self) -> [Vec3A; 2] {
        [Vec3A::X, Vec3A::Y]
    }

    #[inline]
    fn outward(&self) -> Vec3A {
        Vec3A::Z
    }

    #[inline]
    fn within(&self, _: &Frame) -> Self {}
}

/// A place with texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The texture coordinates.
    pub uv: Vec2,
    /// How the position changes with `u` and with `v`.
    pub derivatives: [Vec3A; 2],
    /// The normal of the surface itself, of length 1.
    pub outward: Vec3A,
    /// Which point of a mesh it is.
    pub facet: Facet,
}

impl Spot {
    /// The place with the texture coordinates `uv` on a plane that they measure.
    pub fn new(uv: Vec2) -> Self {
        Self {
            uv,
            derivatives: ().derivatives(),
            outward: ().outward(),
            facet: Facet::default(),
        }
    }
}

impl Place for Spot {
    type Detail = Shading;

    #[inline]
    fn frame(at: &Surface<Shading>) -> Frame {
        Frame::along(at.detail.normal, at.detail.du)
    }

    #[inline]
    fn of(at: &Surface<Shading>, frame: &Frame) -> Self {
        let Shading {
            uv, du, dv, facet, ..
        } = at.detail;
        Self {
            uv,
            derivatives: [du, dv].map(|derivative| frame.local(derivative)),
            outward: frame.local(at.normal),
            facet,
        }
    }

    #[inline]
    fn derivatives(&self) -> [Vec3A; 2] {
        self.derivatives
    }

    #[inline]
    fn outward(&self) -> Vec3A {
        self.outward
    }

    #[inline]
    fn within(&self, frame: &Frame) -> Self {
        Self {
            uv: self.uv,
            derivatives: self.derivatives.map(|derivative| frame.local(derivative)),
            outward: frame.local(self.outward),
            facet: self.facet,
        }
    }
}
