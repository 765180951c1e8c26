//! The properties of one object, asked for by name; what nobody asked for is an error.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::bsdf::Bsdf;
use super::document::{Document, Kind, Object, Property, Value};
use super::error::{Place, SceneError};
use super::shape::Shape;
use super::spectrum::Role;
use super::texture::{self, Texture};

/// How deep objects may be nested by references.
const MOST_LEVELS: usize = 16;

/// A document, and what has been described of it: an object that is used in many places is described once.
#[derive(Debug)]
pub(super) struct Context<'a> {
    pub(super) document: &'a Document,
    pub(super) bsdfs: RefCell<HashMap<usize, Arc<Bsdf>>>,
    pub(super) textures: RefCell<HashMap<(usize, Role), Texture>>,
    pub(super) groups: RefCell<HashMap<usize, Arc<[Shape]>>>,
    /// Which objects have been reached.
    pub(super) reached: RefCell<Vec<bool>>,
}

impl<'a> Context<'a> {
    pub(super) fn new(document: &'a Document) -> Self {
        Self {
            document,
            bsdfs: RefCell::default(),
            textures: RefCell::default(),
            groups: RefCell::default(),
            reached: RefCell::new(vec![false; document.objects.len()]),
        }
    }
}

/// The questions to one object.
#[derive(Debug)]
pub(super) struct Query<'a> {
    pub(super) context: &'a Context<'a>,
    object: &'a Object,
    levels: usize,
    answered: Vec<bool>,
    asked: Vec<&'static str>,
}

/// A child of an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child<'a> {
    pub(super) index: usize,
    pub(super) property: &'a Property,
    pub(super) kind: Kind,
}

impl<'a> Query<'a> {
    /// Questions to the object at `index`; `levels` is how deep it is nested.
    pub(super) fn new(
        context: &'a Context<'a>,
        index: usize,
        levels: usize,
    ) -> Result<Self, SceneError> {
        let object = &context.document.objects[index];
        if levels > MOST_LEVELS {
            return Err(object.place.error(format_args!(
                "nested more than {MOST_LEVELS} deep, or within itself"
            )));
        }
        context.reached.borrow_mut()[index] = true;
        Ok(Self {
            context,
            object,
            levels,
            answered: vec![false; object.properties.len()],
            asked: Vec::new(),
        })
    }

    /// Questions to a child.
    pub(super) fn enter(&self, child: Child<'_>) -> Result<Self, SceneError> {
        Self::new(self.context, child.index, self.levels + 1)
    }

    pub(super) fn plugin(&self) -> &'a str {
        &self.object.plugin
    }

    pub(super) fn id(&self) -> Option<&'a str> {
        self.object.id.as_deref()
    }

    pub(super) fn kind(&self) -> Kind {
        self.object.kind
    }

    pub(super) fn place(&self) -> &'a Place {
        &self.object.place
    }

    pub(super) fn error(&self, message: impl core::fmt::Display) -> SceneError {
        self.object.place.error(message)
    }

    /// That there is no plugin of that name here; `instead` says what there is.
    pub(super) fn unsupported(&self, instead: &str) -> SceneError {
        self.error(format_args!(
            "`{}` is not supported; {instead}",
            self.object.plugin
        ))
    }

    /// The property of that name.
    pub(super) fn property(&mut self, name: &'static str) -> Option<&'a Property> {
        self.asked.push(name);
        let at = self
            .object
            .properties
            .iter()
            .position(|property| property.name == name)?;
        self.answered[at] = true;
        Some(&self.object.properties[at])
    }

    /// Whether there is a property of that name; it remains to be asked for.
    pub(super) fn has(&self, name: &str) -> bool {
        self.object
            .properties
            .iter()
            .any(|property| property.name == name)
    }

    /// Properties that mean nothing here, or nothing for the picture.
    pub(super) fn ignore(&mut self, names: &[&'static str]) {
        for name in names {
            self.property(name);
        }
    }

    pub(super) fn number(&mut self, name: &'static str, default: f64) -> Result<f64, SceneError> {
        Ok(self.optional_number(name)?.unwrap_or(default))
    }

    pub(super) fn optional_number(
        &mut self,
        name: &'static str,
    ) -> Result<Option<f64>, SceneError> {
        let Some(property) = self.property(name) else {
            return Ok(None);
        };
        match property.value {
            Value::Float(value) => Ok(Some(value)),
            Value::Integer(value) => Ok(Some(value as f64)),
            _ => Err(wrong(property, "a float")),
        }
    }

    /// A number above 0.
    pub(super) fn positive(&mut self, name: &'static str, default: f64) -> Result<f64, SceneError> {
        let value = self.number(name, default)?;
        if !(value > 0.0) {
            return Err(self.error(format_args!("`{name}` must be above 0; it is {value}")));
        }
        Ok(value)
    }

    pub(super) fn optional_integer(
        &mut self,
        name: &'static str,
    ) -> Result<Option<i64>, SceneError> {
        let Some(property) = self.property(name) else {
            return Ok(None);
        };
        match property.value {
            Value::Integer(value) => Ok(Some(value)),
            _ => Err(wrong(property, "an integer")),
        }
    }

    /// An integer within the range of `T`.
    pub(super) fn count<T: TryFrom<i64>>(
        &mut self,
        name: &'static str,
        default: T,
    ) -> Result<T, SceneError> {
        let Some(value) = self.optional_integer(name)? else {
            return Ok(default);
        };
        T::try_from(value)
            .map_err(|_| self.error(format_args!("`{name}` is out of range; it is {value}")))
    }

    pub(super) fn flag(&mut self, name: &'static str, default: bool) -> Result<bool, SceneError> {
        match self.property(name) {
            None => Ok(default),
            Some(Property {
                value: Value::Boolean(value),
                ..
            }) => Ok(*value),
            Some(property) => Err(wrong(property, "a boolean")),
        }
    }

    pub(super) fn text(&mut self, name: &'static str) -> Result<Option<&'a str>, SceneError> {
        match self.property(name) {
            None => Ok(None),
            Some(Property {
                value: Value::Text(text),
                ..
            }) => Ok(Some(text)),
            Some(property) => Err(wrong(property, "a string")),
        }
    }

    /// One of a few words; the first is the default.
    pub(super) fn choice<T: Copy>(
        &mut self,
        name: &'static str,
        choices: &[(&str, T)],
    ) -> Result<T, SceneError> {
        let Some(text) = self.text(name)? else {
            return Ok(choices[0].1);
        };
        match choices
            .iter()
            .find(|(word, _)| word.eq_ignore_ascii_case(text))
        {
            Some((_, value)) => Ok(*value),
            None => {
                let words: Vec<_> = choices.iter().map(|(word, _)| *word).collect();
                Err(self.error(format_args!(
                    "`{name}` is one of {}; it is `{text}`",
                    words.join(", ")
                )))
            }
        }
    }

    pub(super) fn vector(&mut self, name: &'static str) -> Result<Option<DVec3>, SceneError> {
        match self.property(name) {
            None => Ok(None),
            Some(Property {
                value: Value::Vector(value),
                ..
            }) => Ok(Some(*value)),
            Some(property) => Err(wrong(property, "a point or vector")),
        }
    }

    /// A transform that can be undone.
    pub(super) fn transform(&mut self, name: &'static str) -> Result<Option<DMat4>, SceneError> {
        let Some(property) = self.property(name) else {
            return Ok(None);
        };
        let Value::Transform(transform) = property.value else {
            return Err(wrong(property, "a transform"));
        };
        let determinant = transform.determinant();
        if !(determinant != 0.0 && transform.inverse().is_finite()) {
            return Err(property.place.error(format_args!(
                "the transform cannot be inverted; its determinant is {determinant}"
            )));
        }
        Ok(Some(transform))
    }

    /// The file that a property names.
    pub(super) fn file(&mut self, name: &'static str) -> Result<PathBuf, SceneError> {
        let Some(property) = self.property(name) else {
            return Err(self.error(format_args!("the property `{name}` is missing")));
        };
        match &property.value {
            Value::Text(text) => self.context.document.resolve(text, &property.place),
            _ => Err(wrong(property, "a string")),
        }
    }

    /// A value or a texture.
    pub(super) fn texture(
        &mut self,
        name: &'static str,
        role: Role,
    ) -> Result<Option<Texture>, SceneError> {
        let Some(property) = self.property(name) else {
            return Ok(None);
        };
        let Some(index) = self.context.document.child(property) else {
            return texture::value(property, role).map(Some);
        };
        self.child_texture(index, property, role).map(Some)
    }

    /// The texture that a child is.
    pub(super) fn child_texture(
        &self,
        index: usize,
        property: &Property,
        role: Role,
    ) -> Result<Texture, SceneError> {
        let known = self.context.textures.borrow().get(&(index, role)).cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        let query = Query::new(self.context, index, self.levels + 1)?;
        if query.kind() != Kind::Texture {
            return Err(wrong(property, "a value or a texture"));
        }
        let texture = texture::describe(query, role)?;
        self.context
            .textures
            .borrow_mut()
            .insert((index, role), texture.clone());
        Ok(texture)
    }

    /// The same, with a grey value for default.
    pub(super) fn texture_or(
        &mut self,
        name: &'static str,
        role: Role,
        default: f64,
    ) -> Result<Texture, SceneError> {
        Ok(self
            .texture(name, role)?
            .unwrap_or(Texture::Constant(DVec3::splat(default))))
    }

    /// A colour that is the same everywhere.
    pub(super) fn color(
        &mut self,
        name: &'static str,
        role: Role,
        default: f64,
    ) -> Result<DVec3, SceneError> {
        match self.texture_or(name, role, default)? {
            Texture::Constant(color) => Ok(color),
            _ => Err(self.error(format_args!(
                "`{name}` must be the same everywhere, without a texture"
            ))),
        }
    }

    /// The children that have not been asked for by their names.
    pub(super) fn children(&mut self) -> Vec<Child<'a>> {
        let document = self.context.document;
        let mut children = Vec::new();
        for (at, property) in self.object.properties.iter().enumerate() {
            if self.answered[at] {
                continue;
            }
            if let Some(index) = document.child(property) {
                self.answered[at] = true;
                let kind = document.objects[index].kind;
                children.push(Child {
                    index,
                    property,
                    kind,
                });
            }
        }
        children
    }

    /// The children, which must be of the given kind.
    pub(super) fn children_of(&mut self, kind: Kind) -> Result<Vec<Child<'a>>, SceneError> {
        let children = self.children();
        match children.iter().find(|child| child.kind != kind) {
            Some(other) => Err(self.stray(*other)),
            None => Ok(children),
        }
    }

    /// That a child does not belong here.
    pub(super) fn stray(&self, child: Child<'_>) -> SceneError {
        child.property.place.error(format_args!(
            "this does not belong in {}",
            self.object.place.element()
        ))
    }

    /// That every property has been asked for.
    pub(super) fn finish(self) -> Result<(), SceneError> {
        let Some(at) = self.answered.iter().position(|answered| !answered) else {
            return Ok(());
        };
        let property = &self.object.properties[at];
        let mut known = self.asked;
        known.sort_unstable();
        known.dedup();
        let known = match known.is_empty() {
            true => "it has none".to_owned(),
            false => format!("it has {}", known.join(", ")),
        };
        Err(property.place.error(format_args!(
            "{} has no property `{}`; {known}",
            self.object.place.element(),
            property.name
        )))
    }
}

/// That a property is of another type than it must be.
pub(super) fn wrong(property: &Property, expected: &str) -> SceneError {
    property.place.error(format_args!(
        "`{}` must be {expected}; it is {}",
        property.name,
        property.value.describe()
    ))
}
