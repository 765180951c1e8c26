//! Monte Carlo and quasi-Monte Carlo integration of any integrand, with errors one can trust.

mod block;
mod error;
mod estimate;
mod estimator;
mod evaluate;
mod integrand;
mod moments;
mod progressive;
mod quantile;
mod reduce;
mod sampler;
mod tallied;
mod tally;
mod value;
mod warning;

pub mod estimators;
pub mod hash;
pub mod integrands;
pub mod points;
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
