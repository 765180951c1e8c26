//! What scenes are made of.

use glam::{Affine2, Affine3A, Mat2, Vec3A};

use super::color;
use super::geometry::around;
use super::light::{Emitter, Picture};
use super::shape::{Mesh, Primitive, Shape};
use super::texture::{self, Parameter, Texture};
use crate::Error;

/// Shapes that scatter light alike, and perhaps emit it.
#[derive(Clone, Debug, PartialEq)]
pub struct Object<B> {
    pub(in crate::path) shapes: Vec<Primitive>,
    pub(in crate::path) meshes: Vec<Mesh>,
    pub(in crate::path) bsdf: B,
    pub(in crate::path) radiance: Radiance,
}

/// What an object emits.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::path) enum Radiance {
    Nothing,
    Uniform(Vec3A),
    Picture(Texture),
}

impl Radiance {
    /// The shape that emits it, given the way from the shape's texture coordinates to those of a picture.
    pub(in crate::path) fn emitter(&self, shape: Primitive, place: Affine2) -> Emitter {
        let (radiance, picture) = match self {
            Self::Nothing => (Vec3A::ZERO, None),
            Self::Uniform(radiance) => (*radiance, None),
            Self::Picture(texture) => {
                let texture = texture.clone();
                (
                    Vec3A::splat(texture.mean()),
                    Some(Picture { texture, place }),
                )
            }
        };
        Emitter {
            shape,
            radiance,
            picture,
        }
    }

    /// The triangles of a mesh that emit it.
    pub(in crate::path) fn emitters(&self, mesh: &Mesh) -> impl Iterator<Item = Emitter> {
        (0..mesh.triangles().len()).map(|triangle| {
            let [a, b, c] = mesh.uvs(triangle);
            let place = Affine2::from_mat2_translation(Mat2::from_cols(b - a, c - a), a);
            self.emitter(mesh.flat(triangle).into(), place)
        })
    }
}

impl<B> Object<B> {
    /// Shapes that scatter light as `bsdf` says.
    pub fn new(shapes: impl IntoIterator<Item = impl Into<Primitive>>, bsdf: impl Into<B>) -> Self {
        Self {
            shapes: shapes.into_iter().map(Into::into).collect(),
            meshes: Vec::new(),
            bsdf: bsdf.into(),
            radiance: Radiance::Nothing,
        }
    }

    /// A mesh that scatters light as `bsdf` says.
    pub fn mesh(mesh: Mesh, bsdf: impl Into<B>) -> Self {
        Self {
            meshes: vec![mesh],
            ..Self::new([] as [Primitive; 0], bsdf)
        }
    }

    /// The same with the triangles of its meshes as shapes of their own. Meshes that know of normals or texture coordinates stay
    /// whole, since single triangles do not.
    pub(in crate::path) fn take_apart(&mut self) {
        if !self.meshes.iter().all(Mesh::is_plain) {
            return;
        }
        for mesh in self.meshes.drain(..) {
            let triangles = (0..mesh.triangles().len()).map(|triangle| mesh.flat(triangle));
            self.shapes.extend(triangles.map(Primitive::from));
        }
    }

    /// The corners of a box around everything.
    pub(in crate::path) fn bounds(&self) -> [Vec3A; 2] {
        let shapes = self.shapes.iter().map(Shape::bounds);
        around(shapes.chain(self.meshes.iter().map(Mesh::bounds)))
    }

    /// The same, emitting light from the outer sides: `radiance` in linear red, green and blue.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a component that is negative or not finite.
    pub fn emitting(mut self, radiance: [f32; 3]) -> Result<Self, Error> {
        let radiance = color::radiance(radiance)?;
        self.radiance = if radiance == Vec3A::ZERO {
            Radiance::Nothing
        } else {
            Radiance::Uniform(radiance)
        };
        Ok(self)
    }

    /// The same, emitting light that varies over its shapes: `radiance` at their texture coordinates.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a texture with a component that is negative or not finite.
    pub fn emitting_picture(mut self, radiance: Texture) -> Result<Self, Error> {
        self.radiance = match texture::finite("radiance", radiance)? {
            Texture::Uniform(uniform) => {
                return self.emitting(uniform.color(&()).to_array());
            }
            picture if picture.range()[1] > 0.0 => Radiance::Picture(picture),
            _ => Radiance::Nothing,
        };
        Ok(self)
    }
}

/// Objects that stand in a scene several times over, each time moved, turned and scaled as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Instances<B> {
    /// What is copied. Nothing of it may emit light.
    pub objects: Vec<Object<B>>,
    /// From the coordinates of the objects to those of the scene, for each copy.
    pub places: Vec<Affine3A>,
}
