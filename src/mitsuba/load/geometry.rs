//! Shapes, as the path tracer has them.

mod cube;
mod mesh;

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, DMat3, DMat4, DVec3};

use super::attributes::Attributes;
use super::surroundings::narrow;
use crate::Error;
use crate::mitsuba::transform::tangent;
use crate::mitsuba::{Description, Geometry, SceneError, Shape, Texture};
use crate::path::Object;
use crate::path::shape::{Cylinder, Disk, Flat, Mesh, Primitive, Sphere};

/// Everything that a ray can hit.
#[derive(Debug, Default)]
pub(super) struct Pieces<'a> {
    pub(super) solids: Vec<Solid<'a>>,
    pub(super) groups: Vec<Group<'a>>,
    pub(super) left_out: Vec<String>,
}

/// A shape with its geometry.
#[derive(Debug)]
pub(super) struct Solid<'a> {
    pub(super) shape: &'a Shape,
    pub(super) surface: Body,
    pub(super) attributes: Attributes,
    /// `None` if it emits nothing.
    pub(super) radiance: Option<&'a Texture>,
}

/// Shapes that stand in a scene many times over.
#[derive(Debug)]
pub(super) struct Group<'a> {
    pub(super) solids: Vec<Solid<'a>>,
    pub(super) places: Vec<Affine3A>,
}

/// What the path tracer makes of a shape.
#[derive(Debug)]
pub(super) enum Body {
    Shapes(Vec<Primitive>),
    /// With normals at the vertices that are not those of the triangles.
    Smooth(Mesh),
    Faceted(Mesh),
}

impl Body {
    /// Whether normals are interpolated.
    pub(super) fn is_smooth(&self) -> bool {
        matches!(self, Self::Smooth(_))
    }

    /// How many shapes it is.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Shapes(shapes) => shapes.len(),
            Self::Smooth(mesh) | Self::Faceted(mesh) => mesh.triangles().len(),
        }
    }

    pub(super) fn object<B>(self, bsdf: B) -> Object<B> {
        match self {
            Self::Shapes(shapes) => Object::new(shapes, bsdf),
            Self::Smooth(mesh) | Self::Faceted(mesh) => Object::mesh(mesh, bsdf),
        }
    }
}

impl<'a> Pieces<'a> {
    /// Loads all shapes and instances of a scene.
    pub(super) fn load(description: &'a Description) -> Result<Self, SceneError> {
        let mut pieces = Self::default();
        let mut known: HashMap<*const [Shape], usize> = HashMap::new();
        let mut dropped = 0;
        for shape in &description.shapes {
            let Geometry::Instance { shapes } = &shape.geometry else {
                pieces.solids.extend(Solid::load(shape, &mut dropped)?);
                continue;
            };
            let place = Affine3A::from_mat4(shape.to_world.as_mat4());
            if let Some(&group) = known.get(&Arc::as_ptr(shapes)) {
                pieces.groups[group].places.push(place);
                continue;
            }
            known.insert(Arc::as_ptr(shapes), pieces.groups.len());
            let mut solids = Vec::new();
            for shape in shapes.iter() {
                solids.extend(Solid::load(shape, &mut dropped)?);
            }
            pieces.groups.push(Group {
                solids,
                places: vec![place],
            });
        }
        for solid in &pieces.solids {
            if solid.shape.radiance.is_some() && solid.radiance.is_none() {
                let place = &solid.shape.place;
                let element = place.element();
                pieces
                    .left_out
                    .push(format!("the light of {element} at {place}, without power"));
            }
        }
        if dropped > 0 {
            pieces
                .left_out
                .push(format!("{dropped} triangles without area"));
        }
        Ok(pieces)
    }
}

impl<'a> Solid<'a> {
    /// `None` if there is nothing to hit.
    fn load(shape: &'a Shape, dropped: &mut usize) -> Result<Option<Self>, SceneError> {
        let mut attributes = Attributes::default();
        let surface = match &shape.geometry {
            Geometry::Mesh(file) => {
                let mesh = file.load()?;
                let refused = |e: String| shape.place.error(e);
                attributes = Attributes::of(shape, &mesh).map_err(refused)?;
                let mesh = mesh::place(mesh, file, &shape.to_world).map_err(refused)?;
                let (Body::Smooth(loaded) | Body::Faceted(loaded)) = &mesh else {
                    return Ok(None);
                };
                *dropped += loaded.dropped();
                if loaded.triangles().is_empty() {
                    return Ok(None);
                }
                mesh
            }
            geometry => Body::Shapes(
                primitives(geometry, &shape.to_world).map_err(|e| shape.place.error(e))?,
            ),
        };
        let radiance = shape
            .radiance
            .as_ref()
            .filter(|&radiance| *radiance != Texture::Constant(DVec3::ZERO));
        Ok(Some(Self {
            shape,
            surface,
            attributes,
            radiance,
        }))
    }
}

/// The shapes that are no meshes.
fn primitives(geometry: &Geometry, to_world: &DMat4) -> Result<Vec<Primitive>, String> {
    let refused = |e: Error| e.to_string();
    let point = |x: f64, y: f64, z: f64| to_world.transform_point3(DVec3::new(x, y, z));
    let vector = |x: f64, y: f64, z: f64| to_world.transform_vector3(DVec3::new(x, y, z));
    // Normals go to the other side where a transform mirrors.
    let mirrored = to_world.determinant() < 0.0;
    let shape: Primitive = match *geometry {
        Geometry::Rectangle { flip_normals } => {
            let flat = Flat::parallelogram(
                narrow(point(-1.0, -1.0, 0.0)),
                narrow(vector(2.0, 0.0, 0.0)),
                narrow(vector(0.0, 2.0, 0.0)),
            )
            .map_err(refused)?;
            let turned = mirrored != flip_normals;
            if turned { flat.turned() } else { flat }.into()
        }
        Geometry::Disk { flip_normals } => {
            let disk = Disk::new(
                narrow(point(0.0, 0.0, 0.0)),
                narrow(vector(1.0, 0.0, 0.0)),
                narrow(vector(0.0, 1.0, 0.0)),
            )
            .map_err(refused)?;
            let turned = mirrored != flip_normals;
            if turned { disk.turned() } else { disk }.into()
        }
        Geometry::Cube { flip_normals } => return cube::sides(to_world, flip_normals),
        Geometry::Sphere {
            center,
            radius,
            flip_normals,
        } => {
            let scale = uniform_scale(to_world)?;
            let sphere = Sphere::new(
                narrow(to_world.transform_point3(center)),
                narrow(DVec3::splat(radius * scale))[0],
            )
            .and_then(|sphere| {
                let [start, pole] = [vector(1.0, 0.0, 0.0), vector(0.0, 0.0, 1.0)];
                sphere.with_axes(start.as_vec3a(), pole.as_vec3a())
            })
            .map_err(refused)?;
            // A mirror turns the sphere inside out.
            match (mirrored, flip_normals) {
                (false, false) => sphere,
                (false, true) => sphere.turned(),
                (true, false) => sphere.mirrored().turned(),
                (true, true) => sphere.mirrored(),
            }
            .into()
        }
        Geometry::Cylinder {
            p0,
            p1,
            radius,
            flip_normals,
        } => {
            let scale = uniform_scale(to_world)?;
            let across = to_world.transform_vector3(tangent((p1 - p0).normalize()));
            let cylinder = Cylinder::placed(
                narrow(to_world.transform_point3(p0)),
                narrow(to_world.transform_point3(p1)),
                narrow(DVec3::splat(radius * scale))[0],
                across.as_vec3a(),
            )
            .map_err(refused)?;
            // A mirror turns normals inside out, and once more by the direction in which it is parametrised.
            match (mirrored, flip_normals) {
                (false, false) => cylinder,
                (false, true) => cylinder.turned(),
                (true, false) => cylinder.mirrored(),
                (true, true) => cylinder.mirrored().turned(),
            }
            .into()
        }
        Geometry::Mesh(_) | Geometry::Instance { .. } => return Ok(Vec::new()),
    };
    Ok(vec![shape])
}

/// The factor by which lengths change, the same in all directions.
fn uniform_scale(to_world: &DMat4) -> Result<f64, String> {
    let linear = DMat3::from_mat4(*to_world);
    let scale = linear.x_axis.length();
    let product = (linear.transpose() * linear) * (scale * scale).recip();
    let difference = (product - DMat3::IDENTITY).to_cols_array();
    if difference.iter().all(|entry| entry.abs() < 1e-4) {
        Ok(scale)
    } else {
        Err("spheres and cylinders are scaled alike in all directions; use a mesh".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;
    use crate::path::Ray;
    use crate::path::shape::Shape as _;

    /// Whether the outer side is inside, and where the texture coordinate u is, at the point that a ray along -x meets.
    fn seen(geometry: &Geometry, x: f64) -> (bool, f32) {
        let to_world = DMat4::from_scale(DVec3::new(x, 1.0, 1.0));
        let shape = primitives(geometry, &to_world).unwrap()[0];
        let ray = Ray {
            origin: Vec3A::new(3.0, 0.3, 0.5),
            direction: Vec3A::NEG_X,
        };
        let surface = shape.surface(&ray, shape.intersect(&ray, 9.0).unwrap());
        (surface.normal.x < 0.0, shape.shading(&surface).uv.x)
    }

    /// Mitsuba 3.9.1, `ray_intersect`.
    #[test]
    fn mirrors_turn_spheres_inside_out_but_not_cylinders() {
        for flip_normals in [false, true] {
            let sphere = Geometry::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
                flip_normals,
            };
            let cylinder = Geometry::Cylinder {
                p0: DVec3::ZERO,
                p1: DVec3::Z,
                radius: 1.0,
                flip_normals,
            };
            for (geometry, x, inside, u) in [
                (&sphere, 1.0, flip_normals, 0.056_299_7),
                (&sphere, -1.0, !flip_normals, 0.443_700),
                (&cylinder, 1.0, flip_normals, 0.048_493_3),
                (&cylinder, -1.0, flip_normals, 0.451_507),
            ] {
                let seen = seen(geometry, x);
                assert_eq!(seen.0, inside, "{geometry:?} {x}");
                assert!((seen.1 - u).abs() < 2e-6, "{geometry:?} {x}: {}", seen.1);
            }
        }
    }
}
