//! What the shapes of a scene belong to.

use glam::Affine2;

use crate::Error;
use crate::path::light::Emitter;
use crate::path::object::{Object, Radiance};
use crate::path::resolution::check_object;
use crate::path::shape::{Mesh, Primitive};

/// What belongs to a shape or a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner {
    pub(super) bsdf: u32,
    /// The emitter that it is; of a mesh the one that its first triangle is, and the others follow.
    pub(super) emitter: u32,
    /// How many triangles of meshes there are before it.
    triangles: usize,
}

impl Owner {
    /// The emitter that was hit, if it is one, and which of all triangles it is, if it is one.
    #[inline]
    pub(super) fn emitter(self, triangle: usize) -> Option<u32> {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "emitters have numbers below 2^32"
        )]
        (self.emitter != DARK).then(|| self.emitter + (triangle - self.triangles) as u32)
    }
}

/// The `emitter` of a shape that emits nothing.
pub(super) const DARK: u32 = u32::MAX;

/// What the objects of a scene are made of.
pub(super) struct Parts<B> {
    pub(super) owners: Vec<Owner>,
    pub(super) bsdfs: Vec<B>,
    pub(super) emitters: Vec<Emitter>,
}

impl<B> Default for Parts<B> {
    fn default() -> Self {
        Self {
            owners: Vec::new(),
            bsdfs: Vec::new(),
            emitters: Vec::new(),
        }
    }
}

impl<B> Parts<B> {
    /// The shapes and the meshes of some objects, after their owners were added in this order.
    pub(super) fn add(
        &mut self,
        objects: Vec<Object<B>>,
    ) -> Result<(Vec<Primitive>, Vec<Mesh>), Error> {
        let (mut shapes, mut meshes, mut owners_of_meshes) = (Vec::new(), Vec::new(), Vec::new());
        let mut triangles = 0;
        for mut object in objects {
            check_object(object.bounds())?;
            let bsdf = index(self.bsdfs.len())?;
            self.bsdfs.push(object.bsdf);
            let shines = object.radiance != Radiance::Nothing;
            for &shape in &object.shapes {
                let mut owner = Owner {
                    bsdf,
                    emitter: DARK,
                    triangles: 0,
                };
                if shines {
                    owner.emitter = index(self.emitters.len())?;
                    let emitter = object.radiance.emitter(shape, Affine2::IDENTITY);
                    self.emitters.push(emitter);
                }
                self.owners.push(owner);
            }
            for mesh in &object.meshes {
                let mut owner = Owner {
                    bsdf,
                    emitter: DARK,
                    triangles,
                };
                triangles += mesh.triangles().len();
                if shines {
                    owner.emitter = index(self.emitters.len())?;
                    index(self.emitters.len() + mesh.triangles().len())?;
                    self.emitters.extend(object.radiance.emitters(mesh));
                }
                owners_of_meshes.push(owner);
            }
            shapes.append(&mut object.shapes);
            meshes.append(&mut object.meshes);
        }
        self.owners.append(&mut owners_of_meshes);
        Ok((shapes, meshes))
    }
}

impl<B> Parts<B> {
    /// Whether only what is flat emits light, the same all over.
    pub(super) fn lights_are_flat(&self) -> bool {
        self.emitters.iter().all(Emitter::is_plain)
    }
}

/// An index below 2^32 - 1, which stands for none.
fn index(index: usize) -> Result<u32, Error> {
    match u32::try_from(index) {
        Ok(index) if index != DARK => Ok(index),
        _ => Err(Error::refused("number of shapes", "below 2^32", index)),
    }
}

/// Up to so many triangles and shapes, a sweep over all is faster than a tree of the triangles.
const APART: usize = 48;

/// Whether meshes are best taken apart.
pub(super) fn are_few<B>(objects: &[Object<B>]) -> bool {
    let count = |object: &Object<B>| {
        let triangles = object.meshes.iter().map(|mesh| mesh.triangles().len());
        object.shapes.len() + triangles.sum::<usize>()
    };
    objects.iter().map(count).sum::<usize>() <= APART
}
