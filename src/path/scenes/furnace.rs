//! A furnace.

use crate::Error;
use crate::path::bsdf::Lambertian;
use crate::path::filter::BoxFilter;
use crate::path::light::{AreaLights, NoEnvironment};
use crate::path::sensor::Pinhole;
use crate::path::shape::{Flat, Sphere, cuboid};
use crate::path::{Object, Paths, Scene, View};

/// A closed room with a ball in it, all of which reflects half of the light and emits a radiance of 0.5: the radiance
/// is 1 everywhere.
pub fn furnace() -> View<Lambertian, AreaLights, NoEnvironment, Pinhole> {
    let scene = || -> Result<_, Error> {
        let walls = cuboid(
            [0.0; 3],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        )?;
        let ball = Sphere::new([0.2, -0.3, 0.4], 0.45)?;
        let grey = Lambertian::new([0.5; 3])?;
        let objects = vec![
            Object::new(walls.map(Flat::turned), grey).emitting([0.5; 3])?,
            Object::new([ball], grey).emitting([0.5; 3])?,
        ];
        Scene::new(objects, NoEnvironment)
    };
    let sensor = Pinhole::look_at(
        [-0.6, 0.5, -0.9],
        [0.2, -0.2, 0.4],
        [0.0, 1.0, 0.0],
        60.0,
        1.0,
    );
    View {
        scene: scene().expect("the furnace is a valid scene"),
        sensor: sensor.expect("the camera is valid"),
        filter: BoxFilter,
        paths: Paths::default(),
    }
}
