//! Walls of needles, walls in one plane, and lights that touch walls.

use super::*;
use estimand::path::shape::{Mesh, Primitive, Sphere};

/// Where the walls of the cube `[-1, 1]^3` are cut: into strips of halves and of millionths, at the edges of the room and
/// amid its walls. The last is one rounding error wide.
const CUTS: [f32; 9] = [
    -1.0,
    -0.999_999,
    -0.5,
    -0.499_99,
    0.0,
    1e-6,
    0.7,
    0.999_999_94,
    1.0,
];

/// The triangles of such walls, as corners: the thinnest are a rounding error by a rounding error, the needles among
/// them a thousandth of a millionth as wide as long.
fn needles() -> Vec<[[f32; 3]; 3]> {
    let mut triangles = Vec::new();
    for side in 0..6 {
        let corner = |a: f32, b: f32| {
            let mut point = [0.0; 3];
            point[side % 3] = if side < 3 { -1.0 } else { 1.0 };
            point[(side + 1) % 3] = a;
            point[(side + 2) % 3] = b;
            point
        };
        for along in CUTS.windows(2) {
            for across in CUTS.windows(2) {
                let ([a, c], [b, d]) = ([along[0], along[1]], [across[0], across[1]]);
                let quad = [corner(a, b), corner(c, b), corner(c, d), corner(a, d)];
                // The outer side is inside the room.
                let [first, second] = if side < 3 {
                    [[0, 1, 2], [0, 2, 3]]
                } else {
                    [[0, 2, 1], [0, 3, 2]]
                };
                triangles.push(first.map(|corner: usize| quad[corner]));
                triangles.push(second.map(|corner: usize| quad[corner]));
            }
        }
    }
    triangles
}

/// The needles each a shape, and all in one mesh.
fn needle_walls(albedo: f32) -> [Object<Lambertian>; 2] {
    let flats = needles().into_iter().map(|t| Flat::triangle(t).unwrap());
    let positions = needles().concat();
    let triangles = (0..768).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Mesh::new(positions, triangles).unwrap();
    assert_eq!((mesh.triangles().len(), mesh.dropped()), (768, 0));
    [
        Object::new(flats, grey(albedo)),
        Object::mesh(mesh, grey(albedo)),
    ]
}

fn cameras() -> [Pinhole; 3] {
    [
        camera([0.1, 0.2, -0.3], [1.0, 0.9, 1.0]),
        camera([-0.6, 0.5, -0.9], [-1.0, -1.0, 0.4]),
        // Along a seam of needles.
        camera([-0.999, -0.999, -0.9], [-1.0, -1.0, 0.9]),
    ]
}

/// 6 tests at 4.4 standard errors: 7e-5.
#[test]
fn needles_are_walls_like_others() {
    for sensor in cameras() {
        for walls in needle_walls(0.5) {
            let seen = lit(vec![walls.emitting([0.5; 3]).unwrap()], sensor, 256);
            assert!(seen.off(1.0).abs() < LIMIT, "{seen:?}");
        }
    }
}

#[test]
fn nothing_leaks_between_needles() {
    for sensor in cameras() {
        for walls in needle_walls(0.9) {
            assert_eq!(leak(vec![walls], sensor), 0.0);
        }
    }
}

/// Blocks that stand on the floor and against a wall, on and beside one another, each with all its sides: white, so that
/// the room stays a furnace. 3 tests: 3e-5.
fn blocks() -> Vec<Flat> {
    let block = |center: [f32; 3], half: f32| {
        let edges = [[half, 0.0, 0.0], [0.0, half, 0.0], [0.0, 0.0, half]];
        cuboid(center, edges).unwrap()
    };
    [
        block([0.2, -0.75, 0.2], 0.25),
        block([0.2, -0.375, 0.2], 0.125),
        block([0.45, -0.75, 0.45], 0.25),
        block([-0.75, -0.75, 0.75], 0.25),
        // The same block twice.
        block([-0.75, -0.75, 0.75], 0.25),
    ]
    .concat()
}

#[test]
fn faces_in_one_plane_keep_the_furnace() {
    for sensor in cameras() {
        let objects = vec![
            furnace_walls(),
            Object::<Lambertian>::new(blocks(), grey(1.0)),
        ];
        let seen = lit(objects, sensor, 256);
        assert!(seen.off(1.0).abs() < LIMIT, "{seen:?}");
    }
}

#[test]
fn nothing_leaks_between_faces_in_one_plane() {
    for sensor in cameras() {
        let [needles, _] = needle_walls(0.9);
        let objects = vec![
            Object::new(room(), grey(0.9)),
            needles,
            Object::new(blocks(), grey(0.9)),
        ];
        assert_eq!(leak(objects, sensor), 0.0);
    }
}

/// Bodies that emit half of their radiance, against the walls: 12 tests, 1.3e-4.
#[test]
fn lights_may_touch_walls() {
    let pane = cuboid(
        [0.0, -0.7, 0.3],
        [[0.4, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 5e-6]],
    );
    let touching: [(&str, Vec<Primitive>); 4] = [
        (
            "a ball on the floor",
            vec![Sphere::new([0.3, -0.75, 0.2], 0.25).unwrap().into()],
        ),
        (
            "a ball in a corner",
            vec![Sphere::new([0.7, -0.7, 0.7], 0.3).unwrap().into()],
        ),
        (
            "a pane on the floor",
            pane.unwrap().map(Primitive::from).to_vec(),
        ),
        (
            "a ball halfway through the floor",
            vec![Sphere::new([0.1, -1.0, 0.2], 0.4).unwrap().into()],
        ),
    ];
    for (name, shapes) in touching {
        for sensor in cameras() {
            let light = Object::<Lambertian>::new(shapes.clone(), grey(0.5))
                .emitting([0.5; 3])
                .unwrap();
            let seen = lit(vec![furnace_walls(), light], sensor, 256);
            assert!(seen.off(1.0).abs() < LIMIT, "{name}: {seen:?}");
        }
    }
}
