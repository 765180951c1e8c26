//! Where rays meet the scene.

use pulp::Simd;

use super::Packet;
use super::drawn::Hits;
use super::place::{Place, Table};
use super::solids::{Names, Points};
use super::sweep::Hit;
use crate::path::lanes::{Mask, Real, Row, Vector};

/// The points that rays meet.
pub(super) struct Here<'a, S: Simd> {
    pub(super) place: Place<S>,
    pub(super) point: Vector<S>,
    /// The normal that light is scattered by.
    pub(super) shading: Vector<S>,
    pub(super) shape: Row<u32>,
    solids: Option<&'a Points>,
}

impl Packet {
    /// The points that rays meet first, where they meet a shape or a solid.
    #[inline(always)]
    pub(super) fn here<'a, S: Simd>(
        &self,
        simd: S,
        hit: &Hit<S>,
        solids: Option<&'a Points>,
    ) -> Here<'a, S> {
        let shape = hit.shapes();
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
            solids,
        };
        if let Some(points) = solids {
            let met = points.met(simd);
            let place = &mut here.place;
            here.point = met.choose(points.point(simd), here.point);
            place.normal = met.choose(points.normal(simd), place.normal);
            place.margin = met.select(points.margin(simd), place.margin);
            place.chance = met.select(points.chance(simd), place.chance);
            here.shading = met.choose(points.shading(simd), place.normal);
        }
        here
    }
}

impl<S: Simd> Here<'_, S> {
    /// Where light is emitted.
    #[inline(always)]
    pub(super) fn shines(&self) -> Mask<S> {
        let chance = self.place.chance;
        chance.ge(chance.all(0.0))
    }

    /// Where the view is asked what is emitted, if anything is; so it may be where lights are never chosen.
    #[inline(always)]
    pub(super) fn is_asked(&self) -> Mask<S> {
        let chance = self.place.chance;
        chance.eq(chance.all(0.0))
    }

    /// Where the outer side is towards `origin`.
    #[inline(always)]
    pub(super) fn faces(&self, origin: Vector<S>) -> Mask<S> {
        let facing = self.place.normal.dot(origin - self.point);
        facing.gt(facing.all(0.0))
    }

    /// 1 where the inner side scatters as the outer one does, 0 where it is black.
    #[inline(always)]
    pub(super) fn inner(&self, simd: S, table: &Table) -> Real<S> {
        let inner = table.inner(simd, &self.shape);
        match self.solids {
            Some(solids) => (solids.met(simd)).select(solids.inner(simd), inner),
            None => inner,
        }
    }

    /// What kind of law it is.
    #[inline(always)]
    pub(super) fn kind(&self, simd: S, table: &Table) -> Real<S> {
        let kind = table.kind(simd, &self.shape);
        match self.solids {
            Some(solids) => (solids.met(simd)).select(solids.kind(simd), kind),
            None => kind,
        }
    }

    /// Of the ideally diffuse law.
    #[inline(always)]
    pub(super) fn albedo(&self, simd: S, table: &Table) -> Vector<S> {
        let albedo = table.albedo(simd, &self.shape);
        match self.solids {
            Some(solids) => (solids.met(simd)).choose(solids.albedo(simd), albedo),
            None => albedo,
        }
    }

    /// The points, to be asked lane by lane, of rays in some directions.
    #[inline(always)]
    pub(super) fn hits<'a>(&self, table: &Table, direction: &'a [Row<f32>; 3]) -> Hits<'a> {
        let mut names = Names::shapes(table.parts(&self.shape));
        if let Some(solids) = self.solids {
            solids.name(&mut names);
        }
        Hits {
            point: self.point.rows(),
            normal: self.place.normal.rows(),
            margin: self.place.margin.row(),
            names,
            direction,
        }
    }
}
