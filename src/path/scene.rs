//! What is rendered.

use std::sync::Arc;

use glam::{Affine2, Affine3A, Mat2, Vec3A};

use super::bsdf::{Bsdf, Material};
use super::color;
use super::geometry::{Copied, FEW, Geometry, Hit, around};
use super::light::{AreaLights, Emitter, Environment, Light, NoEnvironment, Picture};
#[cfg(feature = "simd")]
use super::packet::{Emitted, Optics, Packet};
use super::ray::{Ray, Surface};
use super::resolution::{check_object, check_scene};
use super::segment::{End, Segment};
use super::shape::{Mesh, Primitive, Shape};
use super::texture::{self, Parameter, Texture};
use super::{Detail, Shading};
use crate::Error;

/// Shapes that scatter light alike, and perhaps emit it.
#[derive(Clone, Debug, PartialEq)]
pub struct Object<B> {
    shapes: Vec<Primitive>,
    meshes: Vec<Mesh>,
    bsdf: B,
    radiance: Radiance,
}

/// What an object emits.
#[derive(Clone, Debug, PartialEq)]
enum Radiance {
    Nothing,
    Uniform(Vec3A),
    Picture(Texture),
}

impl Radiance {
    /// The shape that emits it, given the way from the shape's texture coordinates to those of a picture.
    fn emitter(&self, shape: Primitive, place: Affine2) -> Emitter {
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
    fn emitters(&self, mesh: &Mesh) -> impl Iterator<Item = Emitter> {
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
    fn take_apart(&mut self) {
        if !self.meshes.iter().all(Mesh::is_plain) {
            return;
        }
        for mesh in self.meshes.drain(..) {
            let triangles = (0..mesh.triangles().len()).map(|triangle| mesh.flat(triangle));
            self.shapes.extend(triangles.map(Primitive::from));
        }
    }

    /// The corners of a box around everything.
    fn bounds(&self) -> [Vec3A; 2] {
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

/// A scene: shapes, how they scatter light (`B`), which of them emit it (`L`) and what is around them (`E`).
///
/// A part that a scene lacks is a type without content, [`NoLight`](super::light::NoLight) or [`NoEnvironment`]; a scene
/// of one law of scattering names it. What the type does not name costs no code, no memory and no coordinate.
///
/// ```
/// use estimand::path::bsdf::Lambertian;
/// use estimand::path::light::{Constant, NoLight};
/// use estimand::path::shape::Sphere;
/// use estimand::path::{Object, Scene};
///
/// let ball = Object::new([Sphere::new([0.0; 3], 1.0)?], Lambertian::new([0.5; 3])?);
/// let scene: Scene<Lambertian, NoLight, _> = Scene::new(vec![ball], Constant::new([1.0; 3])?)?;
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Debug)]
pub struct Scene<B = Material, L = AreaLights, E = NoEnvironment> {
    geometry: Geometry,
    /// Of each shape.
    owners: Vec<Owner>,
    bsdfs: Vec<B>,
    lights: L,
    environment: E,
    #[cfg(feature = "simd")]
    packet: Option<Box<Packet>>,
}

/// What belongs to a shape or a mesh.
#[derive(Clone, Copy, Debug)]
struct Owner {
    bsdf: u32,
    /// The emitter that it is; of a mesh the one that its first triangle is, and the others follow.
    emitter: u32,
    /// How many triangles of meshes there are before it.
    triangles: usize,
}

impl Owner {
    /// The emitter that was hit, if it is one, and which of all triangles it is, if it is one.
    #[inline]
    fn emitter(self, triangle: usize) -> Option<u32> {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "emitters have numbers below 2^32"
        )]
        (self.emitter != DARK).then(|| self.emitter + (triangle - self.triangles) as u32)
    }
}

/// The `emitter` of a shape that emits nothing.
const DARK: u32 = u32::MAX;

/// The point of a scene that a ray has met.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<'a, B: Bsdf> {
    /// The point of the surface, with what its law of scattering needs to know.
    pub surface: Surface<B::Detail>,
    /// How light is scattered there.
    pub bsdf: &'a B,
    /// Which emitter it belongs to, if any.
    pub emitter: Option<u32>,
    geometry: &'a Geometry,
    hit: Hit,
}

impl<B: Bsdf> Vertex<'_, B> {
    /// The parametrisation of the surface, whether its law of scattering needs it or not.
    #[inline]
    pub fn shading(&self) -> Shading {
        self.geometry.shading(&self.hit)
    }

    /// The point of the surface alone.
    #[inline]
    pub fn place(&self) -> &Surface {
        &self.hit.surface
    }
}

impl<B: Bsdf, L: Light, E: Environment> Scene<B, L, E> {
    /// The scene of some objects in an environment.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the lights are of a type for more or fewer of them, for 2^32 shapes or more, and where `f32`
    /// does not tell points apart: see the limits of [`path`](super).
    pub fn new(objects: Vec<Object<B>>, environment: E) -> Result<Self, Error> {
        Self::with_instances(objects, Vec::new(), environment)
    }

    /// The same with instances: objects that are stored once and stand in many places.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); for instances that emit light; and for places that cannot be inverted.
    pub fn with_instances(
        objects: Vec<Object<B>>,
        instances: Vec<Instances<B>>,
        environment: E,
    ) -> Result<Self, Error> {
        let mut parts = Parts::default();
        let mut objects = objects;
        if B::Detail::is_nothing() && are_few(&objects) && instances.is_empty() {
            objects.iter_mut().for_each(Object::take_apart);
        }
        let (shapes, meshes) = parts.add(objects)?;
        let mut copies = Vec::new();
        for Instances { objects, places } in instances {
            if objects
                .iter()
                .any(|object| object.radiance != Radiance::Nothing)
            {
                let given = "one that does";
                return Err(Error::refused("instance", "one that emits no light", given));
            }
            let start = parts.owners.len();
            let (shapes, meshes) = parts.add(objects)?;
            let group = Arc::new(Geometry::new(shapes, meshes, Vec::new()));
            check_scene(group.bounds())?;
            for place in places {
                let copy = Copied::new(Arc::clone(&group), start, place)?;
                check_object(copy.extent())?;
                copies.push(copy);
            }
        }
        let mut emitters = core::mem::take(&mut parts.emitters);
        let flat = |shape: &Primitive| matches!(shape, Primitive::Flat(_));
        // Many paths at once draw from the area: that costs more samples, but each takes less than half the time.
        let at_once = shapes.len() <= FEW
            && shapes.iter().all(flat)
            && meshes.is_empty()
            && copies.is_empty()
            && parts
                .bsdfs
                .iter()
                .all(|bsdf| bsdf.as_lambertian().is_some())
            && emitters.iter().all(|emitter| emitter.picture.is_none())
            && environment.constant().is_some();
        if !at_once {
            emitters.iter_mut().for_each(Emitter::by_solid_angle);
        }
        let geometry = Geometry::new(shapes, meshes, copies);
        check_scene(geometry.bounds())?;
        #[cfg_attr(
            not(feature = "simd"),
            expect(unused_mut, reason = "there are no packets")
        )]
        let mut scene = Self {
            geometry,
            owners: parts.owners,
            bsdfs: parts.bsdfs,
            lights: L::new(emitters)?,
            environment,
            #[cfg(feature = "simd")]
            packet: None,
        };
        #[cfg(feature = "simd")]
        {
            scene.packet = scene.packed().map(Box::new);
        }
        Ok(scene)
    }

    /// The scene for many paths at once, if it is one of those.
    #[cfg(feature = "simd")]
    fn packed(&self) -> Option<Packet> {
        let sky = self.environment.constant()?;
        let lights = self.lights.as_area_lights()?;
        let optics = |shape: usize| {
            let owner = self.owners[shape];
            let law = self.bsdfs[owner.bsdf as usize].as_lambertian()?;
            let emitted = if owner.emitter == DARK {
                None
            } else {
                Some(Emitted {
                    emitter: owner.emitter,
                    radiance: lights.radiance(owner.emitter)?,
                    probability: lights.probability(owner.emitter),
                })
            };
            Some(Optics {
                albedo: law.albedo,
                inner: law.has_inside(),
                emitted,
            })
        };
        Packet::new(&self.geometry, optics, lights, sky)
    }
}

/// Whether there are so few shapes and triangles that looking at all of them is best.
fn are_few<B>(objects: &[Object<B>]) -> bool {
    let count = |object: &Object<B>| {
        let triangles = object.meshes.iter().map(|mesh| mesh.triangles().len());
        object.shapes.len() + triangles.sum::<usize>()
    };
    objects.iter().map(count).sum::<usize>() <= FEW
}

/// What the objects of a scene are made of.
struct Parts<B> {
    owners: Vec<Owner>,
    bsdfs: Vec<B>,
    emitters: Vec<Emitter>,
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
    fn add(&mut self, objects: Vec<Object<B>>) -> Result<(Vec<Primitive>, Vec<Mesh>), Error> {
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

/// An index below 2^32 - 1, which stands for none.
fn index(index: usize) -> Result<u32, Error> {
    match u32::try_from(index) {
        Ok(index) if index != DARK => Ok(index),
        _ => Err(Error::refused("number of shapes", "below 2^32", index)),
    }
}

impl<B: Bsdf, L, E> Scene<B, L, E> {
    /// Where the ray first meets a surface.
    #[inline]
    pub fn meet(&self, ray: &Ray) -> Option<Vertex<'_, B>> {
        let hit = self.geometry.nearest(ray)?;
        let owner = self.owners[hit.part];
        let detail = Detail::from_shading(|| self.geometry.shading(&hit));
        Some(Vertex {
            surface: hit.surface.with(detail),
            bsdf: &self.bsdfs[owner.bsdf as usize],
            emitter: owner.emitter(hit.triangle),
            geometry: &self.geometry,
            hit,
        })
    }
}

impl<B: Bsdf, L, E> Scene<B, L, E> {
    /// The same ray from behind the shapes that emit light which it meets first.
    pub(in crate::path) fn past_lights(&self, mut ray: Ray) -> Ray {
        while let Some(vertex) = self.meet(&ray)
            && vertex.emitter.is_some()
        {
            ray.origin = vertex.surface.leave(ray.direction);
        }
        ray
    }
}

impl<B, L, E> Scene<B, L, E> {
    /// The shapes that emit light.
    #[inline]
    pub fn lights(&self) -> &L {
        &self.lights
    }

    /// The scene for many paths at once, if it is one of those.
    #[cfg(feature = "simd")]
    #[inline]
    pub(in crate::path) fn packet(&self) -> Option<&Packet> {
        self.packet.as_deref()
    }

    /// What is around the shapes.
    #[inline]
    pub fn environment(&self) -> &E {
        &self.environment
    }

    /// Whether any shape is in the way.
    #[inline]
    pub fn occluded(&self, segment: &Segment) -> bool {
        match segment.end() {
            End::Surface => self.geometry.divided(&segment.ray, segment.length),
            End::Open => self.geometry.occluded(&segment.ray, segment.length),
        }
    }
}
