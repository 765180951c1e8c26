//! What a walk through a tree still has to visit.

use super::node::{Child, Node};
use super::probe::{Met, WIDER};

/// A box that a ray enters at a distance.
#[derive(Clone, Copy, Debug, Default)]
struct Visit {
    child: Child,
    distance: f32,
}

/// Boxes to be visited, the nearest of every node last.
///
/// Trees are rarely deeper than there is room for; then the rest goes to the heap.
pub(super) struct Stack {
    visits: [Visit; ROOM],
    count: usize,
    below: Vec<Visit>,
}

/// A power of two.
const ROOM: usize = 32;

impl Stack {
    /// Nothing. No constant, which would be copied from memory for every ray: a machine is quick to write zeros.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            visits: [Visit::default(); ROOM],
            count: 0,
            below: Vec::new(),
        }
    }

    /// The next box that is entered before `limit`.
    #[inline(always)]
    pub(super) fn pop(&mut self, limit: f32) -> Option<Child> {
        loop {
            let visit = if self.count == 0 {
                self.below.pop()?
            } else {
                self.count -= 1;
                self.visits[self.count % ROOM]
            };
            if visit.distance <= limit * WIDER {
                return Some(visit.child);
            }
        }
    }

    /// The nearest box of a node that a ray enters; the others are added.
    #[inline(always)]
    pub(super) fn push(&mut self, node: &Node, met: &Met) -> Option<Child> {
        let mut lanes = met.lanes().map(
            #[inline(always)]
            |lane| Visit {
                child: node.child(lane),
                distance: met.distances[lane],
            },
        );
        let mut nearest = lanes.next()?;
        if self.count + 8 > ROOM {
            self.spill();
        }
        let first = self.count;
        for mut visit in lanes {
            if visit.distance < nearest.distance {
                core::mem::swap(&mut visit, &mut nearest);
            }
            let mut place = self.count;
            while place > first && self.visits[(place - 1) % ROOM].distance < visit.distance {
                self.visits[place % ROOM] = self.visits[(place - 1) % ROOM];
                place -= 1;
            }
            self.visits[place % ROOM] = visit;
            self.count += 1;
        }
        Some(nearest.child)
    }

    /// Adds the boxes of a node that a ray enters in any order.
    #[inline(always)]
    pub(super) fn add(&mut self, node: &Node, met: &Met) {
        if self.count + 8 > ROOM {
            self.spill();
        }
        for lane in met.lanes() {
            self.visits[self.count % ROOM] = Visit {
                child: node.child(lane),
                distance: met.distances[lane],
            };
            self.count += 1;
        }
    }

    #[cold]
    fn spill(&mut self) {
        self.below.extend_from_slice(&self.visits[..self.count]);
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_in_a_deep_tree() {
        let mut node = Node::EMPTY;
        for lane in 0..8 {
            node.set(lane, [[0.0; 3]; 2], Child::leaf(lane));
        }
        let met = Met {
            distances: [3.0, 1.0, 7.0, 0.0, 2.0, 6.0, 5.0, 4.0],
            which: 0b1110_1111,
        };
        let mut stack = Stack::new();
        for _ in 0..30 {
            assert_eq!(stack.push(&node, &met), Some(Child::leaf(3)));
        }
        let mut pop = |limit| stack.pop(limit).map(Child::index);
        for _ in 0..20 {
            for lane in [1, 0, 7, 6, 5, 2] {
                assert_eq!(pop(f32::INFINITY), Some(lane));
            }
        }
        // Those farther than the limit are passed over.
        for _ in 0..10 {
            for lane in [1, 0, 7, 6] {
                assert_eq!(pop(5.0), Some(lane));
            }
        }
        assert_eq!(pop(5.0), None);
    }
}
