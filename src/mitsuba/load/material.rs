//! Laws of scattering, as the path tracer has them.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::attributes::Attributes;
use super::needs::is_constant_diffuse;
use super::surroundings::narrow;
use crate::mitsuba::{
    self, BitmapFilter, Bsdf, Conductor, Dielectric, Perturbed, Plastic, Roughness, Texture,
};
use crate::path::bsdf::{self, Lambertian, Material, Relief, Saturation, Tint};
use crate::path::texture::{self, Parameter, Uniform};

/// The images that have been read, by what they are described with: each is read once.
#[derive(Debug, Default)]
pub(super) struct Images(HashMap<usize, texture::Texture>);

/// Where the values of a shape's textures come from.
#[derive(Debug)]
pub(super) struct Sources<'a> {
    pub(super) images: &'a mut Images,
    pub(super) attributes: &'a Attributes,
}

impl<'a> Sources<'a> {
    /// Of what is no mesh.
    pub(super) fn of(images: &'a mut Images) -> Self {
        static NONE: Attributes = Attributes::NONE;
        Self {
            images,
            attributes: &NONE,
        }
    }
}

/// A law of scattering that can be made of a description.
pub(super) trait Make: bsdf::Bsdf + fmt::Debug + Sized + 'static {
    fn make(bsdf: &Bsdf, sources: &mut Sources<'_>) -> Result<Self, String>;
}

impl Make for Lambertian {
    fn make(bsdf: &Bsdf, _: &mut Sources<'_>) -> Result<Self, String> {
        let of = |bsdf: &Bsdf| {
            let color = diffuse_color(bsdf).ok_or("a law of scattering that is not diffuse")?;
            Self::new(narrow(color)).map_err(|e| e.to_string())
        };
        match bsdf {
            Bsdf::TwoSided { front, .. } => of(front),
            _ => of(bsdf).map(Self::outside),
        }
    }
}

/// The colour of a diffuse surface that has one.
fn diffuse_color(bsdf: &Bsdf) -> Option<DVec3> {
    match bsdf {
        Bsdf::Diffuse {
            reflectance: Texture::Constant(color),
        } => Some(*color),
        _ => None,
    }
}

impl<P: Value> Make for Material<P> {
    fn make(bsdf: &Bsdf, sources: &mut Sources<'_>) -> Result<Self, String> {
        Maker { sources }.material(bsdf)
    }
}

/// A parameter that can be made of a description.
pub(super) trait Value: Parameter + fmt::Debug + 'static {
    fn value(texture: &Texture, sources: &mut Sources<'_>) -> Result<Self, String>;
}

impl Value for Uniform {
    fn value(texture: &Texture, _: &mut Sources<'_>) -> Result<Self, String> {
        match texture {
            Texture::Constant(color) => Ok(Self::from(narrow(*color))),
            _ => Err("a texture where the same value is needed everywhere".to_owned()),
        }
    }
}

impl Value for texture::Texture {
    fn value(texture: &Texture, sources: &mut Sources<'_>) -> Result<Self, String> {
        let bitmap = match texture {
            Texture::Constant(color) => return Ok(Uniform::from(narrow(*color)).into()),
            Texture::MeshAttribute(asked) => {
                let found = sources.attributes.get(asked).cloned();
                return found.map(Into::into).ok_or_else(|| {
                    let name = &asked.name;
                    format!(
                        "the mesh attribute `{name}` colours what reflects, of a ply; use a bitmap"
                    )
                });
            }
            Texture::Checkerboard(board) => {
                let colors = [
                    Self::value(&board.color0, sources)?,
                    Self::value(&board.color1, sources)?,
                ];
                return Ok(texture::Checkerboard::new(colors, board.to_uv.as_affine2()).into());
            }
            Texture::Bitmap(bitmap) => bitmap,
        };
        let key = Arc::as_ptr(bitmap) as usize;
        if let Some(known) = sources.images.0.get(&key) {
            return Ok(known.clone());
        }
        let made: Self = image(bitmap)?.into();
        sources.images.0.insert(key, made.clone());
        Ok(made)
    }
}

fn image(bitmap: &mitsuba::Bitmap) -> Result<texture::Bitmap, String> {
    let read = if bitmap.raw {
        texture::Bitmap::read_raw(&bitmap.file)
    } else {
        texture::Bitmap::read(&bitmap.file)
    };
    let filter = match bitmap.filter {
        BitmapFilter::Bilinear => texture::Filter::Bilinear,
        BitmapFilter::Nearest => texture::Filter::Nearest,
    };
    let wrap = match bitmap.wrap {
        mitsuba::Wrap::Repeat => texture::Wrap::Repeat,
        mitsuba::Wrap::Mirror => texture::Wrap::Mirror,
        mitsuba::Wrap::Clamp => texture::Wrap::Clamp,
    };
    Ok(read
        .map_err(|e| e.to_string())?
        .filtered(filter)
        .wrapped(wrap)
        .transformed(bitmap.to_uv.as_affine2()))
}

struct Maker<'a, 's> {
    sources: &'a mut Sources<'s>,
}

impl Maker<'_, '_> {
    fn material<P: Value>(&mut self, bsdf: &Bsdf) -> Result<Material<P>, String> {
        if is_constant_diffuse(bsdf) {
            return Lambertian::make(bsdf, self.sources).map(Into::into);
        }
        let refused = |e: crate::Error| e.to_string();
        Ok(match bsdf {
            Bsdf::Diffuse { reflectance } => bsdf::Diffuse::<P>::new(self.value(reflectance)?)
                .map_err(refused)?
                .into(),
            Bsdf::TwoSided { front, back } => {
                let outer = self.material(front)?;
                if front == back {
                    bsdf::TwoSided::new(outer).into()
                } else {
                    bsdf::TwoSided::different(outer, self.material(back)?).into()
                }
            }
            Bsdf::Conductor(conductor) => self.conductor(conductor)?.into(),
            Bsdf::RoughConductor {
                conductor,
                roughness,
            } => {
                let (metal, roughness) = (self.conductor(conductor)?, self.roughness(roughness)?);
                bsdf::RoughConductor::new(metal, roughness).into()
            }
            Bsdf::Dielectric(dielectric) => {
                let [inside, outside] = indices(dielectric.int_ior, dielectric.ext_ior);
                bsdf::Dielectric::new(inside, outside)
                    .map_err(refused)?
                    .tinted(self.tint(dielectric)?)
                    .into()
            }
            Bsdf::ThinDielectric(dielectric) => {
                let [inside, outside] = indices(dielectric.int_ior, dielectric.ext_ior);
                bsdf::ThinDielectric::new(inside, outside)
                    .map_err(refused)?
                    .tinted(self.tint(dielectric)?)
                    .into()
            }
            Bsdf::RoughDielectric {
                dielectric,
                roughness,
            } => {
                let [inside, outside] = indices(dielectric.int_ior, dielectric.ext_ior);
                let roughness = self.roughness(roughness)?;
                bsdf::RoughDielectric::new(inside, outside, roughness)
                    .map_err(refused)?
                    .tinted(self.tint(dielectric)?)
                    .into()
            }
            Bsdf::Plastic(plastic) => {
                let [inside, outside] = indices(plastic.int_ior, plastic.ext_ior);
                let base = self.value(&plastic.diffuse_reflectance)?;
                bsdf::Plastic::new(base, inside, outside)
                    .map_err(refused)?
                    .tinted(self.value(&plastic.specular_reflectance)?)
                    .map_err(refused)?
                    .saturated(saturation(plastic))
                    .into()
            }
            Bsdf::RoughPlastic { plastic, roughness } => {
                let [inside, outside] = indices(plastic.int_ior, plastic.ext_ior);
                let base = self.value(&plastic.diffuse_reflectance)?;
                let Texture::Constant(alpha) = roughness.alpha_u else {
                    return Err("a roughness of plastic that varies".to_owned());
                };
                let [alpha, _, _] = narrow(alpha);
                bsdf::RoughPlastic::new(
                    base,
                    inside,
                    outside,
                    distribution(roughness.distribution),
                    alpha,
                )
                .map_err(refused)?
                .tinted(self.value(&plastic.specular_reflectance)?)
                .map_err(refused)?
                .saturated(saturation(plastic))
                .into()
            }
            Bsdf::Mask { opacity, nested } => {
                let law: Material<P> = self.material(nested)?;
                bsdf::Mask::new(self.value(opacity)?, law).into()
            }
            Bsdf::Blend {
                weight,
                first,
                second,
            } => {
                let laws = [self.material(first)?, self.material(second)?];
                bsdf::Blend::new(self.value(weight)?, laws).into()
            }
            Bsdf::Null => bsdf::Null.into(),
            Bsdf::BumpMap {
                texture,
                scale,
                perturbed,
                nested,
            } => {
                if !texture.attributes().is_empty() {
                    return Err(
                        "a bump map of a mesh attribute, which has no slope; use a bitmap"
                            .to_owned(),
                    );
                }
                let law: Material<P> = self.material(nested)?;
                #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
                let scale = *scale as f32;
                bsdf::BumpMap::new(self.value(texture)?, scale, law)
                    .with(relief(*perturbed))
                    .into()
            }
            Bsdf::NormalMap {
                texture,
                perturbed,
                nested,
            } => {
                let law: Material<P> = self.material(nested)?;
                bsdf::NormalMap::new(self.value(texture)?, law)
                    .with(relief(*perturbed))
                    .into()
            }
        })
    }

    fn value<P: Value>(&mut self, texture: &Texture) -> Result<P, String> {
        P::value(texture, self.sources)
    }

    fn conductor<P: Value>(&mut self, conductor: &Conductor) -> Result<bsdf::Conductor<P>, String> {
        let refused = |e: crate::Error| e.to_string();
        let (eta, k) = (self.value(&conductor.eta)?, self.value(&conductor.k)?);
        bsdf::Conductor::new(eta, k)
            .map_err(refused)?
            .tinted(self.value(&conductor.specular_reflectance)?)
            .map_err(refused)
    }

    fn tint<P: Value>(&mut self, dielectric: &Dielectric) -> Result<Tint<P>, String> {
        let reflectance = self.value(&dielectric.specular_reflectance)?;
        let transmittance = self.value(&dielectric.specular_transmittance)?;
        Tint::new(reflectance, transmittance).map_err(|e| e.to_string())
    }

    fn roughness<P: Value>(&mut self, roughness: &Roughness) -> Result<bsdf::Roughness<P>, String> {
        let distribution = distribution(roughness.distribution);
        let along_u = self.value(&roughness.alpha_u)?;
        if roughness.alpha_u == roughness.alpha_v {
            return bsdf::Roughness::new(distribution, along_u).map_err(|e| e.to_string());
        }
        let along_v = self.value(&roughness.alpha_v)?;
        bsdf::Roughness::anisotropic(distribution, along_u, along_v).map_err(|e| e.to_string())
    }
}

fn distribution(distribution: mitsuba::Distribution) -> bsdf::Distribution {
    match distribution {
        mitsuba::Distribution::Beckmann => bsdf::Distribution::Beckmann,
        mitsuba::Distribution::Ggx => bsdf::Distribution::Ggx,
    }
}

fn saturation(plastic: &Plastic) -> Saturation {
    if plastic.nonlinear {
        Saturation::Nonlinear
    } else {
        Saturation::Linear
    }
}

fn relief(perturbed: Perturbed) -> Relief {
    let mut relief = Relief::default();
    if !perturbed.flip_invalid_normals {
        relief = relief.unturned();
    }
    if !perturbed.use_shadowing_function {
        relief = relief.unshadowed();
    }
    relief
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn indices(inside: f64, outside: f64) -> [f32; 2] {
    [inside as f32, outside as f32]
}
