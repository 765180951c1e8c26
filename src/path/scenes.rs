//! Scenes of this crate's tests and examples, the same as those under `reference/scenes`.

mod cornell_box;
mod environment;
mod furnace;

pub use cornell_box::{CORNELL_LIGHT, cornell_box, cornell_box_lit, cornell_box_specular};
pub use environment::environment;
pub use furnace::furnace;
