//! Maps from the unit cube to other domains, each with its density: one domain a file.
//!
//! | warp | from | to | density |
//! |---|---|---|---|
//! | [`Disk`] | square | unit disk | uniform |
//! | [`Hemisphere`], [`CosineHemisphere`] | square | directions with `z >= 0` | uniform, `z / pi` |
//! | [`Sphere`] | square | directions | uniform |
//! | [`Cone`] | square | directions near `z` | uniform |
//! | [`Triangle`] | square | triangle in space | uniform |
//! | [`SphericalTriangle`], [`SphericalRectangle`] | square | directions to a triangle, a rectangle | uniform |
//! | [`Tent`], [`Normal`], [`Exponential`] | interval | numbers | as named |
//! | [`Piecewise`], [`Piecewise2d`] | interval, square | interval, square | constant in each cell |
//!
//! and [`AliasTable`] for choices among a finite number.
//!
//! All of them are inverse transforms: one coordinate in, one number out, continuous wherever the domain
//! allows. So a well spread set of points stays well spread, which methods that reject would spoil.
//!
//! [`Importance`](crate::integrands::Importance) integrates over the domain of a warp.

mod alias_table;
mod cone;
mod disk;
mod exponential;
mod hemisphere;
mod normal;
mod piecewise;
mod piecewise_2d;
mod sphere;
mod spherical_rectangle;
mod spherical_triangle;
mod tent;
mod triangle;
mod vector;

pub use alias_table::{AliasTable, Choice};
pub use cone::Cone;
pub use disk::Disk;
pub use exponential::Exponential;
pub use hemisphere::{CosineHemisphere, Hemisphere};
pub use normal::Normal;
pub use piecewise::Piecewise;
pub use piecewise_2d::Piecewise2d;
#[cfg(feature = "path")]
pub(crate) use piecewise_2d::Place;
pub use sphere::Sphere;
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::SphericalTriangle;
pub use tent::Tent;
pub use triangle::Triangle;

/// A map from the unit cube of `D` dimensions to another domain, with the density of what it gives.
///
/// # Laws
///
/// - [`sample`](Self::sample) is finite for every `u` in `[0, 1)^D`, 0 and the largest number below 1 included.
/// - If `u` is uniform, the samples have [`density`](Self::density).
/// - [`invert`](Self::invert) undoes `sample`, up to rounding.
///
/// A density may be zero where a sample lands, on the rim of a hemisphere for instance. Such a sample
/// contributes nothing: it is no sample, and never a division by zero or by something made up instead.
///
/// # Writing your own
///
/// ```
/// use estimand::warp::Warp;
///
/// /// Density `2 x` on the unit interval.
/// struct Ramp;
///
/// impl Warp<1> for Ramp {
///     type Point = f64;
///     fn sample(&self, [u]: [f64; 1]) -> f64 { u.sqrt() }
///     fn density(&self, x: f64) -> f64 { if (0.0..1.0).contains(&x) { 2.0 * x } else { 0.0 } }
///     fn invert(&self, x: f64) -> Option<[f64; 1]> { (0.0..1.0).contains(&x).then_some([x * x]) }
/// }
///
/// assert_eq!(Ramp.sample([0.25]), 0.5);
/// ```
pub trait Warp<const D: usize>: Sync {
    /// A point of the domain.
    type Point: Copy;

    /// The image of `u`, whose coordinates are in `[0, 1)`.
    fn sample(&self, u: [f64; D]) -> Self::Point;

    /// The density of the samples at `point`, per unit of the domain's measure; 0 outside the domain.
    fn density(&self, point: Self::Point) -> f64;

    /// The `u` in `[0, 1)^D` whose image is `point`; `None` outside the domain.
    fn invert(&self, point: Self::Point) -> Option<[f64; D]>;
}

impl<const D: usize, W: Warp<D> + ?Sized> Warp<D> for &W {
    type Point = W::Point;

    #[inline]
    fn sample(&self, u: [f64; D]) -> W::Point {
        (**self).sample(u)
    }

    #[inline]
    fn density(&self, point: W::Point) -> f64 {
        (**self).density(point)
    }

    fn invert(&self, point: W::Point) -> Option<[f64; D]> {
        (**self).invert(point)
    }
}

/// The largest number below 1.
const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A coordinate that rounding may have moved to 1 or below 0, back in `[0, 1)`.
fn coordinate(u: f64) -> f64 {
    u.clamp(0.0, ALMOST_ONE)
}

/// Whether `direction` has length 1, up to the rounding of whoever computed it in single precision.
fn is_unit(direction: [f64; 3]) -> bool {
    (vector::dot(direction, direction) - 1.0).abs() < 1e-5
}

/// The angle of `(x, y)` as a fraction of the full circle, in `[0, 1)`.
fn turn(y: f64, x: f64) -> f64 {
    let turn = y.atan2(x) / core::f64::consts::TAU;
    coordinate(if turn < 0.0 { turn + 1.0 } else { turn })
}
