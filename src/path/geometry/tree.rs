//! The bounding volume hierarchy of many shapes.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;

use super::collapse::{Collapse, Cost};
use super::flats::LANES;
use super::node::{Child, Node};
use super::pages::Pages;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
use super::probe::Vectors;
use super::probe::{Plain, Probe};
use super::stack::Stack;
use super::{Found, around};
use crate::path::ray::{Ray, gamma};
use crate::path::shape::Shape;

/// An eight-way tree of boxes around the shapes, with up to eight shapes in a leaf.
///
/// A binary tree of `obvhs`, of whose boxes those are [kept](Collapse) that cost least. The first node is the root.
pub(super) struct Tree {
    nodes: Pages<Node>,
    leaves: Vec<Leaf>,
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    simd: Option<pulp::x86::V3>,
}

/// What is in the leaves of a tree.
pub(super) trait Leaves {
    /// The place in a leaf of the nearest thing that is met before `limit`, and its distance. At the limit itself things may be met that go before others
    /// at the same distance, if those set the limit.
    fn nearest(&mut self, probe: &impl Probe, leaf: usize, limit: f32) -> Option<(usize, f32)>;

    /// Whether anything in a leaf is met before `limit`.
    fn any(&mut self, probe: &impl Probe, leaf: usize, limit: f32) -> bool;
}

/// What a ray meets: its place in a leaf, and its distance.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct InLeaf {
    pub(super) leaf: usize,
    pub(super) lane: usize,
    pub(super) distance: f32,
}

/// The shapes of a leaf; [`NONE`] where there are fewer than eight.
type Leaf = [u32; LANES];

const NONE: u32 = u32::MAX;

impl Tree {
    /// The tree of at least one shape.
    pub(super) fn new<S: Shape>(shapes: &[S], cost: Cost) -> Self {
        let boxes: Vec<_> = shapes.iter().map(Shape::bounds).collect();
        Self::around(&boxes, cost)
    }

    /// The tree of at least one box, given by two corners.
    pub(super) fn around(boxes: &[[Vec3A; 2]], cost: Cost) -> Self {
        let [low, high] = around(boxes.iter().copied());
        let extent = low.abs().max(high.abs()).max_element();
        // A power of two, which is exact, so that areas stay in the range of `f32`.
        let scale = (-extent.max(f32::MIN_POSITIVE).log2().round())
            .clamp(-120.0, 120.0)
            .exp2();
        let boxes: Vec<Aabb> = boxes
            .iter()
            .map(|&corners| scaled(corners, scale))
            .collect();
        // A slow build is for those who render long; a million boxes would take longer than many pictures.
        let parameters = if boxes.len() < SLOW {
            BvhBuildParams::slow_build()
        } else {
            BvhBuildParams::fast_build()
        };
        let parameters = BvhBuildParams {
            max_prims_per_leaf: 1,
            ..parameters
        };
        let binary = build_bvh2(&boxes, parameters, &mut Duration::default());
        Self::of(&Collapse::new(&binary, cost), scale)
    }

    /// The tree of the boxes of a binary one, which is scaled.
    fn of(collapse: &Collapse<'_>, scale: f32) -> Self {
        let (mut nodes, mut leaves) = (vec![Node::EMPTY], Vec::new());
        let mut open = vec![(0, 0)];
        while let Some((node, place)) = open.pop() {
            for (lane, place) in collapse.lanes(place).into_iter().enumerate() {
                let bounds = collapse.bounds(place).map(|end| (end / scale).to_array());
                let child = if let Some(shapes) = collapse.leaf(place) {
                    let mut leaf = [NONE; LANES];
                    leaf[..shapes.len()].copy_from_slice(&shapes);
                    leaves.push(leaf);
                    Child::leaf(leaves.len() - 1)
                } else {
                    nodes.push(Node::EMPTY);
                    let index = nodes.len() - 1;
                    open.push((index, place));
                    Child::node(index)
                };
                nodes[node].set(lane, bounds, child);
            }
        }
        Self {
            nodes: Pages::new(nodes.into_iter()),
            leaves,
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            simd: pulp::x86::V3::try_new(),
        }
    }

    #[cfg(feature = "simd")]
    pub(super) fn nodes(&self) -> &[Node] {
        self.nodes.as_slice()
    }

    /// The boxes that a walk begins with.
    #[cfg(feature = "simd")]
    pub(super) fn boxes(&self) -> impl Iterator<Item = [Vec3A; 2]> {
        let root = &self.nodes.as_slice()[Child::ROOT.index()];
        (0..LANES)
            .map(|lane| root.corners(lane))
            .filter(|[low, high]| !low.cmpgt(*high).any())
    }

    /// The shapes of each leaf.
    pub(super) fn leaves(&self) -> impl ExactSizeIterator<Item = impl Iterator<Item = usize> + '_> {
        self.leaves.iter().map(|leaf| {
            let shapes = leaf.iter().take_while(|&&shape| shape != NONE);
            shapes.map(|&shape| shape as usize)
        })
    }

    #[inline]
    pub(super) fn nearest<S: Shape>(&self, shapes: &[S], ray: &Ray, limit: f32) -> Option<Found> {
        self.search(ray, limit, |shape, limit| {
            shapes[shape].intersect(ray, limit)
        })
    }

    #[inline]
    pub(super) fn occluded<S: Shape>(&self, shapes: &[S], ray: &Ray, limit: f32) -> bool {
        self.meets(ray, limit, |shape, limit| {
            shapes[shape].intersect(ray, limit).is_some()
        })
    }

    /// The nearest of what is in the boxes: `meet` returns the distance of one of them if it is met before a limit.
    #[inline]
    pub(super) fn search(
        &self,
        ray: &Ray,
        limit: f32,
        meet: impl FnMut(usize, f32) -> Option<f32>,
    ) -> Option<Found> {
        let mut each = Each {
            leaves: &self.leaves,
            meet,
        };
        let place = self.nearest_in_leaves(Child::ROOT, ray, limit, &mut each)?;
        Some(Found {
            shape: self.leaves[place.leaf][place.lane] as usize,
            distance: place.distance,
        })
    }

    /// Whether any of what is in the boxes is met before `limit`.
    #[inline]
    pub(super) fn meets(
        &self,
        ray: &Ray,
        limit: f32,
        mut meet: impl FnMut(usize, f32) -> bool,
    ) -> bool {
        let mut each = Each {
            leaves: &self.leaves,
            meet: |shape, limit| meet(shape, limit).then_some(0.0),
        };
        self.any_in_leaves(Child::ROOT, ray, limit, &mut each)
    }

    /// The same leaf by leaf, of those that are in `from` or below it.
    #[inline]
    pub(super) fn nearest_in_leaves(
        &self,
        from: Child,
        ray: &Ray,
        limit: f32,
        leaves: &mut impl Leaves,
    ) -> Option<InLeaf> {
        if is_none(ray) {
            return None;
        }
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(simd) = self.simd {
            return simd.vectorize(ToNearest(InVectors {
                simd,
                tree: self,
                from,
                ray,
                limit,
                leaves,
            }));
        }
        self.walk_to_nearest(from, &Plain::new(ray), limit, leaves)
    }

    /// Whether any leaf holds something that is met.
    #[inline]
    pub(super) fn any_in_leaves(
        &self,
        from: Child,
        ray: &Ray,
        limit: f32,
        leaves: &mut impl Leaves,
    ) -> bool {
        if is_none(ray) {
            return false;
        }
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(simd) = self.simd {
            return simd.vectorize(ToAny(InVectors {
                simd,
                tree: self,
                from,
                ray,
                limit,
                leaves,
            }));
        }
        self.walk_to_any(from, &Plain::new(ray), limit, leaves)
    }

    #[inline(always)]
    fn walk_to_nearest(
        &self,
        from: Child,
        probe: &impl Probe,
        mut limit: f32,
        leaves: &mut impl Leaves,
    ) -> Option<InLeaf> {
        let nodes = self.nodes.as_slice();
        let mut nearest = None;
        let mut stack = Stack::new();
        let mut next = Some(from);
        while let Some(child) = next {
            let index = child.index();
            next = if child.is_leaf() {
                if let Some((lane, distance)) = leaves.nearest(probe, index, limit) {
                    limit = distance;
                    nearest = Some((index, lane));
                }
                None
            } else {
                let node = &nodes[index];
                stack.push(node, &probe.enter(node, limit))
            };
            next = next.or_else(
                #[inline(always)]
                || stack.pop(limit),
            );
        }
        nearest.map(|(leaf, lane)| InLeaf {
            leaf,
            lane,
            distance: limit,
        })
    }

    #[inline(always)]
    fn walk_to_any(
        &self,
        from: Child,
        probe: &impl Probe,
        limit: f32,
        leaves: &mut impl Leaves,
    ) -> bool {
        let nodes = self.nodes.as_slice();
        let mut stack = Stack::new();
        let mut next = Some(from);
        while let Some(child) = next {
            let index = child.index();
            if !child.is_leaf() {
                let node = &nodes[index];
                stack.add(node, &probe.enter(node, limit));
            } else if leaves.any(probe, index, limit) {
                return true;
            }
            next = stack.pop(limit);
        }
        false
    }
}

/// A walk in the vectors of the machine. Not a closure: compilers do not always make it part of the function that is compiled for
/// them, and then every operation is a call.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
struct InVectors<'a, L> {
    simd: pulp::x86::V3,
    tree: &'a Tree,
    from: Child,
    ray: &'a Ray,
    limit: f32,
    leaves: &'a mut L,
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
struct ToNearest<'a, L>(InVectors<'a, L>);

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
impl<L: Leaves> pulp::NullaryFnOnce for ToNearest<'_, L> {
    type Output = Option<InLeaf>;

    #[inline(always)]
    fn call(self) -> Option<InLeaf> {
        let Self(walk) = self;
        let probe = Vectors::new(walk.simd, walk.ray);
        walk.tree
            .walk_to_nearest(walk.from, &probe, walk.limit, walk.leaves)
    }
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
struct ToAny<'a, L>(InVectors<'a, L>);

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
impl<L: Leaves> pulp::NullaryFnOnce for ToAny<'_, L> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Self(walk) = self;
        let probe = Vectors::new(walk.simd, walk.ray);
        walk.tree
            .walk_to_any(walk.from, &probe, walk.limit, walk.leaves)
    }
}

/// Things that are asked one by one, by a function.
struct Each<'a, F> {
    leaves: &'a [Leaf],
    meet: F,
}

impl<F: FnMut(usize, f32) -> Option<f32>> Leaves for Each<'_, F> {
    #[inline(always)]
    fn nearest(&mut self, _: &impl Probe, leaf: usize, mut limit: f32) -> Option<(usize, f32)> {
        let mut nearest = None;
        for (lane, &shape) in self.leaves[leaf].iter().enumerate() {
            if shape == NONE {
                break;
            }
            if let Some(distance) = (self.meet)(shape as usize, limit) {
                limit = distance;
                nearest = Some((lane, distance));
            }
        }
        nearest
    }

    #[inline(always)]
    fn any(&mut self, _: &impl Probe, leaf: usize, limit: f32) -> bool {
        let mut shapes = self.leaves[leaf].iter().take_while(|&&shape| shape != NONE);
        shapes.any(|&shape| (self.meet)(shape as usize, limit).is_some())
    }
}

/// Whether a ray is no ray: NaN in all places tells nothing of any box, also not that nothing is in an empty one.
#[inline(always)]
fn is_none(ray: &Ray) -> bool {
    ray.origin.dot(ray.direction).is_nan()
}

/// From so many boxes on, the tree is built fast.
const SLOW: usize = 100_000;

/// A scaled box, widened by what rounding does to a ray's way to it.
fn scaled(corners: [Vec3A; 2], scale: f32) -> Aabb {
    let [low, high] = corners.map(|corner| corner * scale);
    let margin = gamma(8) * low.abs().max(high.abs()).max_element();
    Aabb::new(low - Vec3A::splat(margin), high + Vec3A::splat(margin))
}

impl core::fmt::Debug for Tree {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Tree")
            .field("nodes", &self.nodes.as_slice().len())
            .field("leaves", &self.leaves.len())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::geometry::ONE_BY_ONE;
    use crate::path::shape::Flat;

    /// Triangles in a cube of edge `size`, every fourth of them twice.
    fn triangles(count: u64, size: f32) -> Vec<Flat> {
        let corner = |triangle: u64, k: u64| {
            core::array::from_fn(|axis| {
                let word = |k| hash(triangle / 4 * 3 + triangle % 4 % 3, 8 * k + axis as u64);
                size * (unit_f32(word(0)) + 0.2 * unit_f32(word(k)))
            })
        };
        (0..count)
            .map(|triangle| Flat::triangle([1, 2, 3].map(|k| corner(triangle, k))).unwrap())
            .collect()
    }

    /// Rays through the cube; some run along the axes, with zeros of both signs.
    fn ray(index: u64, size: f32) -> Ray {
        let random = |k| unit_f32(hash(!index, k));
        let axes = [Vec3A::X, Vec3A::NEG_X, -Vec3A::Y, Vec3A::Z, -Vec3A::Z];
        let direction = match axes.get(usize::try_from(index % 8).unwrap()) {
            Some(&axis) => axis,
            None => Vec3A::new(random(0) - 0.5, random(1) - 0.5, random(2) - 0.5).normalize(),
        };
        Ray {
            origin: Vec3A::new(random(3), random(4), random(5)) * (1.2 * size),
            direction,
        }
    }

    #[test]
    fn a_tree_finds_what_a_look_at_every_shape_finds() {
        let mut met = 0;
        for (count, size) in [(1, 1.0), (9, 3.0), (400, 1.0), (400, 1e-15), (400, 1e15)] {
            let shapes = triangles(count, size);
            let tree = Tree::new(&shapes, ONE_BY_ONE);
            assert_eq!(tree.leaves().flatten().count(), shapes.len());
            for index in 0..2000 {
                let ray = ray(index, size);
                let limit = size * [0.3, f32::INFINITY][usize::from(index % 3 == 0)];
                let distances = shapes
                    .iter()
                    .filter_map(|shape| shape.intersect(&ray, limit));
                let expected = distances.min_by(f32::total_cmp);
                let found = tree.nearest(&shapes, &ray, limit);
                assert_eq!(
                    found.map(|found| found.distance),
                    expected,
                    "{count} {size} {ray:?}"
                );
                assert_eq!(tree.occluded(&shapes, &ray, limit), expected.is_some());
                met += usize::from(expected.is_some());
            }
        }
        assert!(met > 1000, "{met} rays meet something");
        let shapes = triangles(400, 1.0);
        let tree = Tree::new(&shapes, ONE_BY_ONE);
        for [x, y] in [[f32::NAN, 0.0], [0.0, f32::NAN]] {
            let ray = Ray {
                origin: Vec3A::splat(x),
                direction: Vec3A::splat(y),
            };
            assert!(tree.nearest(&shapes, &ray, 1.0).is_none());
            assert!(!tree.occluded(&shapes, &ray, 1.0));
        }
    }
}
