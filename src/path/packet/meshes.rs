//! Meshes, whose triangles are found one lane after the other.

use std::sync::Arc;

use pulp::Simd;

use super::place::Optics;
use crate::path::Ray;
use crate::path::geometry::{Found, Soup};
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};

/// The meshes of a scene; they emit no light.
#[derive(Debug)]
pub(super) struct Meshes {
    soup: Arc<Soup>,
    /// Of each mesh.
    optics: Vec<Optics>,
}

/// What rays meet of meshes, lane by lane.
pub(super) struct Points {
    /// 1 where a triangle is met, 0 elsewhere.
    met: Row<f32>,
    point: [Row<f32>; 3],
    normal: [Row<f32>; 3],
    margin: Row<f32>,
    shading: [Row<f32>; 3],
    albedo: [Row<f32>; 3],
    inner: Row<f32>,
}

impl Points {
    const NONE: Self = Self {
        met: Row::<f32>::ZERO,
        point: [Row::<f32>::ZERO; 3],
        normal: [Row::<f32>::ZERO; 3],
        margin: Row::<f32>::ZERO,
        shading: [Row::<f32>::ZERO; 3],
        albedo: [Row::<f32>::ZERO; 3],
        inner: Row::<f32>::ZERO,
    };

    #[inline(always)]
    pub(super) fn met<S: Simd>(&self, simd: S) -> Mask<S> {
        Real::load(simd, &self.met).gt(Real::splat(simd, 0.0))
    }

    #[inline(always)]
    pub(super) fn point<S: Simd>(&self, simd: S) -> Vector<S> {
        Vector::load(simd, &self.point)
    }

    #[inline(always)]
    pub(super) fn normal<S: Simd>(&self, simd: S) -> Vector<S> {
        Vector::load(simd, &self.normal)
    }

    #[inline(always)]
    pub(super) fn margin<S: Simd>(&self, simd: S) -> Real<S> {
        Real::load(simd, &self.margin)
    }

    /// The normal that light is scattered by.
    #[inline(always)]
    pub(super) fn shading<S: Simd>(&self, simd: S) -> Vector<S> {
        Vector::load(simd, &self.shading)
    }

    #[inline(always)]
    pub(super) fn albedo<S: Simd>(&self, simd: S) -> Vector<S> {
        Vector::load(simd, &self.albedo)
    }

    /// 1 where the inner side scatters as the outer one does, 0 where it is black.
    #[inline(always)]
    pub(super) fn inner<S: Simd>(&self, simd: S) -> Real<S> {
        Real::load(simd, &self.inner)
    }
}

/// Where rays start and where they go, in the lanes that have one.
pub(super) struct Rays<'a> {
    pub(super) origin: &'a [Row<f32>; 3],
    pub(super) direction: &'a [Row<f32>; 3],
    /// How far they go.
    pub(super) limit: &'a Row<f32>,
    /// 1 in the lanes with a ray, 0 in the others.
    pub(super) active: &'a Row<f32>,
}

impl Rays<'_> {
    #[inline(always)]
    fn each(&self) -> impl Iterator<Item = (usize, Ray, f32)> {
        let lanes = (0..WIDEST).filter(|&lane| self.active.0[lane] > 0.0);
        lanes.map(|lane| {
            let ray = Ray {
                origin: Row::vector(self.origin, lane),
                direction: Row::vector(self.direction, lane),
            };
            (lane, ray, self.limit.0[lane])
        })
    }
}

impl Meshes {
    /// `None` if a mesh emits light, or does with it what packets do not know.
    pub(super) fn new(soup: &Arc<Soup>, optics: impl Fn(usize) -> Option<Optics>) -> Option<Self> {
        let dark = |optics: &Optics| optics.emitted.is_none();
        let optics = (0..soup.meshes().len()).map(|mesh| optics(mesh).filter(dark));
        Some(Self {
            soup: Arc::clone(soup),
            optics: optics.collect::<Option<_>>()?,
        })
    }

    /// Whether any of them is black on its inner side.
    pub(super) fn one_sided(&self) -> bool {
        self.optics.iter().any(|optics| !optics.inner)
    }

    /// The triangles that rays meet.
    #[inline(never)]
    pub(super) fn nearest(&self, rays: &Rays<'_>) -> Points {
        let mut points = Points::NONE;
        for (lane, ray, limit) in rays.each() {
            let Some(Found { shape, distance }) = self.soup.nearest(&ray, limit) else {
                continue;
            };
            let mesh = self.soup.mesh(shape);
            let surface = self.soup.surface(shape, &ray, distance);
            let optics = &self.optics[mesh];
            points.met.0[lane] = 1.0;
            Row::set_vector(&mut points.point, lane, surface.point);
            Row::set_vector(&mut points.normal, lane, surface.normal);
            points.margin.0[lane] = surface.margin;
            let shading = self.soup.normal(mesh, shape, &surface);
            Row::set_vector(&mut points.shading, lane, shading);
            Row::set_vector(&mut points.albedo, lane, optics.albedo);
            points.inner.0[lane] = if optics.inner { 1.0 } else { 0.0 };
        }
        points
    }

    /// 1 in the lanes whose rays meet no triangle, 0 in all others.
    #[inline(never)]
    pub(super) fn passes(&self, rays: &Rays<'_>) -> Row<f32> {
        let mut passes = Row::<f32>::ZERO;
        for (lane, ray, limit) in rays.each() {
            if !self.soup.occluded(&ray, limit) {
                passes.0[lane] = 1.0;
            }
        }
        passes
    }
}
