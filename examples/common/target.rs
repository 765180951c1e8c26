//! Where results are written.

use std::error::Error;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::PathBuf;

/// A file, or standard output.
#[derive(Clone, Debug)]
pub(crate) enum Target {
    Standard,
    File(PathBuf),
}

impl Target {
    /// What an argument names, `-` being standard output. A file must be one that can be written: that is said before the work is
    /// done, and leaves no trace.
    pub(crate) fn new(name: &str) -> Result<Self, String> {
        if name == "-" {
            return Ok(Self::Standard);
        }
        let file = PathBuf::from(name);
        let is_new = !file.exists();
        // Pipes and devices are opened once, to be written.
        if is_new || file.is_file() {
            let opened = OpenOptions::new().append(true).create(true).open(&file);
            opened.map_err(|error| error.to_string())?;
        }
        if is_new {
            fs::remove_file(&file).map_err(|error| error.to_string())?;
        }
        Ok(Self::File(file))
    }

    pub(crate) fn is_standard(&self) -> bool {
        matches!(self, Self::Standard)
    }

    /// Writes `text`, a line or more.
    pub(crate) fn write(&self, text: &str) -> Result<(), Box<dyn Error>> {
        match self {
            Self::Standard => Ok(writeln!(io::stdout().lock(), "{text}")?),
            Self::File(file) => fs::write(file, format!("{text}\n"))
                .map_err(|error| format!("{}: {error}", file.display()).into()),
        }
    }
}
