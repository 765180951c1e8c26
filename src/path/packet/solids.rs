//! All that is not flat, whose points are found one lane after the other.

use glam::{Vec2, Vec3A};
use pulp::Simd;

use super::Packet;
use super::optics::Optics;
use super::sweep::Shapes;
use crate::path::Ray;
use crate::path::geometry::{self, Geometry, Hit, Triangles};
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::shape::{Primitive, Shape};

/// What is not flat in a scene: round shapes, and the meshes and copies that the [`Geometry`] finds.
#[derive(Debug)]
pub(super) struct Solids {
    /// The round shapes, and which parts of the scene they are.
    pub(super) round: Vec<(Primitive, usize)>,
    /// The number of the first of them among the shapes; those of the others follow.
    pub(super) first: u32,
    /// What all parts do to light.
    pub(super) optics: Vec<Optics>,
    /// Whether laws heed interpolated normals.
    pub(super) smooth: bool,
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
    chance: Row<f32>,
    names: Names,
}

/// Which part of the scene each lane is at, which triangle of all meshes, and which copy.
pub(super) struct Names {
    pub(super) part: Row<u32>,
    pub(super) triangle: Row<u32>,
    /// The coordinates along its edges.
    pub(super) along: [Row<f32>; 2],
    /// The number after it; 0 for none.
    pub(super) copy: Row<u32>,
}

impl Names {
    const NONE: Self = Self {
        part: Row::<u32>::ZERO,
        triangle: Row::<u32>::ZERO,
        along: [Row::<f32>::ZERO; 2],
        copy: Row::<u32>::ZERO,
    };

    /// Shapes.
    #[inline(always)]
    pub(super) fn shapes(part: Row<u32>) -> Self {
        Self { part, ..Self::NONE }
    }
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
        chance: Row::<f32>::ZERO,
        names: Names::NONE,
    };

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "scenes have fewer than 2^32 parts, triangles and copies"
    )]
    fn set(&mut self, lane: usize, optics: &Optics, hit: &Hit, shading: Vec3A) {
        let (surface, law) = (&hit.surface, &optics.law);
        self.met.0[lane] = 1.0;
        Row::set_vector(&mut self.point, lane, surface.point);
        Row::set_vector(&mut self.normal, lane, surface.normal);
        Row::set_vector(&mut self.shading, lane, shading);
        self.margin.0[lane] = surface.margin;
        Row::set_vector(&mut self.albedo, lane, law.albedo);
        self.kind.0[lane] = law.kind();
        self.inner.0[lane] = law.inner();
        self.chance.0[lane] = optics.emitted.chance();
        self.names.part.0[lane] = hit.part as u32;
        self.names.triangle.0[lane] = hit.triangle as u32;
        self.names.along[0].0[lane] = hit.along.x;
        self.names.along[1].0[lane] = hit.along.y;
        self.names.copy.0[lane] = hit.copy.map_or(0, |copy| copy as u32 + 1);
    }

    #[inline(always)]
    pub(super) fn met<S: Simd>(&self, simd: S) -> Mask<S> {
        Real::load(simd, &self.met).gt(Real::splat(simd, 0.0))
    }

    /// Names what the lanes are at that meet a solid.
    #[inline(always)]
    pub(super) fn name(&self, names: &mut Names) {
        for lane in (0..WIDEST).filter(|&lane| self.met.0[lane] > 0.0) {
            names.part.0[lane] = self.names.part.0[lane];
            names.triangle.0[lane] = self.names.triangle.0[lane];
            names.along[0].0[lane] = self.names.along[0].0[lane];
            names.along[1].0[lane] = self.names.along[1].0[lane];
            names.copy.0[lane] = self.names.copy.0[lane];
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

    /// Negative where nothing is emitted.
    #[inline(always)]
    pub(super) fn chance<S: Simd>(&self, simd: S) -> Real<S> {
        Real::load(simd, &self.chance)
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
    /// The solids that rays meet, of which those to the shapes `shapes` are met at the limit; round ones among them. Meshes and copies are
    /// only looked for in the lanes that have 1 in `near`; it may be known which `triangles` these meet first.
    #[inline(never)]
    pub(super) fn nearest(
        &self,
        geometry: &Geometry,
        rays: &Rays<'_>,
        near: &Row<f32>,
        triangles: Option<Triangles>,
        shapes: &Row<u32>,
    ) -> Points {
        // Of all lanes before anything is read of what is met: machines wait for many such reads at a time, but not beyond a search.
        let triangles = triangles.unwrap_or_else(|| {
            let mut triangles = [None; WIDEST];
            for (lane, ray, limit) in rays.each() {
                if near.0[lane] > 0.0 {
                    triangles[lane] = geometry.nearest_triangle(&ray, limit);
                }
            }
            triangles
        });
        let mut points = Points::NONE;
        for (lane, ray, limit) in rays.each() {
            if near.0[lane] > 0.0
                && let Some((hit, _)) = geometry.nearest_beside(&ray, limit, triangles[lane])
            {
                let shading = if self.smooth {
                    geometry.normal(&hit)
                } else {
                    hit.surface.normal
                };
                points.set(lane, &self.optics[hit.part], &hit, shading);
            } else if limit < f32::INFINITY
                && let Some(round) = shapes.0[lane].checked_sub(self.first)
            {
                let (shape, part) = &self.round[round as usize];
                let hit = Hit {
                    part: *part,
                    surface: shape.surface(&ray, limit),
                    triangle: 0,
                    along: Vec2::ZERO,
                    copy: None,
                };
                points.set(lane, &self.optics[*part], &hit, hit.surface.normal);
            }
        }
        points
    }
}

impl Packet {
    /// Where nothing is in the way, in the active lanes: neither shapes `between` the ends nor, unless the scene is `PLAIN`, anything
    /// else. The ways are where rays start, where they go and how far; `alike`, whether they run side by side.
    #[inline(always)]
    pub(super) fn sees<'g, S: Simd, const PLAIN: bool>(
        &self,
        between: &Shapes,
        geometry: impl FnOnce() -> &'g Geometry,
        alike: bool,
        active: Mask<S>,
        (start, into, limit): (Vector<S>, Vector<S>, Real<S>),
    ) -> Mask<S> {
        let simd = limit.simd();
        let visible = !between.occluded(start, into, limit, !active);
        if PLAIN {
            return visible;
        }
        let near = visible & self.boxes.entered(start, into, limit);
        if !near.any() {
            return visible;
        }
        let geometry = geometry();
        if let Some(soup) = geometry.soup().filter(|soup| alike && soup.is_small())
            && !geometry.has_copies()
        {
            let rays = geometry::Rays {
                origin: start,
                direction: into,
                limit,
                active: near,
            };
            return visible & !soup.occluded_together(rays);
        }
        let rays = Rays {
            origin: &start.rows(),
            direction: &into.rows(),
            limit: &limit.row(),
            active: &near.row(simd),
        };
        let blocked = blocked(geometry, &rays);
        visible & Real::load(simd, &blocked).eq(Real::splat(simd, 0.0))
    }
}

/// 1 in the lanes whose rays meet a mesh or a copy, 0 in all others.
#[inline(never)]
fn blocked(geometry: &Geometry, rays: &Rays<'_>) -> Row<f32> {
    let mut blocked = Row::<f32>::ZERO;
    for (lane, ray, limit) in rays.each() {
        if geometry.occluded_beside(&ray, limit) {
            blocked.0[lane] = 1.0;
        }
    }
    blocked
}
