//! Where `f32` gives out, a scene is refused when it is made; just before, it still keeps its light in.

use glam::{Affine3A, Quat, Vec3, Vec3A};

use super::*;
use estimand::Error;
use estimand::path::Instances;
use estimand::path::shape::{Mesh, Sphere};

type Furnace = Scene<Lambertian, AreaLights, NoEnvironment>;

/// The furnace with walls at a distance of `half` from `center`, whose diagonal is `12^(1/2) half`.
fn furnace(half: f32, center: [f32; 3]) -> Result<Furnace, Error> {
    let edges = [[half, 0.0, 0.0], [0.0, half, 0.0], [0.0, 0.0, half]];
    let walls = cuboid(center, edges)?.map(Flat::turned);
    Scene::new(
        vec![Object::new(walls, grey(0.5)).emitting([0.5; 3])?],
        NoEnvironment,
    )
}

fn check(half: f32, center: [f32; 3]) {
    let at = |point: [f32; 3]| (Vec3::from(point) * half + Vec3::from(center)).to_array();
    let view = View {
        scene: furnace(half, center).unwrap(),
        sensor: camera(at([-0.6, 0.5, -0.9]), at([0.2, -0.2, 0.4])),
        filter: BoxFilter,
        paths: Paths::default(),
    };
    let seen = Mean::of(&picture(&view, 256));
    assert!(
        seen.off(1.0).abs() < LIMIT,
        "{half} at {center:?}: {seen:?}"
    );
}

fn refusal<T: core::fmt::Debug>(result: Result<T, Error>, expected: &str) {
    let message = result.unwrap_err().to_string();
    assert!(message.contains(expected), "{message}");
}

/// The limit is 8192 times 3.46: 2 tests at 4.4 standard errors, 2e-5.
#[test]
fn scenes_far_from_the_origin() {
    check(1.0, [28_000.0, 0.0, 0.0]);
    check(1.0, [28_000.0, -28_000.0, 28_000.0]);
    for center in [[29_000.0, 0.0, 0.0], [0.0, 0.0, -29_000.0], [1e6; 3]] {
        refusal(furnace(1.0, center), "distance of a scene from the origin");
    }
}

/// 2 tests: 2e-5.
#[test]
fn scenes_of_extreme_size() {
    check(3e-12, [0.0; 3]);
    check(2.8e10, [0.0; 3]);
    for half in [2.8e-12, 3e10] {
        refusal(furnace(half, [0.0; 3]), "size of a scene");
    }
}

/// A ball, which is `12^(1/2)` times its radius across, in a large room.
fn with_a_ball(radius: f32, mesh: bool) -> Result<Furnace, Error> {
    let at = 0.9;
    let walls = Object::new(room(), grey(0.5)).emitting([0.5; 3])?;
    let ball = if mesh {
        let edge = 2.0 * radius;
        let corners = vec![
            [at, at, at],
            [at + edge, at, at],
            [at, at + edge, at + edge],
        ];
        Object::mesh(Mesh::new(corners, vec![[0, 1, 2]])?, grey(1.0))
    } else {
        Object::new([Sphere::new([at; 3], radius)?], grey(1.0))
    };
    Scene::new(vec![walls, ball], NoEnvironment)
}

/// The limit is the size of 0.9 times 2^-21.
#[test]
fn objects_too_small_for_where_they_are() {
    for mesh in [false, true] {
        assert!(with_a_ball(2.5e-7, mesh).is_ok());
    }
    refusal(
        with_a_ball(1e-7, false),
        "distance of an object from the origin",
    );
    refusal(
        with_a_ball(6e-8, true),
        "distance of an object from the origin",
    );
}

/// What is copied must be near the origin of its own coordinates, and large enough where it is put.
#[test]
fn copies_too_far_away() {
    let copies = |center: f32, place: Affine3A| {
        let ball = Object::new([Sphere::new([center, 0.0, 0.0], 1.0)?], grey(0.5));
        let instances = Instances {
            objects: vec![ball],
            places: vec![place],
        };
        let floor = Flat::parallelogram([-1e6, 0.0, -1e6], [0.0, 0.0, 2e6], [2e6, 0.0, 0.0])?;
        Scene::<Lambertian, NoLight, _>::with_instances(
            vec![Object::new([floor], grey(0.5))],
            vec![instances],
            Constant::new([1.0; 3])?,
        )
    };
    let moved = |scale: f32| {
        let translation = Vec3::new(1e6, 1.0, 1e6);
        Affine3A::from_scale_rotation_translation(Vec3::splat(scale), Quat::IDENTITY, translation)
    };
    assert!(copies(0.0, moved(1.0)).is_ok());
    assert!(copies(20_000.0, Affine3A::from_translation(Vec3::from(Vec3A::X))).is_ok());
    refusal(
        copies(0.0, moved(0.1)),
        "distance of an object from the origin",
    );
    refusal(
        copies(30_000.0, moved(1.0)),
        "distance of a scene from the origin",
    );
}

/// Scenes without anything in them are of no size, and are none the worse for it.
#[test]
fn empty_scenes_are_no_size() {
    assert!(furnace(1.0, [0.0; 3]).is_ok());
    let nothing = Vec::<Object<Lambertian>>::new();
    assert!(Scene::<_, NoLight, _>::new(nothing, NoEnvironment).is_ok());
}
