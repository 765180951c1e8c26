//! A scene file as a tree of objects with properties, before their meaning is known.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3};

use super::error::{Place, SceneError};
use super::spectrum::Spectrum;

/// All objects of a scene file and of what it includes; the first is the scene.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) objects: Vec<Object>,
    /// Which object has an id, or an alias.
    pub(super) ids: HashMap<String, usize>,
    /// Where files are looked for, the last folder first.
    pub(super) folders: Vec<PathBuf>,
}

/// A plugin with its properties.
#[derive(Debug)]
pub(super) struct Object {
    pub(super) kind: Kind,
    /// The type, as in `diffuse`.
    pub(super) plugin: String,
    pub(super) id: Option<String>,
    pub(super) place: Place,
    pub(super) properties: Vec<Property>,
}

/// A named value of an object, or a child.
#[derive(Debug)]
pub(super) struct Property {
    /// Empty for a child without a name.
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) place: Place,
}

/// The values that properties have.
#[derive(Debug, PartialEq)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector(DVec3),
    Color(DVec3),
    Spectrum(Spectrum),
    Transform(DMat4),
    /// A child, by its place among the objects.
    Child(usize),
    /// A child by its id.
    Reference(String),
}

impl Value {
    /// What it is, for messages.
    pub(super) fn describe(&self) -> &'static str {
        match self {
            Self::Float(_) => "a float",
            Self::Integer(_) => "an integer",
            Self::Boolean(_) => "a boolean",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a vector",
            Self::Color(_) => "an rgb",
            Self::Spectrum(_) => "a spectrum",
            Self::Transform(_) => "a transform",
            Self::Child(_) | Self::Reference(_) => "an object",
        }
    }
}

/// The kinds of objects, named by their elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scene,
    Integrator,
    Sensor,
    Film,
    Filter,
    Sampler,
    Shape,
    Bsdf,
    Texture,
    Emitter,
    /// Media, phase functions and volumes: read only to be told that there are none here.
    Volumetric,
}

impl Kind {
    /// The kind of the objects that an element is for.
    pub(super) fn of(element: &str) -> Option<Self> {
        Some(match element {
            "scene" => Self::Scene,
            "integrator" => Self::Integrator,
            "sensor" => Self::Sensor,
            "film" => Self::Film,
            "rfilter" => Self::Filter,
            "sampler" => Self::Sampler,
            "shape" => Self::Shape,
            "bsdf" => Self::Bsdf,
            "texture" => Self::Texture,
            "emitter" => Self::Emitter,
            "medium" | "phase" | "volume" => Self::Volumetric,
            _ => return None,
        })
    }
}

impl Document {
    /// The object of a property that is a child; `None` for any other.
    pub(super) fn child(&self, property: &Property) -> Option<usize> {
        match &property.value {
            Value::Child(index) => Some(*index),
            Value::Reference(id) => self.ids.get(id).copied(),
            _ => None,
        }
    }

    /// The file of that name: as it is, or in one of the folders, or beside the file that names it.
    pub(super) fn resolve(&self, name: &str, place: &Place) -> Result<PathBuf, SceneError> {
        let name = Path::new(name);
        let own = place.file().parent();
        self.folders
            .iter()
            .rev()
            .map(PathBuf::as_path)
            .chain(own)
            .map(|folder| folder.join(name))
            .find(|path| path.is_file())
            .ok_or_else(|| place.error(format_args!("no such file: `{}`", name.display())))
    }

    /// That every reference is to an object.
    pub(super) fn check_references(&self) -> Result<(), SceneError> {
        for property in self.objects.iter().flat_map(|object| &object.properties) {
            if let Value::Reference(id) = &property.value
                && !self.ids.contains_key(id)
            {
                return Err(property
                    .place
                    .error(format_args!("there is no object with the id `{id}`")));
            }
        }
        Ok(())
    }
}
