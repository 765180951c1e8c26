//! A thin path tracer: rendering as one more integral.
//!
//! It is written against the public traits of this crate alone: a [`Pixel`] is an [`Integrand`](crate::Integrand), a picture
//! is one [estimate](crate::Estimate) a pixel. So every point set and every estimator renders, those of others
//! included.
//!
//! ```
//! use estimand::{Average, MonteCarlo};
//! use estimand::path::scenes;
//! use estimand::points::{HashedOwen, Sobol};
//!
//! let view = scenes::cornell_box();
//! let plain = view.render([16, 16], 1, |seed| MonteCarlo::new(64, seed))?;
//! assert!(plain.std_error().is_some());
//!
//! let sobol = Sobol::new(32)?;
//! let better = view.render([16, 16], 1, |seed| {
//!     Average::new(sobol.clone().scrambled(HashedOwen { seed }), 64)
//! })?;
//! assert!((plain.mean() - better.mean()).length() < 0.03);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Map
//!
//! | | |
//! |---|---|
//! | [`View`] | scene, camera and paths: what a picture is taken of |
//! | [`Scene`], [`Object`] | shapes, and what they do to light |
//! | [`texture`] | what varies over a surface |
//! | [`shape`], [`bsdf`], [`light`], [`sensor`], [`filter`] | one kind of shape, scattering, source, camera and filter a file |
//! | [`Paths::radiance`] | the rendering equation |
//! | [`Recursive`] | the same as it is taught, to be compared with |
//! | [`View::learn_roulette`] | paths that end where it pays |
//! | [`Paths::reused_by`] | paths that the pixels nearby use too |
//! | [`Adaptive`], [`Allocation`] | more samples where the picture needs them |
//! | [`Image`] | pictures, their errors, their files |
//! | [`scenes`] | the Cornell box and others, as `reference/scenes` has them for Mitsuba |
//!
//! # Limits
//!
//! - Geometry is in `f32`: coordinates are known to 6e-8 of themselves. Rays leave surfaces by a bound of the rounding
//!   errors, which scales and moves with the scene; two surfaces nearer to one another than about 1e-6 of
//!   their coordinates are not told apart. A scene may be of any size between 1e-11 and 1e11, and as far from the
//!   origin as 8192 times its size, where its surfaces are known to a 256th of it; an object, 2^21 times. What is
//!   beyond is [refused](Scene::new). Of shapes that coincide, either may be the one that is seen.
//! - Colour is linear red, green and blue. No media, no spectra.
//! - Boxes around many shapes come from the crate `obvhs`; up to 128 shapes are swept over instead, and many paths are followed among
//!   them, and among meshes and copies, at once, with the same result to the bit. The more of the scene is flat, scatters light
//!   ideally diffusely and is lit by what is flat, the faster.

mod adaptive;
pub mod bsdf;
mod color;
pub mod filter;
mod frame;
mod geometry;
pub mod image;
#[cfg(feature = "simd")]
mod lanes;
pub mod light;
mod object;
#[cfg(feature = "simd")]
mod packet;
mod pictures;
mod pixels;
mod place;
mod radiance;
mod ray;
mod recursive;
mod render;
mod resolution;
mod reuse;
pub(crate) mod roulette;
mod scene;
pub mod scenes;
mod segment;
pub mod sensor;
mod shading;
pub mod shape;
pub mod texture;

pub use adaptive::{Adapted, Adaptive, Allocation};
pub use frame::Frame;
pub use image::Image;
pub use object::{Instances, Object};
pub use pictures::Pictures;
pub use pixels::Share;
pub use place::{Place, Spot};
pub use radiance::Paths;
pub use ray::{Ray, Surface, gamma};
pub use recursive::{Direct, Ending, Recursive, RecursivePixel};
pub use render::{Pixel, Unfinished, View};
#[cfg(feature = "mitsuba")]
pub(crate) use scene::Surfaces;
pub use scene::{Scene, Vertex};
pub use segment::Segment;
pub use shading::{Detail, Facet, Shading};
