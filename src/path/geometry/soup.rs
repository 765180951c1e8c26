//! The triangles of all meshes.

use glam::Vec3A;

use super::Found;
use super::flats::Flats;
use super::probe::Probe;
use super::tree::{Leaves, Tree};
use crate::path::Shading;
use crate::path::ray::{Ray, Surface};
use crate::path::shape::{Flat, Mesh, Shape};

/// The triangles of some meshes, one mesh after the other, and a tree around them.
#[derive(Debug)]
pub(super) struct Soup {
    meshes: Vec<Mesh>,
    /// The number of triangles before each mesh.
    starts: Vec<usize>,
    flats: Vec<Flat>,
    tree: Tree,
    /// Those of each leaf of the tree.
    blocks: Vec<Flats>,
    bounds: [Vec3A; 2],
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
        let tree = (!flats.is_empty()).then(|| Tree::new(&flats))?;
        let blocks = tree
            .leaves()
            .flat_map(|leaf| Flats::blocks(leaf.map(|triangle| &flats[triangle])))
            .collect();
        let bounds = super::around(flats.iter().map(Shape::bounds));
        Some(Self {
            bounds,
            meshes,
            starts,
            flats,
            tree,
            blocks,
        })
    }

    pub(super) fn bounds(&self) -> [Vec3A; 2] {
        self.bounds
    }

    #[inline]
    pub(super) fn nearest(&self, ray: &Ray, limit: f32) -> Option<Found> {
        let mut leaves = Blocks(&self.blocks);
        self.tree.nearest_in_leaves(ray, limit, &mut leaves)
    }

    #[inline]
    pub(super) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        let mut leaves = Blocks(&self.blocks);
        self.tree.any_in_leaves(ray, limit, &mut leaves)
    }

    #[inline]
    pub(super) fn surface(&self, triangle: usize, ray: &Ray, distance: f32) -> Surface {
        self.flats[triangle].surface(ray, distance)
    }

    /// Which of the meshes a triangle belongs to.
    #[inline]
    pub(super) fn mesh(&self, triangle: usize) -> usize {
        self.starts.partition_point(|&start| start <= triangle) - 1
    }

    /// The normal that light is scattered by at a point of a triangle.
    #[cfg(feature = "simd")]
    #[inline]
    pub(super) fn normal(&self, mesh: usize, triangle: usize, surface: &Surface) -> Vec3A {
        let within = triangle - self.starts[mesh];
        self.meshes[mesh].normal(within, &self.flats[triangle], surface)
    }

    pub(super) fn shading(&self, triangle: usize, surface: &Surface) -> Shading {
        let mesh = self.mesh(triangle);
        let within = triangle - self.starts[mesh];
        self.meshes[mesh].shading(within, &self.flats[triangle], surface)
    }
}

/// The triangles of each leaf.
struct Blocks<'a>(&'a [Flats]);

impl Leaves for Blocks<'_> {
    #[inline(always)]
    fn nearest(&mut self, probe: &impl Probe, leaf: usize, limit: f32) -> Option<(usize, f32)> {
        probe.meet(&self.0[leaf], limit).nearest()
    }

    #[inline(always)]
    fn any(&mut self, probe: &impl Probe, leaf: usize, limit: f32) -> bool {
        probe.meet(&self.0[leaf], limit).which != 0
    }
}
