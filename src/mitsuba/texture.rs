//! Textures and constant values.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine2, DVec3};

use super::document::{Property, Value};
use super::error::SceneError;
use super::query::{Query, wrong};
use super::spectrum::Role;
use super::transform::on_texture_coordinates;

/// A value that may vary over a surface: linear red, green and blue, or where one number is asked for, these three alike.
///
/// Cheap to clone; what is shared in the file is shared here.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(DVec3),
    /// An image.
    Bitmap(Arc<Bitmap>),
    /// Squares of two textures in turn.
    Checkerboard(Arc<Checkerboard>),
    /// What a mesh has per vertex or per face.
    MeshAttribute(Arc<MeshAttribute>),
}

/// An image as a texture, `bitmap`.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// The image.
    pub file: Arc<Path>,
    /// How values between the pixels are made.
    pub filter: BitmapFilter,
    /// What is beyond the image.
    pub wrap: Wrap,
    /// Whether the values are taken as they are; otherwise those of 8-bit images are decoded from sRGB.
    pub raw: bool,
    /// Applied to the texture coordinates before anything else.
    pub to_uv: DAffine2,
}

/// How values between the pixels are made, `filter_type`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitmapFilter {
    /// Linear in both directions.
    #[default]
    Bilinear,
    /// That of the nearest pixel.
    Nearest,
}

/// What is beyond an image, `wrap_mode`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image, mirrored every other time.
    Mirror,
    /// The pixels of its edge.
    Clamp,
}

/// Squares of half a unit, of two textures in turn, `checkerboard`.
///
/// Where one number is asked for, as for a roughness, Mitsuba 3.9 has the two textures the other way round.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkerboard {
    /// The texture of the square at the origin and of those that touch it by a corner.
    pub color0: Texture,
    /// The texture of the others.
    pub color1: Texture,
    /// Applied to the texture coordinates before anything else.
    pub to_uv: DAffine2,
}

/// What a mesh has per vertex or per face, `mesh_attribute`.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshAttribute {
    /// The name, which begins with `vertex_` or `face_`.
    pub name: String,
    /// A factor.
    pub scale: f64,
}

impl Texture {
    /// The attributes of meshes that it asks for.
    pub(super) fn attributes(&self) -> Vec<&MeshAttribute> {
        match self {
            Self::Constant(_) | Self::Bitmap(_) => Vec::new(),
            Self::Checkerboard(board) => {
                [board.color0.attributes(), board.color1.attributes()].concat()
            }
            Self::MeshAttribute(attribute) => vec![attribute],
        }
    }
}

/// The value of a property that is no object.
pub(super) fn value(property: &Property, role: Role) -> Result<Texture, SceneError> {
    let color = match &property.value {
        Value::Float(value) => DVec3::splat(*value),
        Value::Integer(value) => DVec3::splat(*value as f64),
        Value::Spectrum(spectrum) => spectrum.rgb(role),
        Value::Color(color) => {
            if role == Role::Fraction && !(color.min_element() >= 0.0 && color.max_element() <= 1.0)
            {
                return Err(property.place.error(format_args!(
                    "`{}` must be in [0, 1]; it is {color}",
                    property.name
                )));
            }
            *color
        }
        _ => return Err(wrong(property, "a float, an rgb, a spectrum or a texture")),
    };
    if role == Role::Emission && !(color.min_element() >= 0.0) {
        return Err(property
            .place
            .error(format_args!("light must not be negative; it is {color}")));
    }
    Ok(Texture::Constant(color))
}

/// The texture that an object is.
pub(super) fn describe(mut query: Query<'_>, role: Role) -> Result<Texture, SceneError> {
    let texture = match query.plugin() {
        "bitmap" => bitmap(&mut query)?,
        "checkerboard" => {
            // Whatever the board is for, Mitsuba reads its colours as fractions.
            let color0 = query.texture_or("color0", Role::Fraction, 0.4)?;
            let color1 = query.texture_or("color1", Role::Fraction, 0.2)?;
            let to_uv = to_uv(&mut query)?;
            Texture::Checkerboard(Arc::new(Checkerboard {
                color0,
                color1,
                to_uv,
            }))
        }
        "mesh_attribute" => {
            let name = query.text("name")?.unwrap_or_default().to_owned();
            if !name.starts_with("vertex_") && !name.starts_with("face_") {
                return Err(query.error(format_args!(
                    "`name` begins with vertex_ or face_; it is `{name}`"
                )));
            }
            let scale = query.number("scale", 1.0)?;
            Texture::MeshAttribute(Arc::new(MeshAttribute { name, scale }))
        }
        "uniform" => {
            query.ignore(&["wavelength_min", "wavelength_max"]);
            Texture::Constant(DVec3::splat(required(&mut query, "value")?))
        }
        "rawconstant" => {
            let property = query.property("value");
            match property.map(|property| &property.value) {
                Some(Value::Vector(value)) => Texture::Constant(*value),
                Some(Value::Float(value)) => Texture::Constant(DVec3::splat(*value)),
                _ => return Err(query.error("`value` must be a float or a vector")),
            }
        }
        "srgb" => match query.texture("color", role)? {
            Some(color) => color,
            None => return Err(query.error("the property `color` is missing")),
        },
        "d65" => d65(&mut query, role)?,
        _ => {
            return Err(query.unsupported(
                "there are bitmap, checkerboard, mesh_attribute, and for constant values uniform, srgb, d65 and \
                 rawconstant; spectra are values, as in <spectrum name=\"..\" value=\"400:0.1, 700:0.5\"/>",
            ));
        }
    };
    query.finish()?;
    Ok(texture)
}

fn bitmap(query: &mut Query<'_>) -> Result<Texture, SceneError> {
    let file = query.file("filename")?.into();
    let filter = query.choice(
        "filter_type",
        &[
            ("bilinear", BitmapFilter::Bilinear),
            ("nearest", BitmapFilter::Nearest),
        ],
    )?;
    let wrap = query.choice(
        "wrap_mode",
        &[
            ("repeat", Wrap::Repeat),
            ("mirror", Wrap::Mirror),
            ("clamp", Wrap::Clamp),
        ],
    )?;
    let raw = query.flag("raw", false)?;
    let to_uv = to_uv(query)?;
    query.ignore(&["format", "accel"]);
    Ok(Texture::Bitmap(Arc::new(Bitmap {
        file,
        filter,
        wrap,
        raw,
        to_uv,
    })))
}

/// The spectrum of daylight, which is white in RGB: a scale, a colour or another texture.
fn d65(query: &mut Query<'_>, role: Role) -> Result<Texture, SceneError> {
    let scale = query.number("scale", 1.0)?;
    let color = query.texture("color", role)?;
    let children = query.children();
    match (color, &children[..]) {
        (None, []) => Ok(Texture::Constant(DVec3::splat(scale))),
        (Some(Texture::Constant(color)), []) => Ok(Texture::Constant(color * scale)),
        (None, [child]) => query.child_texture(child.index, child.property, role),
        _ => Err(query.error("a d65 has either a `color` or one texture")),
    }
}

fn to_uv(query: &mut Query<'_>) -> Result<DAffine2, SceneError> {
    let transform = query.transform("to_uv")?;
    Ok(transform.map_or(DAffine2::IDENTITY, |transform| {
        on_texture_coordinates(&transform)
    }))
}

fn required(query: &mut Query<'_>, name: &'static str) -> Result<f64, SceneError> {
    query
        .optional_number(name)?
        .ok_or_else(|| query.error(format_args!("the property `{name}` is missing")))
}
