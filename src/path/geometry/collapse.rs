//! Which boxes of a binary tree a tree of wide nodes keeps.

use glam::Vec3A;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::flats::LANES;

/// What a ray pays, in any unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    /// For a node, whose boxes are all asked at once.
    pub(super) node: f32,
    /// For a leaf.
    pub(super) leaf: f32,
    /// For each shape of a leaf.
    pub(super) shape: f32,
}

/// The tree of wide nodes that costs least of all that keep boxes of a binary one.[^ylitie]
///
/// A ray meets a box about as often as its surface is large; so the cost of a tree is the sum over its boxes of the surface times
/// what is paid there. From the bottom up it is found what the shapes below a box cost at least when they are given so many lanes of a node.
///
/// [^ylitie]: Ylitie, Henri; Karras, Tero; Laine, Samuli (2017). *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*,
///     section 3.3. <https://doi.org/10.1145/3105762.3105773>
pub(super) struct Collapse<'a> {
    binary: &'a Bvh2,
    choices: Vec<Choice>,
}

/// What is best done with the shapes below a box.
#[derive(Clone, Copy, Debug, Default)]
struct Choice {
    shapes: u32,
    /// What they cost with one lane, with two, and so on.
    costs: [f32; LANES],
    /// How many of the lanes the first half gets; 0 if they are better left to the box as a whole.
    first: [u8; LANES],
    /// The same if the box is a node, with lanes of its own; 0 if it is a leaf.
    within: u8,
}

impl<'a> Collapse<'a> {
    pub(super) fn new(binary: &'a Bvh2, cost: Cost) -> Self {
        let mut choices = vec![Choice::default(); binary.nodes.len()];
        for place in upwards(binary) {
            let node = &binary.nodes[place];
            let halves = children(node).map(|children| children.map(|child| choices[child]));
            choices[place] = Choice::best(node, halves, cost);
        }
        Self { binary, choices }
    }

    /// The boxes in the lanes of a node, given by their places in the binary tree; of a leaf the one around it.
    pub(super) fn lanes(&self, node: usize) -> Vec<usize> {
        let mut lanes = Vec::with_capacity(LANES);
        let mut open = vec![(node, LANES, self.choices[node].within)];
        while let Some((place, room, first)) = open.pop() {
            match children(&self.binary.nodes[place]) {
                Some([a, b]) if first > 0 => {
                    let first = usize::from(first);
                    let halves = [(b, room - first), (a, first)];
                    open.extend(
                        halves.map(|(half, room)| (half, room, self.choices[half].first[room - 1])),
                    );
                }
                _ => lanes.push(place),
            }
        }
        lanes
    }

    /// The corners of a box.
    pub(super) fn bounds(&self, place: usize) -> [Vec3A; 2] {
        let aabb = self.binary.nodes[place].aabb;
        [aabb.min, aabb.max]
    }

    /// The shapes in a box that is a leaf; `None` if it is a node.
    pub(super) fn leaf(&self, place: usize) -> Option<Vec<u32>> {
        if self.choices[place].within > 0 {
            return None;
        }
        let mut shapes = Vec::with_capacity(self.choices[place].shapes as usize);
        let mut open = vec![place];
        while let Some(place) = open.pop() {
            let node = &self.binary.nodes[place];
            match children(node) {
                Some(halves) => open.extend(halves.iter().rev()),
                None => shapes.extend_from_slice(self.below(node)),
            }
        }
        Some(shapes)
    }

    fn below(&self, leaf: &Bvh2Node) -> &[u32] {
        let first = leaf.first_index as usize;
        &self.binary.primitive_indices[first..first + leaf.prim_count as usize]
    }
}

/// All places of a binary tree, children before their parents.
fn upwards(binary: &Bvh2) -> Vec<usize> {
    let mut order = vec![0];
    let mut next = 0;
    while let Some(&place) = order.get(next) {
        order.extend(children(&binary.nodes[place]).into_iter().flatten());
        next += 1;
    }
    order.reverse();
    order
}

fn children(node: &Bvh2Node) -> Option<[usize; 2]> {
    let first = node.first_index as usize;
    (!node.is_leaf()).then_some([first, first + 1])
}

impl Choice {
    /// The best for a box, of what is best for its halves.
    fn best(node: &Bvh2Node, halves: Option<[Self; 2]>, cost: Cost) -> Self {
        let surface = node.aabb.half_area();
        let shapes = match &halves {
            Some([a, b]) => a.shapes + b.shapes,
            None => node.prim_count,
        };
        let leaf = surface * (cost.leaf + cost.shape * shapes as f32);
        let mut choice = Self {
            shapes,
            costs: [leaf; LANES],
            first: [0; LANES],
            within: 0,
        };
        let Some(halves) = halves else {
            return choice;
        };
        let (within, first) = Self::divided(&halves, LANES);
        let node = surface * cost.node + within;
        if shapes as usize > LANES || node < leaf {
            choice.costs = [node; LANES];
            choice.within = first;
        }
        for lanes in 2..=LANES {
            let (apart, first) = Self::divided(&halves, lanes);
            if apart < choice.costs[lanes - 2] {
                choice.costs[lanes - 1] = apart;
                choice.first[lanes - 1] = first;
            } else {
                choice.costs[lanes - 1] = choice.costs[lanes - 2];
                choice.first[lanes - 1] = choice.first[lanes - 2];
            }
        }
        choice
    }

    /// What two halves cost with so many lanes, at least two, and how many the first gets.
    fn divided([a, b]: &[Self; 2], lanes: usize) -> (f32, u8) {
        let ways = a.costs[..lanes - 1]
            .iter()
            .zip(b.costs[..lanes - 1].iter().rev());
        let ways = (1..).zip(ways).map(|(first, (a, b))| (a + b, first));
        ways.min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("at least one way")
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use obvhs::BvhBuildParams;
    use obvhs::aabb::Aabb;
    use obvhs::bvh2::builder::build_bvh2;

    use super::*;
    use crate::hash::{hash, unit_f32};

    /// All ways to put the shapes below a box in at most so many boxes.
    fn cuts(binary: &Bvh2, place: usize, room: usize) -> Vec<Vec<usize>> {
        let mut ways = vec![vec![place]];
        if let Some([a, b]) = children(&binary.nodes[place])
            && room > 1
        {
            let others = cuts(binary, b, room - 1);
            for first in cuts(binary, a, room - 1) {
                let fitting = others
                    .iter()
                    .filter(|other| first.len() + other.len() <= room);
                ways.extend(fitting.map(|other| [&first[..], other].concat()));
            }
        }
        ways
    }

    /// The least cost of a box by a look at all trees, and the number of its shapes.
    fn least(binary: &Bvh2, place: usize, cost: Cost) -> (f64, u32) {
        let node = &binary.nodes[place];
        let surface = f64::from(node.aabb.half_area());
        let Some(halves) = children(node) else {
            return (surface * f64::from(cost.leaf + cost.shape), 1);
        };
        let shapes = halves.iter().map(|&half| least(binary, half, cost).1).sum();
        let leaf = surface * (f64::from(cost.leaf) + f64::from(cost.shape) * f64::from(shapes));
        let ways = cuts(binary, place, LANES).into_iter().skip(1);
        let within = ways.map(|way| way.iter().map(|&place| least(binary, place, cost).0).sum());
        let node = surface * f64::from(cost.node) + within.fold(f64::INFINITY, f64::min);
        (
            if shapes as usize > LANES {
                node
            } else {
                node.min(leaf)
            },
            shapes,
        )
    }

    /// What a collapse costs from a box on.
    fn total(collapse: &Collapse<'_>, place: usize, cost: Cost, shapes: &mut Vec<u32>) -> f64 {
        let surface = f64::from(collapse.binary.nodes[place].aabb.half_area());
        if let Some(leaf) = collapse.leaf(place) {
            shapes.extend_from_slice(&leaf);
            assert!(leaf.len() <= LANES);
            return surface * (f64::from(cost.leaf) + f64::from(cost.shape) * leaf.len() as f64);
        }
        let lanes = collapse.lanes(place);
        assert!(lanes.len() > 1 && lanes.len() <= LANES);
        let within = lanes
            .into_iter()
            .map(|lane| total(collapse, lane, cost, shapes));
        surface * f64::from(cost.node) + within.sum::<f64>()
    }

    #[test]
    fn no_other_tree_of_the_same_boxes_costs_less() {
        let costs = [
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 0.5],
            [3.0, 1.0, 0.1],
            [0.1, 2.0, 1.0],
        ];
        for (seed, [node, leaf, shape]) in (0..).zip(costs) {
            let cost = Cost { node, leaf, shape };
            for count in [1_u64, 2, 8, 9, 13] {
                let boxes: Vec<_> = (0..count)
                    .map(|k| {
                        let random = |j| unit_f32(hash(seed, 10 * k + j));
                        let low = Vec3A::new(random(0), random(1), random(2));
                        Aabb::new(low, low + 0.3 * Vec3A::new(random(3), random(4), random(5)))
                    })
                    .collect();
                let parameters = BvhBuildParams {
                    max_prims_per_leaf: 1,
                    ..BvhBuildParams::slow_build()
                };
                let binary = build_bvh2(&boxes, parameters, &mut Duration::default());
                let collapse = Collapse::new(&binary, cost);
                let mut shapes = Vec::new();
                let (found, expected) = (
                    total(&collapse, 0, cost, &mut shapes),
                    least(&binary, 0, cost).0,
                );
                assert!(
                    (found / expected - 1.0).abs() < 1e-5,
                    "{count} {cost:?} {found} {expected}"
                );
                shapes.sort_unstable();
                assert!(shapes.iter().copied().eq(0..u32::try_from(count).unwrap()));
            }
        }
    }
}
