//! Any bytes as a scene file: reading ends with a description or an error.

#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;

/// A file that each input is written to, beside the files that our scenes name.
fn file() -> &'static PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| {
        let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference/scenes");
        let folder = std::env::temp_dir().join(format!("estimand-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for files");
        for entry in std::fs::read_dir(scenes).expect("our scenes") {
            let path = entry.expect("our scenes").path();
            if path.is_file() {
                std::fs::copy(&path, folder.join(path.file_name().expect("a name"))).expect("a copy");
            }
        }
        folder.join("fuzzed.xml")
    })
}

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(file(), bytes).expect("a file");
    let _ = estimand::mitsuba::read(file(), &[]);
});
