//! Scenes whose pictures have a closed form, for every point set and estimator, at every scale and place; the number
//! of coordinates that paths draw; and what is kept of a picture.
//!
//! Statistical tests have fixed seeds; the false-positive rate is stated with each.

#[path = "furnace/coordinates.rs"]
mod coordinates;
#[path = "furnace/pictures.rs"]
mod pictures;
#[path = "furnace/places.rs"]
mod places;
#[path = "furnace/recursion.rs"]
mod recursion;
#[path = "furnace/sets.rs"]
mod sets;

use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::path::bsdf::{Bsdf, Dielectric, Lambertian, Material, Mirror};
use estimand::path::filter::BoxFilter;
use estimand::path::light::{AreaLights, Constant, NoEnvironment, NoLight};
use estimand::path::sensor::Pinhole;
use estimand::path::shape::{Flat, Sphere};
use estimand::path::{Image, Object, Paths, Pixel, Scene, View, scenes};
use estimand::{Average, Estimator, Moments, MonteCarlo, Progressive, Replicated};

use sets::{COUNT, sets};

/// The two-sided probability of 4.6 standard errors is 4e-6.
const LIMIT: f64 = 4.6;

/// How many standard errors the mean over all pixels, which are independent of one another, is from 1.
fn z(picture: &Image) -> f64 {
    let moments: Moments<f64> = picture.pixels().iter().map(|pixel| pixel.x).collect();
    // Where every pixel is exact, what is left is the rounding of directions and weights.
    (moments.mean() - 1.0) / moments.std_error().unwrap().hypot(1e-6)
}

fn camera(origin: [f32; 3], target: [f32; 3]) -> Pinhole {
    Pinhole::look_at(origin, target, [0.0, 1.0, 0.0], 30.0, 1.0).unwrap()
}

fn under_a_sky<B: Bsdf>(
    objects: Vec<Object<B>>,
    scale: f32,
) -> View<B, NoLight, Constant, Pinhole> {
    View {
        scene: Scene::new(objects, Constant::new([1.0, 0.5, 0.25]).unwrap()).unwrap(),
        sensor: camera([0.0, 0.0, -6.0 * scale], [0.0; 3]),
        filter: BoxFilter,
        paths: Paths::default(),
    }
}

/// A ball under a sky of three colours.
fn ball(albedo: f32, scale: f32) -> View<Lambertian, NoLight, Constant, Pinhole> {
    let ball = Sphere::new([0.0; 3], 2.5 * scale).unwrap();
    let grey = Lambertian::new([albedo; 3]).unwrap();
    under_a_sky(vec![Object::new([ball], grey)], scale)
}

/// A perfect mirror.
fn mirror() -> View<Material, NoLight, Constant, Pinhole> {
    let ball = Sphere::new([0.0; 3], 2.5).unwrap();
    let mirror = Mirror::new([1.0; 3]).unwrap();
    under_a_sky(vec![Object::new([ball], mirror)], 1.0)
}

/// A ball that absorbs nothing, with the given index of refraction, in a medium with another.
fn glass(inside: f32, outside: f32) -> View<Material, NoLight, Constant, Pinhole> {
    let ball = Sphere::new([0.0; 3], 2.5).unwrap();
    let glass = Dielectric::new(inside, outside).unwrap();
    under_a_sky(vec![Object::new([ball], glass)], 1.0)
}

/// What every unbiased estimator must find: three tests at the [`LIMIT`], and two that are exact.
///
/// - A furnace, whose walls emit and reflect a half, has the radiance 1 everywhere.
/// - A convex body under a constant sky is lit by the sky alone: its radiance is its albedo times the sky's, on every
///   single path.
/// - A perfect mirror shows the sky, on every single path; a ball of glass, on the mean over the paths that Russian
///   roulette leaves, whatever way they take inside.
fn check<T: Estimator>(name: &str, estimator: impl Fn(u64) -> T + Sync) {
    let picture = scenes::furnace().render([16; 2], 1, &estimator).unwrap();
    let off = z(&picture);
    assert!(off.abs() < LIMIT, "furnace, {name}: {off}");
    for (inside, outside) in [(1.5, 1.0), (1.0, 1.5)] {
        let picture = glass(inside, outside).render([8; 2], 2, &estimator);
        let off = z(&picture.unwrap());
        assert!(off.abs() < LIMIT, "{inside} in {outside}, {name}: {off}");
    }
    let bodies = [
        (ball(0.25, 1.0).render([4; 2], 3, &estimator), 0.25),
        (mirror().render([4; 2], 3, &estimator), 1.0),
    ];
    for (picture, albedo) in bodies {
        for pixel in picture.unwrap().pixels() {
            let error = *pixel / albedo - glam::DVec3::new(1.0, 0.5, 0.25);
            assert!(error.length() < 1e-6, "albedo {albedo}, {name}: {pixel}");
        }
    }
}

/// 30 sets, each alone and in replicates: 180 tests, false-positive rate 8e-4 over all.
#[test]
fn every_point_set_finds_the_closed_forms() {
    for (name, set) in sets() {
        check(&format!("average over {name}"), |seed| {
            Average::new(set(seed), COUNT)
        });
        check(&format!("replicates of {name}"), |seed| {
            Replicated::new(4, COUNT, &set).seed(seed)
        });
    }
}

/// 7 estimators: 21 tests, false-positive rate 9e-5 over all.
#[test]
fn every_estimator_finds_the_closed_forms() {
    check("Monte Carlo", |seed| MonteCarlo::new(COUNT, seed));
    check("strata", |seed| Strata::new(4, 2, COUNT, seed).unwrap());
    check("strata by Neyman", |seed| {
        Strata::new(3, 2, 2 * COUNT, seed).unwrap().neyman()
    });
    // Roulette knows no limit; a path above this one has survived it with a probability below 1e-6.
    check("bounded", |seed| {
        Bounded::new(COUNT, seed, 0.0, 1e3).unwrap()
    });
    check("Vegas", |seed| {
        let vegas = Vegas::new(2, 4 * COUNT, seed).unwrap();
        vegas.iterations(4).unwrap()
    });
    // A tolerance that is reached would bias the mean, as a stopping rule that looks at the values does.
    check("until", |seed| {
        let plain = MonteCarlo::new(COUNT, seed).until();
        plain.least(16).absolute(1e-12).unwrap()
    });
    let (_, set) = sets().swap_remove(0);
    check("replicates of a few", |seed| {
        Replicated::new(COUNT / 2, 2, &set).seed(seed)
    });
}

/// The median is off the mean where the replicates are skewed, as those of paths are: by about a sixth of their
/// skewness times their standard deviation. What is exact on every path it must find all the same, and no more than
/// a hundredth is lost in a furnace.
#[test]
fn medians_are_near() {
    let (_, set) = sets()
        .into_iter()
        .find(|(name, _)| *name == "Sobol, linear matrix")
        .unwrap();
    let median = |seed| Replicated::new(9, COUNT, &set).seed(seed).median();
    let picture = scenes::furnace().render([16; 2], 1, median).unwrap();
    let mean = picture.mean().x;
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
    for pixel in mirror().render([4; 2], 1, median).unwrap().pixels() {
        assert_eq!(pixel.to_array(), [1.0, 0.5, 0.25]);
    }
}

#[test]
fn a_ball_is_as_bright_at_every_scale() {
    for scale in [1e-4, 1.0, 1e4] {
        let picture = ball(0.25, scale)
            .render([8; 2], 1, |seed| MonteCarlo::new(16, seed))
            .unwrap();
        for pixel in picture.pixels() {
            assert!((pixel.x - 0.25).abs() < 1e-7, "{pixel} at scale {scale}");
        }
        assert!(picture.std_error().unwrap().mean().x < 1e-7);
    }
}

/// Indices that hardly differ: 2 tests at the [`LIMIT`].
#[test]
fn glass_like_air_keeps_all_light() {
    for inside in [1.0, 1.0 + 1e-6] {
        let picture = glass(inside, 1.0)
            .render([16; 2], 1, |seed| MonteCarlo::new(64, seed))
            .unwrap();
        let off = z(&picture);
        assert!(off.abs() < LIMIT, "{inside}: {off}");
    }
}

/// The light that a point of a floor gets from a parallel square above it: the form factor of a rectangle over one of its
/// corners (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, C-12), four times. 4.6
/// standard errors: 4e-6.
#[test]
fn a_square_light_has_its_form_factor() {
    let floor = Flat::parallelogram([-9.0, 0.0, -9.0], [0.0, 0.0, 18.0], [18.0, 0.0, 0.0]).unwrap();
    for triangles in [false, true] {
        let light = if triangles {
            let [a, b, c, d] = [
                [-1.0, 2.0, -1.0],
                [1.0, 2.0, -1.0],
                [1.0, 2.0, 1.0],
                [-1.0, 2.0, 1.0],
            ];
            vec![
                Flat::triangle([a, b, c]).unwrap(),
                Flat::triangle([a, c, d]).unwrap(),
            ]
        } else {
            vec![Flat::parallelogram([-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]).unwrap()]
        };
        let objects = vec![
            Object::<Lambertian>::new([floor], Lambertian::new([0.5; 3]).unwrap()),
            Object::new(light, Lambertian::new([0.0; 3]).unwrap())
                .emitting([3.0; 3])
                .unwrap(),
        ];
        let view = View::<_, AreaLights, _, _> {
            scene: Scene::new(objects, NoEnvironment).unwrap(),
            sensor: Pinhole::look_at([5.0, 1.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0], 1e-4, 1.0)
                .unwrap(),
            filter: BoxFilter,
            paths: Paths::default(),
        };
        let pixel = Pixel {
            scene: &view.scene,
            sensor: &view.sensor,
            filter: &view.filter,
            paths: view.paths,
            position: [0, 0],
            size: [1, 1],
        };
        let estimate = MonteCarlo::new(100_000, 1).estimate(&pixel).unwrap();
        let x = 0.5_f64; // Half the edge over the height.
        let root = (1.0 + x * x).sqrt();
        let corner = 2.0 * (x / root * (x / root).atan()) / std::f64::consts::TAU;
        let expected = 0.5 * 3.0 * 4.0 * corner;
        let z = (estimate.mean.x - expected) / estimate.std_error.unwrap().x;
        assert!(z.abs() < 4.6, "{} against {expected}: {z}", estimate.mean.x);
    }
}
