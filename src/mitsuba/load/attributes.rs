//! What meshes have besides their surface, as far as a scene asks for it.

use crate::mitsuba::{Bsdf, Mesh, MeshAttribute, Shape, Texture};
use crate::path::texture;

/// The attributes of a shape that its law of scattering asks for; of most shapes none.
#[derive(Debug, Default)]
pub(super) struct Attributes(Vec<(MeshAttribute, texture::Attribute)>);

impl Attributes {
    pub(super) const NONE: Self = Self(Vec::new());

    /// Those of a mesh, or an error that says what there is instead.
    pub(super) fn of(shape: &Shape, mesh: &Mesh) -> Result<Self, String> {
        let mut attributes = Self::default();
        for asked in asked(&shape.bsdf) {
            if attributes.get(asked).is_none() {
                let found = find(mesh, asked)?;
                attributes.0.push((asked.clone(), found));
            }
        }
        Ok(attributes)
    }

    /// The one that a texture asks for.
    pub(super) fn get(&self, asked: &MeshAttribute) -> Option<&texture::Attribute> {
        let found = self.0.iter().find(|(known, _)| known == asked);
        found.map(|(_, attribute)| attribute)
    }
}

/// The attributes that the textures of a law of scattering ask for.
fn asked(bsdf: &Bsdf) -> Vec<&MeshAttribute> {
    let own = bsdf.textures().into_iter().flat_map(Texture::attributes);
    let nested = bsdf.nested().into_iter().flat_map(asked);
    own.chain(nested).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn find(mesh: &Mesh, asked: &MeshAttribute) -> Result<texture::Attribute, String> {
    let MeshAttribute { name, scale } = asked;
    let Some(attribute) = (mesh.attributes.iter()).find(|attribute| attribute.name == *name) else {
        let names: Vec<_> = (mesh.attributes.iter())
            .map(|attribute| format!("`{}`", attribute.name))
            .collect();
        return Err(match &names[..] {
            [] => format!("the mesh has no attributes, and none of the name `{name}`"),
            names => format!(
                "the mesh has no attribute `{name}`; it has {}",
                names.join(", ")
            ),
        });
    };
    let values = (attribute.values.iter())
        .map(|value| (f64::from(*value) * scale) as f32)
        .collect();
    let made = if name.starts_with("vertex_") {
        let corners = mesh.triangles.clone();
        texture::Attribute::of_vertices(attribute.channels, values, corners)
    } else {
        texture::Attribute::of_triangles(attribute.channels, values)
    };
    made.map_err(|e| format!("attribute `{name}`: {e}"))
}
