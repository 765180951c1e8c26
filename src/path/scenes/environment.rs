//! Bodies under a constant sky.

use crate::Error;
use crate::path::bsdf::{Dielectric, Lambertian, Material, Mirror};
use crate::path::filter::BoxFilter;
use crate::path::light::{Constant, NoLight};
use crate::path::sensor::Pinhole;
use crate::path::shape::{Flat, Sphere, cuboid};
use crate::path::{Object, Paths, Scene, View};

/// A ground, a cube and three balls, diffuse, mirror and glass, under a constant environment.
pub fn environment() -> View<Material, NoLight, Constant, Pinhole> {
    let scene = || -> Result<_, Error> {
        let ground = Flat::parallelogram([-4.0, 0.0, -4.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0])?;
        let (cosine, sine) = (0.433_012_7, 0.25);
        let cube = cuboid(
            [-1.2, 0.52, 0.8],
            [[cosine, 0.0, -sine], [0.0, 0.5, 0.0], [sine, 0.0, cosine]],
        )?;
        let diffuse_ball = Sphere::new([0.35, 0.47, 1.5], 0.45)?;
        let mirror_ball = Sphere::new([1.3, 0.62, 0.3], 0.6)?;
        let glass_ball = Sphere::new([-0.15, 0.52, -0.6], 0.5)?;
        let objects = vec![
            Object::new([ground], Lambertian::new([0.6, 0.55, 0.5])?),
            Object::new(cube, Lambertian::new([0.15, 0.3, 0.7])?),
            Object::new([diffuse_ball], Lambertian::new([0.8, 0.45, 0.1])?),
            Object::new([mirror_ball], Mirror::new([1.0; 3])?),
            Object::new([glass_ball], Dielectric::new(1.5, 1.0)?),
        ];
        Scene::new(objects, Constant::new([1.0, 0.9, 0.8])?)
    };
    let sensor = Pinhole::look_at(
        [0.5, 2.4, -5.0],
        [0.0, 0.4, 0.2],
        [0.0, 1.0, 0.0],
        40.0,
        1.0,
    );
    View {
        scene: scene().expect("the bodies are a valid scene"),
        sensor: sensor.expect("the camera is valid"),
        filter: BoxFilter,
        paths: Paths::default(),
    }
}
