//! Paths that the pixels nearby use too, a path a lane: what is kept of them, and their light shared.

use glam::Vec3A;
use pulp::{Simd, WithSimd};

use super::Packet;
use super::here::Here;
use super::walk::Laws;
use crate::path::geometry::Geometry;
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::reuse::{
    DARKEST, Diffuse, Group, HIGHEST, MOST, Numbers, Points, Traces, Vectors, WIDTH,
};
use crate::path::roulette::Rule;
use crate::path::{Surface, gamma};

// Vectors of any width are whole in the slots that are together.
const _: () = assert!(WIDTH.is_multiple_of(WIDEST));

/// Where the paths of some points are kept.
pub(in crate::path) struct Keeper<'a> {
    pub(in crate::path) traces: &'a mut Traces,
    pub(in crate::path) roulette: &'a Rule,
    /// Of each point.
    pub(in crate::path) of: &'a [usize],
}

/// The lanes that are at a point of which something is to be kept.
pub(super) struct AtPoints<'a, S: Simd> {
    pub(super) segment: &'a Row<f32>,
    /// Which point each path belongs to.
    pub(super) point: &'a [usize],
    pub(super) diffuse: Mask<S>,
}

impl Keeper<'_> {
    /// Keeps the end of the path of a point.
    #[inline(always)]
    pub(super) fn end(&mut self, point: usize, radiance: Vec3A, weight: f32) {
        self.traces.end(self.of[point], radiance, weight);
    }

    /// Keeps the first and second points of paths. Where it is a second one, which is told, what a path has gathered is kept with it.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(
        &mut self,
        simd: S,
        lanes: &AtPoints<'_, S>,
        here: &Here<'_, S>,
        laws: &Laws<'_, S>,
        radiance: Vector<S>,
    ) -> Mask<S> {
        let zero = Real::splat(simd, 0.0);
        let albedo = laws.albedo;
        let early = Real::load(simd, lanes.segment).le(Real::splat(simd, 2.0));
        let darkest = Real::splat(simd, DARKEST);
        let bright = lanes.diffuse & early & albedo.max_element().ge(darkest);
        let mut seconds = Row::<f32>::ZERO;
        if bright.any() {
            let bright = bright.row(simd);
            let (point, normal) = (here.point.rows(), here.place.normal.rows());
            let (margin, albedo) = (here.place.margin.row(), albedo.rows());
            let shading = (laws.shading * Real::splat(simd, 1.0).copysign(laws.facing)).rows();
            let radiance = radiance.rows();
            for lane in (0..S::F32_LANES).filter(|&lane| bright.0[lane] > 0.0) {
                let (slot, segment) = (self.of[lanes.point[lane]], lanes.segment.0[lane]);
                let surface = Surface {
                    point: Row::vector(&point, lane),
                    normal: Row::vector(&normal, lane),
                    margin: margin.0[lane],
                    detail: (),
                };
                let point = Diffuse {
                    surface,
                    shading: Row::vector(&shading, lane),
                    albedo: Row::vector(&albedo, lane),
                };
                if segment == 1.0 {
                    self.traces.set_first(slot, point, self.roulette);
                } else if self.traces.has_first(slot) {
                    let own = Row::vector(&radiance, lane);
                    self.traces.set_second(slot, point, own);
                    seconds.0[lane] = 1.0;
                }
            }
        }
        Real::load(simd, &seconds).gt(zero)
    }
}

/// Some of the points, one a lane.
#[derive(Clone, Copy)]
struct Lanes<S: Simd> {
    known: Mask<S>,
    point: Vector<S>,
    normal: Vector<S>,
    margin: Real<S>,
    shading: Vector<S>,
}

impl<S: Simd> Vector<S> {
    /// Those of slots from `slot` on.
    #[inline(always)]
    fn of_slots(simd: S, [x, y, z]: &Vectors, slot: usize) -> Self {
        Self {
            x: Real::of_slots(simd, x, slot),
            y: Real::of_slots(simd, y, slot),
            z: Real::of_slots(simd, z, slot),
        }
    }
}

impl<S: Simd> Real<S> {
    #[inline(always)]
    fn of_slots(simd: S, numbers: &Numbers, slot: usize) -> Self {
        Self::first_of(simd, &numbers[slot % WIDTH..])
    }
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn of(simd: S, points: &Points, slot: usize) -> Self {
        let zero = Real::splat(simd, 0.0);
        Self {
            known: Real::of_slots(simd, &points.known, slot).gt(zero),
            point: Vector::of_slots(simd, &points.point, slot),
            normal: Vector::of_slots(simd, &points.normal, slot),
            margin: Real::of_slots(simd, &points.margin, slot),
            shading: Vector::of_slots(simd, &points.shading, slot),
        }
    }

    /// As the one of single points.
    #[inline(always)]
    fn density(&self, second: &Self) -> Real<S> {
        let toward = second.point - self.point;
        let squared = toward.dot(toward);
        let cosine = self.shading.dot(toward);
        let other = second.normal.dot(toward).abs();
        (cosine / squared) * (other / squared)
    }

    #[inline(always)]
    fn leave(&self, direction: Vector<S>) -> Vector<S> {
        self.point + self.normal * self.margin.copysign(self.normal.dot(direction))
    }
}

/// The light of some groups to be shared, as [`Traces::share`] does.
pub(super) struct Sharing<'a> {
    pub(super) packet: &'a Packet,
    pub(super) geometry: &'a Geometry,
    pub(super) groups: &'a [Group],
    pub(super) traces: &'a mut Traces,
}

impl WithSimd for Sharing<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for group in self.groups {
            for round in (0..group.rounds).step_by(S::F32_LANES) {
                self.share(simd, group, round);
            }
        }
    }
}

impl Sharing<'_> {
    /// As many rounds as there are lanes.
    #[inline(always)]
    fn share<S: Simd>(&mut self, simd: S, group: &Group, round: usize) {
        let zero = Real::splat(simd, 0.0);
        let slot = |pixel| group.slot(pixel, round);
        let traces = &mut *self.traces;
        let albedo = |traces: &Traces, pixel| {
            Vector::of_slots(simd, &traces.of(slot(pixel)).first.albedo, slot(pixel))
        };
        let survival = |traces: &Traces, pixel| {
            Real::of_slots(simd, &traces.of(slot(pixel)).survival, slot(pixel))
        };
        let mut sums = [Vector::splat(simd, Vec3A::ZERO); MOST];
        for giver in 0..group.pixels {
            let given = traces.of(slot(giver));
            let second = Lanes::of(simd, &given.second, slot(giver));
            if !second.known.any() {
                continue;
            }
            let light = Vector::of_slots(simd, &given.light, slot(giver));
            let light = light * (survival(traces, giver) / albedo(traces, giver).max_element());
            let mut densities = [zero; MOST];
            let mut sum = zero;
            for (taker, density) in densities[..group.pixels].iter_mut().enumerate() {
                let first = Lanes::of(simd, &traces.of(slot(taker)).first, slot(taker));
                let found = first.density(&second);
                let clamped = found.min(Real::splat(simd, HIGHEST));
                let both = second.known & first.known;
                *density = if taker == giver {
                    both.select(clamped.max(Real::splat(simd, f32::MIN_POSITIVE)), zero)
                } else {
                    let toward = second.point - first.point;
                    let facing = second.shading.dot(-toward).gt(zero);
                    let start = first.leave(toward);
                    let way = second.leave(-toward) - start;
                    let length = way.length();
                    let active = both & found.gt(zero) & facing & length.gt(zero);
                    let into = way * (1.0 / length);
                    let limit = length * (1.0 - gamma(8));
                    let visible = if active.any() {
                        let between = &self.packet.dividing;
                        let ways = (start, into, limit);
                        self.packet
                            .sees::<S, false>(between, || self.geometry, false, active, ways)
                    } else {
                        active
                    };
                    visible.select(clamped, zero)
                };
                sum = sum + *density * survival(traces, taker);
            }
            for (taker, density) in densities[..group.pixels].iter().enumerate() {
                let more = sums[taker] + light * albedo(traces, taker) * (*density / sum);
                sums[taker] = density.gt(zero).choose(more, sums[taker]);
            }
        }
        for (pixel, sum) in sums[..group.pixels].iter().enumerate() {
            let slots = traces.of_mut(slot(pixel));
            let weight = Real::of_slots(simd, &slots.weight, slot(pixel));
            let value = (Vector::of_slots(simd, &slots.own, slot(pixel)) + *sum) * weight;
            let [x, y, z] = &mut slots.own;
            for (numbers, component) in [(x, value.x), (y, value.y), (z, value.z)] {
                component.store_first(&mut numbers[slot(pixel) % WIDTH..]);
            }
        }
    }
}
