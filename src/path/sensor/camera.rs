//! Any camera.

use super::{Orthographic, Pinhole, Sensor, ThinLens};
use crate::Sampler;
use crate::path::Ray;

/// Any of the cameras of this module, for programs that do not know which before they read a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// All in focus.
    Pinhole(Pinhole),
    /// With a lens.
    ThinLens(ThinLens),
    /// Without perspective.
    Orthographic(Orthographic),
}

impl From<Pinhole> for Camera {
    fn from(camera: Pinhole) -> Self {
        Self::Pinhole(camera)
    }
}

impl From<ThinLens> for Camera {
    fn from(camera: ThinLens) -> Self {
        Self::ThinLens(camera)
    }
}

impl From<Orthographic> for Camera {
    fn from(camera: Orthographic) -> Self {
        Self::Orthographic(camera)
    }
}

impl Sensor for Camera {
    #[inline]
    fn ray<S: Sampler>(&self, film: [f64; 2], u: &mut S) -> Ray {
        match self {
            Self::Pinhole(camera) => camera.ray(film, u),
            Self::ThinLens(camera) => camera.ray(film, u),
            Self::Orthographic(camera) => camera.ray(film, u),
        }
    }
}
