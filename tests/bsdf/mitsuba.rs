//! What Mitsuba's own laws and textures say, as `reference/bsdf.py` has written it.

use super::*;

use estimand::path::Spot;
use estimand::path::bsdf::{BumpMap, Saturation, Tint};
use estimand::path::texture::{Bitmap, Checkerboard, Filter, Parameter, Texture, Wrap};
use glam::{Affine2, Vec2};
use serde_json::Value;

type Textured = Material<Texture>;

fn read() -> Value {
    serde_json::from_str(include_str!("../../reference/bsdf.json")).unwrap()
}

#[expect(clippy::cast_possible_truncation, reason = "written from f32")]
fn number(value: &Value) -> f32 {
    value.as_f64().unwrap() as f32
}

fn numbers<const N: usize>(value: &Value) -> [f32; N] {
    let list = value.as_array().unwrap();
    assert_eq!(list.len(), N);
    core::array::from_fn(|i| number(&list[i]))
}

/// The direction, or the like, that a row names by its number.
fn named<const N: usize>(data: &Value, row: &Value, name: &str) -> [f32; N] {
    let index = usize::try_from(row[name].as_u64().unwrap()).unwrap();
    numbers(&data[name][index])
}

fn texture(value: impl Into<Uniform>) -> Texture {
    Texture::from(value.into())
}

fn board(first: [f32; 3], second: [f32; 3], scale: f32) -> Texture {
    let scale = Affine2::from_scale(Vec2::splat(scale));
    Checkerboard::new([texture(first), texture(second)], scale).into()
}

/// The image of the script.
fn image(components: usize) -> Bitmap {
    let values = (0..12 * components).map(|i| (i * 7 % 11) as f32 / 11.0);
    Bitmap::new(4, components, values.collect()).unwrap()
}

fn diffuse(color: [f32; 3]) -> Textured {
    Diffuse::new(texture(color)).unwrap().into()
}

fn metal() -> Conductor<Texture> {
    let eta = texture([0.200_438, 0.924_033, 1.102_212]);
    let k = texture([3.912_949, 2.452_848, 2.142_188]);
    Conductor::new(eta, k).unwrap()
}

fn rough_metal(distribution: Distribution, [u, v]: [f32; 2]) -> Textured {
    RoughConductor::new(metal(), roughness(distribution, [u, v])).into()
}

fn roughness(distribution: Distribution, [u, v]: [f32; 2]) -> Roughness<Texture> {
    Roughness::anisotropic(distribution, texture(u), texture(v)).unwrap()
}

fn tint() -> Tint<Texture> {
    Tint::new(texture([0.9, 0.6, 0.3]), texture([0.2, 0.5, 0.8])).unwrap()
}

/// The law of a name.
fn law(name: &str) -> Textured {
    let color = [0.2, 0.5, 0.8];
    let base = || texture([0.1, 0.4, 0.8]);
    let ggx = Distribution::Ggx;
    match name {
        "diffuse" => diffuse(color),
        "diffuse_checkerboard" => {
            let board = board([0.1, 0.2, 0.3], [0.7, 0.8, 0.9], 2.0);
            Diffuse::new(board).unwrap().into()
        }
        "twosided" => TwoSided::new(diffuse(color)).into(),
        "twosided_different" => {
            TwoSided::different(diffuse(color), diffuse([0.9, 0.1, 0.3])).into()
        }
        "conductor" => metal().into(),
        "dielectric" => Dielectric::new(1.5, 1.0).unwrap().tinted(tint()).into(),
        "thindielectric" => ThinDielectric::new(1.5, 1.0).unwrap().tinted(tint()).into(),
        "null" => Null.into(),
        "plastic" => Plastic::new(base(), 1.49, 1.0).unwrap().into(),
        "plastic_nonlinear" => {
            let plastic = Plastic::new(base(), 1.49, 1.0).unwrap();
            let plastic = plastic.saturated(Saturation::Nonlinear);
            plastic.tinted(texture([0.9, 0.6, 0.3])).unwrap().into()
        }
        "mask" => Mask::new(texture(0.3), diffuse(color)).into(),
        "mask_checkerboard" => Mask::new(board([0.2; 3], [0.9; 3], 2.0), diffuse(color)).into(),
        "blendbsdf" => {
            let laws = [diffuse(color), rough_metal(ggx, [0.3; 2])];
            Blend::new(texture(0.3), laws).into()
        }
        "normalmap" => {
            let normal = [0.3, -0.4, 0.75_f32.sqrt()].map(|n| 0.5 * (n + 1.0));
            NormalMap::new(texture(normal), rough_metal(ggx, [0.2, 0.5])).into()
        }
        "bumpmap" => BumpMap::new(image(1).into(), 0.3, rough_metal(ggx, [0.3; 2])).into(),
        "roughplastic_nonlinear" => {
            let plastic = RoughPlastic::new(base(), 1.49, 1.0, ggx, 0.2).unwrap();
            plastic.saturated(Saturation::Nonlinear).into()
        }
        _ => rough_law(name),
    }
}

/// The law of a name with distribution and roughness.
fn rough_law(name: &str) -> Textured {
    let words: Vec<_> = name.split('_').collect();
    let distribution = if words.contains(&"ggx") {
        Distribution::Ggx
    } else {
        Distribution::Beckmann
    };
    let alpha = words.last().unwrap().parse().ok();
    let roughness = |other| roughness(distribution, alpha.map_or(other, |alpha| [alpha; 2]));
    match words[0] {
        "roughconductor" => RoughConductor::new(metal(), roughness([0.1, 0.4])).into(),
        "roughdielectric" => {
            let glass = RoughDielectric::new(1.5, 1.0, roughness([0.5, 0.2])).unwrap();
            if words.contains(&"anisotropic") {
                glass.into()
            } else {
                glass.tinted(tint()).into()
            }
        }
        "roughplastic" => {
            let base = texture([0.1, 0.4, 0.8]);
            let plastic = RoughPlastic::new(base, 1.49, 1.0, distribution, alpha.unwrap());
            plastic.unwrap().into()
        }
        _ => panic!("no law {name}"),
    }
}

/// How far Mitsuba's approximation of the masking of normally distributed slopes is from its integral, at most.[^walter]
///
/// [^walter]: Walter, Bruce; et al. (2007). *Microfacet Models for Refraction through Rough Surfaces*, equation 27.
const MASKING: f32 = 0.0035;

#[test]
fn values_and_densities_are_mitsubas() {
    let data = read();
    let laws = data["laws"].as_object().unwrap();
    assert!(laws.len() > 30);
    for (name, rows) in laws {
        let law = law(name);
        // By how much the tables of rough plastic differ, each by its own rule of integration, which the choice of
        // lobes magnifies.
        let mut relative = if name.starts_with("roughplastic") {
            3e-3
        } else {
            1e-4
        };
        if name.contains("beckmann") {
            relative += 2.0 * MASKING;
        }
        for row in rows["pairs"].as_array().unwrap() {
            let [out, into] = ["out", "into"].map(|end| Vec3A::from(named(&data, row, end)));
            let spot = Spot::new(Vec2::from(named(&data, row, "uv")));
            let ours = law.evaluate(&spot, out.normalize(), into.normalize());
            let value = Vec3A::from(numbers(&row["value"]));
            let density = number(&row["density"]);
            let case = format!("{name} {row}: {ours:?}");
            let error = (ours.value - value).abs().max_element();
            assert!(error <= relative * value.max_element() + 1e-6, "{case}");
            let error = (ours.density - density).abs();
            assert!(error <= relative * density + 1e-6, "{case}");
        }
    }
}

#[test]
fn single_directions_are_mitsubas() {
    let data = read();
    for (name, rows) in data["laws"].as_object().unwrap() {
        let law = law(name);
        for row in rows["single"].as_array().unwrap() {
            let out = Vec3A::from(named(&data, row, "out"));
            let spot = Spot::new(Vec2::from(named(&data, row, "uv")));
            let choice = row["choice"].as_f64().unwrap();
            let ours = law.sample(&spot, out, &mut Fixed::new(&[choice]));
            let weight = Vec3A::from(numbers(&row["weight"]));
            let Some(ours) = ours else {
                assert_eq!(weight, Vec3A::ZERO, "{name} {row}");
                continue;
            };
            let into = Vec3A::from(numbers(&row["into"]));
            let case = format!("{name} {row}: {ours:?}");
            assert_eq!(ours.density, f32::INFINITY, "{case}");
            assert!((ours.direction - into).length() < 1e-6, "{case}");
            assert!((ours.weight - weight).length() < 2e-5, "{case}");
            assert!((ours.eta - number(&row["eta"])).abs() < 1e-6, "{case}");
        }
    }
}

/// The texture of a name.
fn named_texture(name: &str) -> Texture {
    let words: Vec<_> = name.split('_').collect();
    if words[0] == "checkerboard" {
        return board([0.1, 0.2, 0.3], [0.7, 0.8, 0.9], 1.7);
    }
    let image = image(words[1].parse().unwrap());
    if words[2] == "turned" {
        let turn =
            Affine2::from_angle(30.0_f32.to_radians()) * Affine2::from_scale(Vec2::splat(1.5));
        let shift = Affine2::from_translation(Vec2::new(0.2, 0.3));
        return image.transformed(shift * turn).into();
    }
    let filter = if words[2] == "nearest" {
        Filter::Nearest
    } else {
        Filter::Bilinear
    };
    let wrap = match words[3] {
        "repeat" => Wrap::Repeat,
        "mirror" => Wrap::Mirror,
        _ => Wrap::Clamp,
    };
    image.filtered(filter).wrapped(wrap).into()
}

#[test]
fn textures_are_mitsubas() {
    let data = read();
    for (name, rows) in data["textures"].as_object().unwrap() {
        let ours = named_texture(name);
        let mean = number(&rows["mean"]);
        assert!((ours.mean() - mean).abs() < 1e-5, "{name}: {mean}");
        for (row, uv) in rows["values"]
            .as_array()
            .unwrap()
            .iter()
            .zip(data["uv"].as_array().unwrap())
        {
            let uv = Vec2::from(numbers(uv));
            let (color, value) = (ours.color_at(uv), ours.number_at(uv));
            let case = format!("{name} at {uv}: {row} {color} {value}");
            let expected = Vec3A::from(numbers(&row["color"]));
            assert!((color - expected).length() < 2e-5, "{case}");
            assert!((value - number(&row["number"])).abs() < 2e-5, "{case}");
            // Mitsuba multiplies by the numbers of texels after the transformation, not before: with a turn,
            // only square images have the right slope.
            if let Some(slope) = row.get("slope").filter(|_| !name.ends_with("turned")) {
                let slope = Vec2::from(numbers(slope));
                let error = (ours.slope_at(uv) - slope).length();
                assert!(error < 1e-4, "{case}: {}", ours.slope_at(uv));
            }
        }
    }
}
