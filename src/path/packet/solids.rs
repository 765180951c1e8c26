//! Spheres and meshes, whose points are found one lane after the other.

use std::sync::Arc;

use pulp::Simd;

use super::optics::{Law, Optics};
use crate::path::geometry::{Found, Soup};
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::shape::{Shape, Sphere};
use crate::path::{Ray, Surface};

/// The spheres and the meshes of a scene; they emit no light.
#[derive(Debug)]
pub(super) struct Solids {
    spheres: Vec<Solid<Sphere>>,
    /// The number of the first sphere among the shapes; those of the others follow.
    first: u32,
    soup: Option<Arc<Soup>>,
    meshes: Vec<Solid<()>>,
    /// Whether laws heed interpolated normals.
    smooth: bool,
}

/// What is known of a solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid<T> {
    pub(super) shape: T,
    /// Which part of the scene it is.
    pub(super) part: u32,
    pub(super) law: Law,
}

impl<T> Solid<T> {
    /// `None` if it emits light.
    pub(super) fn new(shape: T, part: usize, optics: Optics) -> Option<Self> {
        let part = u32::try_from(part).ok()?;
        let law = optics.law;
        optics
            .emitted
            .is_none()
            .then_some(Self { shape, part, law })
    }
}

/// What rays meet of solids, lane by lane.
pub(super) struct Points {
    /// 1 where one is met, 0 elsewhere.
    met: Row<f32>,
    point: [Row<f32>; 3],
    normal: [Row<f32>; 3],
    margin: Row<f32>,
    shading: [Row<f32>; 3],
    albedo: [Row<f32>; 3],
    kind: Row<f32>,
    inner: Row<f32>,
    part: Row<u32>,
    triangle: Row<u32>,
}

impl Points {
    const NONE: Self = Self {
        met: Row::<f32>::ZERO,
        point: [Row::<f32>::ZERO; 3],
        normal: [Row::<f32>::ZERO; 3],
        margin: Row::<f32>::ZERO,
        shading: [Row::<f32>::ZERO; 3],
        albedo: [Row::<f32>::ZERO; 3],
        kind: Row::<f32>::ZERO,
        inner: Row::<f32>::ZERO,
        part: Row::<u32>::ZERO,
        triangle: Row::<u32>::ZERO,
    };

    #[inline(always)]
    fn set<T>(&mut self, lane: usize, solid: &Solid<T>, surface: &Surface) {
        self.met.0[lane] = 1.0;
        Row::set_vector(&mut self.point, lane, surface.point);
        Row::set_vector(&mut self.normal, lane, surface.normal);
        Row::set_vector(&mut self.shading, lane, surface.normal);
        self.margin.0[lane] = surface.margin;
        Row::set_vector(&mut self.albedo, lane, solid.law.albedo);
        self.kind.0[lane] = solid.law.kind();
        self.inner.0[lane] = solid.law.inner();
        self.part.0[lane] = solid.part;
    }

    #[inline(always)]
    pub(super) fn met<S: Simd>(&self, simd: S) -> Mask<S> {
        Real::load(simd, &self.met).gt(Real::splat(simd, 0.0))
    }

    /// Tells of the lanes that meet a solid which part of the scene it is, and which triangle of all meshes.
    #[inline(always)]
    pub(super) fn name(&self, part: &mut Row<u32>, triangle: &mut Row<u32>) {
        for lane in (0..WIDEST).filter(|&lane| self.met.0[lane] > 0.0) {
            part.0[lane] = self.part.0[lane];
            triangle.0[lane] = self.triangle.0[lane];
        }
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

    #[inline(always)]
    pub(super) fn kind<S: Simd>(&self, simd: S) -> Real<S> {
        Real::load(simd, &self.kind)
    }

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

impl Solids {
    /// `None` if there are none.
    pub(super) fn new(
        first: u32,
        spheres: Vec<Solid<Sphere>>,
        soup: Option<&Arc<Soup>>,
        meshes: Vec<Solid<()>>,
        smooth: bool,
    ) -> Option<Self> {
        (!(spheres.is_empty() && meshes.is_empty())).then(|| Self {
            spheres,
            first,
            soup: soup.map(Arc::clone),
            meshes,
            smooth,
        })
    }

    /// The laws of all of them.
    pub(super) fn laws(&self) -> impl Iterator<Item = &Law> {
        let spheres = self.spheres.iter().map(|solid| &solid.law);
        spheres.chain(self.meshes.iter().map(|solid| &solid.law))
    }

    /// The solids that rays meet, of which those to the shapes `shapes` are met at the limit; spheres among them.
    #[inline(never)]
    pub(super) fn nearest(&self, rays: &Rays<'_>, shapes: &Row<u32>) -> Points {
        let mut points = Points::NONE;
        for (lane, ray, limit) in rays.each() {
            if let Some(soup) = &self.soup
                && let Some(Found { shape, distance }) = soup.nearest(&ray, limit)
            {
                let mesh = soup.mesh(shape);
                let surface = soup.surface(shape, &ray, distance);
                points.set(lane, &self.meshes[mesh], &surface);
                if self.smooth {
                    let shading = soup.normal(mesh, shape, &surface);
                    Row::set_vector(&mut points.shading, lane, shading);
                }
                #[expect(clippy::cast_possible_truncation, reason = "fewer than 2^32")]
                let triangle = shape as u32;
                points.triangle.0[lane] = triangle;
            } else if limit < f32::INFINITY
                && let Some(sphere) = shapes.0[lane].checked_sub(self.first)
            {
                let solid = &self.spheres[sphere as usize];
                points.set(lane, solid, &solid.shape.surface(&ray, limit));
            }
        }
        points
    }

    /// Whether rays may meet triangles.
    #[inline(always)]
    pub(super) fn soup(&self) -> Option<&Soup> {
        self.soup.as_deref()
    }
}

/// 1 in the lanes whose rays meet no triangle, 0 in all others.
#[inline(never)]
pub(super) fn passes(soup: &Soup, rays: &Rays<'_>) -> Row<f32> {
    let mut passes = Row::<f32>::ZERO;
    for (lane, ray, limit) in rays.each() {
        if !soup.occluded(&ray, limit) {
            passes.0[lane] = 1.0;
        }
    }
    passes
}
