//! The lights that are shapes, and the ways to them.

use pulp::Simd;

use super::Packet;
use super::here::Here;
use super::near::{Drawn, Lights};
use crate::path::gamma;
use crate::path::lanes::{Mask, Real, Row, Vector};

/// Light that may arrive.
pub(super) struct Lamp<S: Simd> {
    /// Where the way to it starts, where it goes and how far.
    pub(super) start: Vector<S>,
    pub(super) into: Vector<S>,
    pub(super) limit: Real<S>,
    /// The radiance over the density.
    pub(super) weight: Vector<S>,
    pub(super) density: Real<S>,
    /// Where there is any.
    pub(super) active: Mask<S>,
}

impl Packet {
    /// The shape that a coordinate chooses among the lights, and what is left of the coordinate.
    #[inline(always)]
    pub(super) fn choose(&self, u: f64) -> (u32, f64) {
        let (chosen, u) = self.lights.choose(u);
        (self.emitters[chosen], u)
    }

    /// The one light, where there are no others to be chosen.
    #[inline(always)]
    pub(super) fn first_light(&self) -> Row<u32> {
        match self.emitters[..] {
            [one] => Row::<u32>::splat(one),
            _ => Row::<u32>::ZERO,
        }
    }

    /// What the points of `active` lanes emit towards `origin`, and the density with which they would have been drawn.
    #[inline(always)]
    pub(super) fn emitted<S: Simd>(
        &self,
        simd: S,
        here: &Here<'_, S>,
        origin: Vector<S>,
        active: Mask<S>,
    ) -> (Vector<S>, Real<S>) {
        let Here {
            place,
            point,
            shape,
            ..
        } = here;
        let area = self.table.area(simd, shape);
        let mut drawn = place.density_of_area(origin, *point, area);
        if let Some(near) = &self.near {
            let lights = Lights {
                shapes: shape,
                active: active.row(simd),
                from: origin.rows(),
            };
            let mut rows = Drawn {
                point: [Row::<f32>::ZERO; 3],
                density: drawn.row(),
            };
            self.draw_near(near, &lights, None, &mut rows);
            drawn = Real::load(simd, &rows.density);
        }
        (self.table.radiance(simd, shape), place.chance * drawn)
    }

    /// The way to the points that the coordinates draw of the chosen lights.
    #[inline(always)]
    pub(super) fn lamp<S: Simd>(
        &self,
        simd: S,
        here: &Here<'_, S>,
        chosen: &Row<u32>,
        [a, b]: [Real<S>; 2],
        active: Mask<S>,
    ) -> Lamp<S> {
        let table = &self.table;
        let (zero, one) = (Real::splat(simd, 0.0), Real::splat(simd, 1.0));
        let (there, area, light) = if let [one] = self.emitters[..] {
            let shape = one as usize;
            (
                table.place(simd, one),
                Real::splat(simd, table.area[shape]),
                table.light(simd, shape),
            )
        } else {
            (
                table.places(simd, chosen),
                table.area(simd, chosen),
                table.radiance(simd, chosen),
            )
        };
        let (s, t) = if self.slanted_lights {
            let slanted = table.slant(simd, chosen).gt(zero);
            let above = b.gt(a);
            let (half_a, half_b) = (0.5 * a, 0.5 * b);
            let s = above.select(half_a, a - half_b);
            let t = above.select(b - half_a, half_b);
            (slanted.select(s, a), slanted.select(t, b))
        } else {
            (a, b)
        };
        let mut target = there.at(s, t);
        let mut density = there.density_of_area(here.point, target, area);
        if let Some(near) = &self.near {
            let lights = Lights {
                shapes: chosen,
                active: active.row(simd),
                from: here.point.rows(),
            };
            let mut rows = Drawn {
                point: target.rows(),
                density: density.row(),
            };
            self.draw_near(near, &lights, Some(&[a.row(), b.row()]), &mut rows);
            target = Vector::load(simd, &rows.point);
            density = Real::load(simd, &rows.density);
        }
        let own = there.chance * density;
        let toward = target - here.point;
        let start = here.place.leave(here.point, toward);
        let way = there.leave(target, -toward) - start;
        let length = way.length();
        let active = active
            & there.normal.dot(here.point - target).gt(zero)
            & own.gt(zero)
            & own.lt(Real::splat(simd, f32::MAX))
            & length.gt(zero);
        // Other lanes may have the largest of numbers, whose inverse is a slow one.
        let own = active.select(own, one);
        Lamp {
            start,
            into: way * (1.0 / length),
            limit: length * (1.0 - gamma(8)),
            weight: light * (1.0 / own),
            density: own,
            active,
        }
    }
}
