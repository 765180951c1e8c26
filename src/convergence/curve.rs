//! What a study has found: samples, curves, slopes.

use super::Trial;
use crate::quantile::student;

/// What a [`Study`](super::Study) has found.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Convergence {
    /// How many runs every sample is made of.
    pub seeds: u64,
    /// The root-mean-square error of the reference; 0 if it is exact.
    pub noise: f64,
    /// How long one evaluation of the integrand takes by itself, in seconds on one thread, where it is known:
    /// what is left of a method's time is the cost of its points and of the estimate.
    pub evaluation_seconds: Option<f64>,
    /// One curve a method, in the order in which they were added.
    pub curves: Vec<Curve>,
}

/// The error of one method over growing counts.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Curve {
    /// The name of the method.
    pub method: String,
    /// One sample a count, counts growing.
    pub samples: Vec<Sample>,
    /// The slope of the error over evaluations, both logarithmic, fitted by least squares to the samples that
    /// are [neither limited](Sample::limited) nor exact; `None` for fewer than two of those.
    pub slope: Option<Slope>,
}

/// The runs of one method at one count.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Sample {
    /// How many evaluations were asked for.
    pub count: u64,
    /// How many were made, in the mean over the runs, rounded.
    pub evaluations: u64,
    /// How long a run took, in seconds: the median over the runs.
    pub seconds: f64,
    /// The root of the mean square of the errors.
    pub rmse: f64,
    /// The lower end of the 95 % band of `rmse`.
    pub rmse_low: f64,
    /// The upper end of the 95 % band of `rmse`.
    pub rmse_high: f64,
    /// The root of the mean square of the claimed standard errors, if the method claims one.
    pub claimed: Option<f64>,
    /// Which fraction of the claimed 95 % intervals held the truth, if the method claims intervals.
    pub coverage: Option<f64>,
    /// `1 / (rmse^2 seconds)`: twice the efficiency reaches the same error in half the time, if the error falls
    /// as the root of the count.
    pub efficiency: f64,
    /// Whether the error of the reference itself is more than a third of `rmse`, which then says little about the
    /// method.
    pub limited: bool,
}

/// A fitted slope, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Slope {
    /// The slope: -0.5 for independent points.
    pub value: f64,
    /// The lower end of the interval; infinite if only two samples were fitted.
    pub low: f64,
    /// The upper end of the interval; infinite if only two samples were fitted.
    pub high: f64,
    /// How many samples were fitted.
    pub samples: usize,
}

impl Sample {
    pub(super) fn new(count: u64, trials: &[(Trial, f64)], noise: f64) -> Self {
        let runs = trials.len() as f64;
        let mean = |of: &dyn Fn(&Trial) -> Option<f64>| {
            let sum: Option<f64> = trials.iter().map(|(trial, _)| of(trial)).sum();
            sum.map(|sum| sum / runs)
        };
        let mut times: Vec<f64> = trials.iter().map(|&(_, seconds)| seconds).collect();
        times.sort_by(f64::total_cmp);
        let middle = times.len() / 2;
        let seconds = if times.len().is_multiple_of(2) {
            0.5 * (times[middle - 1] + times[middle])
        } else {
            times[middle]
        };
        let mse = mean(&|trial| Some(trial.squared_error)).unwrap_or(0.0);
        let (low, high) = band(trials, mse);
        #[expect(clippy::cast_possible_truncation, reason = "a mean of u64s is one")]
        let evaluations = mean(&|trial| Some(trial.evaluations as f64))
            .unwrap_or(0.0)
            .round() as u64;
        Self {
            count,
            evaluations,
            seconds,
            rmse: mse.sqrt(),
            rmse_low: low.sqrt(),
            rmse_high: high.sqrt(),
            claimed: mean(&|trial| trial.squared_claim).map(f64::sqrt),
            coverage: mean(&|trial| trial.covered),
            efficiency: 1.0 / (mse * seconds),
            limited: 3.0 * noise > mse.sqrt(),
        }
    }
}

/// The 95 % band of the mean of the squared errors: Student's interval for its logarithm, whose spread is by first
/// order that of the squared errors over their mean. It stays above zero, as an interval of the mean itself would not.
fn band(trials: &[(Trial, f64)], mse: f64) -> (f64, f64) {
    if mse == 0.0 {
        return (0.0, 0.0);
    }
    let runs = trials.len() as f64;
    // Relative to the mean, so that the squares of tiny errors do not vanish.
    let squares: f64 = trials
        .iter()
        .map(|(trial, _)| (trial.squared_error / mse - 1.0).powi(2))
        .sum();
    let spread = (squares / (runs * (runs - 1.0))).sqrt();
    let factor = (student(0.95, runs - 1.0) * spread).exp();
    (mse / factor, mse * factor)
}

impl Curve {
    pub(super) const fn new(method: String) -> Self {
        Self {
            method,
            samples: Vec::new(),
            slope: None,
        }
    }

    /// Fits the slope to the samples.
    pub(super) fn fit(&mut self) {
        let points: Vec<(f64, f64)> = self
            .samples
            .iter()
            .filter(|sample| !sample.limited && sample.rmse > 0.0 && sample.evaluations > 0)
            .map(|sample| ((sample.evaluations as f64).ln(), sample.rmse.ln()))
            .collect();
        self.slope = Slope::fit(&points);
    }

    /// How long the method takes to reach `error`, in seconds: between samples by a power law, before the first
    /// sample its time; `None` if no sample reaches it.
    ///
    /// Samples [limited](Sample::limited) by the reference reach nothing.
    pub fn seconds_to(&self, error: f64) -> Option<f64> {
        let mut before: Option<&Sample> = None;
        for sample in self.samples.iter().filter(|sample| !sample.limited) {
            if sample.rmse <= error {
                return Some(before.map_or(sample.seconds, |before| {
                    let share = (before.rmse / error).ln() / (before.rmse / sample.rmse).ln();
                    (before.seconds.ln() + share * (sample.seconds / before.seconds).ln()).exp()
                }));
            }
            before = Some(sample);
        }
        None
    }
}

impl Slope {
    /// The least-squares line through `points`; `None` for fewer than two different abscissas.
    ///
    /// Its interval is Student's, with two degrees of freedom less than points.
    pub(super) fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let count = points.len() as f64;
        let (mut x, mut y) = (0.0, 0.0);
        for point in points {
            x += point.0 / count;
            y += point.1 / count;
        }
        let (mut xx, mut xy) = (0.0, 0.0);
        for point in points {
            xx += (point.0 - x) * (point.0 - x);
            xy += (point.0 - x) * (point.1 - y);
        }
        if xx == 0.0 || points.is_empty() {
            return None;
        }
        let value = xy / xx;
        let half_width = if points.len() > 2 {
            let residual = |point: &(f64, f64)| point.1 - y - value * (point.0 - x);
            let squares: f64 = points.iter().map(|point| residual(point).powi(2)).sum();
            student(0.95, count - 2.0) * (squares / (count - 2.0) / xx).sqrt()
        } else {
            f64::INFINITY
        };
        Some(Self {
            value,
            low: value - half_width,
            high: value + half_width,
            samples: points.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_and_its_interval_are_those_of_the_textbook() {
        // Hand-computed: x = 0..4, y = 0, 1, 1, 2 has slope 0.6 and residuals -0.1, 0.3, -0.3, 0.1, hence a standard
        // error of sqrt(0.2 / 2 / 5); Student's quantile at 0.975 with two degrees of freedom is 4.302653.
        let fit = Slope::fit(&[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 2.0)]).unwrap();
        assert!((fit.value - 0.6).abs() < 1e-15);
        assert!((fit.high - 0.6 - 4.302_653 * 0.02_f64.sqrt()).abs() < 1e-6);
        assert!(Slope::fit(&[(1.0, 2.0), (1.0, 3.0)]).is_none() && Slope::fit(&[]).is_none());
    }

    #[test]
    fn times_between_samples_follow_the_power_law() {
        let trial = |error: f64| Trial {
            evaluations: 1,
            squared_error: error * error,
            squared_claim: None,
            covered: None,
        };
        let sample = |count, error, seconds| Sample::new(count, &[(trial(error), seconds); 2], 0.0);
        let mut curve = Curve::new("method".into());
        curve.samples = vec![sample(1, 1.0, 1.0), sample(2, 0.01, 100.0)];
        assert!((curve.seconds_to(0.1).unwrap() - 10.0).abs() < 1e-12);
        assert_eq!(curve.seconds_to(2.0), Some(1.0));
        assert_eq!(curve.seconds_to(0.001), None);
    }
}
