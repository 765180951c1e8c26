//! The Cornell box.

use crate::Error;
use crate::path::bsdf::{Bsdf, Dielectric, Lambertian, Material, Mirror};
use crate::path::filter::BoxFilter;
use crate::path::light::{AreaLights, NoEnvironment};
use crate::path::sensor::Pinhole;
use crate::path::shape::{Flat, Sphere};
use crate::path::{Object, Paths, Scene, View};

/// The radiance of the light of the Cornell box, in linear red, green and blue.
pub const CORNELL_LIGHT: [f32; 3] = [18.387, 13.9873, 6.75357];

const VALID: &str = "the published box is a valid scene";

/// The Cornell box: a diffuse room with a short and a tall block, and a light in the ceiling.[^cornell]
///
/// The vertices of the blocks are as published; the room is a rectangular box of 556 by 548.8 by 559.2, open to
/// the camera, and the light fills a hole of its ceiling. The reflectances are the usual linear sRGB for the
/// published spectra.[^mitsuba] To be rendered as a square.
///
/// [^cornell]: Cornell University Program of Computer Graphics (2005). *The Cornell Box*.
///     <https://www.graphics.cornell.edu/online/box/data.html>
/// [^mitsuba]: Jakob, Wenzel; et al. (2022). *Mitsuba 3 renderer*, function `cornell_box`.
///     <https://mitsuba-renderer.org>
pub fn cornell_box() -> View<Lambertian, AreaLights, NoEnvironment, Pinhole> {
    cornell_box_lit(CORNELL_LIGHT).expect(VALID)
}

/// The [Cornell box](cornell_box) with another `radiance` of the light, in linear red, green and blue.
///
/// # Errors
///
/// [`Error::Refused`] for a component that is negative or not finite, and for no light at all.
pub fn cornell_box_lit(
    radiance: [f32; 3],
) -> Result<View<Lambertian, AreaLights, NoEnvironment, Pinhole>, Error> {
    let mut objects = room(radiance)?;
    objects.push(block([
        [130.0, 165.0, 65.0],
        [82.0, 165.0, 225.0],
        [240.0, 165.0, 272.0],
        [290.0, 165.0, 114.0],
    ])?);
    objects.push(block([
        [423.0, 330.0, 247.0],
        [265.0, 330.0, 296.0],
        [314.0, 330.0, 456.0],
        [472.0, 330.0, 406.0],
    ])?);
    view(objects)
}

/// The Cornell box with a mirror ball and a glass ball in place of the blocks, hovering above the floor.
pub fn cornell_box_specular() -> View<Material, AreaLights, NoEnvironment, Pinhole> {
    let balls = || -> Result<_, Error> {
        let mut objects = room(CORNELL_LIGHT)?;
        let mirror_ball = Sphere::new([390.0, 112.0, 370.0], 110.0)?;
        objects.push(Object::new([mirror_ball], Mirror::new([1.0; 3])?));
        let glass_ball = Sphere::new([170.0, 97.0, 190.0], 95.0)?;
        objects.push(Object::new([glass_ball], Dielectric::new(1.5, 1.0)?));
        view(objects)
    };
    balls().expect(VALID)
}

fn view<B: Bsdf>(
    objects: Vec<Object<B>>,
) -> Result<View<B, AreaLights, NoEnvironment, Pinhole>, Error> {
    Ok(View {
        scene: Scene::new(objects, NoEnvironment)?,
        sensor: Pinhole::look_at(
            [278.0, 273.0, -800.0],
            [278.0, 273.0, 0.0],
            [0.0, 1.0, 0.0],
            39.307_648_116_107,
            1.0,
        )?,
        filter: BoxFilter,
        paths: Paths::default(),
    })
}

fn white() -> Result<Lambertian, Error> {
    Lambertian::new([0.885_809, 0.698_859, 0.666_422])
}

/// The walls and the light.
fn room<B: From<Lambertian>>(radiance: [f32; 3]) -> Result<Vec<Object<B>>, Error> {
    let white_walls = [
        // Floor.
        rectangle([0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [556.0, 0.0, 0.0])?,
        // Ceiling: in front of the light, behind it, and on its sides.
        rectangle([0.0, 548.8, 0.0], [556.0, 0.0, 0.0], [0.0, 0.0, 227.0])?,
        rectangle([0.0, 548.8, 332.0], [556.0, 0.0, 0.0], [0.0, 0.0, 227.2])?,
        rectangle([0.0, 548.8, 227.0], [213.0, 0.0, 0.0], [0.0, 0.0, 105.0])?,
        rectangle([343.0, 548.8, 227.0], [213.0, 0.0, 0.0], [0.0, 0.0, 105.0])?,
        // Back wall.
        rectangle([0.0, 0.0, 559.2], [0.0, 548.8, 0.0], [556.0, 0.0, 0.0])?,
    ];
    let right = rectangle([0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 0.0, 559.2])?;
    let left = rectangle([556.0, 0.0, 0.0], [0.0, 0.0, 559.2], [0.0, 548.8, 0.0])?;
    let light = rectangle([213.0, 548.8, 227.0], [130.0, 0.0, 0.0], [0.0, 0.0, 105.0])?;
    let green = Lambertian::new([0.105_421, 0.377_98, 0.076_425])?;
    let red = Lambertian::new([0.570_068, 0.043_013_5, 0.044_370_6])?;
    Ok(vec![
        Object::new(white_walls, white()?),
        Object::new([right], green),
        Object::new([left], red),
        Object::new([light], white()?).emitting(radiance)?,
    ])
}

fn rectangle(corner: [f32; 3], first: [f32; 3], second: [f32; 3]) -> Result<Flat, Error> {
    Flat::parallelogram(corner, first, second)
}

/// The top of a block, which is no parallelogram, and the four sides down to the floor. It has no bottom.
fn block<B: From<Lambertian>>(top: [[f32; 3]; 4]) -> Result<Object<B>, Error> {
    let [a, b, c, d] = top;
    let side = |from: [f32; 3], to: [f32; 3]| {
        let along = [to[0] - from[0], 0.0, to[2] - from[2]];
        rectangle([from[0], 0.0, from[2]], along, [0.0, from[1], 0.0])
    };
    let flats = [
        Flat::triangle([a, b, c])?,
        Flat::triangle([a, c, d])?,
        side(a, b)?,
        side(b, c)?,
        side(c, d)?,
        side(d, a)?,
    ];
    Ok(Object::new(flats, white()?))
}
