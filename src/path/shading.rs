//! What a surface looks like beyond its place: texture coordinates and a normal for shading.

use glam::{Vec2, Vec3A};

/// What a [law of scattering](super::bsdf::Bsdf) needs to know of a surface beyond point and normal: nothing,
/// `()`, or its [`Shading`].
pub trait Detail: Copy + Send + Sync {
    /// The detail, from a function that computes all there is to know. The function is called only if it is
    /// needed.
    fn from_shading(shading: impl FnOnce() -> Shading) -> Self;

    /// The normal that light is scattered by, where that of the surface is `normal`: the same, unless a detail says otherwise whose law heeds another.
    #[inline]
    fn normal(&self, normal: Vec3A) -> Vec3A {
        normal
    }

    /// Whether there is nothing that it needs to know.
    fn is_nothing() -> bool {
        false
    }
}

impl Detail for () {
    #[inline]
    fn from_shading(_: impl FnOnce() -> Shading) -> Self {}

    fn is_nothing() -> bool {
        true
    }
}

impl Detail for Shading {
    #[inline]
    fn from_shading(shading: impl FnOnce() -> Self) -> Self {
        shading()
    }

    #[inline]
    fn normal(&self, _: Vec3A) -> Vec3A {
        self.normal
    }
}

/// Where on a mesh a point is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facet {
    /// Which triangle, of those that the mesh was made of; 0 on other shapes.
    pub triangle: u32,
    /// The coordinates along its first edge, from the first corner to the second, and from the first to the third.
    pub along: Vec2,
}

/// The parametrisation of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shading {
    /// The texture coordinates.
    pub uv: Vec2,
    /// The normal that light is scattered by, of length 1. Where normals are interpolated it differs from that of the
    /// surface.
    pub normal: Vec3A,
    /// How the point moves with the first texture coordinate.
    pub du: Vec3A,
    /// How the point moves with the second texture coordinate.
    pub dv: Vec3A,
    /// Which point of a mesh it is.
    pub facet: Facet,
}
