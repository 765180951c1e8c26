//! What a study has found, as files.

use std::io;
use std::path::Path;

use crate::convergence::Convergence;

impl Convergence {
    /// Writes the [rows](Self::rows) as comma-separated values, with a line of headings.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn write_csv(&self, path: impl AsRef<Path>) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in self.rows() {
            writer.serialize(row).map_err(io::Error::other)?;
        }
        let bytes = writer.into_inner().map_err(|error| error.into_error())?;
        write(path.as_ref(), &bytes)
    }

    /// Writes everything as JSON; `serde_json` reads it back to the bit.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn write_json(&self, path: impl AsRef<Path>) -> io::Result<()> {
        let text = serde_json::to_string_pretty(self)? + "\n";
        write(path.as_ref(), text.as_bytes())
    }
}

/// Writes a file; an error names it.
pub(super) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    std::fs::write(path, bytes)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convergence::{Study, Truth};
    use crate::{MonteCarlo, cube};

    #[test]
    fn files_hold_what_was_found() {
        let f = cube(|[x]| x);
        let study = Study::new([4, 64, 256], 4).unwrap().shortest(0.0);
        let study = study.integral(&f, Truth::exact(0.5));
        let found = study
            .method("plain, of old", MonteCarlo::new)
            .run()
            .unwrap();
        let folder = std::env::temp_dir().join(format!("estimand-files-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (csv, json) = (folder.join("study.csv"), folder.join("study.json"));
        found.write_csv(&csv).unwrap();
        found.write_json(&json).unwrap();
        let again: Convergence = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
        assert_eq!(again, found);
        let text = std::fs::read_to_string(csv).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("method,count,evaluations,seeds,seconds,rmse,"));
        assert!(lines[3].starts_with("\"plain, of old\",256,256,4,"));
        std::fs::remove_dir_all(&folder).unwrap();
        let error = found.write_csv(folder.join("study.csv")).unwrap_err();
        assert!(error.to_string().contains("study.csv"));
    }
}
