//! The inner nodes of a tree: eight boxes each.

use super::flats::{LANES, Lanes, bit, word};
use crate::path::ray::{Ray, gamma};

/// Up to eight boxes, and what is in each.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Node {
    /// The low ends along the three axes, then the high ones. An empty lane is the box that nothing is in.
    bounds: [Lanes; 6],
    children: [Child; LANES],
}

/// What is in a box: another node, or a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Child(u32);

const LEAF: u32 = 1 << 31;

impl Child {
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
    };

    pub(super) fn set(&mut self, lane: usize, [low, high]: [[f32; 3]; 2], child: Child) {
        for axis in 0..3 {
            self.bounds[axis][lane] = low[axis];
            self.bounds[axis + 3][lane] = high[axis];
        }
        self.children[lane] = child;
    }

    #[inline(always)]
    pub(super) fn child(&self, lane: usize) -> Child {
        self.children[lane]
    }
}

/// A ray as boxes are asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Which of the bounds of a box it enters through, and leaves through.
    near: [usize; 3],
    far: [usize; 3],
}

/// Where a ray enters boxes.
pub(super) struct Entry {
    pub(super) distances: Lanes,
    /// Which boxes it enters, the first in the lowest bit.
    pub(super) boxes: u32,
}

/// What rounding does to the distance of a box.[^ize]
///
/// [^ize]: Ize, Thiago (2013). *Robust BVH Ray Traversal*. <https://jcgt.org/published/0002/02/02/>
pub(super) const WIDER: f32 = 1.0 + 2.0 * gamma(3);

impl Probe {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.recip().to_array();
        let near = core::array::from_fn(|axis| axis + 3 * usize::from(inverse[axis] < 0.0));
        Self {
            origin: ray.origin.to_array(),
            inverse,
            near,
            far: core::array::from_fn(|axis| 2 * axis + 3 - near[axis]),
        }
    }

    /// The boxes of a node that the ray enters before `limit`.
    #[inline(always)]
    pub(super) fn enter(&self, node: &Node, limit: f32) -> Entry {
        let near = self.near.map(|bound| &node.bounds[bound]);
        let far = self.far.map(|bound| &node.bounds[bound]);
        let mut distances = [0.0; LANES];
        let mut inside = [0; LANES];
        for lane in 0..LANES {
            let (mut start, mut end) = (0.0, limit);
            for axis in 0..3 {
                // NaN, of a ray within the plane of a side, tells nothing.
                let enters = (near[axis][lane] - self.origin[axis]) * self.inverse[axis];
                let leaves = (far[axis][lane] - self.origin[axis]) * self.inverse[axis];
                start = if enters > start { enters } else { start };
                end = if leaves < end { leaves } else { end };
            }
            distances[lane] = start;
            inside[lane] = bit(lane, start <= end * WIDER);
        }
        Entry {
            distances,
            boxes: word(inside),
        }
    }
}
