//! Every law of scattering against its own density, the conservation of energy, the reciprocity of light, the edges of its
//! domain, and what Mitsuba says of the same law.
//!
//! Statistical tests have fixed seeds. Chi-square has the limit that is passed once in 10^6 cases; with some two hundred
//! cases a false alarm comes in 2e-4 of all choices of the seed.

#[path = "bsdf/density.rs"]
mod density;
#[path = "bsdf/edges.rs"]
mod edges;
#[path = "bsdf/energy.rs"]
mod energy;
#[path = "bsdf/mitsuba.rs"]
mod mitsuba;
#[path = "bsdf/rooms.rs"]
mod rooms;

use core::f32::consts::PI;

use estimand::Sampler;
use estimand::path::bsdf::{
    Blend, Conductor, Dielectric, Diffuse, Distribution, Lambertian, Law, Mask, Material, Mirror,
    NormalMap, Null, Plastic, Relief, RoughConductor, RoughDielectric, RoughPlastic, Roughness,
    ThinDielectric, TwoSided,
};
use estimand::path::texture::Uniform;
use glam::Vec3A;

const DISTRIBUTIONS: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];

/// The same coordinates again and again.
struct Fixed<'a> {
    coordinates: &'a [f64],
    next: usize,
}

impl<'a> Fixed<'a> {
    fn new(coordinates: &'a [f64]) -> Self {
        Self {
            coordinates,
            next: 0,
        }
    }
}

impl Sampler for Fixed<'_> {
    fn next_1d(&mut self) -> f64 {
        self.next += 1;
        self.coordinates[(self.next - 1) % self.coordinates.len()]
    }
}

/// A law with a name for messages.
struct Case {
    name: String,
    law: Material,
    /// The index of refraction inside over that outside.
    eta: f32,
}

impl Case {
    fn new(name: impl Into<String>, law: impl Into<Material>) -> Self {
        Self {
            name: name.into(),
            law: law.into(),
            eta: 1.0,
        }
    }

    fn refracting(self, eta: f32) -> Self {
        Self { eta, ..self }
    }
}

/// The direction with this cosine, at some azimuth.
fn direction(cosine: f32, azimuth: f32) -> Vec3A {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    Vec3A::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
}

fn white() -> Uniform {
    Uniform::ONE
}

/// About copper, relative to air.
fn copper() -> Conductor {
    Conductor::new([0.2, 0.92, 1.1].into(), [3.91, 2.45, 2.14].into()).unwrap()
}

/// A metal that reflects everything.
fn silver() -> Conductor {
    Conductor::new(0.0.into(), white()).unwrap()
}

fn rough(distribution: Distribution, [u, v]: [f32; 2]) -> Roughness<Uniform> {
    if u == v {
        Roughness::new(distribution, u.into()).unwrap()
    } else {
        Roughness::anisotropic(distribution, u.into(), v.into()).unwrap()
    }
}

/// The laws with a roughness.
fn rough_cases(alpha: [f32; 2]) -> Vec<Case> {
    let mut cases = Vec::new();
    for distribution in DISTRIBUTIONS {
        let roughness = rough(distribution, alpha);
        let label = format!("{distribution:?} {alpha:?}");
        let name = |kind: &str| format!("{kind} {label}");
        let metal = RoughConductor::new(silver(), roughness);
        cases.push(Case::new(name("metal"), metal));
        let copper = RoughConductor::new(copper(), roughness);
        cases.push(Case::new(name("copper"), copper));
        for eta in [1.5, 0.7, 1.05] {
            let glass = RoughDielectric::new(eta, 1.0, roughness).unwrap();
            let name = name(&format!("glass {eta}"));
            cases.push(Case::new(name, glass).refracting(eta));
        }
        if alpha[0] == alpha[1] {
            let plastic = RoughPlastic::new(white(), 1.49, 1.0, distribution, alpha[0]).unwrap();
            let dark = RoughPlastic::new(0.2.into(), 1.49, 1.0, distribution, alpha[0]).unwrap();
            cases.push(Case::new(name("plastic"), plastic));
            cases.push(Case::new(name("dark plastic"), dark));
        }
    }
    cases
}

/// The laws without roughness, and those made of others.
fn smooth_cases() -> Vec<Case> {
    let diffuse = || Material::from(Diffuse::new(white()).unwrap());
    let glossy = || {
        let roughness = rough(Distribution::Ggx, [0.3; 2]);
        Material::from(RoughConductor::new(silver(), roughness))
    };
    let mirror = || Material::from(Mirror::new([1.0; 3]).unwrap());
    let leaning = || NormalMap::new([0.65, 0.4, 0.9].into(), diffuse());
    vec![
        Case::new("diffuse", diffuse()),
        Case::new("lambertian", Lambertian::new([1.0; 3]).unwrap()),
        Case::new("mirror", mirror()),
        Case::new("copper", copper()),
        Case::new("glass", Dielectric::new(1.5, 1.0).unwrap()).refracting(1.5),
        Case::new("no boundary", Dielectric::new(1.0, 1.0).unwrap()),
        Case::new("nearly none", Dielectric::new(1.000_001, 1.0).unwrap()),
        Case::new("pane", ThinDielectric::new(1.5, 1.0).unwrap()),
        Case::new("plastic", Plastic::new(white(), 1.49, 1.0).unwrap()),
        Case::new("dark plastic", Plastic::new(0.1.into(), 1.49, 1.0).unwrap()),
        Case::new(
            "black plastic",
            Plastic::new(0.0.into(), 1.49, 1.0).unwrap(),
        ),
        Case::new("matched plastic", Plastic::new(white(), 1.0, 1.0).unwrap()),
        Case::new("nothing", Null),
        Case::new("both sides", TwoSided::new(glossy())),
        Case::new("two sides", TwoSided::different(diffuse(), glossy())),
        Case::new("holes", Mask::new(0.4.into(), diffuse())),
        Case::new("no holes", Mask::new(1.0.into(), diffuse())),
        Case::new("all hole", Mask::new(0.0.into(), diffuse())),
        Case::new("mixture", Blend::new(0.3.into(), [diffuse(), glossy()])),
        Case::new("polished", Blend::new(0.3.into(), [diffuse(), mirror()])),
        Case::new("unpolished", Blend::new(0.0.into(), [diffuse(), mirror()])),
        Case::new("relief", leaning()),
        Case::new(
            "bare relief",
            leaning().with(Relief::default().unshadowed()),
        ),
    ]
}

/// The middle of a cell of the sphere, and the solid angle of the cell.
struct Cell {
    middle: Vec3A,
    angle: f32,
}

/// The sphere in `rings` of equal width, each in `sectors` cells.
fn sphere(rings: u16, sectors: u16) -> impl Iterator<Item = Cell> {
    (0..rings).flat_map(move |i| {
        let width = PI / f32::from(rings);
        let polar = (f32::from(i) + 0.5) * width;
        (0..sectors).map(move |j| Cell {
            middle: direction(
                polar.cos(),
                2.0 * PI * (f32::from(j) + 0.5) / f32::from(sectors),
            ),
            angle: 2.0 * PI / f32::from(sectors) * polar.sin() * width,
        })
    })
}
