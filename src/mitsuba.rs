//! Reads scene files of Mitsuba 3.
//!
//! [`read`] gives a [`Description`]: what a file says, with the defaults of Mitsuba filled in and its colours as the RGB
//! variants of Mitsuba have them. What a file asks for and is not supported is an error that says where, and what there is
//! instead; so is a property that an object does not have.
//!
//! ```no_run
//! let scene = estimand::mitsuba::read("cornell_box.xml", &[("spp", "16")])?;
//! println!("{} shapes", scene.shapes.len());
//! # Ok::<(), estimand::mitsuba::SceneError>(())
//! ```
//!
//! # Limits
//!
//! - No spectral, polarised or volumetric parts, no hair, no principled materials, no plugins of others.
//! - Files may be hostile: they are read with bounds on their size and depth, and never make the reader panic. They name
//!   other files, of which those are opened that exist; do not read files of strangers where that matters.
//! - Numbers must be finite and within the range of 32-bit floats.

mod bsdf;
mod document;
mod emitter;
mod error;
mod field_of_view;
mod film;
mod integrator;
mod load;
mod mesh;
mod number;
mod parameters;
mod parse;
mod picture;
mod query;
mod sampler;
mod scene;
mod sensor;
mod shape;
mod spectrum;
mod texture;
mod transform;
mod upgrade;

use std::path::Path;

pub use bsdf::{Bsdf, Conductor, Dielectric, Distribution, Perturbed, Plastic, Roughness};
pub use emitter::{Emitter, Projector, Source, Spot};
pub use error::{Place, SceneError};
pub use field_of_view::FieldOfView;
pub use film::{Crop, Film, Filter};
pub use integrator::{Integrator, Techniques};
pub use load::{Instance, Loaded};
pub use mesh::{Attribute, Mesh};
pub use picture::Picture;
pub use sampler::{Points, Sampler};
pub use scene::Description;
pub use sensor::{Projection, Sensor};
pub use shape::{Geometry, MeshFile, MeshFormat, Shape};
pub use texture::{Bitmap, BitmapFilter, Checkerboard, MeshAttribute, Texture, Wrap};

/// What a scene file says. `overrides` are values for its parameters, `$name` in the file, in place of its defaults.
///
/// # Errors
///
/// [`SceneError`] for files that are missing, too large or no XML, for what is not supported, for values out of their domain,
/// for references to nothing and to oneself, and for overrides that the scene does not use.
pub fn read(path: impl AsRef<Path>, overrides: &[(&str, &str)]) -> Result<Description, SceneError> {
    scene::describe(&parse::parse(path.as_ref(), overrides)?)
}
