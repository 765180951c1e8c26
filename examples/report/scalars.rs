//! Section 1, first half: integrals of five kinds, every method.

use estimand::convergence::{Convergence, Study, Truth};
use estimand::estimators::{Strata, Vegas};
use estimand::points::{
    Folded, Halton, Hammersley, HashedOwen, Lattice, NRooks, Owen, Shifted, Sobol, Stratified,
};
use estimand::report::number::{seconds, significant};
use estimand::report::{Cell, Chart, Column, Table};
use estimand::{Average, Error, MonteCarlo, Replicated, hash};

use crate::integrands::{Family, Problem};
use crate::setup::on_one_thread;
use crate::{Failure, Report};

pub(crate) const STEPS: u64 = 5;

/// One kind of integrand.
pub(crate) struct Kind {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) problem: Problem,
}

/// All kinds.
pub(crate) fn kinds() -> [Kind; 5] {
    let kind = |name, about, family, dims, a, width| {
        let mut problem = Problem::new(family, dims);
        problem.a = a;
        problem.width = width;
        Kind {
            name,
            about,
            problem,
        }
    };
    [
        kind(
            "smooth",
            "Smooth, 5 dimensions: `exp(-sum (x - 1/2)^2)`, a family of Genz.",
            Family::Gaussian,
            5,
            1.0,
            0.0,
        ),
        kind(
            "kinked",
            "Kinked, 4 dimensions: `exp(-2 sum |x - 1/2|)`, a family of Genz.",
            Family::Continuous,
            4,
            2.0,
            0.0,
        ),
        kind(
            "discontinuous",
            "Discontinuous, 4 dimensions: `exp(2 sum x)` where the first two coordinates are below 1/2, and 0 elsewhere, a family of Genz.",
            Family::Discontinuous,
            4,
            2.0,
            0.0,
        ),
        kind(
            "peaked",
            "Peaked, 3 dimensions: `exp(-sum (x - 1/2)^2 / (2 w^2))` with `w` 0.03: all of it is in 0.04 % of the cube.",
            Family::Peak,
            3,
            0.0,
            0.03,
        ),
        kind(
            "high-dimensional",
            "High-dimensional, 50 dimensions: `cos(pi + 0.2 sum x)`, a family of Genz.",
            Family::Oscillatory,
            50,
            0.2,
            0.0,
        ),
    ]
}

/// The errors, relative to the integral, to which times are given.
const TARGETS: [f64; 2] = [0.01, 0.001];

pub(crate) fn add(report: &mut Report) -> Result<(), Failure> {
    let [first, last] = report.effort.powers;
    report.page.section("Error against run time");
    report.page.text(&format!(
        "Every method integrates every kind of integrand with {} to {} evaluations, each in {} runs with seeds of their own. \
         Sets of points that are not random of themselves are randomised; where they have no error bar, nothing is claimed.",
        1_u64 << first,
        1_u64 << (last - 1),
        report.effort.seeds
    ));
    let mut found = Vec::new();
    for kind in kinds() {
        report.doing(format!("{} integrand", kind.name));
        let mut convergence = study(report, &kind.problem)?;
        convergence
            .curves
            .extend(report.peers.scalars(&kind, &report.effort, report.seed)?);
        convergence.write_csv(report.file(&format!("{}.csv", kind.name)))?;
        convergence.write_json(report.file(&format!("{}.json", kind.name)))?;
        found.push((kind, convergence));
    }
    report.page.subsection("Who is first");
    report.page.text(
        "The method that is the first to bring its RMSE below 1 % and 0.1 % of the integral, and how long plain Monte Carlo takes, \
         if need be by its law: four times the time for half of the error.",
    );
    report.page.table(&winners(&found));
    for (kind, convergence) in &found {
        report
            .page
            .subsection(&format!("{} integrand", capitalised(kind.name)));
        let integral = kind.problem.integral().unwrap_or(f64::NAN);
        let cost = convergence.evaluation_seconds.unwrap_or(f64::NAN);
        report.page.text(&format!(
            "{} Its integral is {}; one evaluation takes {} by itself. The points of a method, and the estimate, are the rest.",
            kind.about,
            significant(integral, 7),
            seconds(cost, 2)
        ));
        report.page.charts([
            &Chart::over_time("Error over time", convergence),
            &Chart::over_evaluations("Error over evaluations, with slopes", convergence),
        ]);
        report.page.table(&Table::of_times(convergence, &TARGETS));
        report.page.table(&Table::of_study(convergence));
        let (csv, json) = (format!("{}.csv", kind.name), format!("{}.json", kind.name));
        report.page.files([csv.as_str(), json.as_str()]);
    }
    Ok(())
}

fn capitalised(word: &str) -> String {
    word[..1].to_uppercase() + &word[1..]
}

fn winners(found: &[(Kind, Convergence)]) -> Table {
    let mut table = Table::new([
        Column::text("integrand"),
        Column::text("first to 1 %"),
        Column::number("after"),
        Column::number("plain"),
        Column::text("first to 0.1 %"),
        Column::number("after"),
        Column::number("plain"),
    ]);
    for (kind, convergence) in found {
        let mut cells = vec![Cell::from(kind.name)];
        for target in TARGETS {
            let error = target * convergence.scale.unwrap_or(1.0).abs();
            let times = convergence.curves.iter().filter_map(|curve| {
                let time = curve.seconds_to(error)?;
                Some((curve.method.as_str(), time))
            });
            match times.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((method, time)) => {
                    cells.push(Cell::best(method));
                    cells.push(seconds(time, 2).into());
                }
                None => cells.extend(["none".into(), "—".into()]),
            }
            cells.push(plain(convergence, error).into());
        }
        table.row(cells);
    }
    table
}

/// How long plain Monte Carlo takes to `error`; behind its last sample by its law.
fn plain(convergence: &Convergence, error: f64) -> String {
    let curve = &convergence.curves[0];
    if let Some(time) = curve.seconds_to(error) {
        return seconds(time, 2);
    }
    curve.samples.last().map_or_else(
        || "—".to_owned(),
        |last| {
            format!(
                "≈ {}",
                seconds(last.seconds * (last.rmse / error).powi(2), 1)
            )
        },
    )
}

fn study(report: &Report, problem: &Problem) -> Result<Convergence, Error> {
    let dims = problem.dims;
    let integral = problem.integral().unwrap_or(f64::NAN);
    let [first, last] = report.effort.powers;
    let (seeds, seed, shortest) = (report.effort.seeds, report.seed, report.effort.shortest);
    let sobol = Sobol::new(dims)?;
    let owen = |seed| sobol.clone().scrambled(HashedOwen { seed });
    let halton = Halton::new(dims)?;
    // Three points a stratum at least, in as many axes as that leaves room for.
    let strata = |count: u64, seed| {
        let axes = dims.min(3);
        let cells = (count / 4)
            .checked_ilog2()
            .map_or(1, |bits| 1 << (bits / axes));
        Strata::new(cells.max(1), axes, count, seed)
            .expect(VALID)
            .neyman()
    };
    on_one_thread(|| {
        Study::new((first..last).map(|power| 1 << power), seeds)?
            .first_seed(seed.wrapping_mul(1_000_003))
            .shortest(shortest)
            .integral(problem, Truth::exact(integral))
            .method("plain Monte Carlo", MonteCarlo::new)
            .method("stratified", |count, seed| {
                Average::new(Stratified::new(count, dims, seed).expect(VALID), count)
            })
            .method("N-rooks", |count, seed| {
                Average::new(NRooks::new(count, seed).expect(VALID), count)
            })
            .method("Halton, Owen", |count, seed| {
                Average::new(halton.clone().scrambled(Owen { seed }), count)
            })
            .method("Hammersley, Owen", |count, seed| {
                let points = Hammersley::new(count, dims).expect(VALID);
                let points = points.offset(hash::unit(seed)).expect(VALID);
                Average::new(points.scrambled(Owen { seed }), count)
            })
            .method("Sobol', hashed Owen", |count, seed| {
                Average::new(owen(seed), count)
            })
            .method("lattice, folded", |count, seed| {
                let lattice = Lattice::published(count, dims).expect(VALID);
                Average::new(Folded::new(Shifted::new(lattice, seed)), count)
            })
            .method("16 × Sobol'", |count, seed| {
                Replicated::new(16, count.div_ceil(16), owen).seed(seed)
            })
            .method("strata, Neyman", strata)
            .method("VEGAS", |count, seed| {
                Vegas::new(dims, count, seed).expect(VALID)
            })
            .run()
    })
}

const VALID: &str = "the counts are powers of two from 2^6 on, the dimensions few";
