//! Where pictures are taken from: one camera a file.

mod pinhole;

use super::Ray;
use crate::Sampler;

pub use pinhole::Pinhole;

/// A camera: from a point of the film to a ray into the scene.
pub trait Sensor: Sync {
    /// The ray through a point of the film: `[0, 0]` is the upper left corner of the picture, `[1, 1]` the lower right
    /// one. Coordinates of a lens, where there is one, are drawn from `u`.
    fn ray<S: Sampler>(&self, film: [f64; 2], u: &mut S) -> Ray;
}
