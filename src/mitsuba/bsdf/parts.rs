//! What a law of scattering is made of.

use super::{Bsdf, Conductor, Dielectric, Plastic, Roughness};
use crate::mitsuba::Texture;

impl Bsdf {
    /// The laws that it is made of.
    pub(in crate::mitsuba) fn nested(&self) -> Vec<&Self> {
        match self {
            Self::TwoSided { front, back } => vec![front, back],
            Self::Blend { first, second, .. } => vec![first, second],
            Self::Mask { nested, .. }
            | Self::BumpMap { nested, .. }
            | Self::NormalMap { nested, .. } => vec![nested],
            _ => Vec::new(),
        }
    }

    /// Whether it, or any that it is made of, is so.
    pub(in crate::mitsuba) fn any(&self, is: &impl Fn(&Self) -> bool) -> bool {
        is(self) || self.nested().into_iter().any(|nested| nested.any(is))
    }

    /// Its values that may vary over a surface, without those of the laws that it is made of.
    pub(in crate::mitsuba) fn textures(&self) -> Vec<&Texture> {
        match self {
            Self::Diffuse { reflectance } => vec![reflectance],
            Self::Conductor(conductor) => conductor.textures(),
            Self::RoughConductor {
                conductor,
                roughness,
            } => [conductor.textures(), roughness.textures()].concat(),
            Self::Dielectric(dielectric) | Self::ThinDielectric(dielectric) => {
                dielectric.textures()
            }
            Self::RoughDielectric {
                dielectric,
                roughness,
            } => [dielectric.textures(), roughness.textures()].concat(),
            Self::Plastic(plastic) => plastic.textures(),
            Self::RoughPlastic { plastic, roughness } => {
                [plastic.textures(), roughness.textures()].concat()
            }
            Self::Mask { opacity, .. } => vec![opacity],
            Self::Blend { weight, .. } => vec![weight],
            Self::BumpMap { texture, .. } | Self::NormalMap { texture, .. } => vec![texture],
            Self::Null | Self::TwoSided { .. } => Vec::new(),
        }
    }
}

impl Conductor {
    fn textures(&self) -> Vec<&Texture> {
        vec![&self.eta, &self.k, &self.specular_reflectance]
    }
}

impl Dielectric {
    fn textures(&self) -> Vec<&Texture> {
        vec![&self.specular_reflectance, &self.specular_transmittance]
    }
}

impl Plastic {
    fn textures(&self) -> Vec<&Texture> {
        vec![&self.diffuse_reflectance, &self.specular_reflectance]
    }
}

impl Roughness {
    fn textures(&self) -> Vec<&Texture> {
        vec![&self.alpha_u, &self.alpha_v]
    }
}
