//! Control variates.

use crate::points::{Independent, PointSet};
use crate::{Error, Integrand, Moments, Sampler, Value};

/// An integrand less a multiple of another one whose integral is known.
///
/// The integrand returns a pair: the value `f` that is wanted and the control `g`, at the same point. With `m` the
/// known integral of `g` and `b` a coefficient per component, the value is `f - b (g - m)`, whose expectation is
/// that of `f` for every `b` that does not depend on the points. The best `b` is `Cov(f, g) / Var(g)`, and leaves
/// `1 - correlation^2` of the variance.[^rubinstein]
///
/// [`pilot`](Self::pilot) learns the coefficient from points of its own, so that nothing is biased.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube, integrands::ControlVariate};
///
/// // exp(x) against its Taylor polynomial, whose integral is 1 + 1/2 + 1/6.
/// let pair = cube(|[x]| (x.exp(), 1.0 + x + 0.5 * x * x));
/// let controlled = ControlVariate::pilot(&pair, 1.0 + 0.5 + 1.0 / 6.0, 1000, 7)?;
/// let plain = cube(|[x]| x.exp());
///
/// let with = MonteCarlo::new(10_000, 1).estimate(&controlled)?.std_error.unwrap();
/// let without = MonteCarlo::new(10_000, 1).estimate(&plain)?.std_error.unwrap();
/// assert!(with < without / 10.0);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^rubinstein]: Rubinstein, Reuven; Marcus, Ruth (1985). *Efficiency of Multivariate Control Variates in Monte Carlo
///     Simulation*. <https://doi.org/10.1287/opre.33.3.661>
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct ControlVariate<I, V> {
    integrand: I,
    mean: V,
    coefficient: V,
}

impl<V: Value, I: Integrand<Value = (V, V)>> ControlVariate<I, V> {
    /// `integrand`'s first value less `coefficient` times its second, whose integral is `mean`.
    pub const fn new(integrand: I, mean: V, coefficient: V) -> Self {
        Self {
            integrand,
            mean,
            coefficient,
        }
    }
}

impl<V: Value<Wide = V>, I: Integrand<Value = (V, V)>> ControlVariate<I, V> {
    /// The same with the best coefficient as `count` independent points show it, which `seed` selects and which are used for
    /// nothing else.
    ///
    /// A control that does not vary on them gets the coefficient zero.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for fewer than two points; [`Error::NonFinite`] if a value is not finite at one of them.
    pub fn pilot(integrand: I, mean: V, count: u64, seed: u64) -> Result<Self, Error> {
        if count < 2 {
            return Err(Error::refused("count of pilot points", "at least 2", count));
        }
        let points = Independent::new(seed);
        // Cov(f, g) = (Var(f + g) - Var(f - g)) / 4, of values scaled to the same spread: no sums of products.
        let values = (0..count).map(|index| {
            let value = integrand.evaluate(&mut points.point(index));
            if value.is_finite() {
                return Ok(value);
            }
            let mut components = Vec::new();
            value.for_each(|component| components.push(component));
            Err(Error::NonFinite {
                index,
                replicate: 0,
                coordinates: Vec::new(),
                value: components,
            })
        });
        let values = values.collect::<Result<Vec<(V, V)>, Error>>()?;
        let spread = |moments: Moments<V>| moments.std_dev().unwrap_or(V::ZERO);
        let wanted = spread(values.iter().map(|value| value.0).collect());
        let control = spread(values.iter().map(|value| value.1).collect());
        let scaled = |value: V, spread: V| {
            value.zip(
                spread,
                |x, spread| if spread > 0.0 { x / spread } else { 0.0 },
            )
        };
        let combined = |sign: f64| -> V {
            spread(
                values
                    .iter()
                    .map(|&(f, g)| scaled(f, wanted).zip(scaled(g, control), |f, g| f + sign * g))
                    .collect(),
            )
        };
        let correlation = combined(1.0).zip(combined(-1.0), |sum, difference| {
            0.25 * (sum * sum - difference * difference)
        });
        let coefficient = scaled(correlation, control.map(|spread| spread))
            .zip(wanted, |per_control, wanted| per_control * wanted);
        Ok(Self::new(integrand, mean, coefficient))
    }

    /// The coefficient of the control, per component.
    pub fn coefficient(&self) -> V {
        self.coefficient
    }
}

impl<V: Value, I: Integrand<Value = (V, V)>> Integrand for ControlVariate<I, V> {
    type Value = V;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> V {
        let (value, control) = self.integrand.evaluate(u);
        let excess = control
            .zip(self.mean, |control, mean| control - mean)
            .zip(self.coefficient, |excess, coefficient| excess * coefficient);
        value.zip(excess, |value, excess| value - excess)
    }

    fn dimensions(&self) -> u32 {
        self.integrand.dimensions()
    }
}
