//! The sweep over a slab of the plane: the largest local discrepancy over all corners, in `O(n log^2 n)`.

use super::Boundary;

/// Points of the plane in order of their first coordinate, the second given as a rank among `heights`.
pub(super) struct Slab {
    /// The first coordinate of each point, ascending, and the rank of its second.
    pub(super) points: Vec<(f64, u32)>,
    /// The second coordinates that occur, ascending, each once.
    pub(super) heights: Vec<f64>,
}

/// The corner in the plane of the largest local discrepancy of one kind of box.
#[derive(Clone, Copy)]
pub(super) struct Peak {
    /// Points times local discrepancy.
    pub(super) excess: f64,
    pub(super) corner: [f64; 2],
}

impl Slab {
    /// The largest excess over the corners whose first coordinate is that of one of the points `range`, or 1 if `range`
    /// reaches to the end.
    ///
    /// The corner moves to the right. For every height `y` the excess times the count `n` of points is a straight line in the
    /// position `x`: `x y n - inside` for an open box, `inside - x y n` for a closed one. A point at height `h` that is passed
    /// changes `inside` for all `y` above `h`. So the largest excess is the highest of a set of lines at the present position, a
    /// suffix of which moves by 1 at a time: a kinetic tree.
    pub(super) fn peak(&self, range: core::ops::Range<usize>, boundary: Boundary) -> Peak {
        let scale = self.points.len() as f64;
        let start = range.start;
        let mut inside = vec![0_u32; self.heights.len() + 1];
        for &(_, rank) in &self.points[..start] {
            inside[rank as usize + 1] += 1;
        }
        for rank in 1..inside.len() {
            inside[rank] += inside[rank - 1];
        }
        // Line `rank` ends at heights[rank] for both kinds; an open box may reach up to 1, and then holds
        // all the points passed that are not at the height 1 themselves.
        let position = self.points.get(start).map_or(1.0, |point| point.0);
        let open_above = self.heights.last().is_none_or(|&top| top < 1.0);
        let mut tree = match boundary {
            Boundary::Open => {
                let above = open_above.then_some(1.0);
                let heights = self.heights.iter().copied().chain(above);
                Kinetic::new(
                    heights
                        .zip(&inside)
                        .map(|(y, &inside)| (y * scale, -f64::from(inside))),
                    inside.len(),
                    position,
                )
            }
            Boundary::Closed => Kinetic::new(
                self.heights
                    .iter()
                    .zip(&inside[1..])
                    .map(|(&y, &inside)| (-y * scale, f64::from(inside))),
                self.heights.len(),
                position,
            ),
        };
        let mut peak = Peak {
            excess: f64::NEG_INFINITY,
            corner: [1.0; 2],
        };
        let height = |rank: u32| self.heights.get(rank as usize).copied().unwrap_or(1.0);
        let mut look = |tree: &mut Kinetic, x: f64| {
            let (excess, rank) = tree.highest(x);
            if excess > peak.excess {
                peak = Peak {
                    excess,
                    corner: [x, height(rank)],
                };
            }
        };
        let end = range.end;
        for column in self.points[range].chunk_by(|a, b| a.0 == b.0) {
            let x = column[0].0;
            tree.advance(x);
            if boundary == Boundary::Open {
                look(&mut tree, x);
            }
            for &(_, rank) in column {
                match boundary {
                    Boundary::Open => tree.shift_from(rank as usize + 1, -1.0, x),
                    Boundary::Closed => tree.shift_from(rank as usize, 1.0, x),
                }
            }
            if boundary == Boundary::Closed {
                look(&mut tree, x);
            }
        }
        if boundary == Boundary::Open && end == self.points.len() {
            tree.advance(1.0);
            look(&mut tree, 1.0);
        }
        peak
    }
}

/// The upper envelope of straight lines at a position that only grows, as a binary tree of winners.
///
/// Each node knows the highest line below it, and the position until which all winners below it stay the same.
struct Kinetic {
    nodes: Vec<Node>,
    /// Leaves, a power of two.
    width: usize,
}

#[derive(Clone, Copy)]
struct Node {
    slope: f64,
    /// The winner's intercept, without the shifts of the nodes above.
    intercept: f64,
    /// What has been added to all lines below.
    shift: f64,
    /// The first position at which a winner below changes.
    until: f64,
    winner: u32,
}

impl Node {
    const NONE: Self = Self {
        slope: 0.0,
        intercept: f64::NEG_INFINITY,
        shift: 0.0,
        until: f64::INFINITY,
        winner: u32::MAX,
    };
}

impl Kinetic {
    fn new(lines: impl Iterator<Item = (f64, f64)>, count: usize, position: f64) -> Self {
        let width = count.next_power_of_two();
        let mut nodes = vec![Node::NONE; 2 * width];
        for (winner, (node, (slope, intercept))) in (0..).zip(nodes[width..].iter_mut().zip(lines))
        {
            *node = Node {
                slope,
                intercept,
                winner,
                ..Node::NONE
            };
        }
        let mut tree = Self { nodes, width };
        for node in (1..width).rev() {
            tree.decide(node, position);
        }
        tree
    }

    /// The value and the number of the highest line; `position` must be where the tree has advanced to.
    fn highest(&self, position: f64) -> (f64, u32) {
        let root = self.nodes[1];
        (root.slope * position + root.intercept, root.winner)
    }

    /// Moves all lines from the number `first` on.
    fn shift_from(&mut self, first: usize, by: f64, position: f64) {
        if first >= self.width {
            return;
        }
        let mut node = first + self.width;
        self.shift(node, by);
        while node > 1 {
            if node.is_multiple_of(2) {
                self.shift(node + 1, by);
            }
            node /= 2;
            self.decide(node, position);
        }
    }

    #[inline]
    fn shift(&mut self, node: usize, by: f64) {
        self.nodes[node].shift += by;
        self.nodes[node].intercept += by;
    }

    /// Lets all winners be those of `position`.
    fn advance(&mut self, position: f64) {
        self.advance_below(1, position);
    }

    fn advance_below(&mut self, node: usize, position: f64) {
        if self.nodes[node].until > position {
            return;
        }
        self.advance_below(2 * node, position);
        self.advance_below(2 * node + 1, position);
        self.decide(node, position);
    }

    /// Finds the winner at `node` from those of its children, which must be those of `position`.
    #[inline]
    fn decide(&mut self, node: usize, position: f64) {
        let (left, right) = (self.nodes[2 * node], self.nodes[2 * node + 1]);
        let at = |line: &Node| line.slope * position + line.intercept;
        // Of two lines that are equal here the steeper one wins from here on.
        let (win, lose) =
            if at(&left) > at(&right) || (at(&left) == at(&right) && left.slope >= right.slope) {
                (left, right)
            } else {
                (right, left)
            };
        let crossing = if lose.slope > win.slope {
            (win.intercept - lose.intercept) / (lose.slope - win.slope)
        } else {
            f64::INFINITY
        };
        let here = &mut self.nodes[node];
        *here = Node {
            slope: win.slope,
            intercept: win.intercept + here.shift,
            shift: here.shift,
            until: left.until.min(right.until).min(crossing),
            winner: win.winner,
        };
    }
}
