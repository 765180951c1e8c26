//! Prints the points of a set.

use std::io::{BufWriter, Write};
use std::process::ExitCode;

use clap::Parser;

#[path = "common/sets.rs"]
mod sets;

/// Prints the points of a set as comma-separated values, one point a line.
#[derive(Parser)]
struct Arguments {
    /// The set
    #[arg(value_enum)]
    set: sets::Set,
    /// In how many dimensions
    #[arg(long, default_value_t = 2)]
    dims: u32,
    /// How many points
    #[arg(long, default_value_t = 16)]
    count: u64,
    /// The index of the first point
    #[arg(long, default_value_t = 0)]
    first: u64,
    #[command(flatten)]
    choice: sets::Choice,
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
    let points = arguments
        .choice
        .build(arguments.set, arguments.dims, arguments.count)?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    for index in 0..points.size().unwrap_or(arguments.count) {
        let index = index + arguments.first;
        let row: Vec<String> = (0..arguments.dims)
            .map(|dimension| format!("{:.17}", points.coordinate(index, dimension)))
            .collect();
        writeln!(out, "{}", row.join(","))?;
    }
    Ok(())
}
