//! Meshes: the same triangles from every format.

use estimand::mitsuba::{Mesh, MeshFile, MeshFormat};

use crate::files::Folder;

const PLAIN: [bool; 3] = [false; 3];

/// The mesh of a file with this content; the flags are `face_normals`, `flip_normals` and `flip_tex_coords`.
fn load(
    format: MeshFormat,
    content: impl AsRef<[u8]>,
    [face_normals, flip_normals, flip_tex_coords]: [bool; 3],
) -> Result<Mesh, String> {
    let folder = Folder::new();
    let file = MeshFile {
        file: folder.write("mesh", content),
        format,
        face_normals,
        flip_normals,
        flip_tex_coords,
    };
    file.load().map_err(|e| e.to_string())
}

const POSITIONS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 2.0, 0.0],
    [0.0, 2.0, 0.5],
];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn header(format: &str, index: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         property float u\nproperty double v\nelement face 2\nproperty list uchar {index} vertex_indices\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    )
}

fn check(mesh: &Mesh) {
    assert_eq!(mesh.positions, POSITIONS);
    assert_eq!(mesh.triangles, TRIANGLES);
    assert!(mesh.normals.is_empty());
    assert_eq!(mesh.texture_coordinates[2], [1.0, 0.25]);
    let [color] = &mesh.attributes[..] else {
        panic!("one attribute");
    };
    assert_eq!((color.name.as_str(), color.channels), ("face_color", 3));
    assert_eq!(color.values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn ply_is_read_in_all_encodings() {
    let mut text = header("ascii", "int");
    for [x, y, z] in POSITIONS {
        text += &format!("{x} {y} {z} {x} 0.25\n");
    }
    text += "3 0 1 2 1 2 3\n3 0 2 3 4 5 6\n";
    check(&load(MeshFormat::Ply, text, PLAIN).unwrap());

    for (format, index, big) in [
        ("binary_little_endian", "int", false),
        ("binary_little_endian", "uint", false),
        ("binary_big_endian", "int", true),
    ] {
        let mut bytes = header(format, index).into_bytes();
        let mut put = |value: &[u8]| {
            let mut value = value.to_vec();
            if big {
                value.reverse();
            }
            bytes.extend(value);
        };
        for [x, y, z] in POSITIONS {
            for value in [x, y, z, x] {
                put(&value.to_le_bytes());
            }
            put(&0.25_f64.to_le_bytes());
        }
        for (triangle, color) in TRIANGLES.into_iter().zip([[1, 2, 3], [4, 5, 6_u8]]) {
            put(&[3]);
            triangle.iter().for_each(|index| put(&index.to_le_bytes()));
            color.iter().for_each(|&value| put(&[value]));
        }
        check(&load(MeshFormat::Ply, bytes, PLAIN).unwrap());
    }
}

/// `src/shapes/obj.cpp` of Mitsuba: polygons are fans, corners are joined by their three indices over all groups.
#[test]
fn obj_is_read_with_its_groups_joined() {
    let content = "# a square\nmtllib no.mtl\no square\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0.5\nvt 0 0\nvt 1 1 0\n\
                   vn 0 0 1\ng one\nusemtl none\nf 1/1/1 2//1 3/2/1 4/1/1\ng two\ns off\nf -4/1/1 3/2/1 4/-2/-1\nl 1 2\n";
    let mesh = load(MeshFormat::Obj, content, PLAIN).unwrap();
    assert_eq!(mesh.positions, POSITIONS);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 4]);
    assert_eq!(
        mesh.texture_coordinates,
        [[0.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 0.0]]
    );
    let flat = load(MeshFormat::Obj, content, [true, false, true]).unwrap();
    assert!(flat.normals.is_empty());
    assert_eq!(flat.texture_coordinates[2], [1.0, 0.0]);
}

#[test]
fn what_is_no_mesh_is_refused() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (content, expected) in [
        (String::new(), "no faces"),
        (vertices.to_owned(), "no faces"),
        (
            format!("{vertices}f 1 2 4\n"),
            "line 4: the index 4 is not one of 3",
        ),
        (
            format!("{vertices}f 1 2 -4\n"),
            "the index -4 is not one of 3",
        ),
        (format!("{vertices}f 1 2 0\n"), "the index 0"),
        (
            format!("{vertices}f 1 2/1 3\n"),
            "the index 1 is not one of 0",
        ),
        (format!("{vertices}f 1 2 x\n"), "`x` is not an index"),
        (format!("{vertices}f /1 2 3\n"), "`/1` has no position"),
        ("v 0 0\n".to_owned(), "line 1: a number is missing"),
        (
            "v 0 0 nan\nv 0 0 0\nv 1 1 1\nf 1 2 3\n".to_owned(),
            "which is not finite",
        ),
    ] {
        let error = load(MeshFormat::Obj, &content, PLAIN).unwrap_err();
        assert!(error.contains(expected), "{content}\n{error}");
    }
    let ply = |vertices: &str, faces: &str, body: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {faces}\nproperty list uchar int vertex_index\nend_header\n{body}"
        )
    };
    let three = "0 0 0\n1 0 0\n0 1 0\n";
    for (content, expected) in [
        (String::new(), ""),
        ("ply\n".to_owned(), ""),
        (
            ply("3", "1", &format!("{three}4 0 1 2 2\n")),
            "4 corners; split polygons",
        ),
        (
            ply("3", "1", &format!("{three}3 0 1 3\n")),
            "of which there are only 3",
        ),
        (
            ply("3", "1", &format!("{three}3 0 1 -1\n")),
            "of which there are only 3",
        ),
        (ply("3", "1", three), "the file ends within `face`"),
        (ply("3", "1", "0 0 0\n1 0\n"), "`vertex`"),
        (ply("3", "1", "0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n"), ""),
        (
            ply("4000000000", "1", three),
            "4000000000 of `vertex` in a file of",
        ),
        (ply("3", "0", three), "no vertices or no faces"),
    ] {
        let error = load(MeshFormat::Ply, &content, PLAIN).unwrap_err();
        assert!(error.contains(expected), "{content}\n{error}");
    }
}

/// What Mitsuba 3.9.1 has as the attributes of this file (`mi.traverse`).
#[test]
fn integers_as_attributes_are_encoded_fractions() {
    let mesh = load(MeshFormat::Ply, "ply\nformat ascii 1.0\n\
         element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar r\nproperty uchar g\nproperty uchar b\nproperty ushort w_0\n\
         element face 1\nproperty list uchar int vertex_indices\nproperty float heat_0\nproperty char cold_0\nend_header\n\
         0 0 0 128 255 0 32768\n1 0 0 128 10 0 65535\n0 1 0 0 0 64 0\n3 0 1 2 0.25 64\n", PLAIN).unwrap();
    let expected: [(&str, usize, &[f32]); 4] = [
        (
            "vertex_color",
            3,
            &[128.0, 255.0, 0.0, 128.0, 10.0, 0.0, 0.0, 0.0, 64.0],
        ),
        ("vertex_w", 1, &[0.214_048_09, 1.0, 0.0]),
        ("face_heat", 1, &[0.25]),
        ("face_cold", 1, &[0.217_703_16]),
    ];
    assert_eq!(mesh.attributes.len(), expected.len());
    for (attribute, (name, channels, values)) in mesh.attributes.iter().zip(expected) {
        assert_eq!((&*attribute.name, attribute.channels), (name, channels));
        assert_eq!(attribute.values.len(), values.len());
        for (value, expected) in attribute.values.iter().zip(values) {
            assert!((value - expected).abs() < 1e-6, "{name}: {value}");
        }
    }
}
