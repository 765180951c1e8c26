//! Measures the discrepancy of a point set or of a file of points, or draws it against the count of points.

#[path = "../common/marks.rs"]
mod marks;
mod measure;
mod read;
#[path = "../common/sets.rs"]
mod sets;
mod sweep;
#[path = "../common/target.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod target;

use std::error::Error;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use estimand::discrepancy::Points;
use indicatif::ProgressBar;
use serde_json::{Value, json};

use measure::{Kind, Measure, Metric};
use target::Target;

/// Measures the discrepancy of a point set or of a file of points.
///
/// With `--sweep` it measures several sets at many counts, and draws the curves.
#[derive(Parser)]
#[command(override_usage = "discrepancy [OPTIONS] <SET|--file POINTS.csv|--sweep>")]
struct Arguments {
    /// The set
    #[arg(value_enum, required_unless_present_any = ["file", "sweep"])]
    set: Option<sets::Set>,
    /// A file of points instead: numbers between commas or blanks, one point a line; `-` for the standard input
    #[arg(long, value_name = "POINTS.csv", conflicts_with_all = ["set", "sweep", "first", "scramble"])]
    file: Option<PathBuf>,
    /// In how many dimensions [default: 2, or all of a file]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    dims: Option<u32>,
    /// How many points [default: 64, or all of a file]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    count: Option<u64>,
    /// The index of the first point
    #[arg(long, default_value_t = 0)]
    first: u64,
    #[command(flatten)]
    choice: sets::Choice,
    /// What is measured
    #[arg(long, value_enum, default_value_t = Metric::Star)]
    metric: Metric,
    /// The square of an L2 discrepancy, not the root
    #[arg(long)]
    squared: bool,
    /// Weights of the dimensions in an L2 discrepancy
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "WEIGHTS",
        allow_hyphen_values = true
    )]
    weights: Option<Vec<f64>>,
    /// The base of a net
    #[arg(long, default_value_t = 2)]
    base: u32,
    /// The kind of answer that the star discrepancy must have [default: the best that the budget allows]
    #[arg(long, value_enum)]
    kind: Option<Kind>,
    /// How far bounds may be apart
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    gap: f64,
    /// Seconds that the star discrepancy may take, about; counted in steps, 2e8 a second, so that the answer is the
    /// same everywhere
    #[arg(
        long,
        default_value_t = 10.0,
        value_name = "SECONDS",
        allow_negative_numbers = true
    )]
    budget: f64,
    /// Writes the answer as JSON; `-` for the standard output
    #[arg(long, value_name = "FILE", value_parser = Target::new)]
    json: Option<Target>,
    /// Draws the discrepancy of several sets against the count, as PNG and SVG
    #[arg(long, conflicts_with_all = ["set", "count"])]
    sweep: bool,
    /// The sets of the sweep
    #[arg(long, value_enum, value_delimiter = ',', value_name = "SETS", requires = "sweep",
          default_values_t = sweep::SETS)]
    sets: Vec<sets::Set>,
    /// The counts of the sweep
    #[arg(long, value_delimiter = ',', value_name = "COUNTS", requires = "sweep",
          default_values_t = sweep::COUNTS)]
    counts: Vec<u64>,
    /// How many seeds random sets are averaged over
    #[arg(long, default_value_t = 16, requires = "sweep",
          value_parser = clap::value_parser!(u64).range(1..))]
    replicates: u64,
    /// Where the pictures of the sweep go
    #[arg(long, value_name = "DIR", default_value = "out", requires = "sweep")]
    out: PathBuf,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that has seen enough is no failure.
        Err(error) if is_broken_pipe(&*error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    error
        .downcast_ref::<std::io::Error>()
        .is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if !(arguments.budget >= 0.0) {
        return Err(format!("--budget must be at least 0; it was {}", arguments.budget).into());
    }
    let measure = Measure {
        metric: arguments.metric,
        kind: arguments.kind,
        gap: arguments.gap,
        budget: arguments.budget,
        squared: arguments.squared,
        weights: arguments.weights.clone(),
        base: arguments.base,
        seed: arguments.choice.seed,
    };
    if arguments.sweep {
        let sweep = sweep::Sweep {
            measure,
            sets: &arguments.sets,
            counts: &arguments.counts,
            replicates: arguments.replicates,
            dimensions: arguments.dims.unwrap_or(2),
            first: arguments.first,
            choice: arguments.choice,
        };
        let curves = sweep.run()?;
        // The numbers first: they are worth having even if there is nothing to draw.
        match &arguments.json {
            Some(target) => target.write(&format!("{:#}", sweep.json(&curves)))?,
            None => write!(std::io::stdout().lock(), "{}", sweep.table(&curves))?,
        }
        std::fs::create_dir_all(&arguments.out)
            .map_err(|error| format!("{}: {error}", arguments.out.display()))?;
        for file in sweep.draw(&curves, &arguments.out)? {
            eprintln!("{}", file.display());
        }
        return Ok(());
    }
    let points = points(arguments)?;
    let spinner = std::io::stderr().is_terminal().then(|| {
        let spinner = ProgressBar::new_spinner().with_message("measuring");
        spinner.enable_steady_tick(Duration::from_millis(100));
        spinner
    });
    let start = Instant::now();
    let answer = measure.of(&points);
    let seconds = start.elapsed().as_secs_f64();
    if let Some(spinner) = spinner {
        spinner.finish_and_clear();
    }
    let answer = answer?;
    match &arguments.json {
        Some(target) => {
            let mut object = serde_json::Map::new();
            object.insert("metric".into(), json!(arguments.metric.name()));
            object.extend(answer.json());
            object.insert("count".into(), json!(points.count()));
            object.insert("dimensions".into(), json!(points.dimensions()));
            object.insert("seconds".into(), json!(seconds));
            target.write(&format!("{:#}", Value::Object(object)))
        }
        None => {
            let mut out = std::io::stdout().lock();
            let squared = if arguments.squared { ", squared" } else { "" };
            writeln!(
                out,
                "{}{squared}, of {} in {}, {}: {} ({seconds:.3} s)",
                arguments.metric.name(),
                measure::counted(points.count(), "point"),
                measure::counted(points.dimensions(), "dimension"),
                answer.kind(),
                answer.text()
            )?;
            Ok(())
        }
    }
}

/// The points that the arguments name.
fn points(arguments: &Arguments) -> Result<Points<'static>, Box<dyn Error>> {
    if let Some(path) = &arguments.file {
        return read::points(path, arguments.dims, arguments.count);
    }
    let set = arguments.set.ok_or("which set?")?;
    let dimensions = arguments.dims.unwrap_or(2);
    let count = arguments.count.unwrap_or(64);
    let points = arguments.choice.build(set, dimensions, count)?;
    let count = points.size().unwrap_or(count);
    if arguments.count.is_some_and(|asked| asked != count) {
        eprintln!("note: this set has {count} points");
    }
    let end = arguments
        .first
        .checked_add(count)
        .ok_or("the indices pass the last one")?;
    Ok(Points::from_set(
        &*points,
        arguments.first..end,
        dimensions,
    )?)
}
