//! What was wrong with a scene, and where.

use core::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What was wrong with a scene file, and where it stands.
///
/// ```
/// let missing = estimand::mitsuba::read("no/such/scene.xml", &[]).unwrap_err();
/// assert!(missing.to_string().starts_with("no/such/scene.xml: "));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The file.
    pub file: PathBuf,
    /// The line of the file, from 1, if it is about one.
    pub line: Option<u32>,
    /// The element, as in `<bsdf type="hair">`, if it is about one.
    pub element: Option<String>,
    /// What is wrong, and where there is another way, which.
    pub message: String,
}

impl SceneError {
    /// Something about a file as a whole.
    pub(super) fn file(file: &Path, message: impl fmt::Display) -> Self {
        Self {
            file: file.to_owned(),
            line: None,
            element: None,
            message: message.to_string(),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(element) = &self.element {
            write!(f, ": {element}")?;
        }
        write!(f, ": {}", self.message)
    }
}

impl core::error::Error for SceneError {}

/// Where an element stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    file: Arc<Path>,
    line: u32,
    element: Arc<str>,
}

impl Place {
    pub(super) fn new(file: Arc<Path>, line: u32, element: String) -> Self {
        Self {
            file,
            line,
            element: element.into(),
        }
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The line of the file, from 1.
    pub fn line(&self) -> u32 {
        self.line
    }

    /// The element, as in `<bsdf type="hair">`.
    pub fn element(&self) -> &str {
        &self.element
    }

    /// What is wrong there.
    pub fn error(&self, message: impl fmt::Display) -> SceneError {
        SceneError {
            file: self.file.to_path_buf(),
            line: Some(self.line),
            element: Some(self.element.to_string()),
            message: message.to_string(),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}
