//! Cubes.

use glam::{DMat4, DVec3};

use crate::mitsuba::load::surroundings::narrow;
use crate::path::shape::{Flat, Primitive};

/// Of each side: the corner with the texture coordinates `(0, 0)` and those with `(1, 0)` and `(0, 1)`, as Mitsuba's
/// `src/shapes/cube.cpp` has them.
const SIDES: [[[f64; 3]; 3]; 6] = [
    [[-1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0]],
    [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, -1.0]],
    [[1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [1.0, -1.0, -1.0]],
    [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]],
    [[-1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]],
    [[-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0], [1.0, 1.0, -1.0]],
];

/// The six sides of a cube from -1 to 1.
pub(super) fn sides(to_world: &DMat4, flip_normals: bool) -> Result<Vec<Primitive>, String> {
    let center = to_world.transform_point3(DVec3::ZERO);
    let side = |side: [[f64; 3]; 3]| {
        let [corner, u, v] = side.map(|point| to_world.transform_point3(DVec3::from(point)));
        let (u, v) = (u - corner, v - corner);
        let flat =
            Flat::parallelogram(narrow(corner), narrow(u), narrow(v)).map_err(|e| e.to_string())?;
        let outward = corner + 0.5 * (u + v) - center;
        let turned = (u.cross(v).dot(outward) < 0.0) != flip_normals;
        Ok(if turned { flat.turned() } else { flat }.into())
    };
    SIDES.into_iter().map(side).collect()
}
