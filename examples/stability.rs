//! Stiff and extreme integrands against every method: error, claimed error, coverage, time, warnings.
//!
//! `cargo run --release --all-features --example stability -- [--json FILE]` prints the table of `docs/stability.md`.

#[path = "common/methods.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod methods;
#[path = "common/stiff.rs"]
mod stiff;
#[path = "common/target.rs"]
mod target;
#[path = "common/trial.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod trial;

use std::process::ExitCode;

use clap::Parser;
use estimand::integrands::Roulette;
use estimand::{Average, Error, Estimator, MonteCarlo, NonFinite, cube, points::Independent};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use methods::Method;
use serde_json::{Value, json};
use stiff::Case;
use target::Target;
use trial::Trial;

/// Runs every method on integrands that are hard to integrate, and says which to use.
#[derive(Parser)]
struct Arguments {
    /// Evaluations of each run
    #[arg(long, default_value_t = 1 << 14, value_parser = clap::value_parser!(u64).range(1024..))]
    count: u64,
    /// Runs of each method on each integrand; fewer in many dimensions
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..))]
    runs: u64,
    /// Evaluations of the longest run
    #[arg(long, default_value_t = 1_000_000_000)]
    longest: u64,
    /// Also write the table as JSON to a file, or nothing but that to standard output for `-`
    #[arg(long, value_name = "FILE", value_parser = Target::new)]
    json: Option<Target>,
    /// Only integrands whose name contains this
    #[arg(
        long,
        value_name = "TEXT",
        default_value = "",
        hide_default_value = true
    )]
    only: String,
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
    let only_json = arguments.json.as_ref().is_some_and(Target::is_standard);
    let show = |text: &str| {
        if !only_json {
            println!("{text}");
        }
    };
    let mut cases = stiff::cases();
    cases.retain(|case| case.name.contains(&arguments.only));
    if cases.is_empty() {
        return Err(format!("no integrand's name contains {}", arguments.only).into());
    }
    let bar = ProgressBar::with_draw_target(Some(cases.len() as u64), ProgressDrawTarget::stderr());
    bar.set_style(ProgressStyle::with_template(
        "{wide_bar} {pos}/{len} {msg}",
    )?);
    show("# Stiff and extreme integrands\n");
    show(&format!(
        "{} runs of about {} evaluations of every method; in 100 dimensions a fifth of that, in 1000 a twenty-fifth. *error*: root mean \
         square error, *claimed*: mean half width of the 95 % intervals, both relative to the integral (absolute where it is \
         zero). *covered*: part of the runs whose interval holds the integral. *warned*: part of the runs with a warning, \
         and the most common. A failing method is one that covers less than 95 % by more than three standard deviations of the \
         number of runs, which is 90 % of 200; *instead* names the one of the others with the smallest \
         error, of those without warnings if there are any, or what to do about the integrand where all fail.\n",
        arguments.runs, arguments.count
    ));
    show("Made by `cargo run --release --all-features --example stability > docs/stability.md`.\n");
    show("| integrand | method | error | claimed | covered | warned | time (ms) | instead |");
    show("|---|---|---:|---:|---:|---|---:|---|");
    let mut table = Vec::new();
    let (mut failing, mut silent) = (0, 0);
    for case in &cases {
        bar.set_message(case.name.clone());
        let rows = trials(arguments, case)?;
        let least = |a: &&Trial, b: &&Trial| a.error.total_cmp(&b.error);
        let best = rows
            .iter()
            .filter(|row| row.holds() && row.warned <= 0.5)
            .min_by(least)
            .or_else(|| rows.iter().filter(|row| row.holds()).min_by(least));
        for row in &rows {
            failing += u32::from(!row.holds());
            silent += u32::from(!row.is_honest());
            let instead = match best {
                _ if row.holds() => "",
                Some(best) => best.method.name(),
                None => case.instead,
            };
            let warned = row.warning.map_or_else(String::new, |warning| {
                format!("{:.0} %: {warning}", 100.0 * row.warned)
            });
            show(&format!(
                "| {} | {} | {:.1e} | {:.1e} | {:.3} | {warned} | {:.2} | {instead} |",
                case.name,
                row.method.name(),
                row.error,
                row.width,
                row.covered,
                1e3 * row.seconds
            ));
            table.push(json!({
                "integrand": case.name, "dims": case.dims, "method": row.method.name(), "error": row.error,
                "claimed": row.width, "covered": row.covered, "warned": row.warned,
                "warning": row.warning, "runs": row.runs, "holds": row.holds(), "honest": row.is_honest(), "seconds": row.seconds, "instead": instead,
            }));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    show(&format!(
        "\nOf {} rows {failing} fail. Of those, {silent} do so in silence: with a warning in less than 95 % of the runs, and with \
         too few of the runs without one holding the integral.",
        table.len()
    ));
    let single = single(arguments.longest, &show)?;
    if let Some(target) = &arguments.json {
        let all = json!({ "rows": table, "single": single });
        target.write(&serde_json::to_string_pretty(&all)?)?;
    }
    Ok(())
}

/// Every method on `case`; fewer runs in many dimensions, where they take long.
fn trials(arguments: &Arguments, case: &Case) -> Result<Vec<Trial>, Error> {
    let runs = match case.dims {
        0..=10 => arguments.runs,
        11..=100 => arguments.runs.div_ceil(5),
        _ => arguments.runs.div_ceil(25),
    };
    let mut trials = Vec::new();
    for method in Method::ALL {
        trials.extend(Trial::new(method, &case.into(), arguments.count, runs, 1)?);
    }
    Ok(trials)
}

/// What is no matter of statistics: counts, scales in one vector, deep roulette, single bad values.
fn single(longest: u64, show: &dyn Fn(&str)) -> Result<Vec<Value>, Box<dyn std::error::Error>> {
    show("\n## One run each\n\n| case | outcome |\n|---|---|");
    let mut table = Vec::new();
    let mut say = |case: &str, outcome: String| {
        show(&format!("| {case} | {outcome} |"));
        table.push(json!({ "case": case, "outcome": outcome }));
    };
    let square = cube(|[x]| x * x);
    for count in [0, 1, 2, longest] {
        let outcome = match MonteCarlo::new(count, 1).estimate(&square) {
            Ok(estimate) => format!(
                "mean {:.6}, interval {}, warnings {}, {:.2} s",
                estimate.mean,
                estimate.interval(0.95).map_or_else(
                    || "none".to_owned(),
                    |interval| format!("[{:.6}, {:.6}]", interval.low, interval.high)
                ),
                estimate.warnings.len(),
                estimate.seconds
            ),
            Err(incomplete) => format!("refused: {incomplete}"),
        };
        say(&format!("x^2, {count} points"), outcome);
    }
    let scales = cube(|[x]| [1e-300 * x, 1e300 * x]);
    let estimate = MonteCarlo::new(100_000, 1).estimate(&scales)?;
    let inside = estimate
        .interval(0.9999)
        .is_some_and(|interval| interval.contains([0.5e-300, 0.5e300]));
    say(
        "x times 1e-300 and 1e300 in one vector",
        format!("means {:?}, both within 99.99 %: {inside}", estimate.mean),
    );
    for exponent in [1, 3, 6, 9] {
        let survival = 10_f64.powi(-exponent);
        let roulette = Roulette::new(&square, survival)?;
        let estimate = MonteCarlo::new(1_000_000, 1).estimate(&roulette)?;
        let interval = estimate.interval(0.95).ok_or("no interval")?;
        say(
            &format!("x^2 with roulette, survival {survival:e}"),
            format!(
                "interval [{:.4}, {:.4}]{}",
                interval.low,
                interval.high,
                estimate
                    .warnings
                    .first()
                    .map_or_else(String::new, |warning| format!(", {warning}"))
            ),
        );
    }
    let bad = cube(|[x]| if x < 1e-6 { f64::NAN } else { x });
    // The first seed with a bad point.
    let stopped = (0..)
        .find_map(|seed| {
            Average::new(Independent::new(seed), 1_000_000)
                .estimate(&bad)
                .err()
        })
        .ok_or("every seed passed")?;
    let named = match &stopped.reason {
        Error::NonFinite {
            index, coordinates, ..
        } => format!("stopped at point {index}, {coordinates:?}"),
        other => other.to_string(),
    };
    let rejecting = MonteCarlo::new(10_000_000, 1).non_finite(NonFinite::Reject);
    let estimate = rejecting.estimate(&bad)?;
    say("NaN in one of 10^6 points", named);
    say(
        "the same, rejecting",
        format!(
            "mean {:.6}, {} rejected of {}",
            estimate.mean, estimate.rejected, estimate.used
        ),
    );
    Ok(table)
}
