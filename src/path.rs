//! A thin path tracer: rendering as one more integral.

pub mod bsdf;
mod color;
mod frame;
mod geometry;
pub mod image;
pub mod light;
pub mod mis;
mod radiance;
mod ray;
mod render;
mod scene;
pub mod scenes;
pub mod sensor;
pub mod shape;

pub use image::Image;
pub use radiance::Paths;
pub use ray::{Ray, Surface, gamma};
pub use render::{Pixel, Unfinished, View};
pub use scene::{Object, Scene, Segment, Vertex};
