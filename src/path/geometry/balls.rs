//! Eight spheres at once.

use super::flats::{self, LANES, Lanes};
use crate::path::shape::Sphere;

/// Eight spheres, one a lane. An empty lane has no real radius: no ray meets it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balls {
    pub(super) center: [Lanes; 3],
    pub(super) squared_radius: Lanes,
}

impl Balls {
    const EMPTY: Self = Self {
        center: [[0.0; LANES]; 3],
        squared_radius: [f32::NEG_INFINITY; LANES],
    };

    /// Blocks of the given spheres in their order.
    pub(super) fn blocks<'a>(spheres: impl Iterator<Item = &'a Sphere>) -> Vec<Self> {
        flats::blocks(spheres, Self::EMPTY, Self::set)
    }

    fn set(&mut self, lane: usize, sphere: &Sphere) {
        for axis in 0..3 {
            self.center[axis][lane] = sphere.center()[axis];
        }
        self.squared_radius[lane] = sphere.squared_radius();
    }
}
