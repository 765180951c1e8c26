//! From a [`Description`] to a scene that can be rendered, of the smallest type that is enough.

mod attributes;
mod filter;
mod geometry;
mod material;
mod needs;
mod surroundings;

use std::fmt;

use super::picture::Picture;
use super::sensor::Projection;
use super::texture as described;
use super::{Description, SceneError, Sensor};
use crate::path::bsdf::{Lambertian, Material};
use crate::path::light::{
    AreaLights, Background, Constant, Environment, Light, LightTree, NoEnvironment, NoLight,
    Surroundings,
};
use crate::path::sensor::{
    self, Camera, Clipped, FarPlane, Orthographic, Pinhole, Sensor as _, ThinLens,
};
use crate::path::texture::{Texture, Uniform};
use crate::path::{Instances, Object, Paths, Ray, Surfaces, View};
use crate::points::{Independent, PointSet};
use crate::{Error, Sampler};
use filter::AnyFilter;
use geometry::{Pieces, Solid};
use material::{Images, Make, Sources, Value};
use needs::{Lights, Needs};

/// Which type a scene is loaded as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instance {
    /// The smallest that can render it: what the scene lacks costs no code, no coordinate and no memory.
    #[default]
    Smallest,
    /// The one that can render every scene.
    General,
}

/// A scene that can be rendered.
#[derive(Debug)]
pub struct Loaded {
    /// What is seen.
    pub picture: Box<dyn Picture>,
    /// The width and the height of the picture, in pixels: those of the crop.
    pub size: [u32; 2],
    /// What the scene has no need of, and what it has in vain: parts of the tracer, lights without power, triangles
    /// without area, objects that nothing refers to.
    pub left_out: Vec<String>,
}

impl Description {
    /// Loads the files that the scene names and makes it ready to be rendered, by its first sensor.
    ///
    /// # Errors
    ///
    /// [`SceneError`] for files that cannot be read, and for what the path tracer has no counterpart of or refuses.
    pub fn load(&self, instance: Instance) -> Result<Loaded, SceneError> {
        let pieces = Pieces::load(self)?;
        let surroundings = surroundings::load(self)?;
        let needs = match instance {
            Instance::Smallest => Needs::of(self, &pieces, &surroundings),
            Instance::General => Needs::ALL,
        };
        let mut left_out = needs.left_out();
        left_out.extend(pieces.left_out.iter().cloned());
        left_out.extend(surroundings.left_out.iter().cloned());
        left_out.extend(
            self.unused
                .iter()
                .map(|place| format!("{} at {place}", place.element())),
        );
        let crop = self.sensors[0].film.crop;
        let plan = Plan {
            description: self,
            sensor: &self.sensors[0],
            needs,
            pieces,
            background: surroundings.background,
            sources: surroundings.sources,
        };
        Ok(Loaded {
            picture: plan.scattering()?,
            size: [crop.width, crop.height],
            left_out,
        })
    }
}

/// A scene on its way to a type, which is found part by part.
struct Plan<'a> {
    description: &'a Description,
    sensor: &'a Sensor,
    needs: Needs,
    pieces: Pieces<'a>,
    background: Background,
    sources: Vec<crate::path::light::Source>,
}

impl Plan<'_> {
    /// With the laws of scattering that it needs.
    fn scattering(self) -> Result<Box<dyn Picture>, SceneError> {
        if self.needs.shading {
            self.light::<Material<Texture>>()
        } else if self.needs.materials {
            self.light::<Material<Uniform>>()
        } else {
            self.light::<Lambertian>()
        }
    }

    /// With the sources of light that it needs.
    fn light<B: Make>(mut self) -> Result<Box<dyn Picture>, SceneError> {
        let place = &self.description.place;
        let refused = |e: Error| place.error(e);
        let (objects, instances) = objects::<B>(core::mem::take(&mut self.pieces))?;
        let surfaces = Surfaces::new(objects, instances).map_err(refused)?;
        let by_tree =
            self.needs.lights == Lights::Several && surfaces.want_light_tree(self.rays()?);
        let sources = core::mem::take(&mut self.sources);
        let background = core::mem::replace(&mut self.background, Background::None);
        // Next to a tree, surroundings that are none cost nothing to speak of.
        if self.needs.surroundings || by_tree {
            let surroundings = Surroundings::new(sources, background).map_err(refused)?;
            return match self.needs.lights {
                Lights::None => self.view::<B, NoLight, _>(surfaces, surroundings),
                _ if by_tree => self.view::<B, LightTree, _>(surfaces, surroundings),
                _ => self.view::<B, AreaLights, _>(surfaces, surroundings),
            };
        }
        match (background, self.needs.lights) {
            (Background::Constant(constant), Lights::None) => {
                self.view::<B, NoLight, Constant>(surfaces, constant)
            }
            (Background::Constant(constant), _) => {
                self.view::<B, AreaLights, Constant>(surfaces, constant)
            }
            (_, Lights::None) => self.view::<B, NoLight, _>(surfaces, NoEnvironment),
            (_, _) => self.view::<B, AreaLights, _>(surfaces, NoEnvironment),
        }
    }

    /// With the camera that it needs.
    fn view<B, L, E>(
        self,
        surfaces: Surfaces<B>,
        environment: E,
    ) -> Result<Box<dyn Picture>, SceneError>
    where
        B: Make,
        L: Light + fmt::Debug + 'static,
        E: Environment + fmt::Debug + 'static,
    {
        let paths = self.paths()?;
        let refused = |e: Error| self.sensor.place.error(e);
        let projection = self.projection();
        let camera = self.camera(&projection).map_err(refused)?;
        let depth = self.sensor.far_clip - self.sensor.near_clip;
        let far = FarPlane::new(&projection, depth).map_err(refused)?;
        let cut = surfaces.are_cut_by(&far);
        let filter = AnyFilter::of(self.sensor.film.filter).map_err(refused)?;
        let place = &self.description.place;
        let scene = surfaces.scene::<L, E>(environment);
        let scene = scene.map_err(|e| place.error(e))?;
        Ok(match (camera, filter) {
            (Camera::Pinhole(sensor), AnyFilter::Box(filter)) if !self.needs.camera && !cut => {
                Box::new(View {
                    scene,
                    sensor,
                    filter,
                    paths,
                })
            }
            (camera, filter) => Box::new(View {
                scene,
                sensor: Clipped::new(camera, cut.then_some(far)),
                filter,
                paths,
            }),
        })
    }

    /// Rays of the camera, all over the picture, without end.
    fn rays(&self) -> Result<impl Iterator<Item = Ray> + use<>, SceneError> {
        let camera = self.camera(&self.projection());
        let camera = camera.map_err(|e| self.sensor.place.error(e))?;
        let points = Independent::new(0);
        Ok((0..).map(move |index| {
            let mut u = points.point(index);
            let film = u.next_2d();
            camera.ray(film, &mut u)
        }))
    }

    /// How the film lies in front of the camera, but for the angle that it spans.
    fn projection(&self) -> sensor::Projection {
        let film = &self.sensor.film;
        let [width, height] = [film.width, film.height].map(f64::from);
        let [left, top] = [
            f64::from(film.crop.x) / width,
            f64::from(film.crop.y) / height,
        ];
        let right = f64::from(film.crop.x + film.crop.width) / width;
        let bottom = f64::from(film.crop.y + film.crop.height) / height;
        sensor::Projection {
            to_world: self.sensor.to_world,
            aspect: width / height,
            window: [[left, top], [right, bottom]],
            near: self.sensor.near_clip,
            ..sensor::Projection::default()
        }
    }

    fn camera(&self, placed: &sensor::Projection) -> Result<Camera, Error> {
        let mut placed = *placed;
        match self.sensor.projection {
            Projection::Perspective {
                fov,
                principal_point_offset,
            } => {
                placed.width_degrees = fov;
                placed.principal_point_offset = principal_point_offset.to_array();
                Ok(Pinhole::new(&placed)?.into())
            }
            Projection::ThinLens {
                fov,
                aperture_radius,
                focus_distance,
            } => {
                placed.width_degrees = fov;
                Ok(ThinLens::new(&placed, aperture_radius, focus_distance)?.into())
            }
            Projection::Orthographic => Ok(Orthographic::new(&placed)?.into()),
        }
    }

    fn paths(&self) -> Result<Paths, SceneError> {
        let Description {
            integrator, place, ..
        } = self.description;
        let mut paths = Paths::default().roulette_from(integrator.rr_depth);
        if integrator.hide_emitters {
            paths = if integrator.hides_in_front_alone {
                paths.hiding_lights_in_front()
            } else {
                paths.hiding_lights()
            };
        }
        match integrator.max_depth {
            None => Ok(paths),
            Some(depth) => paths.longest(depth).map_err(|e| place.error(e)),
        }
    }
}

/// The objects of a scene, and those that stand in it many times over.
#[expect(clippy::type_complexity, reason = "two lists, for one call")]
fn objects<B: Make>(pieces: Pieces<'_>) -> Result<(Vec<Object<B>>, Vec<Instances<B>>), SceneError> {
    let mut images = Images::default();
    let mut object = |solid: Solid<'_>| {
        let shape = solid.shape;
        let refused = |message: String| shape.place.error(message);
        let mut sources = Sources {
            images: &mut images,
            attributes: &solid.attributes,
        };
        let bsdf = B::make(&shape.bsdf, &mut sources).map_err(refused)?;
        let object = solid.surface.object(bsdf);
        match solid.radiance {
            None => Ok(object),
            Some(described::Texture::Constant(radiance)) => object
                .emitting(surroundings::narrow(*radiance))
                .map_err(|e| refused(e.to_string())),
            Some(picture) => {
                let picture = Value::value(picture, &mut sources).map_err(refused)?;
                object
                    .emitting_picture(picture)
                    .map_err(|e| refused(e.to_string()))
            }
        }
    };
    let objects = pieces
        .solids
        .into_iter()
        .map(&mut object)
        .collect::<Result<_, SceneError>>()?;
    let instances = pieces
        .groups
        .into_iter()
        .map(|group| {
            let objects = group.solids.into_iter().map(&mut object);
            Ok(Instances {
                objects: objects.collect::<Result<_, SceneError>>()?,
                places: group.places,
            })
        })
        .collect::<Result<_, SceneError>>()?;
    Ok((objects, instances))
}
