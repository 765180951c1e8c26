//! Values of meshes.

use glam::{Vec2, Vec3A};

use crate::Error;
use crate::path::{Facet, color};

/// Values that a mesh has: at its vertices, interpolated between them, or one for each of its triangles.
///
/// One component each or three. As a number, three components are their luminance. On any other shape than the mesh that it is of
/// it means nothing, and is that of the first triangle.
///
/// ```
/// use estimand::path::Facet;
/// use estimand::path::texture::Attribute;
/// use glam::Vec2;
///
/// let heat = Attribute::of_vertices(1, vec![0.0, 1.0, 4.0], vec![[0, 1, 2]])?;
/// let middle = Facet { triangle: 0, along: Vec2::new(0.5, 0.25) };
/// assert_eq!(heat.color_at(middle).x, 1.5);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    components: usize,
    values: Vec<f32>,
    /// The vertices of each triangle; empty if the values are those of triangles.
    corners: Vec<[u32; 3]>,
}

impl Attribute {
    /// Values of `components` numbers at each vertex, and the vertices of the triangles.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for another number of components than one or three, for one that is not finite, for values that are no
    /// whole number of vertices, for no triangle, and for a vertex that has no value.
    pub fn of_vertices(
        components: usize,
        values: Vec<f32>,
        corners: Vec<[u32; 3]>,
    ) -> Result<Self, Error> {
        let attribute = Self::new(components, values, corners)?;
        let count = attribute.values.len() / components;
        let missing = (attribute.corners.iter().flatten()).find(|&&index| index as usize >= count);
        if attribute.corners.is_empty() {
            return Err(Error::refused("number of triangles", "at least 1", 0));
        }
        match missing {
            None => Ok(attribute),
            Some(index) => Err(Error::refused(
                "vertex of an attribute",
                "one that has a value",
                format_args!("{index} of {count}"),
            )),
        }
    }

    /// Values of `components` numbers for each triangle.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for another number of components than one or three, for one that is not finite, and for values that
    /// are no whole number of triangles, at least one.
    pub fn of_triangles(components: usize, values: Vec<f32>) -> Result<Self, Error> {
        Self::new(components, values, Vec::new())
    }

    fn new(components: usize, values: Vec<f32>, corners: Vec<[u32; 3]>) -> Result<Self, Error> {
        if !matches!(components, 1 | 3) {
            let name = "number of components";
            return Err(Error::refused(name, "one or three", components));
        }
        if values.is_empty() || !values.len().is_multiple_of(components) {
            return Err(Error::refused(
                "number of values of an attribute",
                "a multiple of the number of components, at least once",
                format_args!("{} of {components}", values.len()),
            ));
        }
        match values.iter().find(|value| !value.is_finite()) {
            None => Ok(Self {
                components,
                values,
                corners,
            }),
            Some(value) => Err(Error::refused("value of an attribute", "finite", value)),
        }
    }

    /// That of a vertex or a triangle; black where there is none.
    #[inline]
    fn value(&self, index: usize) -> Vec3A {
        match self.values.get(index * self.components..) {
            Some(&[r, g, b, ..]) if self.components == 3 => Vec3A::new(r, g, b),
            Some(&[value, ..]) if self.components == 1 => Vec3A::splat(value),
            _ => Vec3A::ZERO,
        }
    }

    /// The value at a point of the mesh as linear red, green and blue.
    #[inline]
    pub fn color_at(&self, facet: Facet) -> Vec3A {
        if self.corners.is_empty() {
            return self.value(facet.triangle as usize);
        }
        let Some(corners) = self.corners.get(facet.triangle as usize) else {
            return Vec3A::ZERO;
        };
        let [a, b, c] = corners.map(|index| self.value(index as usize));
        let Vec2 { x: s, y: t } = facet.along;
        a * (1.0 - s - t) + (b * s + c * t)
    }

    /// The value at a point of the mesh as a number.
    #[inline]
    pub fn number_at(&self, facet: Facet) -> f32 {
        self.number(self.color_at(facet))
    }

    #[inline]
    fn number(&self, value: Vec3A) -> f32 {
        match self.components {
            1 => value.x,
            _ => value.dot(color::LUMINANCE),
        }
    }

    /// The mean number.
    pub fn mean(&self) -> f32 {
        let count = self.values.len() / self.components;
        let sum: f64 = (0..count)
            .map(|index| f64::from(self.number(self.value(index))))
            .sum();
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let mean = (sum / count as f64) as f32;
        mean
    }

    /// The least and the greatest component.
    pub fn range(&self) -> [f32; 2] {
        (self.values.iter()).fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &value| {
            [low.min(value), high.max(value)]
        })
    }
}
