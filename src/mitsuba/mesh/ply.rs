//! Stanford PLY.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};

use super::{Attribute, Mesh, attributes};
use crate::path::texture;

/// Reads a PLY file, in ASCII or binary of either byte order.
pub(super) fn read(path: &Path) -> Result<Mesh, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let size = file.metadata().map_err(|e| e.to_string())?.len();
    let mut reader = Reader::new(BufReader::with_capacity(1 << 16, file));
    let header = Parser::<Vertex>::new()
        .read_header(&mut reader)
        .map_err(|e| e.to_string())?;
    let mut mesh = Mesh::default();
    let mut source = Source {
        reader: reader.into_inner(),
        encoding: header.encoding,
        line: String::new(),
    };
    for element in header.elements.values() {
        // Each takes at least one byte, if it has a property at all.
        if element.count as u64 > size {
            return Err(format!(
                "{} of `{}` in a file of {size} bytes",
                element.count, element.name
            ));
        }
        match element.name.as_str() {
            "vertex" => vertices(&mut mesh, &mut source, element)?,
            "face" => faces(&mut mesh, &mut source, element)?,
            _ => {
                for _ in 0..element.count {
                    source.next::<Nothing>(element)?;
                }
            }
        }
    }
    if mesh.positions.is_empty() || mesh.triangles.is_empty() {
        return Err("there are no vertices or no faces".to_owned());
    }
    Ok(mesh)
}

/// The elements of a file, one after the other.
struct Source {
    reader: BufReader<File>,
    encoding: Encoding,
    line: String,
}

impl Source {
    fn next<E: PropertyAccess>(&mut self, element: &ElementDef) -> Result<E, String> {
        let parser = Parser::<E>::new();
        match self.encoding {
            Encoding::BinaryLittleEndian => {
                parser.read_little_endian_element(&mut self.reader, element)
            }
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.reader, element),
            Encoding::Ascii => {
                self.line.clear();
                let read = self.reader.read_line(&mut self.line);
                if read.map_err(|e| e.to_string())? == 0 {
                    return Err(format!("the file ends within `{}`", element.name));
                }
                parser.read_ascii_element(&self.line, element)
            }
        }
        .map_err(|e| format!("`{}`: {e}", element.name))
    }
}

fn vertices(mesh: &mut Mesh, source: &mut Source, element: &ElementDef) -> Result<(), String> {
    let has = |name: &str| element.properties.contains_key(name);
    if !["x", "y", "z"].into_iter().all(has) {
        return Err("the vertices have no x, y and z".to_owned());
    }
    let has_normals = ["nx", "ny", "nz"].into_iter().all(has);
    let has_coordinates = [["u", "v"], ["texture_u", "texture_v"], ["s", "t"]]
        .iter()
        .any(|pair| pair.iter().all(|name| has(name)));
    let mut others = Others::new("vertex", element, is_known);
    mesh.positions.reserve(element.count);
    for _ in 0..element.count {
        let vertex: Vertex = source.next(element)?;
        mesh.positions.push(vertex.position);
        if has_normals {
            mesh.normals.push(vertex.normal);
        }
        if has_coordinates {
            mesh.texture_coordinates.push(vertex.coordinates);
        }
        others.push(&vertex.others);
    }
    mesh.attributes.extend(others.attributes);
    Ok(())
}

fn faces(mesh: &mut Mesh, source: &mut Source, element: &ElementDef) -> Result<(), String> {
    let is_index = |name: &str| name == "vertex_index" || name == "vertex_indices";
    if !element.properties.keys().any(|name| is_index(name)) {
        return Err("the faces have no vertex_index or vertex_indices".to_owned());
    }
    let mut others = Others::new("face", element, is_index);
    mesh.triangles.reserve(element.count);
    for _ in 0..element.count {
        let face: Face = source.next(element)?;
        let [a, b, c] = face.indices[..] else {
            return Err(format!(
                "a face with {} corners; split polygons into triangles",
                face.indices.len()
            ));
        };
        // A negative index becomes one that is too large.
        mesh.triangles.push([a, b, c].map(i32::cast_unsigned));
        others.push(&face.others);
    }
    mesh.attributes.extend(others.attributes);
    Ok(())
}

/// The attributes as they are filled.
struct Others {
    attributes: Vec<Attribute>,
    /// Which of the other properties each has.
    places: Vec<Vec<usize>>,
}

impl Others {
    /// Those of the properties that are scalars and not `known`.
    fn new(kind: &str, element: &ElementDef, known: impl Fn(&str) -> bool) -> Self {
        let names: Vec<String> = element
            .properties
            .values()
            .filter(|property| matches!(property.data_type, PropertyType::Scalar(_)))
            .map(|property| property.name.clone())
            .filter(|name| !known(name))
            .collect();
        let (attributes, places) = attributes::group(kind, &names)
            .into_iter()
            .map(|fields| {
                let attribute = Attribute {
                    name: fields.name,
                    channels: fields.places.len(),
                    values: Vec::new(),
                };
                (attribute, fields.places)
            })
            .unzip();
        Self { attributes, places }
    }

    fn push(&mut self, others: &[f32]) {
        for (attribute, places) in self.attributes.iter_mut().zip(&self.places) {
            let values = places.iter().map(|&place| others[place]);
            attribute.values.extend(values);
        }
    }
}

/// Whether a property of a vertex is none of the others.
fn is_known(name: &str) -> bool {
    matches!(
        name,
        "x" | "y" | "z" | "nx" | "ny" | "nz" | "u" | "v" | "texture_u" | "texture_v" | "s" | "t"
    )
}

#[derive(Default)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    coordinates: [f32; 2],
    others: Vec<f32>,
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match name {
            "x" => self.position[0] = value,
            "y" => self.position[1] = value,
            "z" => self.position[2] = value,
            "nx" => self.normal[0] = value,
            "ny" => self.normal[1] = value,
            "nz" => self.normal[2] = value,
            "u" | "texture_u" | "s" => self.coordinates[0] = value,
            "v" | "texture_v" | "t" => self.coordinates[1] = value,
            _ => self.others.push(value),
        }
        PropertyAccessResult::Set
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = if is_known(name) {
            scalar(&property)
        } else {
            fraction(&property)
        };
        match value {
            Some(value) => self.set_float(name, value),
            None => PropertyAccessResult::Ignored,
        }
    }
}

#[derive(Default)]
struct Face {
    indices: Vec<i32>,
    others: Vec<f32>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn begin_list_int(&mut self, name: &str, _: usize) -> BeginList<'_, i32> {
        match name {
            "vertex_index" | "vertex_indices" => BeginList::Fill(&mut self.indices),
            _ => BeginList::UseSetter,
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(value) = fraction(&property) {
            self.others.push(value);
            return PropertyAccessResult::Set;
        }
        if !matches!(name, "vertex_index" | "vertex_indices") {
            return PropertyAccessResult::Ignored;
        }
        match property.to_u32_list() {
            Some(list) => {
                self.indices = list.into_iter().map(u32::cast_signed).collect();
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

/// An element of no interest.
struct Nothing;

impl PropertyAccess for Nothing {
    fn new() -> Self {
        Self
    }
}

/// What a scalar is as an attribute. Integers are fractions of the greatest of their type, encoded as sRGB has it; but bytes
/// without sign are themselves, as Mitsuba 3.9 has it.
#[expect(
    clippy::cast_possible_truncation,
    reason = "meshes are in 32-bit floats"
)]
fn fraction(property: &Property) -> Option<f32> {
    let part = match *property {
        Property::Char(value) => f64::from(value) / f64::from(i8::MAX),
        Property::Short(value) => f64::from(value) / f64::from(i16::MAX),
        Property::UShort(value) => f64::from(value) / f64::from(u16::MAX),
        Property::Int(value) => f64::from(value) / f64::from(i32::MAX),
        Property::UInt(value) => f64::from(value) / f64::from(u32::MAX),
        _ => return scalar(property),
    };
    Some(texture::Encoding::Srgb.decode(part) as f32)
}

/// The value of a scalar.
#[expect(
    clippy::cast_possible_truncation,
    reason = "meshes are in 32-bit floats"
)]
fn scalar(property: &Property) -> Option<f32> {
    match *property {
        Property::Char(value) => Some(value.into()),
        Property::UChar(value) => Some(value.into()),
        Property::Short(value) => Some(value.into()),
        Property::UShort(value) => Some(value.into()),
        Property::Int(value) => Some(value as f32),
        Property::UInt(value) => Some(value as f32),
        Property::Float(value) => Some(value),
        Property::Double(value) => Some(value as f32),
        _ => None,
    }
}
