//! Lights as small as a millionth of the scene and as bright as a million times the others.

use super::*;
use estimand::path::shape::{Cylinder, Disk, Primitive, Sphere};
use estimand::path::{Pixel, scenes};
use estimand::{Estimator, MonteCarlo};

/// A light at a height of 1 over a floor that reflects half, `radiance` times whose area, seen from below, is 1; and that area
/// over its own.
fn small(size: f32, x: f32) -> Vec<(&'static str, Primitive, f64)> {
    let center = [x, 1.0, 0.0];
    let half = 0.5 * size;
    let [a, b, c] = [[x, 1.0, 0.0], [x + size, 1.0, 0.0], [x, 1.0, size]];
    let area = f64::from(size) * f64::from(size);
    let pi = std::f64::consts::PI;
    let flat = Flat::parallelogram([x, 1.0, 0.0], [size, 0.0, 0.0], [0.0, 0.0, size]);
    let disk = Disk::new(center, [half, 0.0, 0.0], [0.0, 0.0, half]);
    let rod = Cylinder::new([x, 1.0, -half], [x, 1.0, half], half);
    let mut lights = vec![
        ("square", flat.unwrap().into(), area),
        ("disk", disk.unwrap().into(), 0.25 * pi * area),
        (
            "ball",
            Sphere::new(center, half).unwrap().into(),
            0.25 * pi * area,
        ),
        ("rod", rod.unwrap().into(), area),
    ];
    if x == 0.0 {
        // Elsewhere its corners are rounded to a tenth of their distances.
        lights.push((
            "triangle",
            Flat::triangle([a, b, c]).unwrap().into(),
            0.5 * area,
        ));
    }
    lights
}

/// Rounds to `f32`, as numbers of scene files are.
#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn single(x: f64) -> f32 {
    x as f32
}

/// The floor below a small light has the radiance `albedo / pi` times the light's intensity over its squared distance.
/// 27 tests at 4.4 standard errors: 3e-4. The light's size adds a relative 1e-3 at most, that of a thousandth.
#[test]
fn lights_of_a_millionth_of_the_scene_shine_as_points_do() {
    let floor = Flat::parallelogram([-2.0, 0.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).unwrap();
    for size in [1e-3, 1e-5, 1e-6] {
        for x in [0.0, 0.8] {
            for (name, light, area) in small(size, x) {
                let radiance = single(1.0 / area);
                let objects = vec![
                    Object::<Lambertian>::new([floor], grey(0.5)),
                    Object::new([light], grey(0.0))
                        .emitting([radiance; 3])
                        .unwrap(),
                ];
                let sensor =
                    Pinhole::look_at([x, 0.5, 3.0], [x, 0.0, 0.0], [0.0, 1.0, 0.0], 1e-3, 1.0);
                let view = view::<_, AreaLights, _, _>(objects, NoEnvironment, sensor.unwrap());
                let pixel = Pixel {
                    scene: &view.scene,
                    sensor: &view.sensor,
                    filter: &view.filter,
                    paths: view.paths,
                    position: [0, 0],
                    size: [1, 1],
                };
                let estimate = MonteCarlo::new(4096, 1).estimate(&pixel).unwrap();
                let expected = 0.5 * std::f64::consts::FRAC_1_PI;
                let allowed = LIMIT * estimate.std_error.unwrap().x + 1e-3 * expected;
                let off = (estimate.mean.x - expected).abs();
                assert!(
                    off < allowed,
                    "{name} of {size} at {x}: {} {expected}",
                    estimate.mean.x
                );
            }
        }
    }
}

/// In the Cornell box a light of 2^20 times the radiance gives 2^20 times the picture, to the bit.
#[test]
fn light_is_linear_to_the_bit() {
    let original = picture(&scenes::cornell_box(), 16);
    let factor = 2.0_f32.powi(20);
    let bright = scenes::cornell_box_lit(scenes::CORNELL_LIGHT.map(|x| x * factor)).unwrap();
    let bright = picture(&bright, 16);
    for (bright, original) in bright.pixels().iter().zip(original.pixels()) {
        assert_eq!(*bright, *original * f64::from(factor));
    }
}

/// A furnace in which a ball of a millionth of its size shines a million times brighter, black: what it adds, its
/// power times what the walls give back, is less than 1e-5. 1 test: 1.1e-5.
#[test]
fn a_spark_in_a_furnace_adds_no_more_than_its_power() {
    let spark = Sphere::new([0.3, 0.2, 0.1], 1e-6).unwrap();
    let objects = vec![
        furnace_walls::<Lambertian>(),
        Object::new([spark], grey(0.0)).emitting([1e6; 3]).unwrap(),
    ];
    let seen = lit(objects, camera([-0.6, 0.5, -0.9], [0.2, -0.2, 0.4]), 256);
    assert!(seen.off(1.0).abs() < LIMIT, "{seen:?}");
}
