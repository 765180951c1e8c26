//! From XML to a [`Document`].

use std::path::{Path, PathBuf};
use std::sync::Arc;

use roxmltree::Node;

use super::document::{Document, Kind, Object, Property, Value};
use super::error::{Place, SceneError};
use super::number::{number, one_or_three, triple};
use super::parameters::Parameters;
use super::spectrum::Spectrum;
use super::{transform, upgrade};

/// How deep files may include one another.
const MOST_INCLUDES: usize = 15;

/// How deep elements may be nested, far more than any scene needs.
const MOST_LEVELS: usize = 64;

/// How large a file may be, in bytes: an XML of this size describes some 10^6 objects.
const LARGEST_FILE: u64 = 1 << 29;

/// Reads a scene file and all that it includes.
pub(super) fn parse(path: &Path, overrides: &[(&str, &str)]) -> Result<Document, SceneError> {
    let mut parser = Parser {
        parameters: Parameters::new(overrides),
        document: Document::default(),
        open: Vec::new(),
    };
    parser.document.folders.push(folder_of(path));
    parser.file(path, None)?;
    if let Some(name) = parser.parameters.unused() {
        return Err(SceneError::file(
            path,
            format_args!("the parameter `{name}` was given, but the scene does not use it"),
        ));
    }
    parser.document.check_references()?;
    Ok(parser.document)
}

/// The folder of a file.
fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

struct Parser {
    parameters: Parameters,
    document: Document,
    /// The files that are being read, each included by the one before it.
    open: Vec<PathBuf>,
}

/// The file that an element is in.
struct Source {
    file: Arc<Path>,
    /// Where its lines end, in bytes.
    line_ends: Vec<usize>,
    /// Whether it is of a version before 2.0, whose properties had other names.
    old: bool,
}

/// What is being added to.
#[derive(Clone, Copy)]
struct Parent {
    index: usize,
    levels: usize,
}

impl Parser {
    /// Adds the objects of a file: to the object that includes it, or as the scene.
    fn file(&mut self, path: &Path, parent: Option<Parent>) -> Result<(), SceneError> {
        let about = |message: String| SceneError::file(path, message);
        let size = std::fs::metadata(path)
            .map_err(|e| about(e.to_string()))?
            .len();
        if size > LARGEST_FILE {
            return Err(about(format!(
                "the file has {size} bytes, more than {LARGEST_FILE}"
            )));
        }
        let identity = path.canonicalize().map_err(|e| about(e.to_string()))?;
        if self.open.contains(&identity) {
            return Err(about("the file includes itself".to_owned()));
        }
        let text = std::fs::read_to_string(path).map_err(|e| about(e.to_string()))?;
        let xml = roxmltree::Document::parse(&text).map_err(|e| SceneError {
            line: Some(e.pos().row),
            ..about(e.to_string())
        })?;
        let root = xml.root_element();
        let file: Arc<Path> = path.into();
        let line_ends = text.match_indices('\n').map(|(at, _)| at).collect();
        let mut source = Source {
            file,
            line_ends,
            old: false,
        };
        let place = self.place(root, &source);
        source.old = is_old(root, &place)?;
        self.open.push(identity);
        match parent {
            Some(parent) if root.has_tag_name("scene") => self.children(root, parent, &source)?,
            Some(parent) => self.element(root, parent, &source)?,
            None if root.has_tag_name("scene") => self.scene(root, place, &source)?,
            None => return Err(place.error("the outermost element of a scene file is <scene>")),
        }
        self.open.pop();
        Ok(())
    }

    fn scene(
        &mut self,
        root: Node<'_, '_>,
        place: Place,
        source: &Source,
    ) -> Result<(), SceneError> {
        self.only(root, &place, &["version", "id", "name"])?;
        self.document.objects.push(Object {
            kind: Kind::Scene,
            plugin: "scene".to_owned(),
            id: None,
            place,
            properties: Vec::new(),
        });
        let parent = Parent {
            index: 0,
            levels: 0,
        };
        self.children(root, parent, source)
    }

    fn children(
        &mut self,
        node: Node<'_, '_>,
        parent: Parent,
        source: &Source,
    ) -> Result<(), SceneError> {
        for child in node.children() {
            if child.is_element() {
                self.element(child, parent, source)?;
            } else if child.is_text() && !child.text().unwrap_or_default().trim().is_empty() {
                return Err(self
                    .place(child.parent_element().unwrap_or(node), source)
                    .error("unexpected text; values stand in attributes"));
            }
        }
        Ok(())
    }

    /// Adds an element to an object.
    fn element(
        &mut self,
        node: Node<'_, '_>,
        parent: Parent,
        source: &Source,
    ) -> Result<(), SceneError> {
        let place = self.place(node, source);
        if parent.levels > MOST_LEVELS {
            return Err(place.error(format_args!("nested more than {MOST_LEVELS} deep")));
        }
        let name = node.tag_name().name();
        if let Some(kind) = Kind::of(name).filter(|&kind| kind != Kind::Scene) {
            return self.object(node, kind, parent, place, source);
        }
        if name == "spectrum" && node.has_attribute("type") {
            return self.object(node, Kind::Texture, parent, place, source);
        }
        if name != "transform" && node.children().any(|child| child.is_element()) {
            return Err(place.error("this element has no children"));
        }
        match name {
            "include" => self.include(node, parent, &place),
            "default" => {
                let [name, value] = self.required(node, &place, ["name", "value"])?;
                if name.is_empty() {
                    return Err(place.error("a parameter needs a name"));
                }
                self.parameters.default_to(&name, &value);
                Ok(())
            }
            "path" => {
                let [value] = self.required(node, &place, ["value"])?;
                self.add_folder(Path::new(&value), &place)
            }
            "alias" => {
                let [id, alias] = self.required(node, &place, ["id", "as"])?;
                let Some(&index) = self.document.ids.get(&id) else {
                    return Err(place.error(format_args!(
                        "there is no object with the id `{id}` before here"
                    )));
                };
                self.register(alias, index, &place)
            }
            "ref" => {
                let id = self.attribute(node, &place, "id")?;
                let name = self.attribute(node, &place, "name")?.unwrap_or_default();
                self.only(node, &place, &["id", "name"])?;
                let id = id.ok_or_else(|| place.error("the attribute `id` is missing"))?;
                self.add(parent, name, Value::Reference(id), place, source)
            }
            _ => {
                let (name, value) = self.property(node, &place, source)?;
                self.add(parent, name, value, place, source)
            }
        }
    }

    /// Adds an object, and all in it, as a child.
    fn object(
        &mut self,
        node: Node<'_, '_>,
        kind: Kind,
        parent: Parent,
        place: Place,
        source: &Source,
    ) -> Result<(), SceneError> {
        let allowed: &[&str] = if node.parent_element().is_none() {
            &["type", "id", "name", "version"]
        } else {
            &["type", "id", "name"]
        };
        self.only(node, &place, allowed)?;
        let plugin = self
            .attribute(node, &place, "type")?
            .ok_or_else(|| place.error("the attribute `type` is missing"))?;
        let id = self.attribute(node, &place, "id")?;
        let name = self.attribute(node, &place, "name")?.unwrap_or_default();
        let index = self.document.objects.len();
        if let Some(id) = &id {
            self.register(id.clone(), index, &place)?;
        }
        self.add(parent, name, Value::Child(index), place.clone(), source)?;
        self.document.objects.push(Object {
            kind,
            plugin,
            id,
            place,
            properties: Vec::new(),
        });
        let inside = Parent {
            index,
            levels: parent.levels + 1,
        };
        self.children(node, inside, source)?;
        if source.old {
            upgrade::object(&mut self.document.objects[index]);
        }
        Ok(())
    }

    /// A property that is no object: its name and its value.
    fn property(
        &mut self,
        node: Node<'_, '_>,
        place: &Place,
        source: &Source,
    ) -> Result<(String, Value), SceneError> {
        let element = node.tag_name().name();
        if element == "transform" {
            let [name] = self.required(node, place, ["name"])?;
            return Ok((name, self.transform(node, source)?));
        }
        if element == "spectrum" {
            return self.spectrum(node, place);
        }
        if matches!(element, "vector" | "point") && !node.has_attribute("value") {
            let [name, x, y, z] = self.required(node, place, ["name", "x", "y", "z"])?;
            let value = triple(&format!("{x} {y} {z}")).map_err(|e| place.error(e))?;
            return Ok((name, Value::Vector(value)));
        }
        if !matches!(
            element,
            "float" | "integer" | "boolean" | "string" | "vector" | "point" | "rgb"
        ) {
            return Err(place.error("no element of Mitsuba's scene files"));
        }
        let [name, text] = self.required(node, place, ["name", "value"])?;
        let value = match element {
            "float" => number(&text).map(Value::Float).map_err(|e| e.to_string()),
            "integer" => text
                .trim()
                .parse()
                .map(Value::Integer)
                .map_err(|_| format!("`{text}` is not an integer")),
            "boolean" if text.eq_ignore_ascii_case("true") => Ok(Value::Boolean(true)),
            "boolean" if text.eq_ignore_ascii_case("false") => Ok(Value::Boolean(false)),
            "boolean" => Err(format!("`{text}` is neither `true` nor `false`")),
            "string" => Ok(Value::Text(text)),
            "rgb" if text.trim_start().starts_with('#') => Err(format!(
                "`{text}`: Mitsuba 3 has no hexadecimal colours; write three linear values between 0 and 1"
            )),
            "rgb" => one_or_three(&text)
                .map(Value::Color)
                .map_err(|e| e.to_string()),
            _ => one_or_three(&text)
                .map(Value::Vector)
                .map_err(|e| e.to_string()),
        };
        Ok((name, value.map_err(|message| place.error(message))?))
    }

    fn spectrum(
        &mut self,
        node: Node<'_, '_>,
        place: &Place,
    ) -> Result<(String, Value), SceneError> {
        self.only(node, place, &["name", "value", "filename"])?;
        let name = self
            .attribute(node, place, "name")?
            .ok_or_else(|| place.error("the attribute `name` is missing"))?;
        let value = self.attribute(node, place, "value")?;
        let file = self.attribute(node, place, "filename")?;
        let spectrum = match (value, file) {
            (Some(value), None) => Spectrum::parse(&value).map_err(|e| place.error(e))?,
            (None, Some(file)) => {
                let path = self.document.resolve(&file, place)?;
                Spectrum::read(&path).map_err(|e| place.error(format_args!("{file}: {e}")))?
            }
            _ => return Err(place.error("a spectrum has either a `value` or a `filename`")),
        };
        Ok((name, Value::Spectrum(spectrum)))
    }

    /// The steps of a transform, each applied after those before it.
    fn transform(&mut self, node: Node<'_, '_>, source: &Source) -> Result<Value, SceneError> {
        let mut transform = glam::DMat4::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let place = self.place(child, source);
            let step = transform::step(child, &place, |name| self.attribute(child, &place, name))?;
            transform = step * transform;
            if !transform.is_finite() {
                return Err(place.error("the transform is not finite from here on"));
            }
        }
        Ok(Value::Transform(transform))
    }

    fn include(
        &mut self,
        node: Node<'_, '_>,
        parent: Parent,
        place: &Place,
    ) -> Result<(), SceneError> {
        let [name] = self.required(node, place, ["filename"])?;
        if self.open.len() > MOST_INCLUDES {
            return Err(place.error(format_args!("included more than {MOST_INCLUDES} deep")));
        }
        let path = self.document.resolve(&name, place)?;
        self.file(&path, Some(parent))
    }

    fn add_folder(&mut self, folder: &Path, place: &Place) -> Result<(), SceneError> {
        let own = place.file().parent().unwrap_or(Path::new(""));
        let mut candidates = core::iter::once(own)
            .chain(self.document.folders.iter().rev().map(PathBuf::as_path))
            .map(|base| base.join(folder));
        match candidates.find(|path| path.is_dir()) {
            Some(path) => {
                self.document.folders.push(path);
                Ok(())
            }
            None => Err(place.error(format_args!("no such folder: `{}`", folder.display()))),
        }
    }

    fn register(&mut self, id: String, index: usize, place: &Place) -> Result<(), SceneError> {
        if let Some(&other) = self.document.ids.get(&id) {
            let other = self.document.objects.get(other);
            let other = other.map_or_else(String::new, |o| format!(", at {}", o.place));
            return Err(place.error(format_args!("the id `{id}` is taken{other}")));
        }
        self.document.ids.insert(id, index);
        Ok(())
    }

    /// Adds a property to an object.
    fn add(
        &mut self,
        parent: Parent,
        name: String,
        value: Value,
        place: Place,
        source: &Source,
    ) -> Result<(), SceneError> {
        let name = if source.old {
            upgrade::name(&name)
        } else {
            name
        };
        let properties = &mut self.document.objects[parent.index].properties;
        let named = !name.is_empty();
        if named && properties.iter().any(|property| property.name == name) {
            return Err(place.error(format_args!("the property `{name}` is given twice")));
        }
        if !named && !matches!(value, Value::Child(_) | Value::Reference(_)) {
            return Err(place.error("a property needs a name"));
        }
        properties.push(Property { name, value, place });
        Ok(())
    }

    /// An attribute, with the parameters put in.
    fn attribute(
        &mut self,
        node: Node<'_, '_>,
        place: &Place,
        name: &str,
    ) -> Result<Option<String>, SceneError> {
        let Some(text) = node.attribute(name) else {
            return Ok(None);
        };
        self.parameters
            .substitute(text)
            .map(Some)
            .map_err(|undefined| {
                place.error(format_args!(
                    "the parameter ${} has no value; give it one, or a <default>",
                    undefined.name
                ))
            })
    }

    /// Exactly these attributes.
    fn required<const N: usize>(
        &mut self,
        node: Node<'_, '_>,
        place: &Place,
        names: [&str; N],
    ) -> Result<[String; N], SceneError> {
        self.only(node, place, &names)?;
        let mut values = [const { String::new() }; N];
        for (value, name) in values.iter_mut().zip(names) {
            *value = self
                .attribute(node, place, name)?
                .ok_or_else(|| place.error(format_args!("the attribute `{name}` is missing")))?;
        }
        Ok(values)
    }

    /// That there are no other attributes than these.
    fn only(&self, node: Node<'_, '_>, place: &Place, names: &[&str]) -> Result<(), SceneError> {
        match node.attributes().find(|a| !names.contains(&a.name())) {
            Some(other) => Err(place.error(format_args!(
                "unexpected attribute `{}`; it has {}",
                other.name(),
                names.join(", ")
            ))),
            None => Ok(()),
        }
    }

    fn place(&self, node: Node<'_, '_>, source: &Source) -> Place {
        let start = node.range().start;
        let line = source.line_ends.partition_point(|&end| end < start) + 1;
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        let name = node.tag_name().name();
        let label = ["type", "name", "id"]
            .into_iter()
            .find_map(|key| node.attribute(key).map(|value| (key, value)));
        let element = match label {
            Some((key, value)) => format!("<{name} {key}=\"{value}\">"),
            None => format!("<{name}>"),
        };
        Place::new(source.file.clone(), line, element)
    }
}

/// Whether a file is of a version before 2.0.
fn is_old(root: Node<'_, '_>, place: &Place) -> Result<bool, SceneError> {
    let version = root.attribute("version").ok_or_else(|| {
        place.error("the attribute `version` is missing, as in version=\"3.0.0\"")
    })?;
    let mut parts = version.split('.').map(str::parse::<u32>);
    match (parts.next(), parts.all(|part| part.is_ok())) {
        (Some(Ok(major)), true) => Ok(major < 2),
        _ => Err(place.error(format_args!("`{version}` is no version, such as 3.0.0"))),
    }
}
