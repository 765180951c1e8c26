//! What a study has found: samples, curves, slopes.

use std::collections::BTreeMap;

use super::Trial;
use crate::quantile::student;
use crate::{Error, Interval};

/// What a [`Study`](super::Study) has found.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Convergence {
    /// How many runs every sample is made of.
    pub seeds: u64,
    /// The root-mean-square error of the reference; 0 if it is exact.
    pub noise: f64,
    /// What errors are relative to: for an integral the root-mean-square of the components of its truth.
    pub scale: Option<f64>,
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
    /// as the root of the count. `None` where no error was seen.
    pub efficiency: Option<f64>,
    /// Whether the error of the reference itself is more than a third of `rmse`, which then says little about the
    /// method.
    pub limited: bool,
}

/// A fitted slope.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Slope {
    /// The slope: -0.5 for independent points.
    pub value: f64,
    /// Its 95 % interval; `None` if only two samples were fitted, which leaves nothing to judge it by.
    pub interval: Option<Interval<f64>>,
    /// How many samples were fitted.
    pub samples: usize,
}

/// One run of a method: what it gave, and how long it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// How many evaluations were asked for.
    pub count: u64,
    /// What the run has given.
    pub trial: Trial,
    /// How long it took, in seconds.
    pub seconds: f64,
}

impl Sample {
    /// The sample of some runs, all of the same count, at least one.
    fn new(runs: &[Run], noise: f64) -> Self {
        let number = runs.len() as f64;
        let mean = |of: &dyn Fn(&Trial) -> Option<f64>| {
            let sum: Option<f64> = runs.iter().map(|run| of(&run.trial)).sum();
            sum.map(|sum| sum / number)
        };
        let mut times: Vec<f64> = runs.iter().map(|run| run.seconds).collect();
        times.sort_by(f64::total_cmp);
        let middle = times.len() / 2;
        let seconds = if times.len().is_multiple_of(2) {
            0.5 * (times[middle - 1] + times[middle])
        } else {
            times[middle]
        };
        let mse = mean(&|trial| Some(trial.squared_error)).unwrap_or(0.0);
        let (low, high) = band(runs, mse);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a mean of u64s is one"
        )]
        let evaluations = mean(&|trial| Some(trial.evaluations as f64))
            .unwrap_or(0.0)
            .round() as u64;
        Self {
            count: runs[0].count,
            evaluations,
            seconds,
            rmse: mse.sqrt(),
            rmse_low: low.sqrt(),
            rmse_high: high.sqrt(),
            claimed: mean(&|trial| trial.squared_claim).map(f64::sqrt),
            coverage: mean(&|trial| trial.covered),
            efficiency: (mse > 0.0).then(|| 1.0 / (mse * seconds)),
            limited: 3.0 * noise > mse.sqrt(),
        }
    }
}

/// The 95 % band of the mean of the squared errors: Student's interval for its logarithm, whose spread is by first
/// order that of the squared errors over their mean. It stays above zero, as an interval of the mean itself would not.
fn band(runs: &[Run], mse: f64) -> (f64, f64) {
    if mse == 0.0 {
        return (0.0, 0.0);
    }
    let number = runs.len() as f64;
    // Relative to the mean, so that the squares of tiny errors do not vanish.
    let squares: f64 = runs
        .iter()
        .map(|run| (run.trial.squared_error / mse - 1.0).powi(2))
        .sum();
    let spread = (squares / (number * (number - 1.0))).sqrt();
    let factor = (student(0.95, number - 1.0) * spread).exp();
    (mse / factor, mse * factor)
}

impl Curve {
    /// The curve of a method from its runs, however they were made: by another program, for instance. `noise` is the
    /// root-mean-square error of the reference, 0 for an exact truth.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a count with fewer than two runs, for an error that is negative or not finite, and for a
    /// time that is not positive and finite.
    pub fn of_runs(
        method: impl Into<String>,
        runs: impl IntoIterator<Item = Run>,
        noise: f64,
    ) -> Result<Self, Error> {
        let mut by_count = BTreeMap::<u64, Vec<Run>>::new();
        for run in runs {
            let error = run.trial.squared_error;
            if !(error >= 0.0 && error.is_finite()) {
                return Err(Error::refused(
                    "squared error of a run",
                    "finite and at least 0",
                    error,
                ));
            }
            if !(run.seconds > 0.0 && run.seconds.is_finite()) {
                return Err(Error::refused(
                    "seconds of a run",
                    "positive and finite",
                    run.seconds,
                ));
            }
            by_count.entry(run.count).or_default().push(run);
        }
        let mut samples = Vec::new();
        for (count, runs) in by_count {
            if runs.len() < 2 {
                let given = format_args!("{} at a count of {count}", runs.len());
                return Err(Error::refused(
                    "number of runs",
                    "at least 2 at every count",
                    given,
                ));
            }
            samples.push(Sample::new(&runs, noise));
        }
        let line: Vec<(f64, f64)> = samples
            .iter()
            .filter(|sample| !sample.limited && sample.rmse > 0.0 && sample.evaluations > 0)
            .map(|sample| ((sample.evaluations as f64).ln(), sample.rmse.ln()))
            .collect();
        Ok(Self {
            method: method.into(),
            samples,
            slope: Slope::fit(&line),
        })
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

impl Curve {
    /// How long the method would take to reach `error`, in seconds, if its error went on falling as its [slope](Self::slope)
    /// says and its time grew as its evaluations: an extrapolation behind the last sample. `None` where there is nothing to
    /// go by: no interval for the slope, or one that reaches above -0.2; and for more than 10^6 times the last sample's time.
    pub fn seconds_by_slope_to(&self, error: f64) -> Option<f64> {
        let slope = self.slope?;
        let last = self.samples.iter().rev().find(|sample| !sample.limited)?;
        let factor = (last.rmse / error).powf(-1.0 / slope.value);
        (slope.interval?.high < -0.2 && (1.0..1e6).contains(&factor))
            .then_some(factor * last.seconds)
    }
}

impl Slope {
    /// The least-squares line through `points`; `None` for fewer than two different abscissas.
    ///
    /// Its interval is Student's, with two degrees of freedom less than points.
    fn fit(points: &[(f64, f64)]) -> Option<Self> {
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
        let interval = (points.len() > 2).then(|| {
            let residual = |point: &(f64, f64)| point.1 - y - value * (point.0 - x);
            let squares: f64 = points.iter().map(|point| residual(point).powi(2)).sum();
            let half_width = student(0.95, count - 2.0) * (squares / (count - 2.0) / xx).sqrt();
            Interval {
                low: value - half_width,
                high: value + half_width,
            }
        });
        Some(Self {
            value,
            interval,
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
        let high = fit.interval.unwrap().high;
        assert!((high - 0.6 - 4.302_653 * 0.02_f64.sqrt()).abs() < 1e-6);
        let two = Slope::fit(&[(0.0, 0.0), (1.0, 1.0)]).unwrap();
        assert_eq!((two.value, two.interval), (1.0, None));
        assert!(Slope::fit(&[(1.0, 2.0), (1.0, 3.0)]).is_none() && Slope::fit(&[]).is_none());
    }

    #[test]
    fn times_between_samples_follow_the_power_law() {
        let curve = Curve::of_runs(
            "method",
            [run(1, 1.0, 1.0), run(2, 0.01, 100.0)].concat(),
            0.0,
        );
        let curve = curve.unwrap();
        assert!((curve.seconds_to(0.1).unwrap() - 10.0).abs() < 1e-12);
        assert_eq!(curve.seconds_to(2.0), Some(1.0));
        assert_eq!(curve.seconds_to(0.001), None);
        // Two samples have no interval; of three on a line, a tenth of the error takes 10^(1/2) of the time.
        assert_eq!(curve.seconds_by_slope_to(0.001), None);
        let line = [run(1, 1.0, 1.0), run(10, 0.01, 2.0), run(100, 1e-4, 4.0)].concat();
        let line = Curve::of_runs("line", line, 0.0).unwrap();
        let seconds = line.seconds_by_slope_to(1e-5).unwrap();
        assert!((seconds - 4.0 * 10_f64.sqrt()).abs() < 1e-9, "{seconds}");
        assert_eq!(line.seconds_by_slope_to(1e-3), None);
        // 1 / (0.01^2 100).
        assert!((curve.samples[1].efficiency.unwrap() - 100.0).abs() < 1e-9);
    }

    /// Two runs alike.
    fn run(count: u64, error: f64, seconds: f64) -> [Run; 2] {
        let trial = Trial {
            evaluations: count,
            squared_error: error * error,
            squared_claim: None,
            covered: None,
        };
        [Run {
            count,
            trial,
            seconds,
        }; 2]
    }

    #[test]
    fn runs_that_make_no_sense_are_refused() {
        let message = |runs: &[Run]| {
            let curve = Curve::of_runs("method", runs.iter().copied(), 0.0);
            curve.unwrap_err().to_string()
        };
        assert_eq!(
            message(&run(4, f64::NAN, 1.0)),
            "the squared error of a run must be finite and at least 0; it was NaN"
        );
        assert_eq!(
            message(&run(4, 1.0, 0.0)),
            "the seconds of a run must be positive and finite; it was 0"
        );
        assert_eq!(
            message(&run(4, 1.0, 1.0)[..1]),
            "the number of runs must be at least 2 at every count; it was 1 at a count of 4"
        );
    }
}
