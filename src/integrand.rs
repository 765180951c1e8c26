//! Functions on the unit cube.

use core::fmt;

use crate::{Sampler, Value};

/// A function on the unit cube, of however many coordinates it asks for.
///
/// Its integral over the cube is what every [`Estimator`](crate::Estimator) estimates. Integrals over other
/// domains are brought here by a change of variables.
///
/// `evaluate` must be pure: the same coordinates give the same value. Estimators rely on it, evaluating a
/// point again where they need to know more about it.
///
/// # Writing your own
///
/// ```
/// use estimand::{Estimator, Integrand, MonteCarlo, Sampler};
///
/// /// The number of uniform steps needed to pass 1, whose mean is e.
/// struct StepsPastOne;
///
/// impl Integrand for StepsPastOne {
///     type Value = f64;
///     fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
///         let (mut sum, mut steps) = (0.0, 0.0);
///         while sum <= 1.0 {
///             sum += u.next_1d();
///             steps += 1.0;
///         }
///         steps
///     }
/// }
///
/// let estimate = MonteCarlo::new(1 << 16, 1).estimate(&StepsPastOne)?;
/// assert!((estimate.mean - std::f64::consts::E).abs() < 0.02);
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait Integrand: Sync {
    /// What the function returns.
    type Value: Value;

    /// How many points [`evaluate_many`](Self::evaluate_many) is best given at once. At 1 it is not called.
    const AT_ONCE: usize = 1;

    /// The value at the point that `u` gives, coordinate by coordinate.
    fn evaluate<S: Sampler>(&self, u: &mut S) -> Self::Value;

    /// The values at several points: `values[k]` at the one that `samplers[k]` gives.
    ///
    /// For integrands that are faster on many points together than on one after the other, as rays in packets are.
    /// Such an integrand writes its own, and says with [`AT_ONCE`](Self::AT_ONCE) how many points it wants; it may be
    /// given fewer. The values must be those of [`evaluate`](Self::evaluate) to the bit: which of the two
    /// is called is the estimators' choice. Where the coordinates of a point begin where the point before it ends, as in
    /// the stream of a generator, it is `evaluate`.
    ///
    /// ```
    /// use estimand::{Average, Estimator, Integrand, Sampler, points::Independent};
    ///
    /// /// The length of a vector in the unit square, four at once: square roots side by side.
    /// struct Length;
    ///
    /// impl Integrand for Length {
    ///     type Value = f64;
    ///     const AT_ONCE: usize = 4;
    ///
    ///     fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
    ///         let [x, y] = u.next_2d();
    ///         (x * x + y * y).sqrt()
    ///     }
    ///
    ///     fn evaluate_many<S: Sampler>(&self, samplers: &mut [S], values: &mut [f64]) {
    ///         let mut squares = [0.0; Self::AT_ONCE];
    ///         for (square, u) in squares.iter_mut().zip(samplers) {
    ///             let [x, y] = u.next_2d();
    ///             *square = x * x + y * y;
    ///         }
    ///         let roots = squares.map(f64::sqrt);
    ///         values.copy_from_slice(&roots[..values.len()]);
    ///     }
    ///
    ///     fn dimensions(&self) -> u32 { 2 }
    /// }
    ///
    /// let estimate = Average::new(Independent::new(1), 10_001).estimate(&Length)?;
    /// assert!((estimate.mean - 0.765).abs() < 0.015);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    fn evaluate_many<S: Sampler>(&self, samplers: &mut [S], values: &mut [Self::Value]) {
        for (u, value) in samplers.iter_mut().zip(values) {
            *value = self.evaluate(u);
        }
    }

    /// About how many coordinates [`evaluate`](Self::evaluate) reads: estimators may compute that many ahead,
    /// in blocks.
    ///
    /// A hint for speed alone. Reading more or fewer changes no value.
    fn dimensions(&self) -> u32 {
        0
    }
}

impl<I: Integrand> Integrand for &I {
    type Value = I::Value;

    const AT_ONCE: usize = I::AT_ONCE;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> Self::Value {
        (**self).evaluate(u)
    }

    #[inline]
    fn evaluate_many<S: Sampler>(&self, samplers: &mut [S], values: &mut [Self::Value]) {
        (**self).evaluate_many(samplers, values);
    }

    fn dimensions(&self) -> u32 {
        (**self).dimensions()
    }
}

/// A closure on the unit cube as an [`Integrand`]; `D` is inferred from the closure's pattern.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube};
///
/// let volume = cube(|[x, y, z]| f64::from(u8::from(x * x + y * y + z * z < 1.0)));
/// let estimate = MonteCarlo::new(1 << 16, 1).estimate(&volume)?;
/// let error = estimate.mean - std::f64::consts::PI / 6.0;
/// assert!(error.abs() < 4.0 * estimate.std_error.unwrap());
/// # Ok::<(), estimand::Error>(())
/// ```
pub fn cube<const D: usize, V: Value, F: Fn([f64; D]) -> V + Sync>(function: F) -> Cube<D, F> {
    Cube { function }
}

/// A closure on the cube of `D` dimensions, made by [`cube`].
#[derive(Clone, Copy)]
pub struct Cube<const D: usize, F> {
    function: F,
}

impl<const D: usize, F> fmt::Debug for Cube<D, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cube")
            .field("dimensions", &D)
            .finish_non_exhaustive()
    }
}

impl<const D: usize, V: Value, F: Fn([f64; D]) -> V + Sync> Integrand for Cube<D, F> {
    type Value = V;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> V {
        (self.function)(u.next_array())
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "no array on the stack has 2^32 coordinates"
    )]
    fn dimensions(&self) -> u32 {
        D as u32
    }
}
