//! Triangle meshes.

use glam::{Vec2, Vec3A};

use super::{Edges, Flat};
use crate::Error;
use crate::path::geometry::around;
use crate::path::{Facet, Shading};

/// Triangles that share vertices, with or without normals and texture coordinates at them.
///
/// Triangles without area can neither be hit nor shine: they are [dropped](Self::dropped).
///
/// ```
/// use estimand::path::shape::Mesh;
///
/// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3], [1, 1, 2]])?;
/// assert_eq!((mesh.triangles().len(), mesh.dropped()), (2, 1));
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    /// At each vertex, or none at all.
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    /// Which of the given triangles each is; empty if none was dropped.
    numbers: Vec<u32>,
    dropped: usize,
    /// Whether the outer side of the surface is that of clockwise corners.
    turned: bool,
}

impl Mesh {
    /// The mesh of some triangles, each given by the indices of its corners, counter-clockwise when seen from outside.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an index without a vertex, and for a corner that is not finite.
    pub fn new(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        let count = triangles.len();
        if u32::try_from(count).is_err() {
            return Err(Error::refused("number of triangles", "below 2^32", count));
        }
        let mut kept = triangles;
        let mut bad = None;
        let (mut number, mut numbers, mut dropping) = (0, Vec::new(), false);
        kept.retain(|corners| {
            number += 1;
            let corner = |index: u32| positions.get(index as usize).copied();
            let [Some(a), Some(b), Some(c)] = corners.map(corner) else {
                bad.get_or_insert_with(|| {
                    let given = format!("{corners:?} of {}", positions.len());
                    Error::refused("corners of a triangle", "indices of vertices", given)
                });
                return false;
            };
            let points = [a, b, c];
            if !points.iter().flatten().all(|x| x.is_finite()) {
                bad.get_or_insert_with(|| {
                    Error::refused("triangle", "finite", format!("{points:?}"))
                });
                return false;
            }
            let usable = Flat::triangle(points).is_ok();
            if !usable && !dropping {
                dropping = true;
                numbers.extend(0..number - 1);
            } else if usable && dropping {
                numbers.push(number - 1);
            }
            usable
        });
        match bad {
            Some(error) => Err(error),
            None => Ok(Self {
                dropped: count - kept.len(),
                positions,
                normals: Vec::new(),
                uvs: Vec::new(),
                triangles: kept,
                numbers,
                turned: false,
            }),
        }
    }

    /// The same with a normal at each vertex, interpolated between them. They need not have length 1.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for another number of them than there are vertices, and for one that is not finite.
    pub fn with_normals(mut self, normals: Vec<[f32; 3]>) -> Result<Self, Error> {
        self.one_each("normals", normals.len())?;
        finite("normal", &normals)?;
        self.normals = normals;
        Ok(self)
    }

    /// The same with texture coordinates at each vertex, interpolated between them.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for another number of them than there are vertices, and for one that is not finite.
    pub fn with_uvs(mut self, uvs: Vec<[f32; 2]>) -> Result<Self, Error> {
        self.one_each("texture coordinates", uvs.len())?;
        finite("texture coordinate", &uvs)?;
        self.uvs = uvs;
        Ok(self)
    }

    /// The same surface with the outer side, and normals, on the other side.
    #[must_use]
    pub fn turned(mut self) -> Self {
        self.turned = !self.turned;
        self
    }

    /// Whether it knows neither normals nor texture coordinates of its corners.
    pub(in crate::path) const fn is_plain(&self) -> bool {
        self.normals.is_empty() && self.uvs.is_empty()
    }

    /// The corners of the triangles, as indices of vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// How many triangles had no area.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// The corners of a box around all vertices.
    pub(in crate::path) fn bounds(&self) -> [Vec3A; 2] {
        around((self.positions.iter()).map(|&position| [Vec3A::from(position); 2]))
    }

    /// The triangle as a shape of its own.
    pub(in crate::path) fn flat(&self, triangle: usize) -> Flat {
        let corners = self.triangles[triangle].map(|index| self.positions[index as usize]);
        let flat = Flat::triangle(corners).expect("triangles without area are dropped");
        if self.turned { flat.turned() } else { flat }
    }

    /// Where a triangle is, as it was before any turning.
    #[inline]
    pub(in crate::path) fn edges(&self, triangle: usize) -> Edges {
        let [corner, second, third] =
            self.triangles[triangle].map(|index| Vec3A::from(self.positions[index as usize]));
        Edges {
            corner,
            first: second - corner,
            second: third - corner,
        }
    }

    /// Whether the outer side is that of clockwise corners.
    pub(in crate::path) const fn is_turned(&self) -> bool {
        self.turned
    }

    /// The texture coordinates at the corners of a triangle.
    pub(in crate::path) fn uvs(&self, triangle: usize) -> [Vec2; 3] {
        if self.uvs.is_empty() {
            return [Vec2::ZERO, Vec2::X, Vec2::Y];
        }
        self.triangles[triangle].map(|index| Vec2::from(self.uvs[index as usize]))
    }

    /// The parametrisation at the point of a triangle with the coordinates `along` its edges; the triangle has the normal `plain`.
    pub(in crate::path) fn shading(&self, triangle: usize, plain: Vec3A, along: Vec2) -> Shading {
        let Edges {
            first: du,
            second: dv,
            ..
        } = self.edges(triangle);
        let facet = Facet {
            triangle: match self.numbers.get(triangle) {
                Some(&number) => number,
                None => number(triangle),
            },
            along,
        };
        let mut shading = Shading {
            uv: along,
            normal: self.normal(triangle, plain, along),
            du,
            dv,
            facet,
        };
        if !self.uvs.is_empty() {
            let [a, b, c] = self.uvs(triangle);
            let (first, second) = (b - a, c - a);
            shading.uv = a + first * along.x + second * along.y;
            let area = first.perp_dot(second);
            let inverse = if area == 0.0 { 0.0 } else { area.recip() };
            shading.du = (du * second.y - dv * first.y) * inverse;
            shading.dv = (dv * first.x - du * second.x) * inverse;
        }
        shading
    }

    /// The normal that light is scattered by there.
    #[inline]
    pub(in crate::path) fn normal(&self, triangle: usize, plain: Vec3A, along: Vec2) -> Vec3A {
        if self.normals.is_empty() {
            return plain;
        }
        let [s, t] = along.to_array();
        let [a, b, c] =
            self.triangles[triangle].map(|index| Vec3A::from(self.normals[index as usize]));
        let side = if self.turned { -1.0 } else { 1.0 };
        let normal = (a * (1.0 - s - t) + (b * s + c * t)) * side;
        // Normals that cancel one another say nothing.
        normal.try_normalize().unwrap_or(plain)
    }

    fn one_each(&self, name: &'static str, count: usize) -> Result<(), Error> {
        if count == self.positions.len() {
            return Ok(());
        }
        Err(Error::refused(
            name,
            "one for each vertex",
            format_args!("{count} for {}", self.positions.len()),
        ))
    }
}

/// The number of a triangle: there are fewer than 2^32.
fn number(triangle: usize) -> u32 {
    u32::try_from(triangle).unwrap_or(u32::MAX)
}

fn finite<const N: usize>(name: &'static str, vectors: &[[f32; N]]) -> Result<(), Error> {
    match vectors
        .iter()
        .find(|vector| !vector.iter().all(|x| x.is_finite()))
    {
        None => Ok(()),
        Some(vector) => Err(Error::refused(name, "finite", format_args!("{vector:?}"))),
    }
}
