//! What an integral is compared with.

use crate::{Error, Estimate, Value};

/// What an integral is compared with.
///
/// ```
/// use estimand::convergence::Truth;
/// use estimand::{Average, Estimator, Replicated, cube, points::{HashedOwen, Sobol}};
///
/// let f = cube(|[x, y]: [f64; 2]| (-x * y).exp().sin());
/// let sobol = Sobol::new(2)?;
/// let points = |seed| sobol.clone().scrambled(HashedOwen { seed });
/// let long = Replicated::new(16, 1 << 14, points).estimate(&f)?;
/// let truth = Truth::of(&long)?;
/// assert!(truth.noise() < 1e-6);
///
/// // An estimate without an error bar is no reference: nobody knows how good it is.
/// let bare = Average::new(points(1), 1 << 14).estimate(&f)?;
/// assert!(Truth::of(&bare).is_err());
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth<V> {
    value: V,
    noise: f64,
}

impl<V> Truth<V> {
    /// The exact value.
    pub const fn exact(value: V) -> Self {
        Self { value, noise: 0.0 }
    }

    /// An estimate by a much longer run, with its standard error: where a method comes near it, the study
    /// says so ([`Sample::limited`](super::Sample::limited)) instead of drawing the reference's error as the method's.
    pub const fn reference(value: V, std_error: f64) -> Self {
        Self {
            value,
            noise: std_error,
        }
    }

    /// The root-mean-square error of the value; 0 if it is exact.
    pub const fn noise(&self) -> f64 {
        self.noise
    }
}

impl<V: Value> Truth<V> {
    /// The mean of an estimate by a much longer run, with its error bar.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an estimate without an error bar: then there is neither a truth nor a reference.
    pub fn of(estimate: &Estimate<V>) -> Result<Self, Error> {
        let Some(error) = estimate.std_error else {
            return Err(Error::refused(
                "reference of a study",
                "an estimate with an error bar",
                format_args!("one whose error bar is {}", estimate.error_bar),
            ));
        };
        Ok(Self::reference(estimate.mean, root_mean_square(error)))
    }

    /// The value.
    pub fn value(&self) -> V {
        self.value
    }

    /// The root-mean-square of the components of the value.
    pub fn scale(&self) -> f64 {
        root_mean_square(self.value)
    }
}

fn root_mean_square<V: Value>(value: V) -> f64 {
    let (mut largest, mut components) = (0.0_f64, 0.0);
    value.for_each(|component| {
        largest = largest.max(component.abs());
        components += 1.0;
    });
    if largest == 0.0 {
        // NaN is nobody's maximum: it goes on.
        let mut sum = 0.0;
        value.for_each(|component| sum += component);
        return sum;
    }
    let mut sum = 0.0;
    value.for_each(|component| sum += (component / largest).powi(2));
    largest * (sum / components).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Average, Estimator, MonteCarlo, cube, points::Independent};

    #[test]
    fn sizes_are_root_mean_squares_of_components() {
        assert_eq!(Truth::exact([3.0, -4.0]).scale(), 12.5_f64.sqrt());
        assert_eq!(Truth::exact(-1e300).scale(), 1e300);
        assert_eq!(Truth::exact([0.0, 0.0]).scale(), 0.0);
        assert!(Truth::exact(f64::NAN).scale().is_nan());
    }

    #[test]
    fn a_reference_must_know_its_error() {
        let f = cube(|[x]| [x, 2.0 * x]);
        let long = MonteCarlo::new(10_000, 1).estimate(&f).unwrap();
        let truth = Truth::of(&long).unwrap();
        assert_eq!(truth.value(), long.mean);
        // The standard errors are 1 and 2 times that of x.
        let expected = (2.5_f64 / 12.0 / 10_000.0).sqrt();
        assert!((truth.noise() / expected - 1.0).abs() < 0.05);
        let bare = Average::new(Independent::new(1), 100).estimate(&f).unwrap();
        assert_eq!(
            Truth::of(&bare).unwrap_err().to_string(),
            "the reference of a study must be an estimate with an error bar; it was one whose error bar is none"
        );
    }
}
