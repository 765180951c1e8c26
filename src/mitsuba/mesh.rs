//! Triangles from files.

mod attributes;
mod obj;
mod ply;

use super::error::SceneError;
use super::shape::{MeshFile, MeshFormat};

/// Triangles as a file has them, in their own coordinates.
///
/// All indices are those of vertices, and all lists that are there have one entry for each vertex. Nothing is said of the
/// areas of triangles, which may be 0, and of the lengths of normals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Where the vertices are; all finite.
    pub positions: Vec<[f32; 3]>,
    /// The normals of the vertices; empty if there are none, or none are wanted.
    pub normals: Vec<[f32; 3]>,
    /// The texture coordinates of the vertices, with +v as Mitsuba has it; empty if there are none.
    pub texture_coordinates: Vec<[f32; 2]>,
    /// Three vertices each, anticlockwise as seen from the outer side.
    pub triangles: Vec<[u32; 3]>,
    /// What else there is.
    pub attributes: Vec<Attribute>,
}

/// Values of the vertices or the triangles of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The name by which textures ask for it, which begins with `vertex_` or `face_`.
    pub name: String,
    /// How many values each vertex or triangle has.
    pub channels: usize,
    /// The values, those of one vertex or triangle side by side.
    pub values: Vec<f32>,
}

/// Vertices or triangles may be counted by 32-bit numbers.
const MOST: usize = u32::MAX as usize;

impl MeshFile {
    /// Reads the file.
    ///
    /// # Errors
    ///
    /// [`SceneError`] if it cannot be read, is not of its format, has polygons with more than three corners as PLY (those of
    /// an OBJ are split), indices of vertices that are not there, or coordinates that are not finite.
    pub fn load(&self) -> Result<Mesh, SceneError> {
        let mut mesh = match self.format {
            MeshFormat::Obj => obj::read(&self.file),
            MeshFormat::Ply => ply::read(&self.file),
        }
        .map_err(|reason| SceneError::file(&self.file, reason))?;
        let refuse = |message: String| Err(SceneError::file(&self.file, message));
        if mesh.positions.len() > MOST || mesh.triangles.len() > MOST {
            return refuse("more than 2^32 vertices or triangles".to_owned());
        }
        let count = mesh.positions.len();
        if let Some(triangle) = mesh
            .triangles
            .iter()
            .find(|triangle| triangle.iter().any(|&index| index as usize >= count))
        {
            return refuse(format!(
                "a triangle of the vertices {triangle:?}, of which there are only {count}"
            ));
        }
        if let Some(position) = mesh
            .positions
            .iter()
            .find(|position| position.iter().any(|x| !x.is_finite()))
        {
            return refuse(format!("a vertex at {position:?}, which is not finite"));
        }
        if self.face_normals {
            mesh.normals.clear();
        }
        if self.flip_tex_coords {
            for [_, v] in &mut mesh.texture_coordinates {
                *v = 1.0 - *v;
            }
        }
        Ok(mesh)
    }
}
