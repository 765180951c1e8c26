//! Our own scenes, mutated at random: reading ends with a description or an error, and never with a panic.
//!
//! The seeds are fixed, so that the same files are tried in every run. `fuzz/` does the same without an end.

use std::fs;
use std::path::Path;

use estimand::hash;
use estimand::mitsuba::read;

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
