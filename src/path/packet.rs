//! Many paths at once, one in each lane of the vectors that the machine has.
//!
//! For scenes of few flat shapes that scatter light ideally diffusely and emit it, and of meshes that do not emit any, below a
//! constant sky or none. Every lane has the bits of [`Paths::radiance`]: the same arithmetic in the same order, the coordinates read in the same order.

mod meshes;
mod near;
mod place;
mod sweep;
mod walk;

use glam::{Vec3, Vec3A};

use super::Paths;
use super::geometry::Geometry;
use super::light::AreaLights;
use super::render::Start;
use super::shape::Primitive;
use crate::Sampler;

pub(in crate::path) use place::{Emitted, Optics};

use meshes::Meshes;
use near::Near;
use place::{MOST, Table};
use sweep::Shapes;
use walk::Walk;

/// A scene that many paths are followed in at once.
#[derive(Debug)]
pub(in crate::path) struct Packet {
    table: Table,
    shapes: Shapes,
    /// Those of them that can be between two points of the scene.
    dividing: Shapes,
    meshes: Option<Meshes>,
    lights: AreaLights,
    near: Option<Near>,
    /// The shape of each emitter.
    emitters: Vec<u32>,
    sky: Vec3A,
    triangles: bool,
    slanted_lights: bool,
    one_sided: bool,
    arch: pulp::Arch,
}

impl Packet {
    /// The scene of the given shapes and lights, if it is one of those. `optics` tells what a shape does to light, or a mesh, which
    /// have the numbers after the shapes, if that is among what packets know.
    pub(in crate::path) fn new(
        geometry: &Geometry,
        optics: impl Fn(usize) -> Option<Optics>,
        lights: &AreaLights,
        sky: Vec3A,
    ) -> Option<Self> {
        let (primitives, sweep, soup) = geometry.few()?;
        if sweep.flat_shapes.len() != primitives.len() || primitives.len() > MOST {
            return None;
        }
        let meshes = match soup {
            None => None,
            Some(soup) => Some(Meshes::new(soup, |mesh| optics(primitives.len() + mesh))?),
        };
        let mut packet = Self {
            table: Table::EMPTY,
            shapes: Shapes::default(),
            dividing: Shapes::default(),
            lights: lights.clone(),
            near: None,
            emitters: Vec::new(),
            sky,
            triangles: false,
            slanted_lights: false,
            one_sided: meshes.as_ref().is_some_and(Meshes::one_sided),
            meshes,
            arch: pulp::Arch::new(),
        };
        let mut emitters = Vec::new();
        for (place, &shape) in sweep.flat_shapes.iter().enumerate() {
            let Primitive::Flat(flat) = &primitives[shape] else {
                return None;
            };
            let optics = optics(shape)?;
            let number = u32::try_from(place).ok()?;
            packet.table.set(place, flat, &optics);
            packet.shapes.push(number, flat);
            if geometry.divides(flat) {
                packet.dividing.push(number, flat);
            }
            packet.triangles |= flat.slant != 0.0;
            packet.one_sided |= !optics.inner;
            if let Some(light) = optics.emitted {
                packet.slanted_lights |= flat.slant != 0.0;
                emitters.push((light.emitter, number));
            }
        }
        emitters.sort_unstable();
        packet.emitters = emitters.into_iter().map(|(_, shape)| shape).collect();
        packet.near = Near::new(&packet.emitters, lights);
        Some(packet)
    }

    /// What [`Paths::radiance`] gives for each of the points, times the weight that its start has.
    ///
    /// The starts are behind a pointer, and it is not inlined, so that the loop is compiled for every kind of sampler, but not of
    /// view.
    #[inline(never)]
    pub(in crate::path) fn radiance<U: Sampler>(
        &self,
        paths: Paths,
        start: &dyn Fn(&mut U) -> Start,
        points: &mut [U],
        values: &mut [Vec3],
    ) {
        self.arch.dispatch(Walk {
            packet: self,
            paths,
            start,
            points,
            values,
        });
    }

    /// The shape that a coordinate chooses among the lights, and what is left of the coordinate.
    #[inline(always)]
    fn choose(&self, u: f64) -> (u32, f64) {
        let (chosen, u) = self.lights.choose(u);
        (self.emitters[chosen], u)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::hash::{hash, unit_f32};
    use crate::path::bsdf::{Bsdf, Lambertian, Material};
    use crate::path::light::{AreaLights, Constant, Environment, Light, NoEnvironment, NoLight};
    use crate::path::sensor::Pinhole;
    use crate::path::shape::{Flat, Mesh, Primitive, cuboid};
    use crate::path::texture::Texture;
    use crate::path::{Object, Paths, Pixel, Scene, View, filter::BoxFilter, scenes};
    use crate::points::{HashedOwen, PointSet, Sobol};
    use crate::{Error, Integrand};

    /// Every value of `evaluate_many` must be that of `evaluate`, to the bit.
    fn agree<B: Bsdf, L: Light, E: Environment>(view: &View<B, L, E, Pinhole>) {
        assert!(view.scene.packet().is_some(), "the scene has packets");
        let size = [7, 5];
        for position in [[0, 0], [3, 4], [6, 2], [2, 1]] {
            let pixel = Pixel {
                scene: &view.scene,
                sensor: &view.sensor,
                filter: &view.filter,
                paths: view.paths,
                position,
                size,
            };
            let seed = hash(u64::from(position[0]), u64::from(position[1]));
            let points = Sobol::new(12).unwrap().scrambled(HashedOwen { seed });
            for count in [1, 15, 300] {
                let mut samplers: Vec<_> = (0..count).map(|index| points.point(index)).collect();
                let mut values = vec![Vec3::NAN; samplers.len()];
                pixel.evaluate_many(&mut samplers, &mut values);
                for (index, value) in (0..count).zip(values) {
                    let expected = pixel.evaluate(&mut points.point(index));
                    assert_eq!(value, expected, "{position:?}, point {index} of {count}");
                }
            }
        }
    }

    #[test]
    fn packets_give_the_bits_of_single_paths_in_the_cornell_box() {
        let mut view = scenes::cornell_box();
        agree(&view);
        for longest in [1, 2, 8] {
            view.paths = Paths::default().longest(longest).unwrap();
            agree(&view);
        }
        view.paths = Paths::default().roulette_from(1);
        agree(&view);
        view.paths = view.learn_roulette([16, 16], 4, 1).unwrap();
        assert!(view.paths != Paths::default());
        agree(&view);
    }

    /// A room of triangles, turned, below a sky, with lights of both kinds.
    fn room<L: Light, E: Environment>(
        lit: bool,
        environment: E,
    ) -> Result<View<Lambertian, L, E, Pinhole>, Error> {
        let mut state = 0;
        let mut random = || {
            state += 1;
            unit_f32(hash(11, state))
        };
        let mut objects = vec![Object::new(
            cuboid(
                [0.0; 3],
                [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]],
            )?
            .into_iter()
            .skip(1)
            .map(Flat::turned),
            Lambertian::new([0.7, 0.5, 0.9])?,
        )];
        for k in 0..12 {
            let corners = [0; 3].map(|_| [0; 3].map(|_| 1.2 * random() - 0.6));
            let object = Object::new(
                [Flat::triangle(corners)?],
                Lambertian::new([0.5; 3])?.outside(),
            );
            let light = lit && k < 4;
            objects.push(if light {
                object.emitting([1.0, k as f32, 2.0])?
            } else {
                object
            });
        }
        if lit {
            let lamp = Flat::parallelogram([-0.1, 0.7, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2])?;
            objects.push(Object::new([lamp], Lambertian::new([0.0; 3])?).emitting([9.0; 3])?);
        }
        Ok(View {
            scene: Scene::new(objects, environment)?,
            sensor: Pinhole::look_at([0.1, -0.1, -0.9], [0.0; 3], [0.0, 1.0, 0.0], 70.0, 1.4)?,
            filter: BoxFilter,
            paths: Paths::default(),
        })
    }

    #[test]
    fn packets_give_the_bits_of_single_paths_among_triangles_and_many_lights() {
        agree::<_, AreaLights, _>(&room(true, NoEnvironment).unwrap());
        let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
        agree::<_, AreaLights, _>(&room(true, sky).unwrap());
        agree::<_, NoLight, _>(&room(false, sky).unwrap());
    }

    /// A box with a lamp, and in it meshes with and without normals, one of them black inside and turned.
    fn meshes<B: Bsdf + From<Lambertian>, E: Environment>(
        smooth: bool,
        height: f32,
        environment: E,
    ) -> Result<View<B, AreaLights, E, Pinhole>, Error> {
        let edges = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let law = |albedo, one_sided| -> Result<B, Error> {
            let law = Lambertian::new(albedo)?;
            Ok(B::from(if one_sided { law.outside() } else { law }))
        };
        let walls = cuboid([0.0; 3], edges)?.into_iter().map(Flat::turned);
        let lamp = Flat::parallelogram([-0.4, height, -0.4], [0.8, 0.0, 0.0], [0.0, 0.0, 0.8])?;
        let mut objects = vec![
            Object::new(walls, law([0.7, 0.5, 0.9], false)?),
            Object::new([lamp], law([0.3; 3], true)?).emitting([5.0, 4.0, 3.0])?,
        ];
        let mut state = 0;
        let mut random = || {
            state += 1;
            unit_f32(hash(12, state))
        };
        for (k, one_sided) in [false, true, true].into_iter().enumerate() {
            // More triangles than are taken apart.
            let mut vector = |size: f32, shift: f32| [0; 3].map(|_| size * random() - shift);
            let positions: Vec<_> = (0..24).map(|_| vector(1.4, 0.7)).collect();
            let normals = (0..24).map(|_| vector(2.0, 1.0)).collect();
            let corners = (0..22).map(|first| [first, first + 1, first + 2]).collect();
            let mut mesh = Mesh::new(positions, corners)?;
            if smooth {
                mesh = mesh.with_normals(normals)?;
            }
            let mesh = if k == 2 { mesh.turned() } else { mesh };
            objects.push(Object::mesh(mesh, law([0.2, 0.6, 0.8], one_sided)?));
        }
        Ok(View {
            scene: Scene::new(objects, environment)?,
            sensor: Pinhole::look_at([0.1, -0.1, -0.9], [0.0; 3], [0.0, 1.0, 0.0], 70.0, 1.4)?,
            filter: BoxFilter,
            paths: Paths::default(),
        })
    }

    #[test]
    fn packets_give_the_bits_of_single_paths_among_meshes() {
        let sky = Constant::new([0.2, 0.3, 0.4]).unwrap();
        for height in [0.9, -0.6] {
            agree(&meshes::<Lambertian, _>(false, height, NoEnvironment).unwrap());
            agree(&meshes::<Material<Texture>, _>(true, height, NoEnvironment).unwrap());
            agree(&meshes::<Material<Texture>, _>(true, height, sky).unwrap());
        }
    }

    #[test]
    fn packets_give_the_bits_of_single_paths_near_a_lamp() {
        let mut view = scenes::cornell_box();
        let room = |size: f32| -> Result<Vec<Object<Lambertian>>, Error> {
            let white = Lambertian::new([0.6; 3])?;
            let floor = Flat::parallelogram([-4.0, 0.0, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])?;
            let half = 0.5 * size;
            let corner = [-half, 0.8, -half];
            let tile = [[size, 0.0, 0.0], [0.0, 0.0, size]];
            let corners = [corner, [half, 0.8, -half], [-half, 0.8, half]];
            Ok(vec![
                Object::new([floor], white),
                Object::new([Flat::parallelogram(corner, tile[0], tile[1])?], white)
                    .emitting([2.0; 3])?,
                Object::new([Flat::triangle(corners)?], white).emitting([1.0; 3])?,
            ])
        };
        for (size, near) in [(2.0, true), (0.1, false)] {
            view.scene = Scene::new(room(size).unwrap(), NoEnvironment).unwrap();
            let lights = view.scene.lights().shapes();
            let drawn = |shape: &Primitive| match shape {
                Primitive::Flat(flat) => flat.is_by_solid_angle(),
                _ => false,
            };
            assert_eq!(lights.map(drawn).collect::<Vec<_>>(), [near; 2], "{size}");
            agree(&view);
        }
    }

    #[test]
    fn other_scenes_have_no_packets() {
        assert!(scenes::environment().scene.packet().is_none());
        assert!(scenes::cornell_box_specular().scene.packet().is_none());
        let dark = room::<AreaLights, _>(false, NoEnvironment).unwrap();
        assert!(dark.scene.packet().is_none());
    }
}
