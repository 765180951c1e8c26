//! Integrands that are evaluated at several points at once: the same bits, whoever asks.

use core::sync::atomic::{AtomicU64, Ordering};

use estimand::points::{HashedOwen, Independent, PointSet, Sobol};
use estimand::{
    Average, Error, Estimator, Integrand, MonteCarlo, Progressive, Replicated, Sampler,
};

/// Points that do not fill the lanes of any sum evenly.
const AT_ONCE: usize = 7;

/// A product of as many coordinates as the first one says: five at most.
fn product(u: &mut impl Sampler) -> [f64; 2] {
    let first = u.next_1d();
    let mut product = first;
    for least in [0.2, 0.4, 0.6, 0.8] {
        if first > least {
            product *= 1.0 + u.next_1d();
        }
    }
    [product, (7.0 * product).sin() * 1e8]
}

struct OneByOne;

impl Integrand for OneByOne {
    type Value = [f64; 2];

    fn evaluate<S: Sampler>(&self, u: &mut S) -> [f64; 2] {
        product(u)
    }

    fn dimensions(&self) -> u32 {
        3
    }
}

/// The same at several points, which counts them; NaN at the point whose first coordinate is `bad`.
#[derive(Default)]
struct AtOnce {
    seen: AtomicU64,
    bad: Option<f64>,
}

impl Integrand for AtOnce {
    type Value = [f64; 2];

    const AT_ONCE: usize = AT_ONCE;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> [f64; 2] {
        let [x, y] = product(u);
        [if self.bad == Some(x) { f64::NAN } else { x }, y]
    }

    fn evaluate_many<S: Sampler>(&self, samplers: &mut [S], values: &mut [[f64; 2]]) {
        assert_eq!(samplers.len(), values.len());
        assert!((1..=AT_ONCE).contains(&samplers.len()));
        self.seen
            .fetch_add(samplers.len() as u64, Ordering::Relaxed);
        // The last first: the order is the integrand's own matter.
        for (u, value) in samplers.iter_mut().zip(values).rev() {
            *value = self.evaluate(u);
        }
    }

    fn dimensions(&self) -> u32 {
        3
    }
}

#[test]
fn values_at_once_are_the_values_one_by_one() {
    for count in [1, 6, 7, 8, 1023, 1024, 1025, 10_000] {
        let seen = AtOnce::default();
        let average = Average::new(Independent::new(3), count);
        assert_eq!(
            average.estimate(&seen).unwrap(),
            average.estimate(&OneByOne).unwrap()
        );
        assert_eq!(seen.seen.into_inner(), count);
        let sobol = Sobol::new(3).unwrap();
        let replicated = Replicated::new(4, count, |seed| {
            sobol.clone().scrambled(HashedOwen { seed })
        });
        assert_eq!(
            replicated.estimate(&AtOnce::default()).unwrap(),
            replicated.estimate(&OneByOne).unwrap()
        );
    }
}

#[test]
fn growing_gives_the_bits_of_all_at_once() {
    let average = Average::new(Independent::new(4), 5000);
    let mut state = average.start().unwrap();
    for used in [1, 2, 5, 1000, 1030, 3072, 5000] {
        average.grow(&mut state, &AtOnce::default(), used).unwrap();
    }
    assert_eq!(
        average.conclude(&state).unwrap(),
        average.estimate(&OneByOne).unwrap()
    );
}

#[test]
fn a_stream_is_read_point_by_point() {
    let seen = AtOnce::default();
    let plain = MonteCarlo::new(3000, 5);
    assert_eq!(
        plain.estimate(&seen).unwrap(),
        plain.estimate(&OneByOne).unwrap()
    );
    assert_eq!(seen.seen.into_inner(), 0);
}

#[test]
fn a_value_that_is_not_finite_is_named() {
    let points = Independent::new(6);
    let bad = product(&mut points.point(1234))[0];
    let integrand = AtOnce {
        bad: Some(bad),
        ..AtOnce::default()
    };
    let incomplete = Average::new(points, 5000).estimate(&integrand).unwrap_err();
    let Error::NonFinite { index, .. } = incomplete.reason else {
        panic!("another error: {}", incomplete.reason);
    };
    assert_eq!(index, 1234);
    assert_eq!(incomplete.so_far.unwrap().used, 1234);
}
