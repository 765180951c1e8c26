//! Shapes: where surfaces are.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::bsdf::{self, Bsdf};
use super::document::Kind;
use super::emitter::sampling_weight;
use super::error::{Place, SceneError};
use super::query::{Child, Query};
use super::spectrum::Role;
use super::texture::Texture;

/// A shape, what it is made of and what it emits.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The id, if it has one.
    pub id: Option<String>,
    /// What it is, in its own coordinates.
    pub geometry: Geometry,
    /// From its own coordinates to the scene's.
    pub to_world: DMat4,
    /// How it scatters light. Of an instance this is not used.
    pub bsdf: Arc<Bsdf>,
    /// The radiance that it emits from the outer side, if it emits any: an `area` light.
    pub radiance: Option<Texture>,
    /// Where it stands in the file.
    pub place: Place,
}

/// What a shape is in its own coordinates. The outer side is the one that normals point to.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// `rectangle`: the square from -1 to 1 in x and y, at z = 0, whose normal is +z.
    Rectangle {
        /// Whether the normal is -z.
        flip_normals: bool,
    },
    /// `cube`: from -1 to 1 in x, y and z, with outward normals.
    Cube {
        /// Whether the normals are inward.
        flip_normals: bool,
    },
    /// `sphere`: with outward normals.
    Sphere {
        /// The centre.
        center: DVec3,
        /// The radius.
        radius: f64,
        /// Whether the normals are inward.
        flip_normals: bool,
    },
    /// `disk`: of radius 1 around the origin, at z = 0, whose normal is +z.
    Disk {
        /// Whether the normal is -z.
        flip_normals: bool,
    },
    /// `cylinder`: without caps, with outward normals.
    Cylinder {
        /// One end of the axis.
        p0: DVec3,
        /// The other end.
        p1: DVec3,
        /// The radius.
        radius: f64,
        /// Whether the normals are inward.
        flip_normals: bool,
    },
    /// `obj` and `ply`: triangles from a file.
    Mesh(MeshFile),
    /// `instance`: the shapes of a `shapegroup`.
    Instance {
        /// The shapes; none of them is an instance or emits light.
        shapes: Arc<[Shape]>,
    },
}

/// Triangles from a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshFile {
    /// The file.
    pub file: PathBuf,
    /// Its format.
    pub format: MeshFormat,
    /// Whether each triangle has its own normal, instead of those of the vertices.
    pub face_normals: bool,
    /// Whether the normals are turned over.
    pub flip_normals: bool,
    /// Whether the second texture coordinate is one minus that of the file.
    pub flip_tex_coords: bool,
}

/// The formats of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, in ASCII or binary.
    Ply,
}

/// The shape that an object is; `None` for a group, which appears only where it is instanced.
pub(super) fn describe(mut query: Query<'_>) -> Result<Option<Shape>, SceneError> {
    if query.plugin() == "shapegroup" {
        return Ok(None);
    }
    let q = &mut query;
    let geometry = geometry(q)?;
    let to_world = q.transform("to_world")?.unwrap_or_default();
    // It is about derivatives.
    q.ignore(&["silhouette_sampling_weight"]);
    let (mut material, mut radiance) = (None, None);
    for child in q.children() {
        match child.kind {
            Kind::Bsdf if material.is_none() => material = Some(bsdf::child(q, child)?),
            Kind::Emitter if radiance.is_none() => radiance = Some(area_light(q, child)?),
            Kind::Bsdf | Kind::Emitter => {
                return Err(child
                    .property
                    .place
                    .error("a shape has at most one BSDF and one emitter"));
            }
            Kind::Volumetric => {
                return Err(child.property.place.error(
                    "media are not supported; without them the shape is a surface around nothing",
                ));
            }
            _ => return Err(q.stray(child)),
        }
    }
    // What only emits reflects nothing.
    let reflectance = if radiance.is_some() { 0.0 } else { 0.5 };
    let shape = Shape {
        id: q.id().map(str::to_owned),
        geometry,
        to_world,
        bsdf: material.unwrap_or_else(|| {
            Arc::new(Bsdf::Diffuse {
                reflectance: Texture::Constant(DVec3::splat(reflectance)),
            })
        }),
        radiance,
        place: q.place().clone(),
    };
    query.finish()?;
    Ok(Some(shape))
}

fn geometry(q: &mut Query<'_>) -> Result<Geometry, SceneError> {
    Ok(match q.plugin() {
        "rectangle" | "cube" => {
            // Both are flat with or without it.
            q.ignore(&["face_normals"]);
            let flip_normals = q.flag("flip_normals", false)?;
            match q.plugin() {
                "cube" => Geometry::Cube { flip_normals },
                _ => Geometry::Rectangle { flip_normals },
            }
        }
        "sphere" => Geometry::Sphere {
            center: q.vector("center")?.unwrap_or_default(),
            radius: q.positive("radius", 1.0)?,
            flip_normals: q.flag("flip_normals", false)?,
        },
        "disk" => Geometry::Disk {
            flip_normals: q.flag("flip_normals", false)?,
        },
        "cylinder" => {
            let p0 = q.vector("p0")?.unwrap_or(DVec3::ZERO);
            let p1 = q.vector("p1")?.unwrap_or(DVec3::Z);
            if p0 == p1 {
                return Err(q.error("`p0` and `p1` must differ"));
            }
            Geometry::Cylinder {
                p0,
                p1,
                radius: q.positive("radius", 1.0)?,
                flip_normals: q.flag("flip_normals", false)?,
            }
        }
        "obj" => Geometry::Mesh(mesh(q, MeshFormat::Obj, true)?),
        "ply" => Geometry::Mesh(mesh(q, MeshFormat::Ply, false)?),
        "instance" => instance(q)?,
        _ => {
            return Err(q.unsupported(
                "there are rectangle, cube, sphere, disk, cylinder, obj, ply, shapegroup and instance; \
                 convert other meshes to PLY",
            ));
        }
    })
}

fn mesh(
    q: &mut Query<'_>,
    format: MeshFormat,
    flip_tex_coords: bool,
) -> Result<MeshFile, SceneError> {
    Ok(MeshFile {
        file: q.file("filename")?,
        format,
        face_normals: q.flag("face_normals", false)?,
        flip_normals: q.flag("flip_normals", false)?,
        flip_tex_coords: q.flag("flip_tex_coords", flip_tex_coords)?,
    })
}

fn instance(q: &mut Query<'_>) -> Result<Geometry, SceneError> {
    let [group] = q.children_of(Kind::Shape)?[..] else {
        return Err(q.error("it has exactly one shapegroup"));
    };
    let known = q.context.groups.borrow().get(&group.index).cloned();
    if let Some(shapes) = known {
        return Ok(Geometry::Instance { shapes });
    }
    let shapes = self::group(q.enter(group)?)?;
    q.context
        .groups
        .borrow_mut()
        .insert(group.index, shapes.clone());
    Ok(Geometry::Instance { shapes })
}

fn group(mut query: Query<'_>) -> Result<Arc<[Shape]>, SceneError> {
    if query.plugin() != "shapegroup" {
        return Err(query.error("only a shapegroup can be instanced; put the shape into one"));
    }
    query.ignore(&["to_world"]);
    let mut shapes = Vec::new();
    for child in query.children_of(Kind::Shape)? {
        let nested = query.enter(child)?;
        if matches!(nested.plugin(), "shapegroup" | "instance") {
            return Err(nested.error("groups and instances cannot be nested in a shapegroup"));
        }
        let Some(shape) = describe(nested)? else {
            continue;
        };
        if shape.radiance.is_some() {
            return Err(shape
                .place
                .error("an instanced shape cannot emit light; place it without an instance"));
        }
        shapes.push(shape);
    }
    query.finish()?;
    Ok(shapes.into())
}

/// The radiance of an area light.
fn area_light(q: &Query<'_>, child: Child<'_>) -> Result<Texture, SceneError> {
    let mut query = q.enter(child)?;
    if query.plugin() != "area" {
        return Err(query.unsupported("within a shape there is area"));
    }
    let radiance = query.texture_or("radiance", Role::Emission, 1.0)?;
    sampling_weight(&mut query)?;
    query.finish()?;
    Ok(radiance)
}
