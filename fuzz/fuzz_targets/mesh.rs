//! Any bytes as a mesh, by the first of them an OBJ or a PLY: reading ends with triangles or an error.

#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use estimand::mitsuba::{MeshFile, MeshFormat};
use libfuzzer_sys::fuzz_target;

fn file() -> &'static PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| std::env::temp_dir().join(format!("estimand-fuzz-{}", std::process::id())))
}

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(file(), bytes).expect("a file");
    let mesh = MeshFile {
        file: file().clone(),
        format: if bytes.starts_with(b"ply") {
            MeshFormat::Ply
        } else {
            MeshFormat::Obj
        },
        face_normals: false,
        flip_normals: false,
        flip_tex_coords: true,
    };
    let _ = mesh.load();
});
