//! Integrates a test integrand with any points, until a tolerance, a time or a count is reached.
//!
//! `cargo run --release --all-features --example integrate -- gaussian --dims 5 --points sobol --count 65536`

#[path = "common/integrands.rs"]
mod integrands;
#[path = "common/sets.rs"]
mod sets;
#[path = "common/target.rs"]
mod target;

use std::ops::ControlFlow;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::{Parser, ValueEnum};
use estimand::estimators::{Until, Vegas};
use estimand::points::PointSet;
use estimand::{Error, Estimate, Estimator, MonteCarlo, NonFinite, Progressive, Replicated};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use integrands::{Family, Problem};
use sets::{Choice, Scramble, Set};
use target::Target;

/// Integrates a test integrand over the unit cube and says how far the result can be trusted.
#[derive(Parser)]
#[command(allow_negative_numbers = true)]
struct Arguments {
    /// What to integrate
    #[arg(value_enum)]
    integrand: Family,
    /// In how many dimensions
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    dims: u32,
    /// The points: plain, vegas, or a set: independent, stratified, n-rooks, van-der-corput, halton, hammersley, sobol,
    /// faure, lattice, kronecker, multi-jittered, orthogonal-array
    #[arg(long, default_value = "sobol", value_parser = points)]
    points: Points,
    /// How a set is randomised, if not in the way that suits it
    #[arg(long, value_enum)]
    scramble: Option<Scramble>,
    /// Evaluations at most, over all replicates
    #[arg(long, default_value_t = 1 << 20, value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Independent replicates of a set
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u64).range(2..))]
    replicates: u64,
    /// What selects the points
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Stop when the error is below this part of the mean
    #[arg(long)]
    rel_tol: Option<f64>,
    /// Stop when the error is below this
    #[arg(long)]
    abs_tol: Option<f64>,
    /// Stop after this many seconds
    #[arg(long, value_parser = seconds)]
    time: Option<Duration>,
    /// The level of confidence of the interval and of the tolerances
    #[arg(long, default_value_t = 0.95)]
    level: f64,
    /// Leave values that are not finite out instead of stopping at them
    #[arg(long)]
    reject: bool,
    /// Difficulty of the integrand; its own default otherwise
    #[arg(long)]
    a: Option<f64>,
    /// Place of the integrand's peak, kink or cut
    #[arg(long)]
    u: Option<f64>,
    /// Width of a peak or of an indicator's box
    #[arg(long)]
    width: Option<f64>,
    /// Write the result as JSON to a file, or to standard output for `-`
    #[arg(long, value_name = "FILE", value_parser = Target::new)]
    json: Option<Target>,
}

#[derive(Clone, Copy, Debug)]
enum Points {
    Plain,
    Vegas,
    Set(Set),
}

fn points(name: &str) -> Result<Points, String> {
    match name {
        "plain" => Ok(Points::Plain),
        "vegas" => Ok(Points::Vegas),
        name => Set::from_str(name, false)
            .map(Points::Set)
            .map_err(|_| "not plain, vegas or the name of a set".to_owned()),
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())
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
    let mut problem = Problem::new(arguments.integrand, arguments.dims);
    for (name, given, place) in [
        ("a", arguments.a, &mut problem.a),
        ("u", arguments.u, &mut problem.u),
        ("width", arguments.width, &mut problem.width),
    ] {
        if let Some(given) = given {
            if !given.is_finite() {
                return Err(Error::refused(name, "finite", given).into());
            }
            *place = given;
        }
    }
    if problem.width <= 0.0 {
        return Err(Error::refused("width", "above zero", problem.width).into());
    }
    let rule = if arguments.reject {
        NonFinite::Reject
    } else {
        NonFinite::Fail
    };
    let estimate = match arguments.points {
        Points::Plain => {
            let plain = MonteCarlo::new(arguments.count, arguments.seed).non_finite(rule);
            stopped(arguments, plain, &problem)?
        }
        Points::Vegas => {
            let vegas = Vegas::new(problem.dims, arguments.count, arguments.seed)?;
            stopped(arguments, vegas.non_finite(rule), &problem)?
        }
        Points::Set(set) => {
            let count = (arguments.count / arguments.replicates).max(1);
            let scramble = arguments.scramble.unwrap_or(match set {
                Set::Sobol => Scramble::HashOwen,
                Set::Halton | Set::Hammersley | Set::Faure => Scramble::Owen,
                Set::VanDerCorput | Set::Lattice | Set::Kronecker => Scramble::Shift,
                Set::Independent
                | Set::Stratified
                | Set::NRooks
                | Set::MultiJittered
                | Set::OrthogonalArray => Scramble::None,
            });
            let build = move |seed| Choice { scramble, seed }.build(set, problem.dims, count);
            // What is refused is refused here, for every seed alike.
            build(0)?;
            let sets = move |seed| -> Box<dyn PointSet> {
                build(seed).expect("was built with another seed before")
            };
            let replicated = Replicated::new(arguments.replicates, count, sets)
                .seed(arguments.seed)
                .non_finite(rule);
            stopped(arguments, replicated, &problem)?
        }
    };
    report(arguments, &problem, &estimate)
}

/// The estimate under the rules of the command line, with a progress bar.
fn stopped<E: Progressive>(
    arguments: &Arguments,
    estimator: E,
    problem: &Problem,
) -> Result<Estimate<f64>, Box<dyn std::error::Error>> {
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancelled);
    ctrlc::set_handler(move || {
        // The second time somebody means it.
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })?;
    let bar = ProgressBar::with_draw_target(Some(estimator.budget()), ProgressDrawTarget::stderr());
    bar.set_style(ProgressStyle::with_template(
        "{wide_bar} {human_pos}/{human_len} evaluations, {elapsed}",
    )?);
    let shown = bar.clone();
    let mut until: Until<E> = estimator
        .until()
        .level(arguments.level)?
        .watch(move |progress| {
            shown.set_position(progress.used);
            if cancelled.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    if let Some(tolerance) = arguments.rel_tol {
        until = until.relative(tolerance)?;
    }
    if let Some(tolerance) = arguments.abs_tol {
        until = until.absolute(tolerance)?;
    }
    if let Some(time) = arguments.time {
        until = until.time(time);
    }
    let outcome = until.estimate(problem);
    bar.finish_and_clear();
    Ok(outcome?)
}

fn report(
    arguments: &Arguments,
    problem: &Problem,
    estimate: &Estimate<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    let interval = estimate.interval(arguments.level);
    let warnings: Vec<String> = estimate.warnings.iter().map(ToString::to_string).collect();
    let json = serde_json::json!({
        "mean": estimate.mean,
        "std_error": estimate.std_error,
        "interval": interval.map(|interval| [interval.low, interval.high]),
        "level": arguments.level,
        "kind": estimate.error_bar.to_string(),
        "requested": arguments.count,
        "used": estimate.used,
        "rejected": estimate.rejected,
        "seconds": estimate.seconds,
        "stopped": estimate.stop.to_string(),
        "warnings": warnings,
    });
    if let Some(target) = &arguments.json {
        target.write(&json.to_string())?;
        if target.is_standard() {
            return Ok(());
        }
    }
    println!("mean         {:.12e}", estimate.mean);
    if let Some(error) = estimate.std_error {
        println!("std error    {error:.3e}  ({})", estimate.error_bar);
    }
    if let Some(interval) = interval {
        let percent = 100.0 * arguments.level;
        println!(
            "{percent:.4} %      [{:.12e}, {:.12e}]",
            interval.low, interval.high
        );
    }
    if let Some(truth) = problem.integral() {
        let off = estimate.mean - truth;
        let relative = if truth == 0.0 {
            String::new()
        } else {
            format!(", relative {:.1e}", off / truth)
        };
        println!("exact        {truth:.12e}  (error {off:.1e}{relative})");
    }
    println!(
        "evaluations  {} of {} requested, {} rejected",
        estimate.used, arguments.count, estimate.rejected
    );
    println!(
        "stopped by   {} after {:.3} s",
        estimate.stop, estimate.seconds
    );
    for warning in warnings {
        println!("warning      {warning}");
    }
    Ok(())
}
