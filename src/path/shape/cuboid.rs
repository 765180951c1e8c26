//! Boxes.

use super::Flat;
use crate::Error;

/// The six sides of a parallelepiped around `center`, with the given halves of its edges, which must be
/// right-handed: `(halves[0] x halves[1]) . halves[2] > 0`. Their outer sides are outside.
///
/// # Errors
///
/// [`Error::Refused`] for edges that are not right-handed or not finite.
pub fn cuboid(center: [f32; 3], halves: [[f32; 3]; 3]) -> Result<[Flat; 6], Error> {
    use glam::Vec3;
    let [c, x, y, z] = [center, halves[0], halves[1], halves[2]].map(Vec3::from);
    let volume = x.cross(y).dot(z);
    if !(volume > 0.0 && volume.is_finite()) {
        return Err(Error::refused(
            "edges of a box",
            "finite and right-handed",
            format_args!("{halves:?}"),
        ));
    }
    // Each side at `c + n`, with the edges `2 a` and `2 b` where `a x b` points along `n`.
    let side = |n: Vec3, a: Vec3, b: Vec3| {
        Flat::parallelogram(
            (c + n - a - b).to_array(),
            (2.0 * a).to_array(),
            (2.0 * b).to_array(),
        )
    };
    Ok([
        side(x, y, z)?,
        side(-x, z, y)?,
        side(y, z, x)?,
        side(-y, x, z)?,
        side(z, x, y)?,
        side(-z, y, x)?,
    ])
}
