//! Our own scenes, mutated at random: reading ends with a description or an error, and never with a panic.
//!
//! The seeds are fixed, so that the same files are tried in every run. `fuzz/` does the same without an end.

use std::fs;
use std::path::Path;

use estimand::hash;
use estimand::mitsuba::{MeshFile, MeshFormat, read};

use crate::files::Folder;

/// How many mutants there are of each scene.
const MUTANTS: u64 = 200;

/// What a mutant may have in place of something else.
const PIECES: [&str; 24] = [
    "nan",
    "-1",
    "0",
    "1e38",
    "1e-45",
    "99999999999999999999",
    "",
    "\"",
    "<",
    "/>",
    "$",
    "$spp",
    "&lt;",
    "&#0;",
    "é",
    "<include filename=\"scene.xml\"/>",
    "<ref id=\"white\"/>",
    "<scale value=\"0\"/>",
    "<bsdf type=\"mask\">",
    "</bsdf>",
    "<integer name=\"width\" value=\"4000000000\"/>",
    "value",
    "type",
    "\u{0}",
];

struct Dice {
    seed: u64,
    drawn: u64,
}

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.drawn += 1;
        let word = hash::mix(self.seed ^ hash::mix(self.drawn));
        usize::try_from(word % bound.max(1) as u64).expect("below a usize")
    }
}

/// The text with a few parts cut out, put elsewhere or replaced.
fn mutant(text: &str, seed: u64) -> String {
    let mut dice = Dice { seed, drawn: 0 };
    let mut characters: Vec<char> = text.chars().collect();
    for _ in 0..=dice.below(6) {
        let from = dice.below(characters.len());
        let to = (from + dice.below(12)).min(characters.len());
        let piece: Vec<char> = match dice.below(3) {
            0 => PIECES[dice.below(PIECES.len())].chars().collect(),
            1 => {
                let start = dice.below(characters.len());
                let end = (start + dice.below(80)).min(characters.len());
                characters[start..end].to_vec()
            }
            _ => Vec::new(),
        };
        characters.splice(from..to, piece);
    }
    characters.into_iter().collect()
}

/// A mesh with some of its bytes replaced, or cut off.
fn mutant_mesh(bytes: &[u8], seed: u64) -> Vec<u8> {
    let mut dice = Dice { seed, drawn: 0 };
    let mut bytes = bytes.to_vec();
    for _ in 0..=dice.below(8) {
        let at = dice.below(bytes.len());
        match dice.below(6) {
            _ if bytes.len() < 2 => break,
            0 => bytes.truncate(at.max(1)),
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, b"0123456789-.eE \n/"[dice.below(17)]),
            _ => bytes[at] = dice.below(256).to_le_bytes()[0],
        }
    }
    bytes
}

#[test]
fn mutated_meshes_do_not_panic() {
    let folder = Folder::new();
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\n";
    let obj = format!("{vertices}g a\nf 1/1/1 2//1 3\nf -1 -2 -3\n");
    let ply = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float color_0\nelement face 1\nproperty list uchar int vertex_indices\nproperty float red\n\
             end_header\n"
        )
    };
    let ascii = format!("{}0 0 0 1\n1 0 0 1\n0 1 0 2\n3 0 1 2 7\n", ply("ascii"));
    let mut binary = ply("binary_little_endian").into_bytes();
    for value in [
        0.0_f32, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 2.0,
    ] {
        binary.extend(value.to_le_bytes());
    }
    binary.push(3);
    for index in 0_i32..3 {
        binary.extend(index.to_le_bytes());
    }
    binary.extend(7.0_f32.to_le_bytes());
    let (mut read_well, mut refused) = (0, 0);
    for (bytes, format) in [
        (obj.as_bytes(), MeshFormat::Obj),
        (ascii.as_bytes(), MeshFormat::Ply),
        (&binary, MeshFormat::Ply),
    ] {
        for seed in 0..5 * MUTANTS {
            let mesh = MeshFile {
                file: folder.write("mesh", mutant_mesh(bytes, seed)),
                format,
                face_normals: false,
                flip_normals: false,
                flip_tex_coords: true,
            };
            match mesh.load() {
                Ok(mesh) => {
                    let count = mesh.positions.len();
                    let inside = |index: &u32| (*index as usize) < count;
                    assert!(mesh.triangles.as_flattened().iter().all(inside));
                    read_well += 1;
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(read_well > 10 && refused > 100, "{read_well} {refused}");
}

#[test]
fn mutated_scenes_do_not_panic() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/scenes");
    let folder = Folder::new();
    let mut texts = Vec::new();
    for entry in fs::read_dir(&scenes).expect("our scenes") {
        let path = entry.expect("our scenes").path();
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("xml") => texts.push(fs::read_to_string(&path).expect("a scene")),
            _ if path.is_file() => {
                let name = path.file_name().and_then(|name| name.to_str());
                folder.write(name.expect("a name"), fs::read(&path).expect("a file"));
            }
            _ => {}
        }
    }
    assert!(texts.len() >= 4);
    texts.sort();
    let (mut read_well, mut refused) = (0, 0);
    for (number, text) in (0..).zip(&texts) {
        for seed in 0..MUTANTS {
            let file = folder.write("scene.xml", mutant(text, hash::mix(number) ^ seed));
            match read(&file, &[]) {
                Ok(_) => read_well += 1,
                Err(_) => refused += 1,
            }
        }
    }
    // Some mutations do no harm, and most do.
    assert!(
        read_well > 0 && refused > read_well,
        "{read_well} {refused}"
    );
}
