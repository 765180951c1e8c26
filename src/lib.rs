//! Monte Carlo and quasi-Monte Carlo integration of any integrand, with errors one can trust.
//!
//! An integral with no closed form is a mean over random points. This crate makes the points, from independent
//! ones to scrambled nets; takes the mean, the same bits on any number of threads; and says how far off it
//! is, or that it cannot know. A light path is an integrand like any other: the feature `path` adds a thin path
//! tracer that is written against the public traits alone.
//!
//! # Three examples
//!
//! An integral, its integrand a closure on the unit square:
//!
//! ```
//! use estimand::{Estimator, MonteCarlo, cube};
//!
//! let f = cube(|[x, y]| (x * y).exp());
//! let estimate = MonteCarlo::new(1 << 16, 1).estimate(&f)?;
//! assert!((estimate.mean - 1.317_902).abs() < 4.0 * estimate.std_error.unwrap());
//! # Ok::<(), estimand::Error>(())
//! ```
//!
//! The same with better points. Points that are not independent have no sample variance to speak of: the
//! error bar comes from independent randomisations.
//!
//! ```
//! use estimand::{Estimator, Replicated, cube, points::Stratified};
//!
//! let f = cube(|[x, y]| (x * y).exp());
//! let grid = |seed| Stratified::new(1 << 12, 2, seed).expect("a positive count");
//! let estimate = Replicated::new(16, 1 << 12, grid).estimate(&f)?;
//! assert!((estimate.mean - 1.317_902_151).abs() < 4.0 * estimate.std_error.unwrap());
//! assert!(estimate.std_error.unwrap() < 1e-4);
//! # Ok::<(), estimand::Error>(())
//! ```
//!
//! An integrand that draws as many coordinates as it needs: an infinite sum, ended by Russian roulette without
//! a bias.
//!
//! ```
//! use estimand::{Estimator, Integrand, MonteCarlo, Sampler, integrands::Survival};
//!
//! /// The sum over n of 1 / 2^n, each term the mean of a product of n uniform numbers.
//! struct Series;
//!
//! impl Integrand for Series {
//!     type Value = f64;
//!     fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
//!         let survival = Survival::new(0.7).expect("a probability");
//!         let (mut sum, mut term) = (0.0, 1.0);
//!         loop {
//!             sum += term;
//!             match survival.play(u.next_1d()) {
//!                 Some(weight) => term *= u.next_1d() * weight,
//!                 None => return sum,
//!             }
//!         }
//!     }
//! }
//!
//! let estimate = MonteCarlo::new(1 << 16, 1).estimate(&Series)?;
//! assert!((estimate.mean - 2.0).abs() < 4.0 * estimate.std_error.unwrap());
//! # Ok::<(), estimand::Error>(())
//! ```
//!
//! # The map: three axes
//!
//! | axis | trait | what there is |
//! |---|---|---|
//! | where the points come from | [`PointSet`](points::PointSet) | [`points`] |
//! | what is evaluated | [`Integrand`] | [`cube`], adaptors in [`integrands`] |
//! | where the error bar comes from | [`Estimator`] | [`estimators`] |
//!
//! Every combination works, and your own file on one axis works with all of the other two. Beside them:
//! [`warp`] leads from the unit cube to other domains, [`discrepancy`] measures how even a set of points is,
//! [`convergence`] compares methods by error against run time, [`hash`] is the randomness that needs no state,
//! [`Moments`] adds up values without losing digits. The feature `path` adds the module `path`, the path tracer.
//!
//! # Limits
//!
//! - Sampling is for many dimensions, kinks, jumps and odd domains. A smooth integrand in few dimensions belongs to
//!   deterministic cubature: on four smooth functions scipy's came within 4e-13 in two dimensions and 5e-11 in three, where our best
//!   points had reached 1e-11 to 2e-9, in two, and 1e-11 to 3e-8, in three, in the same time; in five it needed one to six
//!   seconds for 2e-13 to 2e-5, where they had 4e-8 to 2e-5 after a sixth of one at most (`docs/race.md`).
//! - Coordinates have a resolution of 2^-53, but near 0 in some sets: a peak narrower than that is seen by no point.
//! - An estimate is only as good as its finite variance: where the square of the integrand has no integral,
//!   error bars are too small, whatever their kind. [`estimators`] has tables of how often they hold.
//! - The integrand must be pure; a closure that counts its calls may see some points twice.
//!
//! # Features
//!
//! | feature | what it adds | depends on |
//! |---|---|---|
//! | `parallel` (default) | all threads of rayon's current pool; the same bits | `rayon` |
//! | `simd` (default) | vector code chosen at run time; the same bits | `pulp` |
//! | `glam` | glam's vectors as values | `glam` |
//! | `serde` | saving and restoring estimates | `serde` |
//! | `sobol-full` | Sobol' points in up to 21201 dimensions, not 1024 | 1.6 MB of tables |
//! | `path` | the path tracer | `glam`, `obvhs`, `exr`, `image`, `bytemuck`; `memmap2` on Linux |
//! | `mitsuba` | reading scene files of Mitsuba 3 into it; implies `path` | `roxmltree`, `ply-rs-bw` |
//! | `report` | pages, plots and files of a study | `serde`, `serde_json`, `csv`, `base64` |
//!
//! Without features the crate depends on `rand` alone.

mod block;
mod error;
mod estimate;
mod estimator;
mod evaluate;
mod integrand;
mod moments;
mod progressive;
mod quantile;
mod recorder;
mod reduce;
mod room;
mod sampler;
mod stratum;
mod tallied;
mod tally;
mod value;
mod warning;

pub mod convergence;
pub mod discrepancy;
pub mod estimators;
pub mod hash;
pub mod integrands;
#[cfg(feature = "mitsuba")]
pub mod mitsuba;
#[cfg(feature = "path")]
pub mod path;
pub mod points;
#[cfg(feature = "report")]
pub mod report;
pub mod warp;

pub use error::{Error, Incomplete};
pub use estimate::{ErrorBar, Estimate, Interval, Stop};
pub use estimator::{Estimator, NonFinite, Outcome};
pub use estimators::{Average, MonteCarlo, Replicated};
pub use integrand::{Cube, Integrand, cube};
pub use moments::Moments;
pub use progressive::Progressive;
pub use reduce::each;
pub use sampler::{Cursor, Sampler, Stream};
pub use tallied::Tallies;
pub use value::Value;
pub use warning::Warning;

/// The README's example, compiled and run with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
