//! Count, mean and spread of a stream of values.

use crate::Value;

/// Count, mean and second central moment of a stream of values; mergeable.
///
/// The spread is kept as the *root* of the sum of squared deviations, so that it neither overflows nor
/// vanishes for values between 1e-300 and 1e300, component by component. Means are updated as Welford
/// gave it,[^welford] merges follow Chan, Golub and LeVeque;[^chan] nothing is ever computed as
/// `E[x^2] - E[x]^2`.
///
/// The components are kept in the precision of `V`: widen `f32` values first
/// ([`Value::widen`]), as the estimators do.
///
/// ```
/// use estimand::Moments;
///
/// let moments: Moments<f64> = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
/// assert_eq!(moments.count(), 4);
/// assert_eq!(moments.mean(), 2.5);
/// assert!((moments.variance().unwrap() - 5.0 / 3.0).abs() < 1e-15);
/// assert!((moments.std_error().unwrap() - (5.0_f64 / 12.0).sqrt()).abs() < 1e-15);
/// ```
///
/// [^welford]: Welford, B. P. (1962). *Note on a Method for Calculating Corrected Sums of Squares and
///     Products*. <https://doi.org/10.1080/00401706.1962.10490022>
/// [^chan]: Chan, Tony; Golub, Gene; LeVeque, Randall (1983). *Algorithms for Computing the Sample
///     Variance*. <https://doi.org/10.1080/00031305.1983.10483115>
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Moments<V> {
    count: u64,
    mean: V,
    /// Root of the sum of squared deviations from the mean, per component.
    root: V,
}

impl<V: Value> Moments<V> {
    /// No values yet.
    pub const fn new() -> Self {
        Self {
            count: 0,
            mean: V::ZERO,
            root: V::ZERO,
        }
    }

    /// `root` is the root of the sum of squared deviations from `mean`.
    #[inline]
    pub(crate) fn from_parts(count: u64, mean: V, root: V) -> Self {
        Self { count, mean, root }
    }

    /// The root of the sum of squared deviations from the mean.
    pub(crate) fn root(&self) -> V {
        self.root
    }

    /// Adds one value.
    #[inline]
    pub fn push(&mut self, value: V) {
        self.merge(Self {
            count: 1,
            mean: value,
            root: V::ZERO,
        });
    }

    /// Adds all values of another stream.
    ///
    /// The result depends on the order of merges in its last bits: merge in a fixed order where the
    /// same bits are wanted again.
    #[inline]
    pub fn merge(&mut self, other: Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = other;
            return;
        }
        let (here, there) = (self.count as f64, other.count as f64);
        let share = there / (here + there);
        let between = (here * share).sqrt();
        let delta = other.mean.zip(self.mean, |b, a| b - a);
        self.count += other.count;
        self.mean = self.mean.zip(delta, |mean, delta| mean + delta * share);
        self.root = self
            .root
            .zip(other.root, norm)
            .zip(delta, |root, delta| norm(root, delta * between));
    }

    /// How many values were added.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean of the values; zero if there are none.
    pub fn mean(&self) -> V {
        self.mean
    }

    /// The unbiased sample variance, per component; `None` for fewer than two values.
    ///
    /// It can overflow where [`std_dev`](Self::std_dev) does not: values of 1e200 have variances of 1e400.
    pub fn variance(&self) -> Option<V> {
        self.std_dev().map(|deviation| deviation.map(|s| s * s))
    }

    /// The root of the [`variance`](Self::variance); `None` for fewer than two values.
    pub fn std_dev(&self) -> Option<V> {
        (self.count > 1).then(|| {
            let scale = ((self.count - 1) as f64).sqrt();
            self.root.map(|root| root / scale)
        })
    }

    /// The standard error of the mean if the values are independent and identically distributed;
    /// `None` for fewer than two values.
    pub fn std_error(&self) -> Option<V> {
        let scale = (self.count as f64).sqrt();
        self.std_dev().map(|deviation| deviation.map(|s| s / scale))
    }
}

impl<V: Value> Default for Moments<V> {
    fn default() -> Self {
        Self::new()
    }
}

impl<V: Value> Extend<V> for Moments<V> {
    fn extend<T: IntoIterator<Item = V>>(&mut self, values: T) {
        for value in values {
            self.push(value);
        }
    }
}

impl<V: Value> FromIterator<V> for Moments<V> {
    fn from_iter<T: IntoIterator<Item = V>>(values: T) -> Self {
        let mut moments = Self::new();
        moments.extend(values);
        moments
    }
}

/// `sqrt(a^2 + b^2)` without overflow or underflow of the squares.
#[inline]
fn norm(a: f64, b: f64) -> f64 {
    let squares = a * a + b * b;
    if (1e-280..1e300).contains(&squares) {
        squares.sqrt()
    } else {
        scaled_norm(a, b)
    }
}

#[cold]
fn scaled_norm(a: f64, b: f64) -> f64 {
    let scale = a.abs().max(b.abs());
    if scale == 0.0 || !scale.is_finite() {
        // The sum, since the larger of a number and NaN is the number.
        return a.abs() + b.abs();
    }
    let (a, b) = (a / scale, b / scale);
    scale * (a * a + b * b).sqrt()
}
