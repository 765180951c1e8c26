//! What a study has found, as a flat table.

use super::{Convergence, Sample};

/// One sample of one method: a line of a table, as files of comma-separated values have them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Row<'a> {
    /// The name of the method.
    pub method: &'a str,
    /// See [`Sample::count`].
    pub count: u64,
    /// See [`Sample::evaluations`].
    pub evaluations: u64,
    /// How many runs the sample is made of.
    pub seeds: u64,
    /// See [`Sample::seconds`].
    pub seconds: f64,
    /// See [`Sample::rmse`].
    pub rmse: f64,
    /// See [`Sample::rmse_low`].
    pub rmse_low: f64,
    /// See [`Sample::rmse_high`].
    pub rmse_high: f64,
    /// See [`Sample::claimed`].
    pub claimed: Option<f64>,
    /// See [`Sample::coverage`].
    pub coverage: Option<f64>,
    /// See [`Sample::efficiency`].
    pub efficiency: Option<f64>,
    /// See [`Sample::limited`].
    pub limited: bool,
    /// See [`Convergence::points_seconds`].
    pub points_seconds: Option<f64>,
}

impl Convergence {
    /// All samples of all methods, curve by curve.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.curves.iter().flat_map(move |curve| {
            curve.samples.iter().map(move |sample| Row {
                method: &curve.method,
                count: sample.count,
                evaluations: sample.evaluations,
                seeds: self.seeds,
                seconds: sample.seconds,
                rmse: sample.rmse,
                rmse_low: sample.rmse_low,
                rmse_high: sample.rmse_high,
                claimed: sample.claimed,
                coverage: sample.coverage,
                efficiency: sample.efficiency,
                limited: sample.limited,
                points_seconds: self.points_seconds(sample),
            })
        })
    }

    /// What an evaluation costs beside the integrand, in seconds: the time of its point, and its share of the estimate.
    /// `None` where the [time of the integrand](Self::evaluation_seconds) is not known.
    ///
    /// For runs on one thread. A difference of two measurements: it can fall below zero where points cost next to nothing, and
    /// where an estimator evaluates several points at once.
    pub fn points_seconds(&self, sample: &Sample) -> Option<f64> {
        let integrand = self.evaluation_seconds?;
        (sample.evaluations > 0).then(|| sample.seconds / sample.evaluations as f64 - integrand)
    }
}

#[cfg(test)]
mod tests {
    use crate::convergence::{Study, Truth};
    use crate::{Average, MonteCarlo, cube, points::Independent};

    #[test]
    fn rows_tell_what_the_curves_do() {
        let f = cube(|[x]| x);
        let study = Study::new([2, 8], 3).unwrap().shortest(0.0);
        let study = study.integral(&f, Truth::exact(0.5));
        let result = study
            .method("plain", MonteCarlo::new)
            .method("bare", |count, seed| {
                Average::new(Independent::new(seed), count)
            })
            .run()
            .unwrap();
        let rows: Vec<_> = result.rows().collect();
        assert_eq!(rows.len(), 4);
        let place = |row: usize| (rows[row].method, rows[row].count, rows[row].seeds);
        assert_eq!(place(1), ("plain", 8, 3));
        assert_eq!(place(2), ("bare", 2, 3));
        assert_eq!(rows[1].rmse, result.curves[0].samples[1].rmse);
        assert!(rows[1].coverage.is_some() && rows[2].coverage.is_none());
        let (sample, integrand) = (&result.curves[0].samples[1], result.evaluation_seconds);
        let points = rows[1].points_seconds.unwrap();
        assert!((points + integrand.unwrap() - sample.seconds / 8.0).abs() < 1e-15);
    }
}
