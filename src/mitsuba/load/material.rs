//! Laws of scattering, as the path tracer has them.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::needs::is_lambertian;
use super::surroundings::narrow;
use crate::mitsuba::{
    self, BitmapFilter, Bsdf, Conductor, Dielectric, Perturbed, Plastic, Roughness, Texture,
};
use crate::path::bsdf::{self, Lambertian, Material, Relief, Saturation, Tint};
use crate::path::texture::{self, Parameter, Uniform};

/// The images that have been read, by what they are described with: each is read once.
#[derive(Debug, Default)]
pub(super) struct Images(HashMap<usize, texture::Texture>);

/// A law of scattering that can be made of a description.
pub(super) trait Make: bsdf::Bsdf + fmt::Debug + Sized + 'static {
    fn make(bsdf: &Bsdf, images: &mut Images) -> Result<Self, String>;
}

impl Make for Lambertian {
    fn make(bsdf: &Bsdf, _: &mut Images) -> Result<Self, String> {
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
    fn make(bsdf: &Bsdf, images: &mut Images) -> Result<Self, String> {
        Maker { images }.material(bsdf)
    }
}

/// A parameter that can be made of a description.
pub(super) trait Value: Parameter + fmt::Debug + 'static {
    fn value(texture: &Texture, images: &mut Images) -> Result<Self, String>;
}

impl Value for Uniform {
    fn value(texture: &Texture, _: &mut Images) -> Result<Self, String> {
        match texture {
            Texture::Constant(color) => Ok(Self::from(narrow(*color))),
            _ => Err("a texture where the same value is needed everywhere".to_owned()),
        }
    }
}

impl Value for texture::Texture {
    fn value(texture: &Texture, images: &mut Images) -> Result<Self, String> {
        let key = match texture {
            Texture::Constant(color) => return Ok(Uniform::from(narrow(*color)).into()),
            Texture::MeshAttribute(attribute) => {
                return Err(format!(
                    "the mesh attribute `{}` is not supported as a texture; use a bitmap",
                    attribute.name
                ));
            }
            Texture::Bitmap(bitmap) => Arc::as_ptr(bitmap) as usize,
            Texture::Checkerboard(board) => Arc::as_ptr(board) as usize,
        };
        if let Some(known) = images.0.get(&key) {
            return Ok(known.clone());
        }
        let made: Self = match texture {
            Texture::Bitmap(bitmap) => image(bitmap)?.into(),
            Texture::Checkerboard(board) => {
                let colors = [
                    Self::value(&board.color0, images)?,
                    Self::value(&board.color1, images)?,
                ];
                texture::Checkerboard::new(colors, board.to_uv.as_affine2()).into()
            }
            Texture::Constant(_) | Texture::MeshAttribute(_) => unreachable!("returned above"),
        };
        images.0.insert(key, made.clone());
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

struct Maker<'a> {
    images: &'a mut Images,
}

impl Maker<'_> {
    fn material<P: Value>(&mut self, bsdf: &Bsdf) -> Result<Material<P>, String> {
        if is_lambertian(bsdf) {
            return Lambertian::make(bsdf, self.images).map(Into::into);
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
        P::value(texture, self.images)
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
