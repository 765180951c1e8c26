//! Monte Carlo and quasi-Monte Carlo integration of any integrand, with errors one can trust.

mod error;
mod estimator;
mod evaluate;
mod integrand;
mod moments;
mod reduce;
mod sampler;
mod value;

pub mod discrepancy;
pub mod estimators;
pub mod hash;
pub mod integrands;
pub mod points;

pub use error::{Error, Incomplete};
pub use estimator::{Estimate, Estimator, NonFinite, Outcome};
pub use estimators::{Average, MonteCarlo, Replicated};
pub use integrand::{Cube, Integrand, cube};
pub use moments::Moments;
pub use reduce::each;
pub use sampler::{Cursor, Sampler, Stream};
pub use value::Value;
