//! How often the intervals of every kind of error bar hold the integral, on Genz' families and on stiff integrands.
//!
//! `cargo run --release --all-features --example coverage -- --markdown docs/coverage.md` writes the table that is shipped.

#[path = "common/cases.rs"]
mod cases;
#[path = "common/integrands.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod integrands;
#[path = "common/methods.rs"]
mod methods;
#[path = "common/stiff.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod stiff;
#[path = "common/target.rs"]
mod target;
#[path = "common/trial.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod trial;

use std::fmt::Write;
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressDrawTarget};

use cases::{Plan, Row};
use target::Target;

/// Measures how often the 95 % intervals of every method hold the integral.
#[derive(Parser)]
struct Arguments {
    /// Evaluations of each run
    #[arg(long, default_value_t = 1 << 12, value_parser = clap::value_parser!(u64).range(1024..))]
    count: u64,
    /// Independent runs of each method on each integrand
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    runs: u64,
    /// Only rows whose integrand and method contain this, as in "gaussian, d = 5, vegas"
    #[arg(long, default_value = "")]
    only: String,
    /// Write the table to this file instead of standard output
    #[arg(long, value_name = "FILE", value_parser = Target::new)]
    markdown: Option<Target>,
    /// Also write the rows as JSON, to standard output for `-`
    #[arg(long, value_name = "FILE", value_parser = Target::new)]
    json: Option<Target>,
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
    let bar = ProgressBar::new_spinner();
    bar.set_draw_target(ProgressDrawTarget::stderr());
    let begin = |name: &str| {
        bar.set_message(name.to_owned());
        bar.tick();
    };
    let plan = Plan {
        count: arguments.count,
        runs: arguments.runs,
        only: &arguments.only,
        begin: &begin,
    };
    let (genz, stiff) = (plan.genz()?, plan.stiff()?);
    bar.finish_and_clear();
    if genz.is_empty() && stiff.is_empty() {
        return Err(format!("no row contains `{}`", arguments.only).into());
    }
    let table = table(arguments, &genz, &stiff)?;
    let only_json = arguments.json.as_ref().is_some_and(Target::is_standard);
    match &arguments.markdown {
        Some(target) => target.write(table.trim_end())?,
        None if only_json => {}
        None => print!("{table}"),
    }
    if let Some(target) = &arguments.json {
        let rows: Vec<_> = genz.iter().chain(&stiff).map(json).collect();
        target.write(&serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(())
}

fn json(Row { integrand, trial }: &Row) -> serde_json::Value {
    serde_json::json!({
        "integrand": integrand, "method": trial.method.name(), "kind": trial.error_bar,
        "runs": trial.runs, "covered": trial.covered, "warned": trial.warned, "warning": trial.warning,
        "missed_without_warning": trial.missed_without_warning, "error": trial.error, "width": trial.width,
        "holds": trial.holds(), "honest": trial.is_honest(),
    })
}

fn table(arguments: &Arguments, genz: &[Row], stiff: &[Row]) -> Result<String, std::fmt::Error> {
    let all = || genz.iter().chain(stiff);
    let number = all().count();
    let hold = all().filter(|row| row.trial.holds()).count();
    let quiet = all()
        .filter(|row| row.trial.holds() && row.trial.warned <= 0.05)
        .count();
    let honest = all().filter(|row| row.trial.is_honest()).count();
    let mut text = format!(
        "# How often the error bars hold the truth\n\n\
         {} independent runs of about {} evaluations of every method on every integrand; intervals at {} %. Made by \
         `cargo run --release --all-features --example coverage -- --markdown docs/coverage.md`; `tests/coverage.rs` asks the \
         same of every change.\n\n\
         *covered*: part of the runs whose interval holds the integral, **bold** where it is too small: more than three \
         standard deviations below 95 %, which is 93 % of 1000 runs. *warned*: part of the runs that came with a \
         warning, and the most common one. *error*: root mean square error, *width*: mean half width of the intervals, both \
         relative to the integral (absolute where it is zero).\n\n\
         Of {number} rows {hold} hold what they claim, {quiet} of them with warnings in at most one run of twenty. The other {} \
         say so: the variance is infinite, or its own variance is (x^a), or the integrand is nearly all in places that are \
         rarer than the points can show, so that a few values decide, or none. There 95 % of the runs carry a warning, or the \
         runs without one hold what they claim; {} do not.\n",
        arguments.runs,
        arguments.count,
        100.0 * trial::LEVEL,
        number - hold,
        number - honest,
    );
    for (title, rows) in [
        ("Genz' families", genz),
        ("Stiff and extreme integrands", stiff),
    ] {
        write!(
            text,
            "\n## {title}\n\n| integrand | method | error bar | covered | warned | error | width |\n\
             |---|---|---|---:|---|---:|---:|\n"
        )?;
        for Row { integrand, trial } in rows {
            let bold = if trial.holds() { "" } else { "**" };
            let warned = trial.warning.map_or_else(String::new, |warning| {
                format!("{:.1} %: {warning}", 100.0 * trial.warned)
            });
            writeln!(
                text,
                "| {integrand} | {} | {} | {bold}{:.3}{bold} | {warned} | {:.1e} | {:.1e} |",
                trial.method.name(),
                trial.error_bar,
                trial.covered,
                trial.error,
                trial.width
            )?;
        }
    }
    Ok(text)
}
