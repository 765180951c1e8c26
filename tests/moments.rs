//! Mean and spread where textbook sums fail, alone and through an estimator.

use approx::assert_relative_eq;
use estimand::points::PointSet;
use estimand::{Average, Estimator, Moments, MonteCarlo, Value, cube};

/// Mean and standard deviation of `0..count`, in closed form.
fn ramp(count: u64) -> (f64, f64) {
    let n = count as f64;
    ((n - 1.0) / 2.0, (n * (n + 1.0) / 12.0).sqrt())
}

#[test]
fn a_ramp_has_its_closed_form_however_it_is_cut() {
    const COUNT: u64 = 10_000;
    let (mean, deviation) = ramp(COUNT);
    for cut in [0, 1, 37, 5000, COUNT - 1, COUNT] {
        let part = |range: std::ops::Range<u64>| range.map(|x| x as f64).collect::<Moments<_>>();
        let mut moments = part(0..cut);
        moments.merge(part(cut..COUNT));
        assert_eq!(moments.count(), COUNT);
        assert_relative_eq!(moments.mean(), mean, max_relative = 1e-14);
        assert_relative_eq!(moments.std_dev().unwrap(), deviation, max_relative = 1e-13);
        assert_relative_eq!(
            moments.std_error().unwrap(),
            deviation / 100.0,
            max_relative = 1e-13
        );
    }
}

#[test]
fn spread_is_free_of_scale_component_by_component() {
    // Two values 1 and 3 times the scale: mean 2, standard deviation sqrt(2).
    let scales = [1e-307, 1e-300, 1e-160, 1.0, 1e160, 1e300, 1e306];
    let moments: Moments<[f64; 7]> = [1.0, 3.0]
        .map(|x| scales.map(|scale| x * scale))
        .into_iter()
        .collect();
    for (k, scale) in scales.into_iter().enumerate() {
        assert_relative_eq!(moments.mean()[k] / scale, 2.0, max_relative = 1e-15);
        assert_relative_eq!(
            moments.std_dev().unwrap()[k] / scale,
            2_f64.sqrt(),
            max_relative = 1e-14
        );
    }
    // The same through an estimator's fast sums: x is uniform, with the standard error sqrt(1 / 12 n).
    let f = cube(|[x]| scales.map(|scale| x * scale));
    let estimate = MonteCarlo::new(20_000, 1).estimate(&f).unwrap();
    for (k, scale) in scales.into_iter().enumerate() {
        let error = estimate.std_error.unwrap()[k] / scale;
        // The sample variance of a uniform variable is uncertain by 0.6 %: six of that.
        assert_relative_eq!(error, (1.0 / 240_000_f64).sqrt(), max_relative = 0.02);
        assert_relative_eq!(estimate.mean[k] / scale, 0.5, max_relative = 12.0 * error);
    }
}

#[test]
fn a_small_spread_about_a_large_mean_is_not_lost() {
    // 1e9 + a coin of 0 and 2: standard deviation 1, where E[x^2] - E[x]^2 has no digit left.
    let moments: Moments<f64> = (0..1000).map(|k| 1e9 + f64::from(k % 2) * 2.0).collect();
    assert_relative_eq!(moments.mean(), 1e9 + 1.0, max_relative = 1e-15);
    assert_relative_eq!(
        moments.variance().unwrap(),
        1000.0 / 999.0,
        max_relative = 1e-6
    );

    let coin = cube(|[x]| if x < 0.5 { 1e9_f64 } else { 1e9 + 2.0 });
    let estimate = MonteCarlo::new(1 << 20, 1).estimate(&coin).unwrap();
    assert_relative_eq!(
        estimate.std_error.unwrap(),
        1.0 / 1024.0,
        max_relative = 1e-2
    );
}

#[test]
fn alternating_giants_cancel() {
    /// 0, 1/2, 0, 1/2, ...
    struct Alternating;
    impl PointSet for Alternating {
        fn coordinate(&self, index: u64, _: u32) -> f64 {
            0.5 * (index % 2) as f64
        }
    }
    let f = cube(|[x]| if x < 0.5 { 1e16_f64 } else { -1e16 });
    for count in [2, 1024, 10_000] {
        let estimate = Average::new(Alternating, count).estimate(&f).unwrap();
        assert!(
            estimate.mean.abs() <= 1e16 * f64::EPSILON,
            "{count}: {}",
            estimate.mean
        );
    }
}

#[test]
fn constants_have_no_spread_at_any_scale() {
    for constant in [0.0_f64, 1.0, -0.1, 5e-324, 1e-310, 1e300, f64::MAX] {
        let estimate = MonteCarlo::new(5000, 1)
            .estimate(&cube(|[_]| constant))
            .unwrap();
        assert_eq!((estimate.mean, estimate.std_error), (constant, Some(0.0)));
    }
}

#[test]
fn single_precision_values_are_averaged_in_double() {
    // In f32 a running mean of 2^25 terms stands still long before its end.
    let f = cube(|[x]| if x < 0.75 { 1.0_f32 } else { 0.0 });
    let estimate = MonteCarlo::new(1 << 22, 1).estimate(&f).unwrap();
    assert!((estimate.mean - 0.75).abs() < 6.0 * estimate.std_error.unwrap());
    assert_eq!(0.1_f32.widen(), f64::from(0.1_f32));
}

#[test]
fn nan_is_never_lost() {
    for place in 0..3 {
        let mut values = [1.0, 2.0, 3.0];
        values[place] = f64::NAN;
        let moments: Moments<f64> = values.into_iter().collect();
        assert!(
            moments.mean().is_nan() && moments.std_error().unwrap().is_nan(),
            "{place}"
        );
    }
}

#[test]
fn spread_too_small_for_its_squares_is_not_taken_for_none() {
    // 0, +s and -s in turn: the sums cancel, the squares underflow.
    struct Thirds;
    impl PointSet for Thirds {
        fn coordinate(&self, index: u64, _: u32) -> f64 {
            (index % 3) as f64 / 3.0
        }
    }
    let f = cube(|[x]| {
        if x < 0.3 {
            0.0_f64
        } else if x < 0.6 {
            1e-200
        } else {
            -1e-200
        }
    });
    let average = Average::new(Thirds, 999).estimate(&f).unwrap();
    assert!(average.mean.abs() < 1e-213, "{}", average.mean);
    let estimate = MonteCarlo::new(999, 1).estimate(&f).unwrap();
    // The standard deviation is sqrt(2/3) 1e-200, within 6 times its own 1 %.
    let expected = (2.0_f64 / 3.0 / 999.0).sqrt();
    assert_relative_eq!(
        estimate.std_error.unwrap() / 1e-200,
        expected,
        max_relative = 0.1
    );
}

#[test]
fn fewer_than_two_values_have_no_spread() {
    let mut moments = Moments::<f64>::new();
    assert_eq!(
        (moments.count(), moments.mean(), moments.variance()),
        (0, 0.0, None)
    );
    moments.push(3.0);
    assert_eq!((moments.mean(), moments.std_error()), (3.0, None));
    moments.push(3.0);
    assert_eq!(moments.std_error(), Some(0.0));
}
