//! How far a list of points is from uniform: discrepancies, exact, bracketed or bounded, and said which.
//!
//! The error of a quasi-Monte Carlo rule is at most the variation of the integrand times the star discrepancy of the points
//! (Koksma and Hlawka):[^niederreiter] so a discrepancy compares point sets before anything is integrated.
//!
//! # Which one
//!
//! | to be known | measure | cost |
//! |---|---|---|
//! | one box | [`local`] | `O(d n)` |
//! | the whole curve in one dimension, to be drawn | [`LocalCurve`] | `O(n log n)` |
//! | the worst box, as the bound on the error has it | [`star`], [`Star`] | `O(n log^2 n)` in the plane, then steep |
//! | the mean over boxes at the origin; large `n` | [`L2::Star`] | `O(d n^2)`, or `O(n log^(d-1) n)` |
//! | designs of experiments: all projections, no corner preferred | [`L2::Centred`], [`L2::Mixture`] | `O(d n^2)` |
//! | points on a torus, lattices, shifted points | [`L2::WrapAround`], [`L2::Diaphony`] | `O(d n^2)` |
//! | the mean over all boxes | [`L2::Extreme`] | `O(d n^2)` |
//! | some dimensions matter more than others | [`L2::squared_weighted`] | `O(d n^2)` |
//! | a search that changes a point at a time | [`UpdatableL2`] | `O(d n)` a change |
//! | digital nets | [`t_value`] | see there |
//! | how close two points come | [`minimum_distance`], [`toroidal_minimum_distance`] | at most `O(d n^2)` |
//! | structure that may alias | [`Periodogram`] | `O(n k^2)` |
//!
//! The L2 star discrepancy has a fault: with `n` below about `2^d` it is hardly above that of points all at `(1, ..., 1)`. Beyond a
//! few dimensions take one with all projections.
//!
//! # A worked value
//!
//! The points 0, 1/2, 1/4, 3/4 of van der Corput. The box `[0, y]` with `y = 1/2` holds 3 of the 4 points, which is 1/4 more than
//! its length; no box is worse, and the star discrepancy is 1/4. The mean of the squared local discrepancy is that of
//! `(y - 1/4)^2` over `[0, 1/4]`, four times over: 1/48.
//!
//! ```
//! use estimand::discrepancy::{L2, Points, star};
//!
//! let points = Points::from_rows(&[0.0, 0.5, 0.25, 0.75], 1)?;
//! assert_eq!(star(&points).lower(), 0.25);
//! assert!((L2::Star.squared(&points) - 1.0 / 48.0).abs() < 1e-16);
//! # Ok::<(), estimand::Error>(())
//! ```
//!
//! [^niederreiter]: Niederreiter, Harald (1992). *Random Number Generation and Quasi-Monte Carlo Methods*, chapter 2.
//!     <https://doi.org/10.1137/1.9781611970081>

mod l2;
mod local;
mod periodogram;
mod points;
mod separation;
mod star;
mod t_value;

pub use l2::{L2, UpdatableL2};
pub use local::{Knot, LocalCurve, local};
pub use periodogram::Periodogram;
pub use points::Points;
pub use separation::{minimum_distance, toroidal_minimum_distance};
pub use star::{AnchoredBox, Boundary, Star, StarDiscrepancy, star};
pub use t_value::t_value;
