//! The inner nodes of a tree: eight boxes each.

use bytemuck::{Pod, Zeroable};
#[cfg(feature = "simd")]
use glam::Vec3A;

use super::flats::{LANES, Lanes};

/// Up to eight boxes, and what is in each.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// The low ends along the three axes, then the high ones. An empty lane is the box that nothing is in.
    pub(super) bounds: [Lanes; 6],
    children: [Child; LANES],
    /// What is left of four lines of a cache.
    rest: Lanes,
}

/// What is in a box: another node, or a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Child(u32);

const LEAF: u32 = 1 << 31;

impl Child {
    pub(super) const ROOT: Self = Self(0);

    pub(super) fn node(index: usize) -> Self {
        Self(number(index))
    }

    pub(super) fn leaf(index: usize) -> Self {
        Self(number(index) | LEAF)
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    /// The index among the nodes, or among the leaves.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        (self.0 & !LEAF) as usize
    }
}

fn number(index: usize) -> u32 {
    let number = u32::try_from(index).unwrap_or(LEAF);
    assert!(number < LEAF, "a tree has less than 2^31 nodes and leaves");
    number
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        bounds: {
            let (low, high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
            [low, low, low, high, high, high]
        },
        children: [Child(0); LANES],
        rest: [0.0; LANES],
    };

    pub(super) fn set(&mut self, lane: usize, [low, high]: [[f32; 3]; 2], child: Child) {
        for axis in 0..3 {
            self.bounds[axis][lane] = low[axis];
            self.bounds[axis + 3][lane] = high[axis];
        }
        self.children[lane] = child;
    }

    /// The corners of a box.
    #[cfg(feature = "simd")]
    #[inline(always)]
    pub(super) fn corners(&self, lane: usize) -> [Vec3A; 2] {
        let [low_x, low_y, low_z, high_x, high_y, high_z] = &self.bounds;
        [
            Vec3A::new(low_x[lane], low_y[lane], low_z[lane]),
            Vec3A::new(high_x[lane], high_y[lane], high_z[lane]),
        ]
    }

    /// Whether there is no box in a lane, nor in later ones.
    #[cfg(feature = "simd")]
    #[inline(always)]
    pub(super) fn is_empty(&self, lane: usize) -> bool {
        self.bounds[0][lane] > self.bounds[3][lane]
    }

    #[inline(always)]
    pub(super) fn child(&self, lane: usize) -> Child {
        self.children[lane]
    }
}
