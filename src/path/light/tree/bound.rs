//! What is known of groups of emitters, as a tree of them grows.

use core::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3A;

use crate::path::light::Emitter;
use crate::path::shape::{Primitive, Shape};

/// Where emitters are, which way they shine and how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bound {
    pub(super) low: Vec3A,
    pub(super) high: Vec3A,
    /// All normals are within `spread`, in `[0, pi]`, of `axis`.
    pub(super) axis: Vec3A,
    pub(super) spread: f32,
    pub(super) power: f32,
}

impl Bound {
    pub(super) fn of(emitter: &Emitter) -> Self {
        let [low, high] = emitter.shape.bounds();
        let (axis, spread) = match &emitter.shape {
            Primitive::Flat(_) | Primitive::Disk(_) => {
                let point = emitter.shape.sample(Vec3A::ZERO, [0.5; 2]);
                (point.normal, 0.0)
            }
            Primitive::Sphere(_) | Primitive::Cylinder(_) => (Vec3A::Z, PI),
        };
        Self {
            low,
            high,
            axis,
            spread,
            power: single(emitter.power()),
        }
    }

    pub(super) fn with(self, other: Self) -> Self {
        let (axis, spread) = cone((self.axis, self.spread), (other.axis, other.spread));
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            spread,
            power: self.power + other.power,
        }
    }

    pub(super) fn center(&self) -> Vec3A {
        (self.low + self.high) * 0.5
    }

    /// What it costs to have such a group: its power, over how wide and in how many directions it is spread.
    fn cost(&self) -> f32 {
        let size = self.high - self.low;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        // Solid angle of all directions that are lit, as a fraction; never nothing.
        let lit = 0.5 * (1.0 - (self.spread + FRAC_PI_2).min(PI).cos());
        self.power * (area + f32::MIN_POSITIVE) * lit
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn single(x: f64) -> f32 {
    x as f32
}

/// The narrowest cone around two cones, each an axis and an angle in `[0, pi]`.
fn cone((a, wide): (Vec3A, f32), (b, other): (Vec3A, f32)) -> (Vec3A, f32) {
    if other > wide {
        return cone((b, other), (a, wide));
    }
    // By the cosine alone small angles would have few digits.
    let between = a.cross(b).length().atan2(a.dot(b));
    if between + other <= wide {
        return (a, wide);
    }
    let spread = 0.5 * (wide + between + other);
    // Towards the other axis by what is missing.
    let across = (b - a * a.dot(b)).try_normalize();
    let (Some(across), true) = (across, spread < PI) else {
        return (a, PI);
    };
    let (sine, cosine) = (spread - wide).sin_cos();
    (a * cosine + across * sine, spread)
}

/// How many slices along each axis are weighed against one another.
const SLICES: usize = 12;

/// Sorts the emitters into two groups of about the least cost and returns the number of the first.
pub(super) fn split(indices: &mut [u32], bounds: &[Bound], whole: &Bound) -> usize {
    let center = |index: u32| bounds[index as usize].center();
    let nothing = [Vec3A::INFINITY, Vec3A::NEG_INFINITY];
    let [low, high] = indices.iter().fold(nothing, |[low, high], &index| {
        [low.min(center(index)), high.max(center(index))]
    });
    let width = high - low;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of slices"
    )]
    let slice = |index: u32, axis: usize| {
        let place = (center(index)[axis] - low[axis]) / width[axis];
        ((place * SLICES as f32) as usize).min(SLICES - 1)
    };
    let mut best = (f32::INFINITY, 0, 0);
    for axis in (0..3).filter(|&axis| width[axis] > 0.0) {
        let mut slices = [None::<Bound>; SLICES];
        for &index in &*indices {
            let slice = &mut slices[slice(index, axis)];
            let bound = bounds[index as usize];
            *slice = Some(slice.map_or(bound, |sum| sum.with(bound)));
        }
        // A long group is cut across.
        let stretch = (whole.high - whole.low).max_element() / width[axis];
        for place in 1..SLICES {
            let (below, above) = slices.split_at(place);
            let together =
                |side: &[Option<Bound>]| side.iter().flatten().copied().reduce(Bound::with);
            let (Some(below), Some(above)) = (together(below), together(above)) else {
                continue;
            };
            let cost = stretch * (below.cost() + above.cost());
            if cost < best.0 {
                best = (cost, axis, place);
            }
        }
    }
    let (cost, axis, place) = best;
    if cost < f32::INFINITY {
        indices.sort_by_key(|&index| slice(index, axis));
        let below = indices.partition_point(|&index| slice(index, axis) < place);
        // All but one on one side, again and again, would make the tree as deep as it is long.
        if below.min(indices.len() - below) * 16 >= indices.len() {
            return below;
        }
    }
    indices.len() / 2
}
