//! From an integrand to an estimate of its integral.

use crate::{Estimate, Incomplete, Integrand, Value};

/// Estimates the integral of an integrand over the unit cube.
///
/// Where the points come from and where the error bar comes from is the estimator's own matter; what is
/// integrated is not. So every estimator takes every [`Integrand`].
///
/// # Writing your own
///
/// ```
/// use estimand::{ErrorBar, Estimate, Estimator, Integrand, Moments, Outcome, Value};
/// use estimand::points::{Independent, PointSet};
///
/// /// The mean over `count` independent points and their mirror images.
/// struct Mirrored { count: u64, seed: u64 }
///
/// /// The mirror image of what another sampler gives.
/// struct Mirror<S>(S);
///
/// impl<S: estimand::Sampler> estimand::Sampler for Mirror<S> {
///     fn next_1d(&mut self) -> f64 { 1.0 - f64::EPSILON / 2.0 - self.0.next_1d() }
/// }
///
/// impl Estimator for Mirrored {
///     fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
///         let points = Independent::new(self.seed);
///         let mut moments = Moments::new();
///         for index in 0..self.count {
///             let here = integrand.evaluate(&mut points.point(index)).widen();
///             let there = integrand.evaluate(&mut Mirror(points.point(index))).widen();
///             moments.push(here.zip(there, |a, b| 0.5 * (a + b)));
///         }
///         let mut estimate = Estimate::new(moments.mean(), 2 * self.count);
///         estimate.std_error = moments.std_error();
///         estimate.error_bar = ErrorBar::SampleVariance;
///         Ok(estimate)
///     }
/// }
///
/// let linear = estimand::cube(|[x, y]| 3.0 * x - y);
/// let estimate = Mirrored { count: 100, seed: 1 }.estimate(&linear)?;
/// assert!((estimate.mean - 1.0).abs() < 1e-14);
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait Estimator {
    /// The estimate of the integral of `integrand`.
    ///
    /// # Errors
    ///
    /// An [`Incomplete`] with the estimate so far: if the integrand returned a value that is not finite
    /// (unless such values are to be [rejected](NonFinite::Reject)), or if the estimator cannot be run as it was
    /// set up.
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value>;
}

impl<E: Estimator> Estimator for &E {
    fn estimate<I: Integrand>(&self, integrand: &I) -> Outcome<I::Value> {
        (**self).estimate(integrand)
    }
}

/// What an [`Estimator`] returns for integrands with values of type `V`: means and errors are `f64`s.
pub type Outcome<V> = Result<Estimate<<V as Value>::Wide>, Incomplete<<V as Value>::Wide>>;

/// What to do with a value of an integrand that is NaN or infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NonFinite {
    /// Stop with an error that names the point and carries the estimate so far. Points after it may have been evaluated.
    #[default]
    Fail,
    /// Leave the value out, count it in [`Estimate::rejected`], and go on.
    ///
    /// The mean is then the mean over the part of the domain where the integrand is finite.
    Reject,
}
