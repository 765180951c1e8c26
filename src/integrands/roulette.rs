//! Russian roulette.

use core::fmt;

use crate::{Error, Integrand, Sampler, Value};

/// A probability of survival in `(0, 1]`: the rule of Russian roulette.
///
/// [`play`](Self::play) is all there is to it, for an [adaptor](Roulette) as for the end of a light path.
///
/// ```
/// use estimand::integrands::Survival;
///
/// let survival = Survival::new(0.25)?;
/// assert_eq!(survival.play(0.1), Some(4.0));
/// assert_eq!(survival.play(0.9), None);
/// assert!(Survival::new(f64::NAN).is_err());
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survival {
    probability: f64,
    weight: f64,
}

impl Survival {
    /// Survival with `probability`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a probability outside `(0, 1]`, NaN included, and for one below about 6e-309, whose
    /// inverse is infinite.
    #[inline]
    pub fn new(probability: f64) -> Result<Self, Error> {
        let weight = 1.0 / probability;
        if !(probability > 0.0 && probability <= 1.0 && weight.is_finite()) {
            return Err(Error::refused(
                "survival probability",
                "in (0, 1], its inverse finite",
                probability,
            ));
        }
        Ok(Self {
            probability,
            weight,
        })
    }

    /// The probability of survival, in `(0, 1]`.
    pub fn probability(self) -> f64 {
        self.probability
    }

    /// The weight of a survivor, `1 / probability`; `None` for what does not survive.
    ///
    /// `u` is a coordinate in `[0, 1)`. The mean over `u` of the weight, zero for `None`, is 1, but for this limit: coordinates are multiples
    /// of 2^-53 at the finest that all sets have, so that a probability is met to 2^-53 at best, which is 1e-7 of 1e-9
    /// and all of 1e-16.
    #[inline]
    #[must_use]
    pub fn play(self, u: f64) -> Option<f64> {
        (u < self.probability).then_some(self.weight)
    }
}

/// An integrand that is evaluated with a probability below one, and weighted up when it is.
///
/// With `X` the integrand, `p` the probability of survival and `c` the constant returned otherwise, the value is
/// `(X - (1 - p) c) / p` with probability `p` and `c` else.[^arvo] Its expectation is that of `X`, for every
/// `p` in `(0, 1]` and every `c`; its variance is
///
/// `Var(X) / p + (1 / p - 1) (E[X] - c)^2`,
///
/// never below `Var(X)`. What is gained is time: the integrand is evaluated with probability `p` only.
///
/// The first coordinate decides, the others are the integrand's.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube, integrands::Roulette};
///
/// let f = cube(|[x]| 3.0 * x * x);
/// let estimate = MonteCarlo::new(100_000, 1).estimate(&Roulette::new(&f, 0.3)?)?;
/// assert!((estimate.mean - 1.0).abs() < 4.0 * estimate.std_error.unwrap());
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^arvo]: Arvo, James; Kirk, David (1990). *Particle Transport and Image Synthesis*.
///     <https://doi.org/10.1145/97879.97886>
#[derive(Clone, Copy)]
#[must_use]
pub struct Roulette<I: Integrand> {
    integrand: I,
    survival: Survival,
    otherwise: I::Value,
}

impl<I: Integrand> Roulette<I> {
    /// `integrand`, evaluated with `probability`, and zero otherwise.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a probability outside `(0, 1]`, NaN included: see [`Survival::new`].
    pub fn new(integrand: I, probability: f64) -> Result<Self, Error> {
        let survival = Survival::new(probability)?;
        Ok(Self {
            integrand,
            survival,
            otherwise: I::Value::ZERO,
        })
    }

    /// The same with another value than zero where the integrand is not evaluated.
    ///
    /// The nearer to the integral, the smaller the variance that the roulette adds.
    pub fn otherwise(mut self, value: I::Value) -> Self {
        self.otherwise = value;
        self
    }
}

impl<I: Integrand> Integrand for Roulette<I> {
    type Value = I::Value;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> I::Value {
        let Some(weight) = self.survival.play(u.next_1d()) else {
            return self.otherwise;
        };
        // (x - (1 - p) c) / p
        let lost = weight - 1.0;
        self.integrand
            .evaluate(u)
            .zip(self.otherwise, |x, c| x * weight - lost * c)
    }

    fn dimensions(&self) -> u32 {
        self.integrand.dimensions().saturating_add(1)
    }
}

impl<I: Integrand> fmt::Debug for Roulette<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Roulette")
            .field("survival", &self.survival)
            .finish_non_exhaustive()
    }
}
