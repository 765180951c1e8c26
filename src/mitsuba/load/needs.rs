//! What a scene needs of the path tracer.

use super::geometry::Pieces;
use super::surroundings::Surroundings;
use crate::mitsuba::{Bsdf, Description, Filter, Projection, Texture};
use crate::path::light::Background;

/// What a scene needs of the path tracer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Needs {
    /// Texture coordinates, or normals that are not those of the surface.
    pub(super) shading: bool,
    /// Other laws of scattering than the ideally diffuse one.
    pub(super) materials: bool,
    /// Shapes that emit light.
    pub(super) lights: Lights,
    /// Lights without size, or a picture of the sky.
    pub(super) surroundings: bool,
    /// The same light from everywhere.
    pub(super) constant: bool,
    /// A camera with a lens or without perspective, or a filter wider than a pixel.
    pub(super) camera: bool,
    pub(super) instances: bool,
}

/// How many shapes emit light, and how one of them is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lights {
    None,
    /// Chosen by their power: one, or as many as there may be.
    ByPower,
    /// Two or more: a look at the scene tells whether by their power or by a [tree](crate::path::light::LightTree).
    Several,
}

impl Lights {
    /// Of a mesh every triangle is a light. Nothing that is copied shines.
    fn of(pieces: &Pieces<'_>) -> Self {
        let shining = pieces
            .solids
            .iter()
            .filter(|solid| solid.radiance.is_some());
        match shining.map(|solid| solid.surface.count()).sum() {
            0 => Self::None,
            1 => Self::ByPower,
            _ => Self::Several,
        }
    }
}

impl Needs {
    /// Everything; any number of lights can be chosen by their power.
    pub(super) const ALL: Self = Self {
        shading: true,
        materials: true,
        lights: Lights::ByPower,
        surroundings: true,
        constant: true,
        camera: true,
        instances: true,
    };

    pub(super) fn of(
        description: &Description,
        pieces: &Pieces<'_>,
        surroundings: &Surroundings,
    ) -> Self {
        let sensor = &description.sensors[0];
        let solids = || {
            let copied = pieces.groups.iter().flat_map(|group| &group.solids);
            pieces.solids.iter().chain(copied)
        };
        let is_sky = matches!(surroundings.background, Background::Sky(_));
        Self {
            shading: solids().any(|solid| solid.surface.is_smooth() || varies(&solid.shape.bsdf)),
            materials: !solids().all(|solid| is_constant_diffuse(&solid.shape.bsdf)),
            lights: Lights::of(pieces),
            surroundings: is_sky || !surroundings.sources.is_empty(),
            constant: matches!(surroundings.background, Background::Constant(_)),
            camera: !matches!(sensor.projection, Projection::Perspective { .. })
                || sensor.film.filter != Filter::Box,
            instances: !pieces.groups.is_empty(),
        }
    }

    /// The parts that it does not need.
    pub(super) fn left_out(&self) -> Vec<String> {
        let materials = self.materials || self.shading;
        [
            (self.shading, "textures and interpolated normals"),
            (materials, "laws of scattering other than the diffuse one"),
            (self.lights != Lights::None, "shapes that emit light"),
            (self.surroundings, "lights without size and skies"),
            (self.surroundings || self.constant, "an environment"),
            (self.camera, "lens, orthographic camera and wide filters"),
            (self.instances, "instances"),
        ]
        .into_iter()
        .filter(|(needed, _)| !needed)
        .map(|(_, part)| part.to_owned())
        .collect()
    }
}

/// Whether it is ideally diffuse with one colour, on the outer side or alike on both.
pub(super) fn is_constant_diffuse(bsdf: &Bsdf) -> bool {
    match bsdf {
        Bsdf::Diffuse {
            reflectance: Texture::Constant(_),
        } => true,
        Bsdf::TwoSided { front, back } => {
            front == back
                && matches!(
                    **front,
                    Bsdf::Diffuse {
                        reflectance: Texture::Constant(_)
                    }
                )
        }
        _ => false,
    }
}

/// Whether it varies over the surface, or with the direction along it.
fn varies(bsdf: &Bsdf) -> bool {
    bsdf.any(&|bsdf| match bsdf {
        Bsdf::BumpMap { .. } | Bsdf::NormalMap { .. } => true,
        // Directions along the surface are those of texture coordinates.
        Bsdf::RoughConductor { roughness, .. } | Bsdf::RoughDielectric { roughness, .. }
            if roughness.alpha_u != roughness.alpha_v =>
        {
            true
        }
        _ => !(bsdf.textures().into_iter()).all(|texture| matches!(texture, Texture::Constant(_))),
    })
}
