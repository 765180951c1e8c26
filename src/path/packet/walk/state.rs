//! Where the paths are, one a lane.

use super::Start;
use crate::path::lanes::{Row, WIDEST};

/// What the loop over single paths keeps in its variables, of each lane's path.
#[derive(Clone, Copy)]
pub(super) struct State {
    pub(super) origin: [Row<f32>; 3],
    pub(super) direction: [Row<f32>; 3],
    pub(super) throughput: [Row<f32>; 3],
    pub(super) radiance: [Row<f32>; 3],
    pub(super) density: Row<f32>,
    pub(super) eta: Row<f32>,
    /// Zero in a lane without a path.
    pub(super) segment: Row<f32>,
    pub(super) weight: Row<f32>,
    /// Which point the path belongs to.
    pub(super) point: [usize; WIDEST],
}

/// The same of one path.
pub(super) struct Path {
    pub(super) origin: [f32; 3],
    pub(super) direction: [f32; 3],
    pub(super) throughput: [f32; 3],
    pub(super) radiance: [f32; 3],
    pub(super) density: f32,
    pub(super) eta: f32,
    pub(super) segment: f32,
    pub(super) weight: f32,
    pub(super) point: usize,
}

impl Path {
    #[inline(always)]
    pub(super) fn begin(point: usize, start: &Start) -> Self {
        let Start { ray, weight } = *start;
        Self {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            throughput: [1.0; 3],
            radiance: [0.0; 3],
            // The density of the camera's direction, which is no choice.
            density: f32::INFINITY,
            eta: 1.0,
            segment: 1.0,
            weight,
            point,
        }
    }
}

impl State {
    pub(super) const IDLE: Self = Self {
        origin: [Row::<f32>::ZERO; 3],
        direction: [Row::<f32>::ZERO; 3],
        throughput: [Row::<f32>::ZERO; 3],
        radiance: [Row::<f32>::ZERO; 3],
        density: Row::<f32>::ZERO,
        eta: Row::<f32>::ZERO,
        segment: Row::<f32>::ZERO,
        weight: Row::<f32>::ZERO,
        point: [usize::MAX; WIDEST],
    };

    /// The path of a lane.
    #[inline(always)]
    pub(super) fn path(&self, lane: usize) -> Path {
        Path {
            origin: Row::numbers(&self.origin, lane),
            direction: Row::numbers(&self.direction, lane),
            throughput: Row::numbers(&self.throughput, lane),
            radiance: Row::numbers(&self.radiance, lane),
            density: self.density.0[lane],
            eta: self.eta.0[lane],
            segment: self.segment.0[lane],
            weight: self.weight.0[lane],
            point: self.point[lane],
        }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, path: Path) {
        Row::set_numbers(&mut self.origin, lane, path.origin);
        Row::set_numbers(&mut self.direction, lane, path.direction);
        Row::set_numbers(&mut self.throughput, lane, path.throughput);
        Row::set_numbers(&mut self.radiance, lane, path.radiance);
        self.density.0[lane] = path.density;
        self.eta.0[lane] = path.eta;
        self.segment.0[lane] = path.segment;
        self.weight.0[lane] = path.weight;
        self.point[lane] = path.point;
    }
}
