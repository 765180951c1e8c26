//! Random integrands with a known integral x points x adaptors x estimators: the mean is the integral, the
//! variance is what theory says, and the claimed error is the true one.
//!
//! Every case is an average over `RUNS` independent runs; the mean of the runs is compared with the truth in units of
//! its own standard error, with a limit of `LIMIT` = 6. Student's t with 399 degrees of freedom passes it in 4.5e-9 of
//! cases, and the whole file makes some 2000 comparisons: a false alarm in about 1e-5 of all choices of the seeds, which
//! are fixed.

use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::integrands::{
    Antithetic, ControlVariate, Heuristic, Importance, ImportanceMap, Joint, Mapped, Mixture,
    MultiSample, Roulette, Splitting, Staged,
};
use estimand::points::{
    DigitPermutation, DigitalShift, Folded, Halton, Hammersley, HashedOwen, Independent,
    LinearMatrix, NRooks, Owen, PointSet, Shifted, Sobol, Stratified,
};
use estimand::warp::Warp;
use estimand::{Average, Estimator, Integrand, Moments, MonteCarlo, Replicated, Sampler};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const RUNS: u64 = 400;
const LIMIT: f64 = 6.0;
const DIMENSIONS: usize = 3;

/// A polynomial of three variables plus a step along the second.
#[derive(Clone, Debug)]
struct Random {
    terms: Vec<(f64, [u8; DIMENSIONS])>,
    step: f64,
    cut: f64,
}

impl Integrand for Random {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        self.at(std::array::from_fn(|_| u.next_1d()))
    }

    fn dimensions(&self) -> u32 {
        3
    }
}

impl Random {
    /// The value at a point.
    fn at(&self, x: [f64; DIMENSIONS]) -> f64 {
        let polynomial: f64 = self
            .terms
            .iter()
            .map(|(c, powers)| {
                c * x
                    .iter()
                    .zip(powers)
                    .map(|(x, &a)| x.powi(a.into()))
                    .product::<f64>()
            })
            .sum();
        polynomial + if x[1] < self.cut { self.step } else { 0.0 }
    }

    /// The integral of a monomial over the part of the cube where the second coordinate is below `cut`.
    fn monomial(powers: [u8; DIMENSIONS], cut: f64) -> f64 {
        let whole: f64 = powers.iter().map(|&a| 1.0 / (f64::from(a) + 1.0)).product();
        whole * cut.powi(i32::from(powers[1]) + 1)
    }

    /// The integral, in closed form.
    fn mean(&self) -> f64 {
        let polynomial: f64 = self
            .terms
            .iter()
            .map(|&(c, powers)| c * Self::monomial(powers, 1.0))
            .sum();
        polynomial + self.step * self.cut
    }

    /// The variance of one evaluation at a uniform point, in closed form.
    fn variance(&self) -> f64 {
        let mut square = self.step * self.step * self.cut;
        for &(c, powers) in &self.terms {
            square += 2.0 * self.step * c * Self::monomial(powers, self.cut);
            for &(d, others) in &self.terms {
                let powers = std::array::from_fn(|axis| powers[axis] + others[axis]);
                square += c * d * Self::monomial(powers, 1.0);
            }
        }
        square - self.mean().powi(2)
    }
}

fn random() -> impl Strategy<Value = Random> {
    let term = (-2.0..2.0, proptest::array::uniform3(0_u8..4));
    (proptest::collection::vec(term, 1..4), -2.0..2.0, 0.05..0.95)
        .prop_map(|(terms, step, cut)| Random { terms, step, cut })
        .prop_filter("the variance must be worth the name", |f| {
            f.variance() > 1e-3
        })
}

/// The estimates of many seeds, and the mean of the squares of the errors that they claim.
fn runs<I: Integrand<Value = f64>, E: Estimator>(
    integrand: &I,
    estimator: impl Fn(u64) -> E,
) -> (Moments<f64>, Option<Moments<f64>>) {
    let (mut means, mut claims) = (Moments::new(), None);
    for seed in 0..RUNS {
        let estimate = estimator(seed)
            .estimate(integrand)
            .expect("the integrand is finite");
        means.push(estimate.mean);
        if let Some(error) = estimate.std_error {
            claims.get_or_insert_with(Moments::new).push(error * error);
        }
    }
    (means, claims)
}

/// How many of its standard errors the mean of `moments` is off the truth.
fn sigmas(moments: &Moments<f64>, truth: f64) -> f64 {
    // Where a rule is exact, what is left is rounding.
    (moments.mean() - truth) / moments.std_error().expect("many runs").max(1e-14)
}

/// The mean of the estimates is the integral; the mean square of the claimed errors is their variance.
fn check<I: Integrand<Value = f64>, E: Estimator>(
    name: &str,
    integrand: &I,
    truth: f64,
    estimator: impl Fn(u64) -> E,
) -> Result<Moments<f64>, TestCaseError> {
    let (means, claims) = runs(integrand, estimator);
    let off = sigmas(&means, truth);
    prop_assert!(
        off.abs() < LIMIT,
        "{name}: mean {} is {off:.1} sigma from {truth}",
        means.mean()
    );
    if let Some(claims) = claims {
        // The variance of R runs is uncertain by sqrt((kurtosis - 1) / R), at most sqrt(2 / R) for means
        // of bounded values; the mean claim by its own standard error.
        let variance = means.variance().expect("many runs");
        let uncertainty = variance * (2.0 / RUNS as f64).sqrt();
        let spread = uncertainty.hypot(claims.std_error().expect("many runs"));
        let off = (claims.mean() - variance) / spread;
        prop_assert!(
            off.abs() < LIMIT,
            "{name}: claimed variance {}, true {variance}",
            claims.mean()
        );
    }
    Ok(means)
}

/// Checks the variance of estimates against its closed form.
fn check_variance(name: &str, means: &Moments<f64>, expected: f64) -> Result<(), TestCaseError> {
    let variance = means.variance().expect("many runs");
    let off = (variance / expected - 1.0) / (2.0 / (RUNS - 1) as f64).sqrt();
    prop_assert!(
        off.abs() < LIMIT,
        "{name}: variance {variance} is {off:.1} sigma from {expected}"
    );
    Ok(())
}

/// A point set of a seed and a number of points.
type Set = (&'static str, fn(u64, u64) -> Box<dyn PointSet>);

/// Every kind of randomised point set.
const SETS: [Set; 13] = [
    ("independent", |seed, _| Box::new(Independent::new(seed))),
    ("stratified", |seed, count| {
        Box::new(Stratified::new(count, 3, seed).expect("valid"))
    }),
    ("stratified pairs", |seed, count| {
        Box::new(Stratified::new(count, 2, seed).expect("valid"))
    }),
    ("n-rooks", |seed, count| {
        Box::new(NRooks::new(count, seed).expect("valid"))
    }),
    ("halton, digit permutation", |seed, _| {
        Box::new(halton().scrambled(DigitPermutation { seed }))
    }),
    ("halton, digital shift", |seed, _| {
        Box::new(halton().scrambled(DigitalShift { seed }))
    }),
    ("halton, owen", |seed, _| {
        Box::new(halton().scrambled(Owen { seed }))
    }),
    ("hammersley, shifted", |seed, count| {
        let points = Hammersley::new(count, 3).expect("valid");
        Box::new(Shifted::new(points, seed))
    }),
    ("sobol, digital shift", |seed, _| {
        Box::new(sobol().scrambled(DigitalShift { seed }))
    }),
    ("sobol, linear matrix", |seed, _| {
        Box::new(sobol().scrambled(LinearMatrix { seed }))
    }),
    ("sobol, owen", |seed, _| {
        Box::new(sobol().scrambled(Owen { seed }))
    }),
    ("sobol, hashed owen", |seed, _| {
        Box::new(sobol().scrambled(HashedOwen { seed }))
    }),
    ("sobol, folded", |seed, _| {
        Box::new(Folded::new(Shifted::new(sobol(), seed)))
    }),
];

fn halton() -> Halton {
    Halton::new(3).expect("three dimensions")
}

fn sobol() -> Sobol {
    Sobol::new(3).expect("three dimensions")
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(0x5eed),
        failure_persistence: None,
        ..Default::default()
    }
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn every_point_set_is_unbiased(f in random()) {
        let truth = f.mean();
        for (name, set) in SETS {
            check(&format!("{name}, average"), &f, truth, |seed| Average::new(set(seed, 16), 16))?;
            check(&format!("{name}, replicated"), &f, truth, |seed| {
                Replicated::new(4, 8, |seed| set(seed, 8)).seed(seed)
            })?;
        }
    }

    #[test]
    fn monte_carlo_has_the_variance_of_theory_and_knows_it(f in random()) {
        let means = check("monte carlo", &f, f.mean(), |seed| MonteCarlo::new(32, seed))?;
        check_variance("monte carlo", &means, f.variance() / 32.0)?;
        let means = check("independent", &f, f.mean(), |seed| Average::new(Independent::new(seed), 32))?;
        check_variance("independent", &means, f.variance() / 32.0)?;
    }

    #[test]
    fn stratification_never_raises_the_variance(f in random()) {
        // Owen (1997): at most n / (n - 1) times the variance of independent points for N-rooks; at most
        // once for one point in each cell of a grid.
        let bound = 1.0 + LIMIT * (2.0 / (RUNS - 1) as f64).sqrt();
        for dimensions in 1..=3 {
            let grid = |seed| Stratified::new(27, dimensions, seed).expect("valid");
            let used = grid(0).size().expect("a finite set") as f64;
            let (means, _) = runs(&f, |seed| Average::new(grid(seed), 27));
            let ratio = means.variance().expect("many runs") / (f.variance() / used);
            prop_assert!(ratio < bound, "{dimensions} dimensions: {ratio}");
        }
        let (means, _) = runs(&f, |seed| Average::new(NRooks::new(16, seed).expect("valid"), 16));
        let ratio = means.variance().expect("many runs") / (f.variance() / 15.0);
        prop_assert!(ratio < bound, "n-rooks: {ratio}");
    }

    #[test]
    fn roulette_keeps_the_mean_and_has_the_variance_of_its_formula(
        f in random(),
        p in prop_oneof![Just(1.0), 0.05..1.0],
        c in -1.0..1.0,
    ) {
        let roulette = Roulette::new(&f, p).expect("a probability").otherwise(c);
        let means = check("roulette", &roulette, f.mean(), |seed| MonteCarlo::new(64, seed))?;
        let variance = f.variance() / p + (1.0 / p - 1.0) * (f.mean() - c).powi(2);
        // A roulette's values have heavier tails than the limit of two thirds of the mean square allows for
        // one run, but not their means over 64 points.
        check_variance("roulette", &means, variance / 64.0)?;
        let twice = Roulette::new(&roulette, 0.5).expect("a probability");
        check("roulette of a roulette", &twice, f.mean(), |seed| MonteCarlo::new(64, seed))?;
        check("roulette on n-rooks", &roulette, f.mean(), |seed| {
            Average::new(NRooks::new(16, seed).expect("valid"), 16)
        })?;
    }
}

/// The random integrand with the first coordinate as its control.
struct Controlled<'a>(&'a Random);

impl Integrand for Controlled<'_> {
    type Value = (f64, f64);

    fn evaluate<S: Sampler>(&self, u: &mut S) -> (f64, f64) {
        let mut seen = [0.0; DIMENSIONS];
        seen.fill_with(|| u.next_1d());
        (self.0.at(seen), seen[0])
    }
}

/// The random integrand with its last coordinate as a second stage, and a constant from the first.
struct Stages<'a>(&'a Random);

impl Staged for Stages<'_> {
    type Value = f64;
    type State = [f64; 2];

    fn first<S: Sampler>(&self, u: &mut S) -> (f64, [f64; 2]) {
        let state = u.next_2d();
        (state[0], state)
    }

    fn second<S: Sampler>(&self, &[x, y]: &[f64; 2], u: &mut S) -> f64 {
        self.0.at([x, y, u.next_1d()])
    }
}

/// Density `1/2 + x` or its mirror image along each axis of the cube.
#[derive(Clone, Copy)]
struct Ramp {
    mirrored: bool,
}

impl Warp<DIMENSIONS> for Ramp {
    type Point = [f64; DIMENSIONS];

    fn sample(&self, u: [f64; DIMENSIONS]) -> [f64; DIMENSIONS] {
        // The root of x^2 / 2 + x / 2 = u.
        u.map(|u| {
            let x = 0.5 * ((1.0 + 8.0 * u).sqrt() - 1.0);
            if self.mirrored { 1.0 - x } else { x }
        })
    }

    fn density(&self, x: [f64; DIMENSIONS]) -> f64 {
        x.iter()
            .map(|x| if self.mirrored { 1.5 - x } else { 0.5 + x })
            .product()
    }

    fn invert(&self, _: [f64; DIMENSIONS]) -> Option<[f64; DIMENSIONS]> {
        None
    }
}

const RAMPS: [Ramp; 2] = [Ramp { mirrored: false }, Ramp { mirrored: true }];

proptest! {
    #![proptest_config(config(16))]

    #[test]
    fn importance_and_its_mixtures_keep_the_mean(f in random(), share in 0.1..0.9) {
        let truth = f.mean();
        let at = |x: [f64; DIMENSIONS]| f.at(x);
        let importance = Importance::new(RAMPS[0], at);
        check("importance", &importance, truth, |seed| MonteCarlo::new(64, seed))?;
        let mixture = Mixture::new(&[share, 1.0 - share], RAMPS).expect("weights");
        let mixed = Importance::new(mixture, at);
        check("mixture", &mixed, truth, |seed| MonteCarlo::new(64, seed))?;
        check("mixture on nets", &mixed, truth, |seed| {
            Average::new(sobol().scrambled(Owen { seed }), 16)
        })?;
        for heuristic in [Heuristic::Balance, Heuristic::Power] {
            let several = MultiSample::new(RAMPS, [1, 2], heuristic, at).expect("counts");
            check("multi-sample", &several, truth, |seed| MonteCarlo::new(32, seed))?;
        }
    }

    #[test]
    fn antithetic_pairs_and_controls_keep_the_mean(f in random(), b in -3.0..3.0) {
        let truth = f.mean();
        let antithetic = Antithetic::new(&f);
        check("antithetic", &antithetic, truth, |seed| MonteCarlo::new(32, seed))?;
        check("antithetic on nets", &antithetic, truth, |seed| {
            Average::new(sobol().scrambled(Owen { seed }), 16)
        })?;
        let controlled = ControlVariate::new(Controlled(&f), 0.5, b);
        check("control", &controlled, truth, |seed| MonteCarlo::new(64, seed))?;
        // The pilot's points are part of the experiment: another pilot in every run.
        let (mut means, mut variances) = (Moments::new(), Moments::new());
        for seed in 0..RUNS {
            let learned = ControlVariate::pilot(Controlled(&f), 0.5, 64, !seed).expect("finite");
            let estimate = MonteCarlo::new(64, seed).estimate(&learned).expect("finite");
            means.push(estimate.mean);
            variances.push(estimate.std_error.expect("independent points").powi(2));
        }
        prop_assert!(sigmas(&means, truth).abs() < LIMIT, "control by pilot: {}", means.mean());
        // The best coefficient loses nothing but what 64 points do not tell: some 1/64 of the variance.
        let spread = variances.std_error().expect("many runs");
        prop_assert!(variances.mean() < f.variance() / 64.0 * 1.04 + LIMIT * spread);
    }

    #[test]
    fn splitting_keeps_the_mean_and_has_the_variance_of_its_formula(
        f in random(),
        rate in prop_oneof![0.05..1.0, (1_u32..9).prop_map(f64::from)],
        odd in 1.0..6.0,
    ) {
        let truth = f.mean() + 0.5;
        let stages = Stages(&f);
        let splitting = Splitting::new(Stages(&f), rate).expect("a rate");
        let means = check("splitting", &splitting, truth, |seed| MonteCarlo::new(64, seed))?;
        let mut pilot = Splitting::pilot(&stages, 40_000, 5).expect("a count");
        (pilot.first_cost, pilot.second_cost) = (0.0, 1.0 / rate);
        let variance = means.variance().expect("many runs") * 64.0;
        let off = (variance / pilot.work(rate) - 1.0) / (2.0 / (RUNS - 1) as f64).sqrt();
        prop_assert!(off.abs() < LIMIT + 1.0, "variance {variance}, formula {}", pilot.work(rate));
        let odd = Splitting::new(stages, odd).expect("a rate");
        check("splitting, not whole", &odd, truth, |seed| MonteCarlo::new(64, seed))?;
    }

    #[test]
    fn strata_and_adapted_points_keep_the_mean(f in random()) {
        let truth = f.mean();
        check("strata", &f, truth, |seed| Strata::new(2, 3, 64, seed).expect("valid"))?;
        check("strata, two axes", &f, truth, |seed| Strata::new(3, 2, 64, seed).expect("valid"))?;
        check("strata, neyman", &f, truth, |seed| {
            Strata::new(2, 3, 160, seed).expect("valid").neyman()
        })?;
        check("bounded", &f, truth, |seed| Bounded::new(64, seed, -20.0, 20.0).expect("valid"))?;
        check("vegas", &f, truth, |seed| Vegas::new(3, 800, seed).expect("valid"))?;
        check("vegas, one axis and one bin", &f, truth, |seed| {
            Vegas::new(1, 400, seed).expect("valid").map(ImportanceMap::identity(1, 1).expect("valid"))
        })?;
        let map = Vegas::new(3, 4000, 9).expect("valid").train(&f).expect("finite");
        let mapped = Mapped::new(&f, &map);
        check("mapped", &mapped, truth, |seed| MonteCarlo::new(64, seed))?;
        check("mapped nets", &mapped, truth, |seed| {
            Average::new(sobol().scrambled(Owen { seed }), 16)
        })?;
    }

    #[test]
    fn covariances_are_those_of_the_means(f in random()) {
        // With the first coordinate, whose mean is 1/2 and whose variance is 1/12.
        struct Pair<'a>(&'a Random);
        impl Integrand for Pair<'_> {
            type Value = [f64; 2];
            fn evaluate<S: Sampler>(&self, u: &mut S) -> [f64; 2] {
                let (f, x) = Controlled(self.0).evaluate(u);
                [f, x]
            }
        }
        let joint = Joint::new(Pair(&f));
        let (mut products, mut claims) = (Moments::new(), Moments::new());
        for seed in 0..RUNS {
            let estimate = MonteCarlo::new(64, seed).estimate(&joint).expect("finite");
            let [a, b] = estimate.means();
            products.push((a - f.mean()) * (b - 0.5));
            claims.push(estimate.covariance().expect("independent points")[0][1]);
        }
        let spread = products.std_error().expect("many runs").hypot(claims.std_error().expect("many runs"));
        prop_assert!((products.mean() - claims.mean()).abs() < LIMIT * spread);
    }
}
