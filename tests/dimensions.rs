//! The coordinates that are read are the ones that the documentation says, in number and order.

use estimand::integrands::Roulette;
use estimand::points::{Independent, PointSet};
use estimand::{Average, Estimator, Integrand, Sampler, cube};

/// Gives out a list, and panics when asked for more.
struct Only<'a>(&'a [f64]);

impl Sampler for Only<'_> {
    fn next_1d(&mut self) -> f64 {
        let (first, rest) = self.0.split_first().expect("no coordinate was to be read");
        self.0 = rest;
        *first
    }
}

/// Evaluates with exactly these coordinates: not one more, and none left.
fn exactly<I: Integrand>(integrand: &I, coordinates: &[f64]) -> I::Value {
    let mut u = Only(coordinates);
    let value = integrand.evaluate(&mut u);
    assert!(u.0.is_empty(), "{} coordinates were left", u.0.len());
    value
}

#[test]
fn a_closure_reads_as_many_as_its_pattern_has_in_order() {
    assert_eq!(exactly(&cube(|[]| 1.0), &[]), 1.0);
    assert_eq!(
        exactly(&cube(|[x, y, z]| [x, y, z]), &[0.1, 0.2, 0.3]),
        [0.1, 0.2, 0.3]
    );
}

#[test]
fn roulette_reads_one_and_then_what_its_integrand_reads() {
    let roulette = Roulette::new(cube(|[x, y]| x - y), 0.25)
        .unwrap()
        .otherwise(8.0);
    assert_eq!(exactly(&roulette, &[0.25]), 8.0);
    // (x - (1 - p) c) / p = (0.5 - 0.75 * 8) / 0.25
    assert_eq!(exactly(&roulette, &[0.2, 0.75, 0.25]), -22.0);
    assert_eq!(roulette.dimensions(), 3);
}

#[test]
fn two_coordinates_are_the_next_two() {
    let points = Independent::new(1);
    let mut u = points.point(3);
    let pair = u.next_2d();
    assert_eq!(pair, [points.coordinate(3, 0), points.coordinate(3, 1)]);
    assert_eq!(u.dimension(), 2);
}

#[test]
fn a_wrong_hint_changes_nothing() {
    struct Hinted(u32);
    impl Integrand for Hinted {
        type Value = f64;
        fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
            (0..5).map(|power| u.next_1d().powi(power)).sum()
        }
        fn dimensions(&self) -> u32 {
            self.0
        }
    }
    let estimate = |hint| {
        Average::new(Independent::new(2), 3000)
            .estimate(&Hinted(hint))
            .unwrap()
    };
    for hint in [1, 2, 5, 9, 4096, 5000, u32::MAX] {
        assert_eq!(estimate(0), estimate(hint), "hint {hint}");
    }
}
