//! The triangles of all meshes.

#[cfg(feature = "simd")]
pub(in crate::path) mod together;

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3A};

use super::Hit;
use super::collapse::Cost;
use super::flats::{Flats, LANES};
use super::node::Child;
use super::pages::Pages;
use super::probe::Probe;
use super::tree::{InLeaf, Leaves, Tree};
use crate::path::Shading;
use crate::path::ray::{Ray, Surface};
use crate::path::shape::{Flat, Mesh, Shape};

/// The triangles of some meshes, one mesh after the other, and a tree around them.
#[derive(Debug)]
pub(in crate::path) struct Soup {
    meshes: Vec<Mesh>,
    /// The number of triangles before each mesh.
    starts: Vec<usize>,
    tree: Tree,
    /// Those of each leaf of the tree.
    blocks: Pages<Block>,
    bounds: [Vec3A; 2],
}

/// The triangles of a leaf, and their numbers: eight lines of a cache.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
struct Block {
    flats: Flats,
    numbers: [u32; LANES],
}

/// All triangles of a leaf are asked at once, as the boxes of a node are.
const BLOCK: Cost = Cost {
    node: 1.0,
    leaf: 1.0,
    shape: 0.0,
};

impl Block {
    /// The triangles of the given numbers, at most eight.
    fn new(flats: &[Flat], leaf: impl Iterator<Item = usize>) -> Self {
        let mut block = Self {
            flats: Flats::default(),
            numbers: [0; LANES],
        };
        for (lane, triangle) in leaf.enumerate() {
            block.flats.set(lane, &flats[triangle]);
            block.numbers[lane] =
                u32::try_from(triangle).expect("a tree has fewer than 2^32 triangles");
        }
        block
    }
}

/// A triangle that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Struck {
    /// The number among all triangles.
    pub(super) triangle: usize,
    /// Of the mesh that it belongs to.
    pub(super) mesh: usize,
    pub(super) distance: f32,
    pub(super) surface: Surface,
    pub(super) along: Vec2,
}

impl Soup {
    /// The triangles of the meshes; `None` if there are none.
    pub(super) fn new(meshes: Vec<Mesh>) -> Option<Self> {
        let mut flats = Vec::with_capacity(meshes.iter().map(|mesh| mesh.triangles().len()).sum());
        let mut starts = Vec::with_capacity(meshes.len());
        for mesh in &meshes {
            starts.push(flats.len());
            flats.extend((0..mesh.triangles().len()).map(|triangle| mesh.flat(triangle)));
        }
        let tree = (!flats.is_empty()).then(|| Tree::new(&flats, BLOCK))?;
        let blocks = Pages::new(tree.leaves().map(|leaf| Block::new(&flats, leaf)));
        let bounds = super::around(flats.iter().map(Shape::bounds));
        Some(Self {
            bounds,
            meshes,
            starts,
            tree,
            blocks,
        })
    }

    pub(super) fn bounds(&self) -> [Vec3A; 2] {
        self.bounds
    }

    #[cfg(feature = "simd")]
    pub(super) fn boxes(&self) -> impl Iterator<Item = [Vec3A; 2]> {
        self.tree.boxes()
    }

    /// The triangle that a ray meets first, if it is nearer than `limit`.
    #[inline]
    pub(super) fn nearest(&self, ray: &Ray, limit: f32) -> Option<InLeaf> {
        let mut leaves = Blocks::new(self.blocks.as_slice());
        self.tree
            .nearest_in_leaves(Child::ROOT, ray, limit, &mut leaves)
    }

    /// More of what a ray meets.
    #[inline]
    pub(super) fn struck(&self, ray: &Ray, met: InLeaf) -> Struck {
        let InLeaf {
            leaf,
            lane,
            distance,
        } = met;
        let block = &self.blocks.as_slice()[leaf];
        let triangle = block.numbers[lane] as usize;
        let mesh = self.mesh(triangle);
        let edges = self.meshes[mesh].edges(triangle - self.starts[mesh]);
        let turned = self.meshes[mesh].is_turned();
        let (surface, along) = block.flats.surface(lane, &edges, turned, ray, distance);
        Struck {
            triangle,
            mesh,
            distance,
            surface,
            along,
        }
    }

    #[inline]
    pub(super) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        let mut leaves = Blocks::new(self.blocks.as_slice());
        self.tree
            .any_in_leaves(Child::ROOT, ray, limit, &mut leaves)
    }

    /// Which of the meshes a triangle belongs to.
    #[inline]
    fn mesh(&self, triangle: usize) -> usize {
        self.starts.partition_point(|&start| start <= triangle) - 1
    }

    /// The normal that light is scattered by at a point of a triangle of a mesh.
    #[cfg(feature = "simd")]
    #[inline]
    pub(super) fn normal(&self, mesh: usize, hit: &Hit) -> Vec3A {
        let triangle = hit.triangle - self.starts[mesh];
        self.meshes[mesh].normal(triangle, hit.surface.normal, hit.along)
    }

    pub(super) fn shading(&self, hit: &Hit) -> Shading {
        let mesh = self.mesh(hit.triangle);
        let triangle = hit.triangle - self.starts[mesh];
        self.meshes[mesh].shading(triangle, hit.surface.normal, hit.along)
    }
}

/// The triangles of each leaf.
struct Blocks<'a> {
    blocks: &'a [Block],
    /// The leaf of the nearest triangle so far.
    nearest: usize,
}

impl<'a> Blocks<'a> {
    #[inline(always)]
    fn new(blocks: &'a [Block]) -> Self {
        Self { blocks, nearest: 0 }
    }
}

impl Leaves for Blocks<'_> {
    /// Of several triangles at the same distance that of the leaf of the least number is the nearest, and of those the first, in whatever order leaves
    /// are visited.
    #[inline(always)]
    fn nearest(&mut self, probe: &impl Probe, leaf: usize, limit: f32) -> Option<(usize, f32)> {
        let limit = if leaf < self.nearest {
            limit.next_up()
        } else {
            limit
        };
        let met = probe.meet(&self.blocks[leaf].flats, limit).nearest()?;
        self.nearest = leaf;
        Some(met)
    }

    #[inline(always)]
    fn any(&mut self, probe: &impl Probe, leaf: usize, limit: f32) -> bool {
        probe.meet(&self.blocks[leaf].flats, limit).which != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, unit_f32};

    fn vector(seed: u64) -> [f32; 3] {
        core::array::from_fn(|axis| unit_f32(hash(seed, axis as u64)) - 0.5)
    }

    #[test]
    fn a_triangle_is_hit_where_its_shape_is() {
        let mesh = |first: u64| {
            let triangles = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            Mesh::new((first..first + 300).map(vector).collect(), triangles).unwrap()
        };
        let meshes = vec![mesh(0), mesh(300).turned()];
        let soup = Soup::new(meshes.clone()).unwrap();
        let mut met = [0, 0];
        for seed in 0..1000 {
            let ray = Ray {
                origin: Vec3A::from(vector(1000 + seed)),
                direction: Vec3A::from(vector(3000 + seed)).normalize(),
            };
            let Some(first) = soup.nearest(&ray, f32::INFINITY) else {
                continue;
            };
            let struck = soup.struck(&ray, first);
            let flat = meshes[struck.mesh].flat(struck.triangle - soup.starts[struck.mesh]);
            assert_eq!(flat.intersect(&ray, f32::INFINITY), Some(struck.distance));
            let surface = flat.surface(&ray, struck.distance);
            assert_eq!(struck.surface, surface);
            // Both are rounded.
            let along = flat.shading(&surface).uv;
            assert!(
                (struck.along - along).length() < 1e-3,
                "{} {along}",
                struck.along
            );
            met[struck.mesh] += 1;
        }
        assert!(met[0] > 200 && met[1] > 200, "{met:?}");
    }
}
