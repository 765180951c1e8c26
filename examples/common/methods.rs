//! The estimators that are compared, each with about the same number of evaluations.

use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::points::{HashedOwen, LinearMatrix, Sobol};
use estimand::{Error, Estimate, Estimator, Integrand, MonteCarlo, Replicated};

/// An estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    Plain,
    Strata,
    Neyman,
    Sobol,
    Median,
    Vegas,
    Bounded,
}

impl Method {
    pub(crate) const ALL: [Self; 7] = [
        Self::Plain,
        Self::Strata,
        Self::Neyman,
        Self::Sobol,
        Self::Median,
        Self::Vegas,
        Self::Bounded,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Strata => "strata",
            Self::Neyman => "neyman",
            Self::Sobol => "sobol x 16",
            Self::Median => "median of 15",
            Self::Vegas => "vegas",
            Self::Bounded => "bounded",
        }
    }

    /// An estimate from about `count` evaluations; `None` where the method does not apply.
    pub(crate) fn estimate(
        self,
        integrand: &impl Integrand<Value = f64>,
        bounds: Option<[f64; 2]>,
        count: u64,
        seed: u64,
    ) -> Option<Result<Estimate<f64>, Error>> {
        let dims = integrand.dimensions();
        let sobol = || Sobol::new(dims).expect("a dimension that Sobol' has");
        // Four points a stratum at least, in as many axes as that leaves room for.
        let axes = dims.min(3);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a root of a count"
        )]
        let cells = ((count / 8) as f64).powf(1.0 / f64::from(axes)) as u64;
        let estimate = match self {
            Self::Plain => MonteCarlo::new(count, seed).estimate(integrand),
            Self::Strata => Strata::new(cells, axes, count, seed)
                .ok()?
                .estimate(integrand),
            Self::Neyman => Strata::new(cells, axes, count, seed)
                .ok()?
                .neyman()
                .estimate(integrand),
            Self::Sobol => Replicated::new(16, count / 16, |seed| {
                sobol().scrambled(HashedOwen { seed })
            })
            .seed(seed)
            .estimate(integrand),
            Self::Median => Replicated::new(15, count / 16, |seed| {
                sobol().scrambled(LinearMatrix { seed })
            })
            .seed(seed)
            .median()
            .estimate(integrand),
            Self::Vegas => Vegas::new(dims, count, seed).ok()?.estimate(integrand),
            Self::Bounded => {
                let [low, high] = bounds?;
                Bounded::new(count, seed, low, high)
                    .ok()?
                    .estimate(integrand)
            }
        };
        Some(estimate.map_err(|incomplete| incomplete.reason))
    }
}
