//! Integrands made from integrands: one adaptor a file.
//!
//! An adaptor keeps the integral and changes what it costs to estimate it. Writing your own: hold an
//! [`Integrand`](crate::Integrand), implement `Integrand`, and say what becomes of the expectation.

mod roulette;

pub use roulette::{Roulette, Survival};
