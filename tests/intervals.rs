//! Widths of intervals against published quantiles and formulas.

use estimand::estimators::{Bounded, Strata};
use estimand::{Estimate, Estimator, cube};

/// Quantiles of Student's distribution for two-sided 95 %: NIST/SEMATECH *e-Handbook of Statistical Methods*, 1.3.6.7.2.
/// <https://www.itl.nist.gov/div898/handbook/eda/section3/eda3672.htm>
const STUDENT: [(u64, f64); 5] = [(1, 12.706), (2, 4.303), (4, 2.776), (9, 2.262), (30, 2.042)];

/// Half the width of the interval at 95 %, in standard errors.
fn errors_wide(estimate: &Estimate<f64>) -> f64 {
    let interval = estimate.interval(0.95).unwrap();
    0.5 * (interval.high - interval.low) / estimate.std_error.unwrap()
}

#[test]
fn strata_have_the_freedom_of_the_one_that_varies() {
    // The first half is constant: by Satterthwaite's formula the freedom is that of the second.
    let f = cube(|[x, y]: [f64; 2]| if x < 0.5 { 1.0 } else { y });
    for (freedom, quantile) in STUDENT {
        let strata = Strata::new(2, 1, 2 * (freedom + 1), 7).unwrap();
        let estimate = strata.estimate(&f).unwrap();
        let widths = errors_wide(&estimate);
        assert!((widths - quantile).abs() < 6e-4, "{freedom}: {widths}");
    }
}

#[test]
fn strata_of_equal_variance_add_their_freedoms() {
    // Two values of 0 or 1 in each half: a half whose values differ has the variance 1/2 and one degree of freedom, the mean of the
    // two then a standard error of 1/4, or of sqrt(1/8) if both halves have it.
    let f = cube(|[_, y]: [f64; 2]| f64::from(u8::from(y < 0.5)));
    let mut seen = [0; 2];
    for seed in 0..40 {
        let estimate = Strata::new(2, 1, 4, seed).unwrap().estimate(&f).unwrap();
        let error = estimate.std_error.unwrap();
        if error == 0.0 {
            continue;
        }
        let both = usize::from(error > 0.3);
        let (freedom, quantile) = STUDENT[both];
        let widths = errors_wide(&estimate);
        assert!((widths - quantile).abs() < 6e-4, "{freedom}: {widths}");
        assert!((error - [0.25, 0.125_f64.sqrt()][both]).abs() < 1e-15);
        seen[both] += 1;
    }
    assert!(seen[0] > 0 && seen[1] > 0, "{seen:?}");
}

/// Maurer, Andreas; Pontil, Massimiliano (2009). *Empirical Bernstein Bounds and Sample Variance Penalization*, theorem 4, on
/// both sides. <https://arxiv.org/abs/0907.3740>
#[test]
fn bounded_values_have_the_interval_of_maurer_and_pontil() {
    let f = cube(|[x]: [f64; 1]| 3.0 * x * x - 1.0);
    for count in [10, 1000] {
        for level in [0.9_f64, 0.99] {
            let estimate = Bounded::new(count, 3, -1.0, 2.0)
                .unwrap()
                .estimate(&f)
                .unwrap();
            let n = count as f64;
            let variance = estimate.std_error.unwrap().powi(2) * n;
            // Each side takes half of the doubt, and theorem 4 has ln(2 / doubt).
            let logarithm = (4.0 / (1.0 - level)).ln();
            let expected =
                (2.0 * variance * logarithm / n).sqrt() + 7.0 * 3.0 * logarithm / (3.0 * (n - 1.0));
            let [low, high] = [estimate.mean - expected, estimate.mean + expected];
            let interval = estimate.interval(level).unwrap();
            assert!(
                (interval.low - low.max(-1.0)).abs() < 1e-12,
                "{interval:?} {low}"
            );
            assert!(
                (interval.high - high.min(2.0)).abs() < 1e-12,
                "{interval:?} {high}"
            );
        }
    }
}
