//! All shapes of a scene, and which of them a ray meets.

mod sweep;
mod tree;

use super::Shading;
use super::ray::{Ray, Surface};
use super::shape::{Primitive, Shape};

use sweep::Sweep;
use tree::Tree;

/// The shapes of a scene, and a way to find them.
#[derive(Debug)]
pub(in crate::path) struct Geometry {
    shapes: Vec<Primitive>,
    search: Search,
}

/// How the shapes that a ray meets are found.
#[derive(Debug)]
enum Search {
    /// By looking at all of them.
    Sweep(Sweep),
    /// By boxes around groups of them.
    Tree(Tree),
}

/// A shape at a distance along a ray.
#[derive(Clone, Copy, Debug)]
struct Found {
    shape: usize,
    distance: f32,
}

/// The nearest shape that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Hit {
    pub(in crate::path) shape: usize,
    pub(in crate::path) surface: Surface,
}

/// Up to so many shapes are swept over: there a sweep of vectors is faster than a tree.
const FEW: usize = 48;

impl Geometry {
    pub(in crate::path) fn new(shapes: Vec<Primitive>) -> Self {
        let search = if shapes.len() <= FEW {
            Search::Sweep(Sweep::new(&shapes))
        } else {
            Search::Tree(Tree::new(&shapes))
        };
        Self { shapes, search }
    }

    /// The first shape that the ray meets.
    #[inline]
    pub(in crate::path) fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let Found { shape, distance } = match &self.search {
            Search::Sweep(sweep) => sweep.nearest(ray),
            Search::Tree(tree) => tree.nearest(&self.shapes, ray),
        }?;
        let surface = self.shapes[shape].surface(ray, distance);
        Some(Hit { shape, surface })
    }

    /// The parametrisation of a shape at a point of it.
    #[inline]
    pub(in crate::path) fn shading(&self, hit: &Hit) -> Shading {
        self.shapes[hit.shape].shading(&hit.surface)
    }

    /// Whether the ray meets any shape nearer than `limit`.
    #[inline]
    pub(in crate::path) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        match &self.search {
            Search::Sweep(sweep) => sweep.occluded(ray, limit),
            Search::Tree(tree) => tree.occluded(&self.shapes, ray, limit),
        }
    }
}
