//! Error against run time of this crate's methods on one page: integrals, pictures, the claims of a lecture, extreme cases.
//!
//! `cargo run --release --all-features --example report -- [--out DIR] [--quick]`

mod boxes;
mod effort;
mod extremes;
mod false_color;
#[path = "../common/integrands.rs"]
mod integrands;
mod lean;
mod lecture;
#[path = "../common/methods.rs"]
mod methods;
mod peers;
mod pictures;
#[path = "../common/pixel_points.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod points;
mod scalars;
mod setup;
mod spread;
#[path = "../common/stiff.rs"]
mod stiff;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use estimand::report::Page;
use estimand::report::number::seconds;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use effort::Effort;
use peers::Peers;

/// Measures error against run time, and writes a page about it.
///
/// The page is `index.html` in the folder; beside it are the figures as CSV and JSON, and the pictures as EXR.
#[derive(Parser)]
struct Arguments {
    /// Where the page and the files go
    #[arg(long, value_name = "DIR", default_value = "out/report")]
    out: PathBuf,
    /// Fewer runs and smaller pictures: below a minute
    #[arg(long)]
    quick: bool,
    /// Selects all randomness
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// A Python with Mitsuba, scipy and vegas to compare with [default: `python3`, if it has them]
    #[arg(long, value_name = "PATH")]
    python: Option<PathBuf>,
    /// Compare with no other program
    #[arg(long, conflicts_with = "python")]
    alone: bool,
    /// Also write what the program did as JSON; `-` for the standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What all sections share.
pub(crate) struct Report {
    pub(crate) page: Page,
    pub(crate) out: PathBuf,
    pub(crate) effort: Effort,
    pub(crate) seed: u64,
    pub(crate) peers: Peers,
    bar: ProgressBar,
}

type Failure = Box<dyn Error>;

impl Report {
    /// Names what is being done.
    pub(crate) fn doing(&self, what: impl Into<String>) {
        self.bar.set_message(what.into());
        self.bar.inc(1);
    }

    /// A file beside the page.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.out.join(name)
    }
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

/// A section: how many steps it takes, and what takes them.
type Section = (u64, fn(&mut Report) -> Result<(), Failure>);

const SECTIONS: [Section; 6] = [
    (scalars::STEPS, scalars::add),
    (boxes::STEPS, boxes::add),
    (pictures::STEPS, pictures::add),
    (lecture::STEPS, lecture::add),
    (extremes::STEPS, extremes::add),
    (lean::STEPS, lean::add),
];

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let start = Instant::now();
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| format!("{}: {error}", arguments.out.display()))?;
    let peers = if arguments.alone {
        Peers::none("not asked for: the page was made with `--alone`")
    } else {
        Peers::find(arguments.python.as_deref())?
    };
    let steps = SECTIONS.iter().map(|section| section.0).sum();
    let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
    bar.set_style(ProgressStyle::with_template(
        "{bar:30} {pos}/{len} {elapsed} {msg}",
    )?);
    let mut report = Report {
        page: Page::new("Monte Carlo integration: error against run time"),
        out: arguments.out.clone(),
        effort: Effort::new(arguments.quick),
        seed: arguments.seed,
        peers,
        bar,
    };
    setup::add(&mut report);
    for (_, add) in SECTIONS {
        add(&mut report)?;
    }
    report.bar.finish_and_clear();
    let took = start.elapsed().as_secs_f64();
    report
        .page
        .text(&format!("All of this took {}.", seconds(took, 2)));
    let path = report.page.write(&report.out)?;
    let done = serde_json::json!({
        "page": path, "seconds": took, "quick": arguments.quick, "seed": arguments.seed,
        "peers": report.peers.names(),
    });
    match &arguments.json {
        Some(file) if file == Path::new("-") => println!("{done:#}"),
        Some(file) => std::fs::write(file, format!("{done:#}\n"))
            .map_err(|error| format!("{}: {error}", file.display()))?,
        None => println!("{}", path.display()),
    }
    Ok(())
}
