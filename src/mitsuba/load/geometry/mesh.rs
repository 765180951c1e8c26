//! Meshes.

use glam::{DMat3, DMat4, DVec3};

use super::Body;
use crate::mitsuba::load::surroundings::narrow;
use crate::mitsuba::{Mesh, MeshFile};
use crate::path::shape;

/// A mesh in the coordinates of the scene.
pub(super) fn place(mesh: Mesh, file: &MeshFile, to_world: &DMat4) -> Result<Body, String> {
    let Mesh {
        positions,
        normals,
        texture_coordinates,
        mut triangles,
        attributes: _,
    } = mesh;
    let moved: Vec<DVec3> = positions
        .iter()
        .map(|&position| to_world.transform_point3(widen(position)))
        .collect();
    let normals = if normals.is_empty() {
        match file.face_normals {
            true => Vec::new(),
            false => angle_weighted(&moved, &triangles),
        }
    } else {
        let outward = DMat3::from_mat4(*to_world).inverse().transpose();
        // The normals of a file decide which side is the outer one; where a transform mirrors, the corners change sides.
        if to_world.determinant() < 0.0 {
            triangles
                .iter_mut()
                .for_each(|triangle| triangle.swap(1, 2));
        }
        normals
            .iter()
            .map(|&normal| (outward * widen(normal)).normalize_or_zero())
            .collect()
    };
    let smooth = is_smooth(&moved, &normals, &triangles);
    let refused = |e: crate::Error| e.to_string();
    let mut mesh =
        shape::Mesh::new(moved.into_iter().map(narrow).collect(), triangles).map_err(refused)?;
    if smooth {
        mesh = mesh
            .with_normals(normals.into_iter().map(narrow).collect())
            .map_err(refused)?;
    }
    if !texture_coordinates.is_empty() {
        mesh = mesh.with_uvs(texture_coordinates).map_err(refused)?;
    }
    if file.flip_normals {
        mesh = mesh.turned();
    }
    Ok(if smooth {
        Body::Smooth(mesh)
    } else {
        Body::Faceted(mesh)
    })
}

fn widen(vector: [f32; 3]) -> DVec3 {
    DVec3::from(vector.map(f64::from))
}

/// Whether a normal of a vertex differs from that of a triangle by more than rounding.
fn is_smooth(positions: &[DVec3], normals: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    !normals.is_empty()
        && triangles.iter().any(|triangle| {
            let [a, b, c] = triangle.map(|index| positions[index as usize]);
            let Some(flat) = (b - a).cross(c - a).try_normalize() else {
                return false;
            };
            triangle
                .iter()
                .any(|&index| !(flat.distance_squared(normals[index as usize]) < 1e-10))
        })
}

/// Normals at the vertices: those of the triangles around each, weighted by their angles at it.
///
/// Thürmer, G.; Wüthrich, C. A. (1998). Computing vertex normals from polygonal facets. *Journal of Graphics Tools* 3(1).
fn angle_weighted(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|index| positions[index as usize]);
        let [a, b, c] = corners;
        let Some(flat) = (b - a).cross(c - a).try_normalize() else {
            continue;
        };
        for corner in 0..3 {
            let here = corners[corner];
            let [next, last] = [1, 2].map(|step| corners[(corner + step) % 3] - here);
            normals[triangle[corner] as usize] += flat * next.angle_between(last);
        }
    }
    for normal in &mut normals {
        *normal = normal.normalize_or_zero();
    }
    normals
}
