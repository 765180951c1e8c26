//! Work that is saved, to go on with.

use std::error::Error;
use std::fs::{self, File};
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use estimand::hash;
use serde::{Deserialize, Serialize};

use crate::state::State;

/// To be counted up with every change of the values that a seed gives: rows of before and after it do not go together.
const VALUES: u64 = 4;

/// A file that work is saved to.
pub(crate) struct Checkpoint {
    file: PathBuf,
    /// What the work is about: another one cannot go on with it.
    work: u64,
}

#[derive(Deserialize)]
struct Saved {
    state: State,
}

/// What a file is about, whatever else is in it: the state of other work may be of another kind.
#[derive(Deserialize)]
struct About {
    work: u64,
}

#[derive(Serialize)]
struct Saving<'a> {
    work: u64,
    state: &'a State,
}

impl Checkpoint {
    /// The file for the work that a text describes.
    pub(crate) fn new(file: &Path, work: &str) -> Self {
        let work = work
            .bytes()
            .fold(VALUES, |key, byte| hash::hash(key, byte.into()));
        Self {
            file: file.to_owned(),
            work,
        }
    }

    /// The saved work; `None` if there is none.
    pub(crate) fn load(&self, size: [u32; 2]) -> Result<Option<State>, Box<dyn Error>> {
        let about = |error: &dyn std::fmt::Display| format!("{}: {error}", self.file.display());
        if !self.file.exists() {
            return Ok(None);
        }
        let open = || File::open(&self.file).map(BufReader::new);
        let opened = open().map_err(|e| about(&e))?;
        let what: About = serde_json::from_reader(opened).map_err(|e| about(&e))?;
        if what.work != self.work {
            return Err(about(&"this checkpoint is of another scene, of other arguments or of another version of this program").into());
        }
        let opened = open().map_err(|e| about(&e))?;
        let Saved { state } = serde_json::from_reader(opened).map_err(|e| about(&e))?;
        match state.is_of(size) {
            true => Ok(Some(state)),
            false => Err(about(&"this checkpoint is damaged").into()),
        }
    }

    /// Saves the work: the file is always whole, an old one or the new one.
    pub(crate) fn save(&self, state: &State) -> Result<(), Box<dyn Error>> {
        let about = |error: &dyn std::fmt::Display| format!("{}: {error}", self.file.display());
        let mut name = self.file.clone().into_os_string();
        name.push(".new");
        let new = PathBuf::from(name);
        let mut writer = BufWriter::new(File::create(&new).map_err(|e| about(&e))?);
        let saving = Saving {
            work: self.work,
            state,
        };
        serde_json::to_writer(&mut writer, &saving).map_err(|e| about(&e))?;
        writer.flush().map_err(|e| about(&e))?;
        let file = writer.into_inner().map_err(|e| about(&e))?;
        file.sync_all().map_err(|e| about(&e))?;
        fs::rename(&new, &self.file).map_err(|e| about(&e))?;
        Ok(())
    }
}
