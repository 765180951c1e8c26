//! Where the error bar comes from: one estimator a file.
//!
//! | estimator | points | error bar |
//! |---|---|---|
//! | [`MonteCarlo`] | independent, from any generator of `rand` | sample variance |
//! | [`Average`] | any one point set | none |
//! | [`Replicated`] | any randomised point set, several times | spread of the replicates |
//!
//! Writing your own: implement [`Estimator`](crate::Estimator), as its example shows.

mod average;
mod monte_carlo;
mod replicated;
mod until;

pub use average::Average;
pub use monte_carlo::MonteCarlo;
pub use replicated::Replicated;
pub use until::{Progress, Until};
