//! Where rays meet the scene.

use pulp::Simd;

use super::Packet;
use super::drawn::Hits;
use super::place::{DARK, Place, Table};
use super::solids::{Points, Rays};
use crate::path::lanes::{Mask, Real, Row, Vector};

/// The points that rays meet.
pub(super) struct Here<S: Simd> {
    pub(super) place: Place<S>,
    pub(super) point: Vector<S>,
    /// The normal that light is scattered by.
    pub(super) shading: Vector<S>,
    pub(super) shape: Row<u32>,
    solids: Option<Points>,
}

impl Packet {
    /// The points that rays meet first, and in which of the `active` lanes they meet any.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        origin: &[Row<f32>; 3],
        direction: &[Row<f32>; 3],
        active: Mask<S>,
    ) -> (Here<S>, Mask<S>) {
        let rays = [origin, direction].map(|rows| Vector::load(simd, rows));
        let hit = self.shapes.nearest(simd, rays[0], rays[1]);
        let mut met = active & hit.distance.lt(Real::splat(simd, f32::INFINITY));
        let mut shape = Row::<u32>::ZERO;
        hit.shape.store(&mut shape);
        let place = self.table.places(simd, &shape);
        let point = {
            let one = Real::splat(simd, 1.0);
            let [low_s, low_t] = self.table.inset(simd, &shape);
            let s = hit.s.max(low_s).min(one - low_s);
            let t = hit.t.max(low_t).min(one - low_t);
            if self.triangles {
                let slant = self.table.slant(simd, &shape);
                let beyond = (slant * (s + t) + low_s.max(low_t)).max(one);
                place.at(s / beyond, t / beyond)
            } else {
                place.at(s, t)
            }
        };
        let mut here = Here {
            place,
            point,
            shading: place.normal,
            shape,
            solids: None,
        };
        if let Some(solids) = &self.solids {
            let rays = Rays {
                origin,
                direction,
                limit: &hit.distance.row(),
                active: &active.row(simd),
            };
            let points = solids.nearest(&rays, &shape);
            met = met | points.met(simd);
            here.set_solids(simd, points);
        }
        (here, met)
    }
}

impl<S: Simd> Here<S> {
    #[inline(always)]
    fn set_solids(&mut self, simd: S, points: Points) {
        let met = points.met(simd);
        let place = &mut self.place;
        self.point = met.choose(points.point(simd), self.point);
        place.normal = met.choose(points.normal(simd), place.normal);
        place.margin = met.select(points.margin(simd), place.margin);
        place.chance = met.select(Real::splat(simd, DARK), place.chance);
        self.shading = met.choose(points.shading(simd), place.normal);
        self.solids = Some(points);
    }

    /// Where light is emitted towards `origin`.
    #[inline(always)]
    pub(super) fn shines(&self, origin: Vector<S>) -> Mask<S> {
        let zero = origin.x.all(0.0);
        let facing = self.place.normal.dot(origin - self.point);
        self.place.chance.ge(zero) & facing.gt(zero)
    }

    /// 1 where the inner side scatters as the outer one does, 0 where it is black.
    #[inline(always)]
    pub(super) fn inner(&self, simd: S, table: &Table) -> Real<S> {
        let inner = table.inner(simd, &self.shape);
        match &self.solids {
            Some(solids) => (solids.met(simd)).select(solids.inner(simd), inner),
            None => inner,
        }
    }

    /// What kind of law it is.
    #[inline(always)]
    pub(super) fn kind(&self, simd: S, table: &Table) -> Real<S> {
        let kind = table.kind(simd, &self.shape);
        match &self.solids {
            Some(solids) => (solids.met(simd)).select(solids.kind(simd), kind),
            None => kind,
        }
    }

    /// Of the ideally diffuse law.
    #[inline(always)]
    pub(super) fn albedo(&self, simd: S, table: &Table) -> Vector<S> {
        let albedo = table.albedo(simd, &self.shape);
        match &self.solids {
            Some(solids) => (solids.met(simd)).choose(solids.albedo(simd), albedo),
            None => albedo,
        }
    }

    /// The points, to be asked lane by lane, of rays in some directions.
    #[inline(always)]
    pub(super) fn hits<'a>(&self, table: &Table, direction: &'a [Row<f32>; 3]) -> Hits<'a> {
        let mut part = table.parts(&self.shape);
        let mut triangle = Row::<u32>::ZERO;
        if let Some(solids) = &self.solids {
            solids.name(&mut part, &mut triangle);
        }
        Hits {
            point: self.point.rows(),
            normal: self.place.normal.rows(),
            margin: self.place.margin.row(),
            part,
            triangle,
            direction,
        }
    }
}
