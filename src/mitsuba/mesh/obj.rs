//! Wavefront OBJ.
//!
//! Read by ourselves: Mitsuba takes all groups for one mesh and joins the corners that name the same position, texture
//! coordinate and normal, which decides where surfaces are smooth. `tobj` joins within groups alone; `obj-rs` panics at what it
//! does not know.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::Mesh;

/// Which position, texture coordinate and normal a corner has, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Corner {
    position: usize,
    coordinates: Option<usize>,
    normal: Option<usize>,
}

/// What has been read so far.
#[derive(Debug, Default)]
struct Lists {
    positions: Vec<[f32; 3]>,
    coordinates: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    vertices: HashMap<Corner, u32>,
    triangles: Vec<[u32; 3]>,
}

/// Reads an OBJ file: vertices and faces; all else is for others.
pub(super) fn read(path: &Path) -> Result<Mesh, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let mut lists = Lists::default();
    let mut line = String::new();
    for number in 1_u64.. {
        line.clear();
        if reader.read_line(&mut line).map_err(|e| e.to_string())? == 0 {
            break;
        }
        lists
            .add(&line)
            .map_err(|reason| format!("line {number}: {reason}"))?;
    }
    lists.mesh()
}

impl Lists {
    fn add(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => self.positions.push(numbers(words)?),
            Some("vt") => self.coordinates.push(numbers(words)?),
            Some("vn") => self.normals.push(numbers(words)?),
            Some("f") => self.face(words)?,
            _ => {}
        }
        Ok(())
    }

    /// A polygon as a fan of triangles around its first corner.
    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let mut fan: [Option<u32>; 2] = [None; 2];
        for word in words {
            let next = self.vertex(word)?;
            match fan {
                [None, _] => fan[0] = Some(next),
                [_, None] => fan[1] = Some(next),
                [Some(first), Some(last)] => {
                    self.triangles.push([first, last, next]);
                    fan[1] = Some(next);
                }
            }
        }
        Ok(())
    }

    /// The vertex of a corner, as in `position/coordinates/normal`.
    fn vertex(&mut self, word: &str) -> Result<u32, String> {
        let mut parts = word.split('/');
        let mut part = |count| match parts.next() {
            None | Some("") => Ok(None),
            Some(text) => index(text, count).map(Some),
        };
        let corner = Corner {
            position: part(self.positions.len())?
                .ok_or_else(|| format!("`{word}` has no position"))?,
            coordinates: part(self.coordinates.len())?,
            normal: part(self.normals.len())?,
        };
        let next = u32::try_from(self.corners.len()).map_err(|_| "more than 2^32 vertices")?;
        let corners = &mut self.corners;
        Ok(*self.vertices.entry(corner).or_insert_with(|| {
            corners.push(corner);
            next
        }))
    }

    /// A vertex without what others have has zeros there, as with Mitsuba.
    fn mesh(self) -> Result<Mesh, String> {
        if self.triangles.is_empty() {
            return Err("there are no faces".to_owned());
        }
        let of_corners = self.corners.iter();
        let mut mesh = Mesh {
            positions: of_corners
                .clone()
                .map(|corner| self.positions[corner.position])
                .collect(),
            triangles: self.triangles,
            ..Mesh::default()
        };
        if !self.normals.is_empty() {
            let normal = |corner: &Corner| corner.normal.map_or([0.0; 3], |at| self.normals[at]);
            mesh.normals = of_corners.clone().map(normal).collect();
        }
        if !self.coordinates.is_empty() {
            let pair = |corner: &Corner| {
                corner
                    .coordinates
                    .map_or([0.0; 2], |at| self.coordinates[at])
            };
            mesh.texture_coordinates = of_corners.map(pair).collect();
        }
        Ok(mesh)
    }
}

/// The first `N` numbers.
fn numbers<'a, const N: usize>(
    mut words: impl Iterator<Item = &'a str>,
) -> Result<[f32; N], String> {
    let mut values = [0.0; N];
    for value in &mut values {
        let word = words.next().ok_or("a number is missing")?;
        *value = word
            .parse()
            .map_err(|_| format!("`{word}` is not a number"))?;
    }
    Ok(values)
}

/// An index: from 1, or backwards from the last.
fn index(text: &str, count: usize) -> Result<usize, String> {
    let value: i64 = text
        .parse()
        .map_err(|_| format!("`{text}` is not an index"))?;
    let at = match value {
        1.. => usize::try_from(value - 1).ok(),
        _ => usize::try_from(value.unsigned_abs())
            .ok()
            .and_then(|back| count.checked_sub(back)),
    };
    at.filter(|&at| at < count)
        .ok_or_else(|| format!("the index {value} is not one of {count}"))
}
