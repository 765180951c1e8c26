//! Paths that the pixels nearby use too.
//!
//! A path that is scattered ideally diffusely at its first two points could have come from the first point of a neighbour's path as well:
//! what leaves the second point is the same, and the way there is the one thing to be looked at. So pixels that go together give the light of each
//! second point to all of their first points that see it, weighted by the balance heuristic: that of one pixel goes with the density with which its
//! own path would have come there, over the sum of those of all of them. The mean of each pixel is what it was, and its paths beyond
//! the second point are as many as those of all pixels together.

mod means;

use core::ops::Range;

use glam::{Vec3, Vec3A};

use super::bsdf::Bsdf;
use super::roulette::{Rule, Witness};
use super::{Detail, Segment, Surface, Vertex};

#[cfg(feature = "simd")]
pub(in crate::path) use means::TOGETHER;
pub(in crate::path) use means::{Group, Part, Pixels, Run};

/// The most pixels that go together.
pub(in crate::path) const MOST: usize = 16;

/// Pixels that go together are drawn from so many times as many columns.
pub(in crate::path) const SPREAD: u32 = 4;

/// How many slots are together.
pub(in crate::path) const WIDTH: usize = 16;

/// A number for each slot.
pub(in crate::path) type Numbers = [f32; WIDTH];

/// A vector for each slot.
pub(in crate::path) type Vectors = [Numbers; 3];

/// What is kept of paths, each in a slot of its own.
#[derive(Debug, Default)]
pub(in crate::path) struct Traces {
    pub(in crate::path) slots: Vec<Slots>,
}

/// What is kept of as many paths as are together: numbers beside one another, so that vectors of any width read them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(in crate::path) struct Slots {
    pub(in crate::path) first: Points,
    /// The probability with which the roulette lets a path go on from its first point.
    pub(in crate::path) survival: Numbers,
    pub(in crate::path) second: Points,
    /// The radiance of the pixel that is its own; in the end all of it.
    pub(in crate::path) own: Vectors,
    /// What leaves the second point, times the largest component of the albedo of the first over its survival.
    pub(in crate::path) light: Vectors,
    /// What the path counts in its pixel.
    pub(in crate::path) weight: Numbers,
}

/// Points that scatter light ideally diffusely.
#[derive(Clone, Debug)]
pub(in crate::path) struct Points {
    /// 1 where there is one, 0 elsewhere, where all else is anything.
    pub(in crate::path) known: Numbers,
    pub(in crate::path) point: Vectors,
    pub(in crate::path) normal: Vectors,
    pub(in crate::path) margin: Numbers,
    /// The normal that light is scattered by, on the side that the path came from.
    pub(in crate::path) shading: Vectors,
    pub(in crate::path) albedo: Vectors,
}

/// A point that scatters light ideally diffusely.
#[derive(Clone, Copy)]
pub(crate) struct Diffuse {
    pub(in crate::path) surface: Surface,
    pub(in crate::path) shading: Vec3A,
    pub(in crate::path) albedo: Vec3A,
}

impl Diffuse {
    /// That of a path which came from `out`, if it is one.
    pub(in crate::path) fn of<B: Bsdf>(vertex: &Vertex<'_, B>, out: Vec3A) -> Option<Self> {
        let law = vertex.bsdf.lambertian_at(&vertex.surface)?;
        let normal = vertex.surface.detail.normal(vertex.surface.normal);
        let facing = normal.dot(out);
        law.is_seen(facing).then(|| Self {
            surface: *vertex.place(),
            shading: normal * 1.0_f32.copysign(facing),
            albedo: law.albedo,
        })
    }
}

const NUMBERS: Numbers = [0.0; WIDTH];
const VECTORS: Vectors = [NUMBERS; 3];

impl Points {
    const NONE: Self = Self {
        known: NUMBERS,
        point: VECTORS,
        normal: VECTORS,
        margin: NUMBERS,
        shading: VECTORS,
        albedo: VECTORS,
    };

    #[inline]
    fn is_known(&self, slot: usize) -> bool {
        self.known[slot % WIDTH] > 0.0
    }

    #[inline]
    fn set(&mut self, slot: usize, diffuse: &Diffuse) {
        let Diffuse {
            surface,
            shading,
            albedo,
        } = diffuse;
        self.known[slot % WIDTH] = 1.0;
        set_vector(&mut self.point, slot, surface.point);
        set_vector(&mut self.normal, slot, surface.normal);
        self.margin[slot % WIDTH] = surface.margin;
        set_vector(&mut self.shading, slot, *shading);
        set_vector(&mut self.albedo, slot, *albedo);
    }

    fn get(&self, slot: usize) -> Option<Diffuse> {
        let surface = Surface {
            point: vector(&self.point, slot),
            normal: vector(&self.normal, slot),
            margin: self.margin[slot % WIDTH],
            detail: (),
        };
        self.is_known(slot).then(|| Diffuse {
            surface,
            shading: vector(&self.shading, slot),
            albedo: vector(&self.albedo, slot),
        })
    }
}

#[inline]
fn set_vector(vectors: &mut Vectors, slot: usize, vector: Vec3A) {
    for (numbers, component) in vectors.iter_mut().zip(vector.to_array()) {
        numbers[slot % WIDTH] = component;
    }
}

#[inline]
fn vector([x, y, z]: &Vectors, slot: usize) -> Vec3A {
    Vec3A::new(x[slot % WIDTH], y[slot % WIDTH], z[slot % WIDTH])
}

impl Slots {
    const EMPTY: Self = Self {
        first: Points::NONE,
        survival: NUMBERS,
        second: Points::NONE,
        own: VECTORS,
        light: VECTORS,
        weight: NUMBERS,
    };
}

impl Traces {
    /// Room for so many paths, of which nothing is known.
    pub(in crate::path) fn clear(&mut self, slots: usize) {
        self.slots.resize(slots.div_ceil(WIDTH), Slots::EMPTY);
        for slots in &mut self.slots {
            (slots.first.known, slots.second.known) = (NUMBERS, NUMBERS);
        }
    }

    /// What is kept of a path and those beside it.
    #[inline]
    pub(in crate::path) fn of(&self, slot: usize) -> &Slots {
        &self.slots[slot / WIDTH]
    }

    #[inline]
    pub(in crate::path) fn of_mut(&mut self, slot: usize) -> &mut Slots {
        &mut self.slots[slot / WIDTH]
    }

    /// Whether the first point of a path is known, and the second one is to be.
    #[inline]
    pub(in crate::path) fn has_first(&self, slot: usize) -> bool {
        self.of(slot).first.is_known(slot)
    }

    /// The first point of a path.
    #[inline]
    pub(in crate::path) fn set_first(&mut self, slot: usize, point: Diffuse, roulette: &Rule) {
        let slots = self.of_mut(slot);
        slots.first.set(slot, &point);
        slots.survival[slot % WIDTH] = roulette.chance(1, point.albedo.max_element());
    }

    /// The second point of a path, which has gathered `own`.
    #[inline]
    pub(in crate::path) fn set_second(&mut self, slot: usize, point: Diffuse, own: Vec3A) {
        let slots = self.of_mut(slot);
        slots.second.set(slot, &point);
        set_vector(&mut slots.own, slot, own);
    }

    /// The end of a path: what it has gathered, after its second point if that is known.
    #[inline]
    pub(in crate::path) fn end(&mut self, slot: usize, radiance: Vec3A, weight: f32) {
        let slots = self.of_mut(slot);
        let gathered = match slots.second.is_known(slot) {
            true => &mut slots.light,
            false => &mut slots.own,
        };
        set_vector(gathered, slot, radiance);
        slots.weight[slot % WIDTH] = weight;
    }

    /// What the paths of some slots in a row count in their pixel.
    pub(in crate::path) fn values(&self, slots: Range<usize>) -> impl Iterator<Item = Vec3> {
        slots.map(|slot| vector(&self.of(slot).own, slot).into())
    }

    /// Gives the light of each second point of a group to all first points of the same round, and makes `own` the value of each path.
    /// `occluded` tells whether anything is in the way.
    pub(in crate::path) fn share(&mut self, group: &Group, occluded: &dyn Fn(&Segment) -> bool) {
        for round in 0..group.rounds {
            let slot = |pixel| group.slot(pixel, round);
            let albedo = |of: &Self, pixel| vector(&of.of(slot(pixel)).first.albedo, slot(pixel));
            let survival = |of: &Self, pixel| of.of(slot(pixel)).survival[slot(pixel) % WIDTH];
            let mut sums = [Vec3A::ZERO; MOST];
            for giver in 0..group.pixels {
                let Some(second) = self.of(slot(giver)).second.get(slot(giver)) else {
                    continue;
                };
                let light = vector(&self.of(slot(giver)).light, slot(giver));
                let largest = albedo(self, giver).max_element();
                let light = light * (survival(self, giver) / largest);
                let mut densities = [0.0; MOST];
                let mut sum = 0.0;
                for (taker, density) in densities[..group.pixels].iter_mut().enumerate() {
                    if let Some(first) = self.of(slot(taker)).first.get(slot(taker)) {
                        *density = match taker == giver {
                            true => found(&first, &second),
                            false => visible(&first, &second, occluded),
                        };
                        sum += *density * survival(self, taker);
                    }
                }
                for (taker, density) in densities[..group.pixels].iter().enumerate() {
                    if *density > 0.0 {
                        sums[taker] += light * albedo(self, taker) * (density / sum);
                    }
                }
            }
            for (pixel, sum) in sums[..group.pixels].iter().enumerate() {
                let slot = slot(pixel);
                let slots = self.of_mut(slot);
                let value = (vector(&slots.own, slot) + *sum) * slots.weight[slot % WIDTH];
                set_vector(&mut slots.own, slot, value);
            }
        }
    }
}

/// The density per area, up to a factor, with which light of one point would be looked for at another, whatever is between them.
fn density(first: &Diffuse, second: &Diffuse) -> f32 {
    let toward = second.surface.point - first.surface.point;
    let squared = toward.dot(toward);
    let cosine = first.shading.dot(toward);
    let other = second.surface.normal.dot(toward).abs();
    (cosine / squared) * (other / squared)
}

/// That where the path has been found to be there, however its points are rounded.
fn found(first: &Diffuse, second: &Diffuse) -> f32 {
    clamped(density(first, second)).max(f32::MIN_POSITIVE)
}

/// That where the path must be looked for, and would have met the same side: else 0.
fn visible(first: &Diffuse, second: &Diffuse, occluded: &dyn Fn(&Segment) -> bool) -> f32 {
    let toward = second.surface.point - first.surface.point;
    let density = density(first, second);
    if !(density > 0.0 && second.shading.dot(-toward) > 0.0) {
        return 0.0;
    }
    match Segment::between(&first.surface, &second.surface) {
        Some(way) if !occluded(&way) => clamped(density),
        _ => 0.0,
    }
}

/// A number whose sum is finite.
fn clamped(density: f32) -> f32 {
    density.min(HIGHEST)
}

/// The largest density that is told from others.
pub(in crate::path) const HIGHEST: f32 = 1e36;

/// The darkest albedo whose points give light and take it: what is given is divided by it, and by what survives of it.
pub(in crate::path) const DARKEST: f32 = 1e-6;

/// Keeps what is to be kept of one path.
pub(in crate::path) struct Tracer<'a> {
    pub(in crate::path) traces: &'a mut Traces,
    pub(in crate::path) roulette: &'a Rule,
    pub(in crate::path) slot: usize,
}

impl Tracer<'_> {
    /// The end of the path.
    pub(in crate::path) fn end(&mut self, radiance: Vec3, weight: f32) {
        self.traces.end(self.slot, radiance.into(), weight);
    }
}

impl Witness for Tracer<'_> {
    fn scatters(
        &mut self,
        segment: u32,
        diffuse: &dyn Fn() -> Option<Diffuse>,
        throughput: &mut Vec3A,
        radiance: &mut Vec3A,
    ) {
        if segment > 2 || segment == 2 && !self.traces.has_first(self.slot) {
            return;
        }
        let Some(point) = diffuse().filter(|point| point.albedo.max_element() >= DARKEST) else {
            return;
        };
        if segment == 1 {
            self.traces.set_first(self.slot, point, self.roulette);
        } else {
            self.traces.set_second(self.slot, point, *radiance);
            // The colour of the first point is another for each pixel; the path is no less likely to go on than it was.
            *radiance = Vec3A::ZERO;
            *throughput = Vec3A::splat(throughput.max_element());
        }
    }
}

#[cfg(test)]
mod tests;
