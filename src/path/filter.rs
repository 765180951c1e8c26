//! What of the film a pixel sees: one reconstruction filter a file.
//!
//! A pixel is the mean of the radiance around it, weighted by a filter. Points of the film are drawn in proportion
//! to the filter's absolute value, for each pixel of its own:[^ernst] so a pixel is one integral whatever the filter, and
//! pixels are independent of one another.
//!
//! | filter | reaches |
//! |---|---|
//! | [`BoxFilter`] | its own pixel |
//! | [`Centre`] | nothing but a point: to be compared with |
//! | [`Separable`] with [`Tent`], [`Gaussian`], [`Mitchell`], [`Lanczos`] or a [`Profile`] of one's own | as it says |
//!
//! [^ernst]: Ernst, Manfred; Stamminger, Marc; Greiner, Günther (2006). *Filter Importance Sampling*.
//!     <https://doi.org/10.1109/RT.2006.280223>

mod centre;
mod gaussian;
mod lanczos;
mod mitchell;
mod separable;
mod square;
mod tent;

pub use centre::Centre;
pub use gaussian::Gaussian;
pub use lanczos::Lanczos;
pub use mitchell::Mitchell;
pub use separable::{Profile, Separable};
pub use square::BoxFilter;
pub use tent::Tent;

/// A reconstruction filter.
pub trait Filter: Sync {
    /// A point of the film that the pixel in column and row `position` of a picture of `size` sees, drawn from the
    /// coordinates `u` in `[0, 1)`.
    fn sample(&self, position: [u32; 2], size: [u32; 2], u: [f64; 2]) -> Filtered;
}

/// A point of the film drawn by a [`Filter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filtered {
    /// Where it is, in pixels from the upper left corner of the picture.
    pub point: [f64; 2],
    /// The value of the filter over the density of the point; 1 about 1 for a filter that is nowhere negative.
    pub weight: f32,
}
