//! Importance sampling.

use core::fmt;

use crate::warp::Warp;
use crate::{Integrand, Sampler, Value};

/// A function on the domain of a [`Warp`], integrated with samples of the warp's density.
///
/// With `p` the density and `x` a sample of it, the value is `f(x) / p(x)`: its expectation is the integral of `f` over
/// the domain's measure wherever `p` is above zero. The nearer `p` is to being proportional to `f`, the smaller
/// the variance. Where `p` falls off faster than `f`, the variance is infinite.
///
/// A sample where the density is zero is no sample: it contributes zero, and `f` is not asked.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, integrands::Importance, warp::Normal};
///
/// // The fourth moment of the normal distribution.
/// let normal = Normal::new(0.0, 1.0)?;
/// let wide = Normal::new(0.0, 2.0)?;
/// use estimand::warp::Warp;
/// let f = Importance::new(wide, |x: f64| x.powi(4) * normal.density(x));
/// let estimate = MonteCarlo::new(100_000, 1).estimate(&f)?;
/// assert!((estimate.mean - 3.0).abs() < 4.0 * estimate.std_error.unwrap());
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy)]
#[must_use]
pub struct Importance<const D: usize, W, F> {
    warp: W,
    function: F,
}

impl<const D: usize, V: Value, W: Warp<D>, F: Fn(W::Point) -> V + Sync> Importance<D, W, F> {
    /// `function`, on the domain of `warp`.
    pub const fn new(warp: W, function: F) -> Self {
        Self { warp, function }
    }
}

impl<const D: usize, V: Value, W: Warp<D>, F: Fn(W::Point) -> V + Sync> Integrand
    for Importance<D, W, F>
{
    type Value = V;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> V {
        let point = self.warp.sample(core::array::from_fn(|_| u.next_1d()));
        weighted(&self.function, point, self.warp.density(point))
    }

    #[expect(clippy::cast_possible_truncation, reason = "a handful of coordinates")]
    fn dimensions(&self) -> u32 {
        D as u32
    }
}

/// `function` at `point` over the density there; zero where there is none.
#[inline]
pub(super) fn weighted<P, V: Value>(function: impl Fn(P) -> V, point: P, density: f64) -> V {
    if density > 0.0 {
        function(point).map(|value| value / density)
    } else {
        V::ZERO
    }
}

impl<const D: usize, W: fmt::Debug, F> fmt::Debug for Importance<D, W, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Importance")
            .field("warp", &self.warp)
            .finish_non_exhaustive()
    }
}
