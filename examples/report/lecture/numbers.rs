//! Integrals: roulette, strata, quasi-Monte Carlo.

use std::time::Instant;

use estimand::convergence::{Convergence, Study, Truth};
use estimand::discrepancy::{Points, star};
use estimand::integrands::Roulette;
use estimand::points::{
    Halton, Hammersley, HashedOwen, Independent, NRooks, Owen, PointSet, Sobol, Stratified,
};
use estimand::report::number::{fixed, significant};
use estimand::report::{Axis, Chart, Line, Point};
use estimand::{Average, Estimator, Integrand, MonteCarlo, Sampler, cube, hash};

use super::{Claim, Verdict};
use crate::setup::on_one_thread;
use crate::spread::Spread;
use crate::{Failure, Report};

pub(super) const STEPS: u64 = 3;

pub(super) fn claims(report: &Report, charts: &mut Vec<Chart>) -> Result<Vec<Claim>, Failure> {
    report.doing("claim about roulette");
    let mut claims = vec![roulette(report)?];
    report.doing("claims about discrepancy");
    claims.push(discrepancies(report, charts)?);
    report.doing("claims about strata and quasi-Monte Carlo");
    claims.extend(slopes(report, charts)?);
    Ok(claims)
}

/// A cheap part and a costly one that is small, as the light of long paths is.
struct Late;

/// The costly part.
struct Costly;

impl Integrand for Costly {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        let mut x = u.next_1d();
        for _ in 0..50 {
            x = (1.0 + x).sin();
        }
        0.2 * x * u.next_1d()
    }

    fn dimensions(&self) -> u32 {
        2
    }
}

impl Integrand for Late {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        u.next_1d() + Costly.evaluate(u)
    }

    fn dimensions(&self) -> u32 {
        3
    }
}

/// The same with Russian roulette before the costly part.
struct Played(Roulette<Costly>);

impl Integrand for Played {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        u.next_1d() + self.0.evaluate(u)
    }

    fn dimensions(&self) -> u32 {
        4
    }
}

/// Variance and seconds of one sample.
fn one_sample(report: &Report, integrand: &impl Integrand<Value = f64>) -> [Spread; 2] {
    const COUNT: u64 = 1 << 14;
    let runs = 2 * report.effort.claim_runs;
    on_one_thread(|| {
        let (mut variances, mut times) = (Vec::new(), Vec::new());
        for run in 0..runs {
            let start = Instant::now();
            let estimate = MonteCarlo::new(COUNT, hash::hash(report.seed, run)).estimate(integrand);
            times.push(start.elapsed().as_secs_f64() / COUNT as f64);
            let error = estimate.ok().and_then(|estimate| estimate.std_error);
            variances.push(error.unwrap_or(f64::NAN).powi(2) * COUNT as f64);
        }
        [Spread::of(variances), Spread::of_times(times)]
    })
}

fn roulette(report: &Report) -> Result<Claim, Failure> {
    const SURVIVAL: f64 = 0.2;
    let [variance, seconds] = one_sample(report, &Late);
    let [played, quicker] = one_sample(report, &Played(Roulette::new(Costly, SURVIVAL)?));
    let (noisier, time) = (played.over(variance), quicker.over(seconds));
    let work = noisier.times(time);
    Ok(Claim {
        claim: "Russian roulette raises the variance of a sample, and pays by the time it saves where what it cuts off is small and costly."
            .into(),
        measured: format!(
            "survival {SURVIVAL}: variance × {}, time × {}, hence time to a given error × {}",
            noisier.text(),
            time.text(),
            work.text()
        ),
        confidence: format!(
            "{}, {}, {}",
            noisier.interval(),
            time.interval(),
            work.interval()
        ),
        verdict: Verdict::of(
            noisier.is_above(1.0) && work.is_below(1.0),
            noisier.is_below(1.0) || work.is_above(1.0),
        ),
    })
}

fn discrepancies(report: &Report, charts: &mut Vec<Chart>) -> Result<Claim, Failure> {
    const SEEDS: u64 = 8;
    let powers = if report.effort.powers[1] < 16 {
        4..10
    } else {
        4..13
    };
    let counts: Vec<u64> = powers.map(|power| 1 << power).collect();
    let of = |points: &dyn PointSet, count: u64| -> Result<f64, Failure> {
        let count = points.size().unwrap_or(count);
        Ok(star(&Points::from_set(points, 0..count, 2)?).lower())
    };
    let one = |set: &dyn Fn(u64) -> Result<f64, Failure>| -> Result<Vec<f64>, Failure> {
        counts.iter().map(|&count| set(count)).collect()
    };
    let mean = |set: &dyn Fn(u64, u64) -> Result<f64, Failure>| {
        one(&|count| {
            let values: Result<Vec<f64>, Failure> =
                (0..SEEDS).map(|seed| set(count, seed)).collect();
            Ok(values?.iter().sum::<f64>() / SEEDS as f64)
        })
    };
    let halton = one(&|count| of(&Halton::new(2)?, count))?;
    let hammersley = one(&|count| of(&Hammersley::new(count, 2)?, count))?;
    let curves = [
        (
            "independent",
            mean(&|count, seed| of(&Independent::new(seed), count))?,
        ),
        (
            "stratified",
            mean(&|count, seed| of(&Stratified::new(count, 2, seed)?, count))?,
        ),
        (
            "N-rooks",
            mean(&|count, seed| of(&NRooks::new(count, seed)?, count))?,
        ),
        ("Halton", halton.clone()),
        ("Hammersley", hammersley.clone()),
        ("Sobol'", one(&|count| of(&Sobol::new(2)?, count))?),
    ];
    let mut chart = Chart::new(
        "Star discrepancy in the plane, exact",
        Axis::new("points (count)"),
        Axis::new("star discrepancy (dimensionless)"),
    );
    for (name, values) in curves {
        let points = counts.iter().zip(values);
        chart.line(Line::new(
            name,
            points.map(|(&count, value)| Point::new(count as f64, value)),
        ));
    }
    chart.write_svg(report.file("discrepancy.svg"))?;
    charts.push(chart);
    let ratios: Vec<f64> = hammersley
        .iter()
        .zip(&halton)
        .map(|(ham, hal)| ham / hal)
        .collect();
    let texts: Vec<String> = counts
        .iter()
        .zip(&ratios)
        .map(|(count, ratio)| format!("{} at {count}", fixed(*ratio, 2)))
        .collect();
    Ok(Claim {
        claim: "Hammersley's points have a slightly lower star discrepancy than Halton's (in the plane).".into(),
        measured: format!("Hammersley over Halton: {}", texts.join(", ")),
        confidence: "exact discrepancies of the unscrambled sets".into(),
        verdict: match ratios.iter().filter(|&&ratio| ratio < 1.0).count() {
            all if all == ratios.len() => Verdict::Holds,
            most if 2 * most > ratios.len() => Verdict::Partly,
            _ => Verdict::Fails,
        },
    })
}

/// Error over count of five sets for one integrand.
fn study(
    report: &Report,
    f: &impl Integrand<Value = f64>,
    dims: u32,
    truth: f64,
) -> Result<Convergence, estimand::Error> {
    let last = if report.effort.powers[1] < 16 { 11 } else { 15 };
    let (halton, sobol) = (Halton::new(dims)?, Sobol::new(dims)?);
    Study::new((4..last).map(|power| 1 << power), report.effort.seeds)?
        .first_seed(report.seed)
        .shortest(0.0)
        .integral(f, Truth::exact(truth))
        .method("plain Monte Carlo", MonteCarlo::new)
        .method("stratified", |count, seed| {
            Average::new(Stratified::new(count, dims, seed).expect("a count"), count)
        })
        .method("Halton, Owen", |count, seed| {
            Average::new(halton.clone().scrambled(Owen { seed }), count)
        })
        .method("Sobol', hashed Owen", |count, seed| {
            Average::new(sobol.clone().scrambled(HashedOwen { seed }), count)
        })
        .run()
}

/// The slope of a curve with its interval, as text.
fn slope(convergence: &Convergence, method: usize) -> String {
    convergence.curves[method].slope.map_or_else(
        || "—".to_owned(),
        |slope| {
            slope.interval.map_or_else(
                || fixed(slope.value, 2),
                |i| {
                    format!(
                        "{} ± {}",
                        fixed(slope.value, 2),
                        fixed(0.5 * (i.high - i.low), 2)
                    )
                },
            )
        },
    )
}

fn slopes(report: &Report, charts: &mut Vec<Chart>) -> Result<Vec<Claim>, Failure> {
    let e = std::f64::consts::E;
    let product = |x: &[f64]| x.iter().map(|x| x.exp()).product::<f64>();
    let smooth = study(
        report,
        &cube(|x: [f64; 2]| product(&x)),
        2,
        (e - 1.0).powi(2),
    )?;
    let quarter = cube(|[x, y]: [f64; 2]| f64::from(u8::from(x * x + y * y < 1.0)));
    let jump = study(report, &quarter, 2, std::f64::consts::FRAC_PI_4)?;
    let many = cube(|x: [f64; 10]| product(&x.map(|x| 0.3 * x)));
    let many = study(report, &many, 10, (0.3_f64.exp_m1() / 0.3).powi(10))?;
    let kinds = [
        ("smooth, 2 dimensions", &smooth),
        ("a jump (quarter disk), 2 dimensions", &jump),
        ("smooth, 10 dimensions", &many),
    ];
    for (name, convergence) in kinds {
        charts.push(Chart::over_evaluations(
            format!("Error over evaluations: {name}"),
            convergence,
        ));
    }
    let at_1024 = |convergence: &Convergence, method: usize| {
        let sample = convergence.curves[method]
            .samples
            .iter()
            .find(|sample| sample.count == 1024);
        sample.map(|sample| Spread {
            value: sample.rmse,
            low: sample.rmse_low,
            high: sample.rmse_high,
        })
    };
    let gain = |convergence: &Convergence| match (at_1024(convergence, 0), at_1024(convergence, 1))
    {
        (Some(plain), Some(stratified)) => plain.over(stratified),
        _ => Spread::around(f64::NAN, f64::NAN),
    };
    let gains = kinds.map(|(_, convergence)| gain(convergence));
    let texts: Vec<String> = kinds
        .iter()
        .zip(gains)
        .map(|((name, convergence), gain)| {
            format!(
                "{name}: error of plain / {}, slope {}",
                gain.text(),
                slope(convergence, 1)
            )
        })
        .collect();
    let stratified = Claim {
        claim: "Stratified sampling is never worse than plain sampling, and better where few dimensions count.".into(),
        measured: format!("at 1024 points. {}", texts.join(". ")),
        confidence: format!(
            "gains {}; slopes in theory −1, −0.75 and −0.6, plain −0.5",
            gains.map(Spread::interval).join(", ")
        ),
        verdict: Verdict::of(
            gains[0].is_above(1.0) && gains[1].is_above(1.0) && !gains[2].is_below(1.0),
            gains.iter().any(|gain| gain.is_below(1.0)),
        ),
    };
    let texts: Vec<String> = kinds
        .iter()
        .map(|(name, convergence)| {
            format!(
                "{name}: stratified {}, Halton {}, Sobol' {}",
                slope(convergence, 1),
                slope(convergence, 2),
                slope(convergence, 3)
            )
        })
        .collect();
    let last = |convergence: &Convergence, method: usize| {
        convergence.curves[method]
            .samples
            .last()
            .map_or(f64::NAN, |sample| sample.rmse)
    };
    let alike = (0.4..2.5).contains(&(last(&jump, 3) / last(&jump, 1)));
    let better = last(&smooth, 3) < 0.4 * last(&smooth, 1) && last(&many, 3) < 0.4 * last(&many, 1);
    let like = Claim {
        claim: "Quasi-Monte Carlo converges like stratified sampling.".into(),
        measured: format!(
            "slopes. {}. At the largest count the error of stratified is {} (smooth), {} (jump) and {} (10 dimensions) times that of scrambled Sobol': \
             alike across a jump; where the integrand is smooth quasi-Monte Carlo is faster, and goes on being so where a grid has no cells left",
            texts.join(". "),
            significant(last(&smooth, 1) / last(&smooth, 3), 2),
            significant(last(&jump, 1) / last(&jump, 3), 2),
            significant(last(&many, 1) / last(&many, 3), 2),
        ),
        confidence: format!("{} runs of each count", report.effort.seeds),
        verdict: if alike && better {
            Verdict::Partly
        } else {
            Verdict::Open
        },
    };
    Ok(vec![stratified, like])
}
