//! Laws in scenes: light that is drawn against light that is met, closed rooms, and places in the world.

use super::*;

use estimand::path::bsdf::{Bsdf, Framed};
use estimand::path::filter::BoxFilter;
use estimand::path::light::{AreaLights, Constant, NoEnvironment, NoLight};
use estimand::path::sensor::Pinhole;
use estimand::path::shape::Sphere;
use estimand::path::texture::{Checkerboard, Texture};
use estimand::path::{Facet, Image, Object, Paths, Scene, Shading, Spot, Surface, View};
use estimand::{Moments, MonteCarlo};
use glam::{Affine2, Vec2};

/// The two-sided probability of 4.9 standard errors is 1e-6.
const LIMIT: f64 = 4.9;

fn ball(law: Material) -> Object<Material> {
    Object::new([Sphere::new([0.0; 3], 2.5).unwrap()], law)
}

/// The walls of a room around the ball.
fn walls(law: impl Into<Material>, radiance: f32) -> Object<Material> {
    let room = Sphere::new([0.0; 3], 10.0).unwrap().turned();
    Object::<Material>::new([room], law.into())
        .emitting([radiance; 3])
        .unwrap()
}

fn camera() -> Pinhole {
    Pinhole::look_at([0.0, 0.0, -6.0], [0.0; 3], [0.0, 1.0, 0.0], 30.0, 1.0).unwrap()
}

fn in_a_room(objects: Vec<Object<Material>>, seed: u64) -> Image {
    let scene: Scene<_, AreaLights, _> = Scene::new(objects, NoEnvironment).unwrap();
    let view = View {
        scene,
        sensor: camera(),
        filter: BoxFilter,
        paths: Paths::default(),
    };
    view.render([8; 2], seed, |seed| MonteCarlo::new(300, seed))
        .unwrap()
}

fn under_a_sky(law: Material, seed: u64) -> Image {
    let sky = Constant::new([1.0; 3]).unwrap();
    let scene: Scene<_, NoLight, _> = Scene::new(vec![ball(law)], sky).unwrap();
    let view = View {
        scene,
        sensor: camera(),
        filter: BoxFilter,
        paths: Paths::default(),
    };
    view.render([8; 2], seed, |seed| MonteCarlo::new(300, seed))
        .unwrap()
}

/// The mean over a picture and its standard error: pixels are independent of one another.
fn mean(picture: &Image) -> [f64; 2] {
    let errors = picture.std_error().unwrap();
    let variance: f64 = errors.pixels().iter().map(|error| error.x * error.x).sum();
    [
        picture.mean().x,
        variance.sqrt() / picture.pixels().len() as f64,
    ]
}

/// Walls that shine are a light whose points are drawn, and met, each weighed against the other; a sky of the same
/// radiance is only met.
#[test]
fn light_that_is_drawn_adds_nothing_and_takes_nothing() {
    let mut cases = smooth_cases();
    for alpha in [[0.02, 0.02], [0.2, 0.2], [0.8, 0.8]] {
        cases.extend(rough_cases(alpha));
    }
    for (seed, Case { name, law, .. }) in (1_u64..).zip(cases) {
        let black = Lambertian::new([0.0; 3]).unwrap();
        let drawn = mean(&in_a_room(vec![ball(law.clone()), walls(black, 1.0)], seed));
        let met = mean(&under_a_sky(law, seed + 1000));
        let z = (drawn[0] - met[0]) / drawn[1].hypot(met[1]).max(2e-5);
        assert!(z.abs() < LIMIT, "{name}: {drawn:?} {met:?}");
    }
}

/// A room whose walls emit one half and reflect the other, partly as a mirror does, with a ball in it that takes nothing
/// away: the radiance is 1 everywhere.
#[test]
fn closed_rooms_are_evenly_lit() {
    let half = || {
        let diffuse = Diffuse::new(0.5.into()).unwrap().into();
        Blend::new(0.4.into(), [diffuse, Mirror::new([0.5; 3]).unwrap().into()])
    };
    for (seed, Case { name, law, eta }) in (1_u64..).zip(smooth_cases()) {
        let names = [
            "mirror",
            "glass",
            "no boundary",
            "nearly none",
            "pane",
            "nothing",
            "polished",
        ];
        if !names.contains(&name.as_str()) {
            continue;
        }
        // Light comes in through holes, unless that would leave out a boundary.
        let opaque = ["mirror", "polished"].contains(&name.as_str());
        let law = if opaque {
            TwoSided::new(law).into()
        } else {
            law
        };
        let opacity = if eta == 1.0 { 0.6 } else { 1.0 };
        let masked = Mask::new(opacity.into(), law).into();
        let picture = in_a_room(vec![ball(masked), walls(half(), 0.5)], seed);
        let pixels: Moments<f64> = picture.pixels().iter().map(|pixel| pixel.x).collect();
        let [mean, error] = mean(&picture);
        let z = (mean - 1.0) / error.max(2e-5);
        assert!(z.abs() < LIMIT, "{name}: {mean} {error}");
        assert!(pixels.variance().unwrap().sqrt() < 0.2, "{name}");
    }
}

/// A point of a surface with texture coordinates and a shading normal, in the world.
fn leaning() -> Surface<Shading> {
    let normal = Vec3A::new(0.1, -0.3, 0.9).normalize();
    let flat = Surface {
        point: Vec3A::new(3.0, 4.0, 5.0),
        normal: Vec3A::Z,
        margin: 1e-5,
        detail: (),
    };
    flat.with(Shading {
        uv: Vec2::new(0.3, 0.8),
        normal,
        du: Vec3A::new(0.5, 2.0, 0.1),
        dv: Vec3A::new(-2.0, 0.5, 0.0),
        facet: Facet::default(),
    })
}

#[test]
fn the_frame_follows_the_shading_normal_and_u() {
    let at = leaning();
    let texture = |value: f32| Texture::from(Uniform::from(value));
    let colors = [texture(0.9), texture(0.1)];
    let board = Texture::from(Checkerboard::new(colors, Affine2::IDENTITY));
    let roughness = Roughness::anisotropic(Distribution::Ggx, texture(0.1), board).unwrap();
    let metal = Conductor::new(texture(0.2), texture(3.0)).unwrap();
    let law = Material::from(RoughConductor::new(metal, roughness));

    let normal = at.detail.normal;
    let tangent = (at.detail.du - normal * normal.dot(at.detail.du)).normalize();
    let bitangent = normal.cross(tangent);
    let world = |v: Vec3A| tangent * v.x + bitangent * v.y + normal * v.z;
    let local = |v: Vec3A| Vec3A::new(tangent.dot(v), bitangent.dot(v), normal.dot(v));
    let spot = Spot::new(at.detail.uv);
    for cell in sphere(9, 7) {
        let (out, into) = (direction(0.7, 0.2), cell.middle);
        let expected = Law::evaluate(&law, &spot, out, into);
        for found in [
            Bsdf::evaluate(&law, &at, world(out), world(into)),
            Framed(law.clone()).evaluate(&at, world(out), world(into)),
        ] {
            let error = (found.value - expected.value).length();
            assert!(error <= 1e-4 * expected.value.length() + 1e-6, "{into}");
        }
    }
    let u = [0.3, 0.1];
    let there = Law::sample(&law, &spot, direction(0.7, 0.2), &mut Fixed::new(&u)).unwrap();
    let drawn = Bsdf::sample(&law, &at, world(direction(0.7, 0.2)), &mut Fixed::new(&u)).unwrap();
    assert!((local(drawn.direction) - there.direction).length() < 1e-5);
}

/// The laws that a material evaluates without a frame agree with those in it.
#[test]
fn materials_take_no_short_cut_that_shows() {
    let at = leaning();
    let white = Texture::from(Uniform::ONE);
    let lambertian = Lambertian::new([0.7; 3]).unwrap();
    let mirror = Mirror::new([0.7; 3]).unwrap();
    let tint = estimand::path::bsdf::Tint::new(white.clone(), white).unwrap();
    let glass = Dielectric::new(1.5, 1.0).unwrap().tinted(tint);
    let laws: [Material<Texture>; 3] = [lambertian.into(), mirror.into(), glass.into()];
    for law in laws {
        for out in sphere(6, 5).map(|cell| cell.middle) {
            for into in sphere(5, 4).map(|cell| cell.middle) {
                let short = Bsdf::evaluate(&law, &at, out, into);
                let long = Framed(law.clone()).evaluate(&at, out, into);
                assert!(
                    (short.value - long.value).length() < 1e-6,
                    "{law:?} {out} {into}"
                );
                assert!(
                    (short.density - long.density).abs() < 1e-6,
                    "{law:?} {out} {into}"
                );
            }
            for choice in [0.0, 0.99] {
                let u = [choice, 0.4];
                let short = Bsdf::sample(&law, &at, out, &mut Fixed::new(&u));
                let long = Framed(law.clone()).sample(&at, out, &mut Fixed::new(&u));
                let (Some(short), Some(long)) = (short, long) else {
                    assert_eq!(short, long, "{law:?} {out}");
                    continue;
                };
                assert!(
                    (short.weight - long.weight).length() < 1e-6,
                    "{law:?} {out}"
                );
                // A diffuse direction may be another with the same cosine.
                let normal = at.detail.normal;
                let [a, b] = [short, long].map(|drawn| drawn.direction.dot(normal));
                assert!((a - b).abs() < 1e-6, "{law:?} {out}");
            }
        }
    }
}
