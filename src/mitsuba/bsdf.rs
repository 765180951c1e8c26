//! How surfaces scatter light.

mod conductors;
mod ior;
mod parts;

use std::sync::Arc;

use super::document::Kind;
use super::error::SceneError;
use super::query::{Child, Query};
use super::spectrum::Role;
use super::texture::Texture;

/// How a surface scatters light.
#[derive(Clone, Debug, PartialEq)]
pub enum Bsdf {
    /// `diffuse`: ideally diffuse reflection, on the outer side.
    Diffuse {
        /// The fraction that is reflected.
        reflectance: Texture,
    },
    /// `twosided`: opaque materials for both sides.
    TwoSided {
        /// That of the outer side.
        front: Arc<Self>,
        /// That of the inner side; often the same.
        back: Arc<Self>,
    },
    /// `conductor`: a smooth metal.
    Conductor(Conductor),
    /// `roughconductor`: a rough metal.
    RoughConductor {
        /// The metal.
        conductor: Conductor,
        /// Its roughness.
        roughness: Roughness,
    },
    /// `dielectric`: a smooth boundary between transparent media.
    Dielectric(Dielectric),
    /// `thindielectric`: a thin pane.
    ThinDielectric(Dielectric),
    /// `roughdielectric`: a rough boundary between transparent media.
    RoughDielectric {
        /// The media.
        dielectric: Dielectric,
        /// The roughness.
        roughness: Roughness,
    },
    /// `plastic`: a diffuse base below a smooth boundary.
    Plastic(Plastic),
    /// `roughplastic`: a diffuse base below a rough boundary.
    RoughPlastic {
        /// Base and boundary.
        plastic: Plastic,
        /// The roughness of the boundary, the same in all directions and places.
        roughness: Roughness,
    },
    /// `mask`: partly transparent.
    Mask {
        /// The probability to meet the surface.
        opacity: Texture,
        /// The surface.
        nested: Arc<Self>,
    },
    /// `blendbsdf`: a mixture of two.
    Blend {
        /// The part of the second.
        weight: Texture,
        /// The first.
        first: Arc<Self>,
        /// The second.
        second: Arc<Self>,
    },
    /// `null`: nothing happens.
    Null,
    /// `bumpmap`: normals tilted by the slope of a texture.
    BumpMap {
        /// The heights.
        texture: Texture,
        /// A factor on them.
        scale: f64,
        /// What happens at odd normals.
        perturbed: Perturbed,
        /// The surface.
        nested: Arc<Self>,
    },
    /// `normalmap`: normals from a texture.
    NormalMap {
        /// The normals, components from -1 to 1 stored from 0 to 1.
        texture: Texture,
        /// What happens at odd normals.
        perturbed: Perturbed,
        /// The surface.
        nested: Arc<Self>,
    },
}

/// What a metal does to light.
#[derive(Clone, Debug, PartialEq)]
pub struct Conductor {
    /// The index of refraction.
    pub eta: Texture,
    /// The extinction coefficient.
    pub k: Texture,
    /// A factor on what is reflected.
    pub specular_reflectance: Texture,
}

/// Two transparent media.
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric {
    /// The index of refraction on the inner side.
    pub int_ior: f64,
    /// The index of refraction on the outer side.
    pub ext_ior: f64,
    /// A factor on what is reflected.
    pub specular_reflectance: Texture,
    /// A factor on what is transmitted.
    pub specular_transmittance: Texture,
}

/// A diffuse base below a transparent layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Plastic {
    /// The index of refraction of the layer.
    pub int_ior: f64,
    /// The index of refraction outside.
    pub ext_ior: f64,
    /// The fraction that the base reflects.
    pub diffuse_reflectance: Texture,
    /// A factor on what the boundary reflects.
    pub specular_reflectance: Texture,
    /// Whether the colour deepens by reflections between base and boundary.
    pub nonlinear: bool,
}

/// Small facets of random directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Roughness {
    /// How their directions are distributed.
    pub distribution: Distribution,
    /// The roughness along the first tangent.
    pub alpha_u: Texture,
    /// The roughness along the second tangent.
    pub alpha_v: Texture,
    /// Whether only visible facets are sampled. It changes the noise alone.
    pub sample_visible: bool,
}

/// How the normals of small facets are distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distribution {
    /// As of a Gaussian random surface.
    #[default]
    Beckmann,
    /// Trowbridge-Reitz, also called GGX.
    Ggx,
}

/// What happens where a perturbed normal faces away from the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Perturbed {
    /// Whether it is turned over.
    pub flip_invalid_normals: bool,
    /// Whether the shading is weakened where the true surface would hide it.
    pub use_shadowing_function: bool,
}

/// The BSDF that a child is: that of the cache if it has been described before.
pub(super) fn child(query: &Query<'_>, child: Child<'_>) -> Result<Arc<Bsdf>, SceneError> {
    let known = query.context.bsdfs.borrow().get(&child.index).cloned();
    if let Some(known) = known {
        return Ok(known);
    }
    let bsdf = Arc::new(describe(query.enter(child)?)?);
    query
        .context
        .bsdfs
        .borrow_mut()
        .insert(child.index, bsdf.clone());
    Ok(bsdf)
}

fn describe(mut query: Query<'_>) -> Result<Bsdf, SceneError> {
    let q = &mut query;
    let bsdf = match q.plugin() {
        "diffuse" => Bsdf::Diffuse {
            reflectance: q.texture_or("reflectance", Role::Fraction, 0.5)?,
        },
        "twosided" => twosided(q)?,
        "conductor" => Bsdf::Conductor(conductor(q)?),
        "roughconductor" => Bsdf::RoughConductor {
            conductor: conductor(q)?,
            roughness: roughness(q)?,
        },
        "dielectric" => Bsdf::Dielectric(dielectric(q)?),
        "thindielectric" => Bsdf::ThinDielectric(dielectric(q)?),
        "roughdielectric" => Bsdf::RoughDielectric {
            dielectric: dielectric(q)?,
            roughness: roughness(q)?,
        },
        "plastic" => Bsdf::Plastic(plastic(q)?),
        "roughplastic" => {
            let (plastic, roughness) = (plastic(q)?, roughness(q)?);
            if !matches!(roughness.alpha_u, Texture::Constant(_))
                || roughness.alpha_u != roughness.alpha_v
            {
                return Err(q.error(
                    "the roughness of plastic is one number, the same in all places and directions",
                ));
            }
            Bsdf::RoughPlastic { plastic, roughness }
        }
        "mask" => Bsdf::Mask {
            opacity: q.texture_or("opacity", Role::Fraction, 0.5)?,
            nested: nested(q)?,
        },
        "blendbsdf" => {
            let weight = required_texture(q, "weight")?;
            let [first, second] = pair(q)?;
            Bsdf::Blend {
                weight,
                first,
                second,
            }
        }
        "null" => Bsdf::Null,
        "bumpmap" => bumpmap(q)?,
        "normalmap" => Bsdf::NormalMap {
            texture: required_texture(q, "normalmap")?,
            perturbed: perturbed(q)?,
            nested: nested(q)?,
        },
        _ => {
            return Err(q.unsupported(
                "there are diffuse, twosided, conductor, roughconductor, dielectric, thindielectric, roughdielectric, \
                 plastic, roughplastic, mask, blendbsdf, null, bumpmap and normalmap",
            ));
        }
    };
    query.finish()?;
    Ok(bsdf)
}

fn twosided(q: &mut Query<'_>) -> Result<Bsdf, SceneError> {
    if q.flag("allow_transmission", false)? {
        return Err(q.error("`allow_transmission` is not supported; transparent materials have two sides as they are"));
    }
    let children = q.children_of(Kind::Bsdf)?;
    let [front, back] = match children[..] {
        [both] => [both, both],
        [front, back] => [front, back],
        _ => return Err(q.error("it has one BSDF for both sides, or two")),
    };
    let [front, back] = [child(q, front)?, child(q, back)?];
    if transmits(&front) || transmits(&back) {
        return Err(
            q.error("only opaque materials are made two-sided; use the transparent one as it is")
        );
    }
    Ok(Bsdf::TwoSided { front, back })
}

/// Whether light gets to the other side.
fn transmits(bsdf: &Bsdf) -> bool {
    match bsdf {
        Bsdf::Dielectric(_)
        | Bsdf::ThinDielectric(_)
        | Bsdf::RoughDielectric { .. }
        | Bsdf::Mask { .. }
        | Bsdf::Null => true,
        Bsdf::Diffuse { .. }
        | Bsdf::TwoSided { .. }
        | Bsdf::Conductor(_)
        | Bsdf::RoughConductor { .. }
        | Bsdf::Plastic(_)
        | Bsdf::RoughPlastic { .. } => false,
        Bsdf::Blend { first, second, .. } => transmits(first) || transmits(second),
        Bsdf::BumpMap { nested, .. } | Bsdf::NormalMap { nested, .. } => transmits(nested),
    }
}

fn conductor(q: &mut Query<'_>) -> Result<Conductor, SceneError> {
    let specular_reflectance = q.texture_or("specular_reflectance", Role::Fraction, 1.0)?;
    let material = q.text("material")?.unwrap_or("none");
    if material == "none" {
        return Ok(Conductor {
            eta: q.texture_or("eta", Role::Unbounded, 0.0)?,
            k: q.texture_or("k", Role::Unbounded, 1.0)?,
            specular_reflectance,
        });
    }
    if q.has("eta") || q.has("k") {
        return Err(q.error("either `material` or `eta` and `k`, not both"));
    }
    let Some(metal) = conductors::named(material) else {
        return Err(q.error(format_args!(
            "there is no metal `{material}`; there are {}, or give `eta` and `k`",
            conductors::names().collect::<Vec<_>>().join(", ")
        )));
    };
    Ok(Conductor {
        eta: Texture::Constant(metal.eta),
        k: Texture::Constant(metal.k),
        specular_reflectance,
    })
}

fn dielectric(q: &mut Query<'_>) -> Result<Dielectric, SceneError> {
    Ok(Dielectric {
        int_ior: index_of_refraction(q, "int_ior", "bk7")?,
        ext_ior: index_of_refraction(q, "ext_ior", "air")?,
        specular_reflectance: q.texture_or("specular_reflectance", Role::Fraction, 1.0)?,
        specular_transmittance: q.texture_or("specular_transmittance", Role::Fraction, 1.0)?,
    })
}

fn plastic(q: &mut Query<'_>) -> Result<Plastic, SceneError> {
    Ok(Plastic {
        int_ior: index_of_refraction(q, "int_ior", "polypropylene")?,
        ext_ior: index_of_refraction(q, "ext_ior", "air")?,
        diffuse_reflectance: q.texture_or("diffuse_reflectance", Role::Fraction, 0.5)?,
        specular_reflectance: q.texture_or("specular_reflectance", Role::Fraction, 1.0)?,
        nonlinear: q.flag("nonlinear", false)?,
    })
}

/// A number, or the name of a medium.
fn index_of_refraction(
    q: &mut Query<'_>,
    name: &'static str,
    default: &str,
) -> Result<f64, SceneError> {
    let is_name = q
        .property(name)
        .is_none_or(|property| matches!(property.value, super::document::Value::Text(_)));
    if !is_name {
        return q.positive(name, 1.0);
    }
    let medium = q.text(name)?.unwrap_or(default);
    ior::named(medium).ok_or_else(|| {
        q.error(format_args!(
            "there is no medium `{medium}`; there are {}, or give a number",
            ior::names().collect::<Vec<_>>().join(", ")
        ))
    })
}

fn roughness(q: &mut Query<'_>) -> Result<Roughness, SceneError> {
    let distribution = q.choice(
        "distribution",
        &[
            ("beckmann", Distribution::Beckmann),
            ("ggx", Distribution::Ggx),
        ],
    )?;
    let sample_visible = q.flag("sample_visible", true)?;
    let alpha = q.texture("alpha", Role::Unbounded)?;
    let u = q.texture("alpha_u", Role::Unbounded)?;
    let v = q.texture("alpha_v", Role::Unbounded)?;
    let (alpha_u, alpha_v) = match (alpha, u, v) {
        (None, Some(u), Some(v)) => (u, v),
        (Some(alpha), None, None) => (alpha.clone(), alpha),
        (None, None, None) => {
            let default = Texture::Constant(glam::DVec3::splat(0.1));
            (default.clone(), default)
        }
        _ => return Err(q.error("either `alpha`, or `alpha_u` and `alpha_v`")),
    };
    for alpha in [&alpha_u, &alpha_v] {
        if let Texture::Constant(value) = alpha
            && !(value.min_element() >= 0.0)
        {
            return Err(q.error(format_args!(
                "a roughness must not be negative; it is {value}"
            )));
        }
    }
    Ok(Roughness {
        distribution,
        alpha_u,
        alpha_v,
        sample_visible,
    })
}

fn bumpmap(q: &mut Query<'_>) -> Result<Bsdf, SceneError> {
    let scale = q.number("scale", 1.0)?;
    let perturbed = perturbed(q)?;
    let children = q.children();
    let of = |kind| children.iter().filter(move |child| child.kind == kind);
    let (mut textures, mut bsdfs) = (of(Kind::Texture), of(Kind::Bsdf));
    let (Some(texture), Some(&nested), 2) = (textures.next(), bsdfs.next(), children.len()) else {
        return Err(q.error("it has one texture and one BSDF"));
    };
    Ok(Bsdf::BumpMap {
        texture: q.child_texture(texture.index, texture.property, Role::Unbounded)?,
        scale,
        perturbed,
        nested: child(q, nested)?,
    })
}

fn perturbed(q: &mut Query<'_>) -> Result<Perturbed, SceneError> {
    Ok(Perturbed {
        flip_invalid_normals: q.flag("flip_invalid_normals", true)?,
        use_shadowing_function: q.flag("use_shadowing_function", true)?,
    })
}

fn required_texture(q: &mut Query<'_>, name: &'static str) -> Result<Texture, SceneError> {
    q.texture(name, Role::Fraction)?
        .ok_or_else(|| q.error(format_args!("the property `{name}` is missing")))
}

fn nested(q: &mut Query<'_>) -> Result<Arc<Bsdf>, SceneError> {
    match q.children_of(Kind::Bsdf)?[..] {
        [only] => child(q, only),
        _ => Err(q.error("it has exactly one BSDF")),
    }
}

fn pair(q: &mut Query<'_>) -> Result<[Arc<Bsdf>; 2], SceneError> {
    match q.children_of(Kind::Bsdf)?[..] {
        [first, second] => Ok([child(q, first)?, child(q, second)?]),
        _ => Err(q.error("it has exactly two BSDFs")),
    }
}
