//! How long each method takes to come within an error of an integral that is known.
//!
//! `cargo run --release --example race -- gaussian --dims 10`
//!
//! `reference/race.py` runs it beside other programs.

#[path = "common/integrands.rs"]
mod integrands;
#[path = "common/target.rs"]
mod target;

use std::f64::consts::PI;
use std::process::ExitCode;
use std::time::Instant;

use clap::{Parser, ValueEnum};
use estimand::estimators::Vegas;
use estimand::integrands::Mapped;
use estimand::points::{Folded, HashedOwen, LatticeSequence, Shifted, Sobol};
use estimand::{Error, Estimator, Integrand, MonteCarlo, Replicated, cube};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use integrands::{Family, Problem};
use target::Target;

/// Measures root mean square relative errors and times of growing numbers of evaluations.
///
/// The errors are those of several runs with seeds of their own, the times those of one run on average, on as many threads as
/// `RAYON_NUM_THREADS` says.
#[derive(Parser)]
struct Arguments {
    /// The integrand, with its usual parameters
    #[arg(value_enum)]
    integrand: Family,
    /// In how many dimensions: 2, 3, 4, 5 or 10
    #[arg(long, default_value_t = 5)]
    dims: u32,
    /// The methods, all if none is named
    #[arg(long = "method", value_enum)]
    methods: Vec<Method>,
    /// Runs of each method at each count
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..))]
    runs: u64,
    /// Evaluations at most
    #[arg(long, default_value_t = 1 << 20, value_parser = clap::value_parser!(u64).range(1024..))]
    count: u64,
    /// An error that is small enough
    #[arg(long, default_value_t = 5e-6, value_parser = error)]
    enough: f64,
    /// Write the result as JSON to a file, or to standard output for `-`
    #[arg(long, value_name = "FILE", value_parser = Target::new)]
    json: Option<Target>,
}

fn error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(error) if error >= 0.0 => Ok(error),
        _ => Err("not a number that is 0 or more".to_owned()),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Independent points
    Plain,
    /// VEGAS
    Vegas,
    /// Eight scrambled Sobol' sets
    Sobol,
    /// Eight shifted and folded lattices
    Lattice,
    /// Eight scrambled Sobol' sets under a map that VEGAS learned from a quarter of the evaluations
    Mapped,
}

/// Independent randomisations of a set.
const REPLICATES: u64 = 8;

impl Method {
    fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn estimate<I: Integrand<Value = f64>>(
        self,
        integrand: &I,
        count: u64,
        seed: u64,
    ) -> Result<f64, Error> {
        let dims = integrand.dimensions();
        let estimate = match self {
            Self::Plain => MonteCarlo::new(count, seed).estimate(integrand)?,
            Self::Vegas => Vegas::new(dims, count, seed)?.estimate(integrand)?,
            Self::Sobol => Replicated::new(REPLICATES, count / REPLICATES, scrambled(dims)?)
                .seed(seed)
                .estimate(integrand)?,
            Self::Lattice => Replicated::new(REPLICATES, count / REPLICATES, folded(dims)?)
                .seed(seed)
                .estimate(integrand)?,
            Self::Mapped => {
                let map = Vegas::new(dims, count / 4, seed)?.train(integrand)?;
                Replicated::new(REPLICATES, count / 2 / REPLICATES, scrambled(dims)?)
                    .seed(seed)
                    .estimate(&Mapped::new(integrand, &map))?
            }
        };
        Ok(estimate.mean)
    }
}

// What makes the sets is written here, so that it is compiled once and not for every integrand.

fn scrambled(dims: u32) -> Result<impl Fn(u64) -> Sobol<HashedOwen> + Sync, Error> {
    let sobol = Sobol::new(dims)?;
    Ok(move |seed| sobol.clone().scrambled(HashedOwen { seed }))
}

fn folded(dims: u32) -> Result<impl Fn(u64) -> Folded<Shifted<LatticeSequence>> + Sync, Error> {
    let lattice = LatticeSequence::new(dims)?;
    Ok(move |seed| Folded::new(Shifted::new(lattice.clone(), seed)))
}

/// One count of one method.
struct Row {
    method: Method,
    count: u64,
    seconds: f64,
    error: f64,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let rows = match arguments.dims {
        2 => race::<2>(arguments),
        3 => race::<3>(arguments),
        4 => race::<4>(arguments),
        5 => race::<5>(arguments),
        10 => race::<10>(arguments),
        dims => Err(Error::refused(
            "number of dimensions",
            "2, 3, 4, 5 or 10",
            dims,
        )),
    }?;
    let json: Vec<_> = rows
        .iter()
        .map(|row| {
            serde_json::json!({
                "method": row.method.name(),
                "count": row.count,
                "seconds": row.seconds,
                "error": row.error,
            })
        })
        .collect();
    let json = serde_json::json!({
        "integrand": arguments.integrand.to_string(),
        "dims": arguments.dims,
        "runs": arguments.runs,
        "rows": json,
    });
    if let Some(target) = &arguments.json {
        target.write(&json.to_string())?;
        if target.is_standard() {
            return Ok(());
        }
    }
    println!("method     evaluations     seconds   relative error");
    for row in rows {
        println!(
            "{:<8} {:>13} {:>11.3e}   {:.2e}",
            row.method.name(),
            row.count,
            row.seconds,
            row.error
        );
    }
    Ok(())
}

/// Measures in `D` dimensions, with a function that is compiled for them.
fn race<const D: usize>(arguments: &Arguments) -> Result<Vec<Row>, Error> {
    let family = arguments.integrand;
    if matches!(
        family,
        Family::Keister | Family::RandomWalk | Family::Indicator
    ) {
        return Err(Error::refused(
            "integrand",
            "one of Genz' six, or peak",
            family,
        ));
    }
    let Problem { a, u, width, .. } = Problem::new(family, arguments.dims);
    let square = move |x: &[f64; D]| x.iter().map(|x| (x - u) * (x - u)).sum::<f64>();
    let sum = |x: &[f64; D]| x.iter().sum::<f64>();
    let below = 1.0 / (a * a);
    let power = -arguments.dims.cast_signed() - 1;
    let fall = -0.5 / (width * width);
    let integrand = cube(move |x: [f64; D]| match family {
        Family::Oscillatory => (2.0 * PI * u + a * sum(&x)).cos(),
        Family::ProductPeak => {
            let factors = x.map(|x| below + (x - u) * (x - u));
            1.0 / factors.iter().product::<f64>()
        }
        Family::CornerPeak => (1.0 + a * sum(&x)).powi(power),
        Family::Gaussian => (-a * a * square(&x)).exp(),
        Family::Continuous => (-a * x.iter().map(|x| (x - u).abs()).sum::<f64>()).exp(),
        Family::Discontinuous if x[0] < u && x[1] < u => (a * sum(&x)).exp(),
        Family::Peak => (fall * square(&x)).exp(),
        _ => 0.0,
    });
    measure(arguments, &integrand)
}

fn measure<I: Integrand<Value = f64>>(
    arguments: &Arguments,
    integrand: &I,
) -> Result<Vec<Row>, Error> {
    let problem = Problem::new(arguments.integrand, arguments.dims);
    let truth = problem.integral().expect("it is known for these");
    let methods = match arguments.methods.as_slice() {
        [] => Method::value_variants(),
        methods => methods,
    };
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    bar.set_style(ProgressStyle::with_template("{spinner} {msg}, {elapsed}").expect("a template"));
    let mut rows = Vec::new();
    for &method in methods {
        let mut count = 1024;
        while count <= arguments.count {
            bar.set_message(format!("{}: {count} evaluations", method.name()));
            bar.tick();
            let clock = Instant::now();
            let mut squares = 0.0;
            for seed in 0..arguments.runs {
                squares += (method.estimate(integrand, count, seed)? / truth - 1.0).powi(2);
            }
            let runs = arguments.runs as f64;
            let error = f64::sqrt(squares / runs);
            rows.push(Row {
                method,
                count,
                seconds: clock.elapsed().as_secs_f64() / runs,
                error,
            });
            if error < arguments.enough {
                break;
            }
            let Some(next) = count.checked_mul(4) else {
                break;
            };
            count = next;
        }
    }
    bar.finish_and_clear();
    Ok(rows)
}
