//! Where the error bar comes from: one estimator a file.
//!
//! | estimator | points | error bar |
//! |---|---|---|
//! | [`MonteCarlo`] | independent, from any generator of `rand` | sample variance |
//! | [`Bounded`] | the same, for integrands between known limits | a bound that holds for any count |
//! | [`Strata`] | independent in each cell of a grid | sample variance of each cell |
//! | [`Vegas`] | adapted to the integrand, axis by axis and cell by cell | the same, over iterations |
//! | [`Average`] | any one point set | none |
//! | [`Replicated`] | any randomised point set, several times | spread of the replicates |
//! | [`Median`] | the same | order statistics of the replicates |
//! | [`Until`] | another estimator's, until a rule stops it | the other estimator's |
//!
//! What their intervals are worth, measured: [`coverage`] has the part of many runs whose interval held the integral, and
//! [`stability`] what becomes of stiff and extreme integrands, with the estimator to use instead where one fails.
//!
//! Writing your own: implement [`Estimator`](crate::Estimator), as its example shows.

mod average;
mod bounded;
mod median;
mod monte_carlo;
mod replicated;
mod strata;
mod until;
mod vegas;

pub use average::Average;
#[cfg(feature = "path")]
pub(crate) use average::whole;
pub use bounded::Bounded;
pub use median::Median;
pub use monte_carlo::MonteCarlo;
pub use replicated::Replicated;
pub use strata::{Strata, StrataState};
pub use until::{Progress, Until};
pub use vegas::{Adapted, Iteration, Vegas, VegasState};

#[cfg(doc)]
#[doc = include_str!("../docs/coverage.md")]
pub mod coverage {}

#[cfg(doc)]
#[doc = include_str!("../docs/stability.md")]
pub mod stability {}
