//! Integrands made from integrands: one adaptor a file.
//!
//! An adaptor keeps the integral and changes what it costs to estimate it.
//!
//! | adaptor | the integral of |
//! |---|---|
//! | [`Importance`] | a function on the domain of a [warp](crate::warp), by samples of the warp's density |
//! | [`Mixture`], [`MultiSample`] | the same with several densities, their weights shared by a [`Heuristic`] |
//! | [`Antithetic`] | an integrand, at points and their mirror images |
//! | [`ControlVariate`] | an integrand, less a multiple of one whose integral is known |
//! | [`Mapped`] | an integrand, at points that an [`ImportanceMap`] sends where it is large |
//! | [`Roulette`] | an integrand, evaluated now and then |
//! | [`Splitting`] | a function in two stages, the second evaluated more or less often than the first |
//! | [`Joint`] | a vector, with the covariances of its components; [`ratio`] of two of them |
//!
//! Writing your own: hold an [`Integrand`](crate::Integrand), implement `Integrand`, and say what becomes of the
//! expectation.

mod antithetic;
mod control_variate;
mod importance;
mod joint;
mod mapped;
mod mixture;
mod roulette;
mod splitting;

pub use antithetic::Antithetic;
pub use control_variate::ControlVariate;
pub use importance::Importance;
pub use joint::{Joint, Ratio, ratio};
pub(crate) use mapped::Bin;
pub use mapped::{ImportanceMap, Mapped};
pub use mixture::{Heuristic, Mixture, MultiSample};
pub use roulette::{Roulette, Survival};
pub use splitting::{Pilot, Splitting, Staged};
