//! All shapes of a scene, and which of them a ray meets.

mod balls;
mod collapse;
mod copies;
mod flats;
mod kind;
mod node;
mod pages;
mod probe;
mod soup;
mod stack;
mod sweep;
mod tree;

use glam::{Vec2, Vec3A};

use super::Shading;
use super::ray::{Ray, Surface};
use super::shape::{Mesh, Primitive, Shape};

use collapse::Cost;
pub(in crate::path) use copies::Copied;
use copies::Copies;
#[cfg(feature = "simd")]
pub(in crate::path) use kind::{Kind, axis};
#[cfg(feature = "simd")]
pub(in crate::path) use probe::Inverted;
pub(in crate::path) use soup::Soup;
#[cfg(feature = "simd")]
pub(in crate::path) use soup::together::{Rays, Triangles};
use sweep::Sweep;
pub(in crate::path) use tree::InLeaf;
use tree::Tree;

/// The shapes of a scene, and a way to find them.
#[derive(Debug)]
pub(in crate::path) struct Geometry {
    shapes: Vec<Primitive>,
    search: Search,
    soup: Option<Soup>,
    copies: Option<Copies>,
    bounds: [Vec3A; 2],
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
pub(in crate::path) struct Found {
    pub(in crate::path) shape: usize,
    pub(in crate::path) distance: f32,
}

/// The nearest shape that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Hit {
    /// Which part of the scene: the shapes come first, then the meshes, then the parts of groups that are copied.
    pub(in crate::path) part: usize,
    pub(in crate::path) surface: Surface,
    /// Which triangle of all meshes, if it is one.
    pub(in crate::path) triangle: usize,
    /// The coordinates along the edges of the triangle.
    pub(in crate::path) along: Vec2,
    /// Which copy, if it is one.
    pub(in crate::path) copy: Option<usize>,
}

/// Up to so many shapes are swept over: there a sweep of vectors is faster than a tree, above all where many paths go at once.
pub(in crate::path) const FEW: usize = 128;

/// Shapes of any kind are asked one after the other: two take as long as eight boxes.
const ONE_BY_ONE: Cost = Cost {
    node: 1.0,
    leaf: 0.0,
    shape: 0.5,
};

/// The smallest box around boxes.
pub(in crate::path) fn around(boxes: impl Iterator<Item = [Vec3A; 2]>) -> [Vec3A; 2] {
    let nothing = [Vec3A::INFINITY, Vec3A::NEG_INFINITY];
    boxes.fold(nothing, |[low, high], [l, h]| [low.min(l), high.max(h)])
}

impl Geometry {
    pub(in crate::path) fn new(
        shapes: Vec<Primitive>,
        meshes: Vec<Mesh>,
        copies: Vec<Copied>,
    ) -> Self {
        let (soup, copies) = (Soup::new(meshes), Copies::new(copies));
        let soups = soup.iter().map(Soup::bounds);
        let others: Vec<_> = soups.chain(copies.iter().map(Copies::bounds)).collect();
        let search = if shapes.len() <= FEW {
            Search::Sweep(Sweep::new(&shapes, &others))
        } else {
            Search::Tree(Tree::new(&shapes, ONE_BY_ONE))
        };
        let bounds = around(shapes.iter().map(Shape::bounds).chain(others));
        Self {
            shapes,
            search,
            soup,
            copies,
            bounds,
        }
    }

    /// The corners of a box around everything.
    pub(in crate::path) fn bounds(&self) -> [Vec3A; 2] {
        self.bounds
    }

    /// The first shape that the ray meets.
    #[inline]
    pub(in crate::path) fn nearest(&self, ray: &Ray) -> Option<Hit> {
        if self.soup.is_none() && self.copies.is_none() {
            return self.nearest_shape(ray, f32::INFINITY).map(|(hit, _)| hit);
        }
        self.nearest_within(ray, f32::INFINITY).map(|(hit, _)| hit)
    }

    /// The first shape that the ray meets before `limit`, and its distance.
    fn nearest_within(&self, ray: &Ray, limit: f32) -> Option<(Hit, f32)> {
        let nearest = self.nearest_shape(ray, limit);
        let limit = nearest.map_or(limit, |(_, distance)| distance);
        let triangle = self.nearest_triangle(ray, limit);
        self.nearest_beside(ray, limit, triangle).or(nearest)
    }

    /// The first triangle of a mesh that the ray meets before `limit`.
    #[inline]
    pub(in crate::path) fn nearest_triangle(&self, ray: &Ray, limit: f32) -> Option<InLeaf> {
        self.soup.as_ref()?.nearest(ray, limit)
    }

    /// That triangle, or a shape of a copy if the ray meets one before, and the distance.
    #[inline]
    pub(in crate::path) fn nearest_beside(
        &self,
        ray: &Ray,
        mut limit: f32,
        triangle: Option<InLeaf>,
    ) -> Option<(Hit, f32)> {
        let mut nearest = None;
        if let (Some(soup), Some(met)) = (&self.soup, triangle) {
            let struck = soup.struck(ray, met);
            limit = struck.distance;
            let hit = Hit {
                part: self.shapes.len() + struck.mesh,
                surface: struck.surface,
                triangle: struck.triangle,
                along: struck.along,
                copy: None,
            };
            nearest = Some((hit, limit));
        }
        let copies = self.copies.as_ref();
        copies
            .and_then(|copies| copies.nearest(ray, limit))
            .or(nearest)
    }

    #[inline]
    fn nearest_shape(&self, ray: &Ray, limit: f32) -> Option<(Hit, f32)> {
        let Found { shape, distance } = match &self.search {
            Search::Sweep(sweep) => sweep.nearest(ray).filter(|found| found.distance < limit),
            Search::Tree(tree) => tree.nearest(&self.shapes, ray, limit),
        }?;
        Some((self.hit(ray, shape, distance), distance))
    }

    #[inline]
    fn hit(&self, ray: &Ray, shape: usize, distance: f32) -> Hit {
        Hit {
            part: shape,
            surface: self.shapes[shape].surface(ray, distance),
            triangle: 0,
            along: Vec2::ZERO,
            copy: None,
        }
    }

    /// The parametrisation of a shape at a point of it.
    pub(in crate::path) fn shading(&self, hit: &Hit) -> Shading {
        if let (Some(copy), Some(copies)) = (hit.copy, &self.copies) {
            return copies.shading(copy, hit);
        }
        match (self.shapes.get(hit.part), &self.soup) {
            (Some(shape), _) => shape.shading(&hit.surface),
            (None, Some(soup)) => soup.shading(hit),
            (None, None) => unreachable!("a hit is of a shape or of a mesh"),
        }
    }

    /// The shapes.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn shapes(&self) -> &[Primitive] {
        &self.shapes
    }

    /// The sweep over the shapes, if they are few.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn sweep(&self) -> Option<&Sweep> {
        match &self.search {
            Search::Sweep(sweep) => Some(sweep),
            Search::Tree(_) => None,
        }
    }

    /// Boxes: a ray that meets a triangle of a mesh or a copy enters one of them, made [wider](WIDER).
    #[cfg(feature = "simd")]
    pub(in crate::path) fn boxes_beside(&self) -> Vec<[Vec3A; 2]> {
        let soup = self.soup.iter().flat_map(Soup::boxes);
        soup.chain(self.copies.iter().flat_map(Copies::boxes))
            .collect()
    }

    /// The normal that light is scattered by, for laws that heed interpolated ones.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn normal(&self, hit: &Hit) -> Vec3A {
        if hit.copy.is_some() {
            return self.shading(hit).normal;
        }
        match (hit.part.checked_sub(self.shapes.len()), &self.soup) {
            (Some(mesh), Some(soup)) => soup.normal(mesh, hit),
            _ => hit.surface.normal,
        }
    }

    /// Whether any shape is in the way from one point of the scene to another, at `limit`.
    #[inline]
    pub(in crate::path) fn divided(&self, ray: &Ray, limit: f32) -> bool {
        let shapes = match &self.search {
            Search::Sweep(sweep) => sweep.divided(ray, limit),
            Search::Tree(tree) => tree.occluded(&self.shapes, ray, limit),
        };
        shapes || self.occluded_beside(ray, limit)
    }

    /// Whether the ray meets any shape nearer than `limit`.
    #[inline]
    pub(in crate::path) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        let shapes = match &self.search {
            Search::Sweep(sweep) => sweep.occluded(ray, limit),
            Search::Tree(tree) => tree.occluded(&self.shapes, ray, limit),
        };
        shapes || self.occluded_beside(ray, limit)
    }

    /// Whether the ray meets a triangle of a mesh or a copy nearer than `limit`.
    #[inline]
    pub(in crate::path) fn occluded_beside(&self, ray: &Ray, limit: f32) -> bool {
        let soup = |soup: &Soup| soup.occluded(ray, limit);
        let copies = |copies: &Copies| copies.occluded(ray, limit);
        self.soup.as_ref().is_some_and(soup) || self.copies.as_ref().is_some_and(copies)
    }

    /// The triangles of all meshes.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn soup(&self) -> Option<&Soup> {
        self.soup.as_ref()
    }

    /// Whether there are any copies.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn has_copies(&self) -> bool {
        self.copies.is_some()
    }
}
