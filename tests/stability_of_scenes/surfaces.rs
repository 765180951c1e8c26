//! Surfaces nearly smooth and quite rough, boundaries of nearly nothing, nothing absorbed, and grazing views.

use super::*;
use estimand::path::bsdf::{
    Conductor, Dielectric, Distribution, Material, RoughConductor, RoughDielectric, Roughness,
};
use estimand::path::shape::Sphere;
use estimand::path::texture::Uniform;

fn in_the_furnace(law: impl Into<Material<Uniform>>) -> Mean {
    let ball = Sphere::new([0.1, -0.2, 0.3], 0.6).unwrap();
    let objects = vec![
        furnace_walls(),
        Object::<Material<Uniform>>::new([ball], law.into()),
    ];
    lit(objects, camera([-0.5, 0.4, -0.9], [0.1, -0.2, 0.3]), 256)
}

const ROUGH: [f32; 7] = [1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6, 1.0];

/// A metal that absorbs nothing takes only the light that its facets would reflect more than once: none where it is
/// smooth. 14 upper and 6 lower tests at 4.4 standard errors, of one side each: 1.1e-4.
#[test]
fn rough_metal_makes_no_light_and_smooth_metal_takes_none() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for alpha in ROUGH {
            let metal = Conductor::new(Uniform::from(0.0), Uniform::from(1.0)).unwrap();
            let roughness = Roughness::new(distribution, Uniform::from(alpha)).unwrap();
            let seen = in_the_furnace(RoughConductor::new(metal, roughness));
            assert!(seen.off(1.0) < LIMIT, "{distribution:?} {alpha}: {seen:?}");
            if alpha <= 0.01 {
                assert!(seen.off(1.0) > -LIMIT, "{distribution:?} {alpha}: {seen:?}");
            }
        }
    }
}

/// Glass of an index of refraction of all but 1 is as good as none, smooth or rough: 2 + 28 tests of one or two sides,
/// 3.3e-4.
#[test]
fn boundaries_of_nearly_nothing_keep_the_furnace() {
    for eta in [1.0, 1.0 + 1e-6] {
        let seen = in_the_furnace(Dielectric::new(eta, 1.0).unwrap());
        assert!(seen.off(1.0).abs() < LIMIT, "{eta}: {seen:?}");
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            for alpha in ROUGH {
                let roughness = Roughness::new(distribution, Uniform::from(alpha)).unwrap();
                let seen = in_the_furnace(RoughDielectric::new(eta, 1.0, roughness).unwrap());
                assert!(
                    seen.off(1.0) < LIMIT,
                    "{eta} {distribution:?} {alpha}: {seen:?}"
                );
                if alpha <= 0.01 {
                    assert!(
                        seen.off(1.0) > -LIMIT,
                        "{eta} {distribution:?} {alpha}: {seen:?}"
                    );
                }
            }
        }
    }
}

/// A room that absorbs nothing but where it shines, with a radiance of 1: the same everywhere, after as many reflections
/// as it takes. 3 tests: 3e-5.
#[test]
fn a_room_that_absorbs_nothing_is_as_bright_as_its_light() {
    let [light, walls @ ..] = room();
    for ball in [None, Some(0.45), Some(0.999)] {
        let mut objects = vec![
            Object::<Lambertian>::new(walls, grey(1.0)),
            Object::new([light], grey(0.0)).emitting([1.0; 3]).unwrap(),
        ];
        if let Some(radius) = ball {
            let ball = Sphere::new([0.0; 3], radius).unwrap();
            objects.push(Object::new([ball], grey(1.0)));
        }
        let seen = lit(objects, camera([-0.9, 0.8, -0.9], [0.2, 0.2, 0.4]), 256);
        assert!(seen.off(1.0).abs() < LIMIT, "{ball:?}: {seen:?}");
    }
}

/// Where light is made and nothing takes it away there is no end to it; of every path there is.
#[test]
fn paths_end_where_light_does_not() {
    let walls = Object::<Lambertian>::new(room(), grey(1.0))
        .emitting([0.1; 3])
        .unwrap();
    let seen = lit(vec![walls], camera([0.0; 3], [1.0, 0.3, 0.2]), 64);
    assert!(seen.mean > 1.0 && seen.mean < 1e3, "{seen:?}");
}

/// Views along a wall from a distance of 10^-1 to 10^-7, the last a single rounding error: 7 tests, 8e-5.
#[test]
fn grazing_views_of_a_furnace() {
    for exponent in 1..=7 {
        let y = -1.0 + 10.0_f32.powi(-exponent).max(f32::EPSILON / 2.0);
        let sensor = Pinhole::look_at([-0.9, y, -0.9], [0.9, y, 0.9], [0.0, 1.0, 0.0], 100.0, 1.0);
        let seen = lit(vec![furnace_walls::<Lambertian>()], sensor.unwrap(), 256);
        assert!(seen.off(1.0).abs() < LIMIT, "{y}: {seen:?}");
    }
    // In the wall itself no side is the right one: no number is lost all the same.
    let sensor = Pinhole::look_at(
        [-0.9, -1.0, -0.9],
        [0.9, -1.0, 0.9],
        [0.0, 1.0, 0.0],
        100.0,
        1.0,
    );
    let seen = lit(vec![furnace_walls::<Lambertian>()], sensor.unwrap(), 256);
    assert!(seen.mean <= 1.0 + LIMIT * seen.std_error, "{seen:?}");
}
