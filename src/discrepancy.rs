//! How far a list of points is from uniform: discrepancies, exact, bracketed or bounded, and said which.

mod l2;
mod local;
mod points;
mod star;

pub use l2::{L2, UpdatableL2};
pub use local::{Knot, LocalCurve, local};
pub use points::Points;
pub use star::{AnchoredBox, Boundary, Star, StarDiscrepancy, star};
