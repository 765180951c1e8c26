//! What a walk through a tree still has to visit.

use super::node::{Child, Entry, Node};

/// A box that a ray enters at a distance.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Visit {
    pub(super) child: Child,
    pub(super) distance: f32,
}

/// Boxes to be visited, the nearest of every node last.
///
/// Trees are rarely deeper than there is room for; then the rest goes to the heap.
pub(super) struct Stack {
    visits: [Visit; ROOM],
    count: usize,
    below: Vec<Visit>,
}

const ROOM: usize = 64;

impl Stack {
    #[inline(always)]
    pub(super) fn new(root: Child) -> Self {
        let mut visits = [Visit::default(); ROOM];
        visits[0].child = root;
        Self {
            visits,
            count: 1,
            below: Vec::new(),
        }
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Visit> {
        if self.count == 0 {
            return self.below.pop();
        }
        self.count -= 1;
        Some(self.visits[self.count])
    }

    /// Adds the boxes of a node that a ray enters.
    #[inline(always)]
    pub(super) fn push(&mut self, node: &Node, entry: &Entry) {
        if self.count + 8 > ROOM {
            self.spill();
        }
        let first = self.count;
        let mut left = entry.boxes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let visit = Visit {
                child: node.child(lane),
                distance: entry.distances[lane],
            };
            let mut place = self.count;
            while place > first && self.visits[place - 1].distance < visit.distance {
                self.visits[place] = self.visits[place - 1];
                place -= 1;
            }
            self.visits[place] = visit;
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
        let entry = Entry {
            distances: [3.0, 1.0, 7.0, 0.0, 2.0, 6.0, 5.0, 4.0],
            boxes: 0b1110_1111,
        };
        let mut stack = Stack::new(Child::node(5));
        for _ in 0..30 {
            stack.push(&node, &entry);
        }
        for _ in 0..30 {
            let leaves: Vec<_> = (0..7).map(|_| stack.pop().unwrap().child.index()).collect();
            assert_eq!(leaves, [3, 1, 0, 7, 6, 5, 2]);
        }
        assert_eq!(stack.pop().unwrap().child, Child::node(5));
        assert!(stack.pop().is_none());
    }
}
