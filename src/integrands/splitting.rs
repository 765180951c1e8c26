//! Splitting and roulette of the second stage of an integrand, at the best rate.

use std::time::Instant;

use crate::points::{Independent, PointSet};
use crate::{Error, Integrand, Moments, Sampler, Value};

/// A function in two stages: what the first finds out is used for any number of second ones.
///
/// Its value is that of the first stage plus that of one second stage. The second stages of one first stage must be
/// independent and alike, given the first.
pub trait Staged: Sync {
    /// What the function returns.
    type Value: Value;
    /// What the first stage hands on.
    type State;

    /// The first stage: its own part of the value, and what the second stages need.
    fn first<S: Sampler>(&self, u: &mut S) -> (Self::Value, Self::State);

    /// One second stage.
    fn second<S: Sampler>(&self, state: &Self::State, u: &mut S) -> Self::Value;
}

/// A [`Staged`] function whose second stage is evaluated `rate` times on average.
///
/// For a rate above 1 this is splitting, below 1 Russian roulette: the number of second stages is the rate rounded up or
/// down, at random where it is not whole, and their sum is divided by the rate. The expectation does not
/// depend on the rate. The first coordinate decides, then come those of the stages.
///
/// The [best rate](Pilot::rate) balances variance against time; [`pilot`](Self::pilot) measures both.
///
/// ```
/// use estimand::integrands::{Splitting, Staged};
/// use estimand::{Estimator, MonteCarlo, Sampler};
///
/// /// x + x y, the second stage being the product.
/// struct Product;
///
/// impl Staged for Product {
///     type Value = f64;
///     type State = f64;
///     fn first<S: Sampler>(&self, u: &mut S) -> (f64, f64) {
///         let x = u.next_1d();
///         (x, x)
///     }
///     fn second<S: Sampler>(&self, x: &f64, u: &mut S) -> f64 { x * u.next_1d() }
/// }
///
/// for rate in [0.1, 1.0, 3.7] {
///     let estimate = MonteCarlo::new(10_000, 1).estimate(&Splitting::new(Product, rate)?)?;
///     assert!((estimate.mean - 0.75).abs() < 4.0 * estimate.std_error.unwrap());
/// }
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Splitting<T> {
    staged: T,
    rate: f64,
}

impl<T: Staged> Splitting<T> {
    /// `staged` with `rate` second stages on average.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a rate outside `[1e-300, 2^32]`.
    pub fn new(staged: T, rate: f64) -> Result<Self, Error> {
        if !(1e-300..=4_294_967_296.0).contains(&rate) {
            return Err(Error::refused("rate", "in [1e-300, 2^32]", rate));
        }
        Ok(Self { staged, rate })
    }

    /// How many second stages there are on average.
    pub fn rate(&self) -> f64 {
        self.rate
    }
}

impl<T: Staged<Value = f64>> Splitting<T> {
    /// Measures what the best rate depends on, with `count` independent first stages of two second stages each, which
    /// `seed` selects.
    ///
    /// The variances are the same in every run, the seconds are not. For a rate that is to be the same everywhere, set the
    /// costs yourself.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for fewer than two first stages.
    pub fn pilot(staged: &T, count: u64, seed: u64) -> Result<Pilot, Error> {
        if count < 2 {
            return Err(Error::refused("count of pilot points", "at least 2", count));
        }
        let points = Independent::new(seed);
        let (mut both, mut square, mut within) = (Moments::new(), Moments::new(), Moments::new());
        let mut cost = [0.0; 2];
        for index in 0..count {
            let mut u = points.point(index);
            let start = Instant::now();
            let (first, state) = staged.first(&mut u);
            let middle = Instant::now();
            let second = [staged.second(&state, &mut u), staged.second(&state, &mut u)];
            cost[0] += (middle - start).as_secs_f64();
            cost[1] += 0.5 * middle.elapsed().as_secs_f64();
            both.push(first + second[0]);
            square.push(0.5 * (second[0] * second[0] + second[1] * second[1]));
            within.push(0.5 * (second[0] - second[1]).powi(2));
        }
        Ok(Pilot {
            variance: both.variance().unwrap_or(0.0),
            second_square: square.mean(),
            second_variance: within.mean(),
            first_cost: cost[0] / count as f64,
            second_cost: cost[1] / count as f64,
        })
    }
}

/// What the best rate of a [`Splitting`] depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pilot {
    /// The variance of the value with one second stage.
    pub variance: f64,
    /// The mean of the square of the second stage.
    pub second_square: f64,
    /// The mean variance of the second stage, given the first.
    pub second_variance: f64,
    /// What a first stage costs, in seconds or any other unit.
    pub first_cost: f64,
    /// What a second stage costs, in the same unit.
    pub second_cost: f64,
}

impl Pilot {
    /// The rate with the smallest product of variance and cost.
    ///
    /// With `V` the variance at rate 1, `A` and `B` the costs of the stages: a rate `r` above 1 has the variance
    /// `V - W + W / r` with `W` the variance within, best at `sqrt(W A / ((V - W) B))`; a rate below 1 has
    /// `V - Q + Q / r` with `Q` the mean square, best at `sqrt(Q A / ((V - Q) B))`. Above 1 it is whole, at most
    /// 2^20; below 1 at least 1e-9.
    pub fn rate(&self) -> f64 {
        let best = |part: f64| {
            let rest = (self.variance - part).max(0.0);
            (part * self.first_cost / (rest * self.second_cost)).sqrt()
        };
        let (split, roulette) = (best(self.second_variance), best(self.second_square));
        if split > 1.0 {
            let below = split.min(1_048_576.0).floor();
            let above = below + 1.0;
            if self.work(above) < self.work(below) {
                above
            } else {
                below
            }
        } else if roulette < 1.0 {
            roulette.max(1e-9)
        } else {
            1.0
        }
    }

    /// The variance of one evaluation times its cost at `rate`, to be made small; whole rates above 1.
    pub fn work(&self, rate: f64) -> f64 {
        let part = if rate < 1.0 {
            self.second_square
        } else {
            self.second_variance
        };
        (self.variance - part + part / rate) * (self.first_cost + rate * self.second_cost)
    }
}

impl<T: Staged> Integrand for Splitting<T> {
    type Value = T::Value;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> T::Value {
        let whole = self.rate.floor();
        let extra = u.next_1d() < self.rate - whole;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most 2^32"
        )]
        let times = whole as u64 + u64::from(extra);
        let (value, state) = self.staged.first(u);
        let mut sum = T::Value::ZERO;
        for _ in 0..times {
            sum = sum.zip(self.staged.second(&state, u), |sum, x| sum + x);
        }
        value.zip(sum, |value, sum| value + sum / self.rate)
    }
}
