//! How many coordinates a path draws.

use estimand::hash::hash;
use estimand::path::bsdf::{Bsdf, Dielectric, Lambertian, Material, Mirror};
use estimand::path::filter::BoxFilter;
use estimand::path::light::{AreaLights, Environment, Light, NoEnvironment};
use estimand::path::sensor::Pinhole;
use estimand::path::shape::{Flat, Sphere, cuboid};
use estimand::path::{Object, Paths, Pixel, Scene, View};
use estimand::{Integrand, Sampler};

use crate::{camera, under_a_sky};

/// Counts what is read from a stream of independent coordinates.
struct Counting(u64, u64);

impl Sampler for Counting {
    fn next_1d(&mut self) -> f64 {
        self.1 += 1;
        estimand::hash::unit(hash(self.0, self.1))
    }
}

/// How many coordinates each of a thousand paths of at most `segments` segments draws.
fn counts<B: Bsdf, L: Light, E: Environment>(
    view: &View<B, L, E, Pinhole>,
    segments: u32,
) -> Vec<u64> {
    let pixel = Pixel {
        scene: &view.scene,
        sensor: &view.sensor,
        filter: &view.filter,
        paths: view.paths.longest(segments).unwrap(),
        position: [0, 0],
        size: [1, 1],
    };
    (0..1000)
        .map(|path| {
            let mut u = Counting(path, 0);
            pixel.evaluate(&mut u);
            u.1
        })
        .collect()
}

#[test]
fn absent_parts_draw_no_coordinates() {
    let grey = Lambertian::new([0.5; 3]).unwrap();
    let room = || {
        cuboid(
            [0.0; 3],
            [[9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]],
        )
        .unwrap()
    };
    let ball = Sphere::new([0.0; 3], 2.5).unwrap();
    let closed = || {
        vec![
            Object::<Lambertian>::new(room(), grey),
            Object::new([ball], grey),
        ]
    };
    // In a closed room every path has all its segments. Film: 2. With lights: 2 and 2 for every surface but the last;
    // without: 2.
    let lit = {
        let mut objects = closed();
        objects[0] = Object::new(room().map(Flat::turned), grey)
            .emitting([1.0; 3])
            .unwrap();
        View::<_, AreaLights, _, _> {
            scene: Scene::new(objects, NoEnvironment).unwrap(),
            sensor: camera([0.0, 0.0, -6.0], [0.0; 3]),
            filter: BoxFilter,
            paths: Paths::default(),
        }
    };
    let dark = under_a_sky(closed(), 1.0);
    for segments in 1..=5 {
        let surfaces = u64::from(segments) - 1;
        assert!(
            counts(&lit, segments)
                .iter()
                .all(|&count| count == 2 + 4 * surfaces)
        );
        assert!(
            counts(&dark, segments)
                .iter()
                .all(|&count| count == 2 + 2 * surfaces)
        );
    }
    // One for Russian roulette after the fifth segment.
    assert!(counts(&dark, 6).iter().all(|&count| count == 2 + 2 * 5 + 1));
    // A mirror draws none, glass one at every surface; neither asks for lights.
    let mirror = Object::<Material>::new([ball], Mirror::new([1.0; 3]).unwrap());
    assert!(
        counts(&under_a_sky(vec![mirror], 1.0), 4)
            .iter()
            .all(|&count| count == 2)
    );
    let glass = Object::<Material>::new([ball], Dielectric::new(1.5, 1.0).unwrap());
    let glass = counts(&under_a_sky(vec![glass], 1.0), 4);
    assert!(
        glass.iter().all(|count| (3..=5).contains(count)),
        "{glass:?}"
    );
}
