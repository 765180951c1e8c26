//! Copies of groups of shapes.

use std::sync::Arc;

use glam::{Affine3A, Mat3A, Vec3A};

use super::collapse::Cost;
use super::tree::Tree;
use super::{Geometry, Hit, around};
use crate::Error;
use crate::path::Shading;
use crate::path::ray::{Ray, Surface, gamma};

/// Copies of groups of shapes, each moved, turned and scaled as a whole, and a tree around them.
#[derive(Debug)]
pub(super) struct Copies {
    copies: Vec<Copied>,
    tree: Tree,
}

/// In a copy a ray walks through a tree again.
const COPY: Cost = Cost {
    node: 1.0,
    leaf: 0.0,
    shape: 4.0,
};

/// A group of shapes in another place.
#[derive(Clone, Debug)]
pub(in crate::path) struct Copied {
    group: Arc<Geometry>,
    /// The number of parts of the scene before those of the group.
    start: usize,
    outward: Affine3A,
    inward: Affine3A,
    /// The transpose of the inverse, for normals.
    normals: Mat3A,
}

impl Copied {
    /// The group as the map `outward` places it.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a map that cannot be inverted in `f32`.
    pub(in crate::path) fn new(
        group: Arc<Geometry>,
        start: usize,
        outward: Affine3A,
    ) -> Result<Self, Error> {
        let inward = outward.inverse();
        if !(outward.is_finite() && inward.is_finite()) {
            return Err(Error::refused(
                "placing of a copy",
                "a finite map that can be inverted",
                outward,
            ));
        }
        Ok(Self {
            group,
            start,
            outward,
            inward,
            normals: inward.matrix3.transpose(),
        })
    }

    /// The ray as the group sees it, and how many of its units are one of the scene along it.
    #[inline]
    fn inward(&self, ray: &Ray) -> (Ray, f32) {
        let direction = self.inward.transform_vector3a(ray.direction);
        let scale = direction.length();
        let ray = Ray {
            origin: self.inward.transform_point3a(ray.origin),
            direction: direction / scale,
        };
        (ray, scale)
    }

    /// A point of the group's surface as the scene sees it.
    fn outward(&self, surface: &Surface) -> Surface {
        let point = self.outward.transform_point3a(surface.point);
        let normal = (self.normals * surface.normal).normalize();
        let matrix = self.outward.matrix3.abs();
        // What rounding does to the map, and the margin of the group, at most so much longer.
        let extent = matrix * surface.point.abs() + self.outward.translation.abs();
        let stretch = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(Vec3A::length);
        let margin = surface.margin * stretch.iter().sum::<f32>()
            + 2.0 * gamma(8) * (extent + point.abs()).dot(normal.abs());
        Surface {
            point,
            normal,
            margin,
            detail: (),
        }
    }

    /// The corners of the box around the group, and where they are put.
    fn corners(&self) -> impl Iterator<Item = [Vec3A; 2]> {
        let [low, high] = self.group.bounds();
        (0..8).map(move |corner| {
            let pick =
                |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 0 { low } else { high };
            let corner = Vec3A::new(
                pick(0, low.x, high.x),
                pick(1, low.y, high.y),
                pick(2, low.z, high.z),
            );
            [corner, self.outward.transform_point3a(corner)]
        })
    }

    /// The corners of a box around the copy, up to rounding.
    pub(in crate::path) fn extent(&self) -> [Vec3A; 2] {
        around(self.corners().map(|[_, point]| [point; 2]))
    }

    /// The corners of a box around the copy.
    fn bounds(&self) -> [Vec3A; 2] {
        around(self.corners().map(|[corner, point]| {
            let matrix = self.outward.matrix3.abs();
            let slack = (matrix * corner.abs() + self.outward.translation.abs()) * gamma(16);
            [point - slack, point + slack]
        }))
    }
}

impl Copies {
    /// The copies; `None` if there are none.
    pub(super) fn new(copies: Vec<Copied>) -> Option<Self> {
        if copies.is_empty() {
            return None;
        }
        let bounds: Vec<_> = copies.iter().map(Copied::bounds).collect();
        let tree = Tree::around(&bounds, COPY);
        Some(Self { copies, tree })
    }

    pub(super) fn bounds(&self) -> [Vec3A; 2] {
        around(self.copies.iter().map(Copied::bounds))
    }

    #[cfg(feature = "simd")]
    pub(super) fn boxes(&self) -> impl Iterator<Item = [Vec3A; 2]> {
        self.tree.boxes()
    }

    pub(super) fn nearest(&self, ray: &Ray, limit: f32) -> Option<(Hit, f32)> {
        let mut nearest = None;
        let found = self.tree.search(ray, limit, |copy, limit| {
            let copied = &self.copies[copy];
            let (inward, scale) = copied.inward(ray);
            let (hit, distance) = copied.group.nearest_within(&inward, limit * scale)?;
            let distance = distance / scale;
            if distance >= limit {
                return None;
            }
            nearest = Some((copy, hit));
            Some(distance)
        })?;
        let (copy, hit) = nearest?;
        let copied = &self.copies[copy];
        let hit = Hit {
            part: copied.start + hit.part,
            surface: copied.outward(&hit.surface),
            copy: Some(copy),
            ..hit
        };
        Some((hit, found.distance))
    }

    pub(super) fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        self.tree.meets(ray, limit, |copy, limit| {
            let copied = &self.copies[copy];
            let (inward, scale) = copied.inward(ray);
            copied.group.occluded(&inward, limit * scale)
        })
    }

    /// The parametrisation of a copy at a point of the scene.
    pub(super) fn shading(&self, copy: usize, hit: &Hit) -> Shading {
        let copied = &self.copies[copy];
        let inside = Hit {
            part: hit.part - copied.start,
            surface: Surface {
                point: copied.inward.transform_point3a(hit.surface.point),
                normal: (copied.outward.matrix3.transpose() * hit.surface.normal).normalize(),
                ..hit.surface
            },
            copy: None,
            ..*hit
        };
        let shading = copied.group.shading(&inside);
        // The plain normal is there already, without what rounding does on the way in and out.
        let normal = if shading.normal == inside.surface.normal {
            hit.surface.normal
        } else {
            (copied.normals * shading.normal).normalize()
        };
        Shading {
            uv: shading.uv,
            normal,
            du: copied.outward.transform_vector3a(shading.du),
            dv: copied.outward.transform_vector3a(shading.dv),
            facet: shading.facet,
        }
    }
}
