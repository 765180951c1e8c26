//! Scenes of every size and at every place.

use estimand::path::bsdf::Lambertian;
use estimand::path::filter::BoxFilter;
use estimand::path::light::{AreaLights, Constant, NoEnvironment, NoLight};
use estimand::path::sensor::Pinhole;
use estimand::path::shape::{Flat, Sphere, cuboid};
use estimand::path::{Object, Paths, Scene, View};
use estimand::{Moments, MonteCarlo};
use glam::{Mat3A, Vec3A};

/// A scene is the same picture, whether it is of the size of an atom or of a planet, and wherever it is: as far as
/// `f32` tells its points apart.
fn moved(
    scale: f32,
    turn: Mat3A,
    shift: Vec3A,
) -> View<Lambertian, AreaLights, NoEnvironment, Pinhole> {
    let at = |point: [f32; 3]| (turn * (Vec3A::from(point) * scale) + shift).to_array();
    let along = |edge: [f32; 3]| (turn * (Vec3A::from(edge) * scale)).to_array();
    let halves = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(along);
    let room = cuboid(at([0.0; 3]), halves).unwrap().map(Flat::turned);
    let ball = Sphere::new(at([0.2, -0.3, 0.4]), 0.45 * scale).unwrap();
    let grey = Lambertian::new([0.5; 3]).unwrap();
    let objects = vec![
        Object::new(room, grey).emitting([0.5; 3]).unwrap(),
        Object::new([ball], grey).emitting([0.5; 3]).unwrap(),
    ];
    View {
        scene: Scene::new(objects, NoEnvironment).unwrap(),
        sensor: Pinhole::look_at(
            at([-0.6, 0.5, -0.9]),
            at([0.2, -0.2, 0.4]),
            along([0.0, 1.0, 0.0]),
            60.0,
            1.0,
        )
        .unwrap(),
        filter: BoxFilter,
        paths: Paths::default(),
    }
}

/// Scales, turns and places to try.
fn placements() -> Vec<(f32, Mat3A, Vec3A)> {
    let turned = Mat3A::from_rotation_y(0.7) * Mat3A::from_rotation_x(0.4);
    let mut placements = Vec::new();
    for turn in [Mat3A::IDENTITY, turned] {
        for scale in [1e-10, 1e-4, 1.0, 1e4, 1e10] {
            placements.push((scale, turn, Vec3A::ZERO));
        }
        for shift in [10.0, 1000.0, 1e4] {
            placements.push((1.0, turn, Vec3A::new(shift, -shift, 0.5 * shift)));
        }
    }
    placements
}

/// 16 tests at 4.4 standard errors, the two-sided 1.1e-5: false-positive rate 1.8e-4 over all.
#[test]
fn a_furnace_is_uniform_at_every_scale_and_place() {
    for (scale, turn, shift) in placements() {
        let view = moved(scale, turn, shift);
        let picture = view
            .render([32; 2], 1, |seed| MonteCarlo::new(64, seed))
            .unwrap();
        let moments: Moments<f64> = picture.pixels().iter().map(|pixel| pixel.x).collect();
        let z = (moments.mean() - 1.0) / moments.std_error().unwrap();
        assert!(z.abs() < 4.4, "scale {scale}, shift {shift}: {z}");
    }
}

/// The walls of the cube `[-1, 1]^3`, each of `cells` by `cells` squares of two triangles, so that every edge is a seam.
fn triangles(cells: u8, at: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<Flat> {
    let mut triangles = Vec::new();
    let line = |cell| 2.0 * f32::from(cell) / f32::from(cells) - 1.0;
    for side in 0..6 {
        for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
            let corner = |i, j| {
                let mut point = [0.0; 3];
                point[side % 3] = if side < 3 { -1.0 } else { 1.0 };
                point[(side + 1) % 3] = line(i);
                point[(side + 2) % 3] = line(j);
                at(point)
            };
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            triangles.push(Flat::triangle([a, b, c]).unwrap());
            triangles.push(Flat::triangle([a, c, d]).unwrap());
        }
    }
    triangles
}

/// Nothing of a bright sky comes into a closed room, through no edge and no corner: with walls of twelve triangles,
/// which are swept, and of 300, which are in a tree.
#[test]
fn a_closed_room_stays_dark() {
    for cells in [1, 5] {
        for (scale, turn, shift) in placements() {
            let at = |point: [f32; 3]| (turn * (Vec3A::from(point) * scale) + shift).to_array();
            let walls = Lambertian::new([0.9; 3]).unwrap();
            let room = Object::<Lambertian>::new(triangles(cells, at), walls);
            let sensor = Pinhole::look_at(
                at([0.1, 0.2, 0.3]),
                at([0.5, 0.4, 0.9]),
                [0.0, 1.0, 0.0],
                120.0,
                1.0,
            );
            let view = View::<_, NoLight, _, _> {
                scene: Scene::new(vec![room], Constant::new([1e6; 3]).unwrap()).unwrap(),
                sensor: sensor.unwrap(),
                filter: BoxFilter,
                paths: Paths::default(),
            };
            let picture = view
                .render([32; 2], 1, |seed| MonteCarlo::new(128, seed))
                .unwrap();
            let light = picture.mean().x;
            assert_eq!(
                light, 0.0,
                "{cells} cells, scale {scale}, turn {turn}, shift {shift}"
            );
        }
    }
}
