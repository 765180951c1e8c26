//! The names of what PLY files have besides positions, normals and texture coordinates.

/// An attribute and which of the other properties it is made of.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Fields {
    /// The name by which textures ask for it.
    pub(super) name: String,
    /// The places of its values among the other properties.
    pub(super) places: Vec<usize>,
}

/// The last letters of the names of properties that belong together.
const ENDINGS: [[&str; 3]; 4] = [
    ["x", "y", "z"],
    ["r", "g", "b"],
    ["0", "1", "2"],
    ["1", "2", "3"],
];

/// The attributes that some properties make up: `r`, `g` and `b`, or `red`, `green` and `blue`, are the colour; otherwise one
/// or three in a row whose names end in `_x`, `_y`, `_z` or the like. Others are left out, as Mitsuba leaves them out.
pub(super) fn group(kind: &str, names: &[String]) -> Vec<Fields> {
    let place = |name: &str| names.iter().position(|other| other == name);
    let mut groups = Vec::new();
    for color in [["r", "g", "b"], ["red", "green", "blue"]] {
        let places: Vec<_> = color.iter().filter_map(|name| place(name)).collect();
        if places.len() == 3 && groups.is_empty() {
            groups.push(Fields {
                name: format!("{kind}_color"),
                places,
            });
        }
    }
    let mut at = 0;
    while let Some(name) = names.get(at) {
        let Some((prefix, ending)) = name.rsplit_once('_') else {
            at += 1;
            continue;
        };
        let follows = |offset: usize| {
            let next = names.get(at + offset)?.rsplit_once('_')?;
            (next.0 == prefix).then_some(next.1)
        };
        let count = (1..)
            .take_while(|&offset| follows(offset).is_some())
            .count()
            + 1;
        let endings = ENDINGS.iter().find(|endings| endings[0] == ending);
        let fits = |endings: &[&str; 3]| {
            count == 1 || count == 3 && (1..3).all(|i| follows(i) == Some(endings[i]))
        };
        if let Some(endings) = endings.filter(|endings| fits(endings)) {
            let color = if endings[0] == "r" { "_color" } else { "" };
            groups.push(Fields {
                name: format!("{kind}_{prefix}{color}"),
                places: (at..at + count).collect(),
            });
        }
        at += count;
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(kind: &str, names: &[&str]) -> Vec<String> {
        let names: Vec<_> = names.iter().map(|&name| name.to_owned()).collect();
        group(kind, &names)
            .into_iter()
            .map(|fields| format!("{} {:?}", fields.name, fields.places))
            .collect()
    }

    /// `find_other_fields` of Mitsuba's `src/shapes/ply.h`.
    #[test]
    fn names_are_those_of_mitsuba() {
        assert_eq!(
            names("vertex", &["color_0", "color_1", "color_2"]),
            ["vertex_color [0, 1, 2]"]
        );
        assert_eq!(
            names("face", &["red", "green", "blue", "weight_0", "quality"]),
            ["face_color [0, 1, 2]", "face_weight [3]"]
        );
        assert_eq!(
            names(
                "face",
                &["a_r", "a_g", "a_b", "b_x", "b_y", "c_x", "c_z", "c_y"]
            ),
            ["face_a_color [0, 1, 2]"]
        );
    }
}
