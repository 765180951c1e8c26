//! Prints the points of a set, and draws them.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use estimand::points::{MultiJittered, PointSet, Stratified};

#[path = "../common/sets.rs"]
mod sets;

mod periodogram;
mod picture;

/// Prints the points of a set as comma-separated values, one point a line, and draws their projections on
/// pairs of dimensions, each beside its periodogram.
#[derive(Parser)]
struct Arguments {
    /// The set
    #[arg(value_enum)]
    set: sets::Set,
    /// In how many dimensions
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..))]
    dims: u32,
    /// How many points
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// The index of the first point
    #[arg(long, default_value_t = 0)]
    first: u64,
    #[command(flatten)]
    choice: sets::Choice,
    /// Where the coordinates go; `-` is standard output, which they also go to when there is no picture
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Where the picture goes
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// A pair of dimensions to draw, as in `0,1`; may be given several times
    #[arg(long, value_name = "X,Y", value_parser = pair, default_value = "0,1")]
    project: Vec<[u32; 2]>,
}

fn pair(text: &str) -> Result<[u32; 2], String> {
    let parse = |number: &str| {
        let number = number.trim();
        number
            .parse()
            .map_err(|_| format!("`{number}` is no dimension"))
    };
    match text.split_once(',') {
        Some((x, y)) => Ok([parse(x)?, parse(y)?]),
        None => Err("two dimensions with a comma between them are wanted".to_owned()),
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // Who reads no further has seen what they wanted.
        Err(Failure::Io(error)) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Why the program stopped.
#[derive(Debug)]
enum Failure {
    Refused(estimand::Error),
    Io(io::Error),
    File(PathBuf, String),
    Usage(String),
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Refused(error) => error.fmt(f),
            Self::Io(error) => error.fmt(f),
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Usage(error) => error.fmt(f),
        }
    }
}

impl From<estimand::Error> for Failure {
    fn from(error: estimand::Error) -> Self {
        Self::Refused(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments {
        set,
        dims,
        count,
        first,
        choice,
        ..
    } = *arguments;
    let points = choice.build(set, dims, count)?;
    let used = points.size().unwrap_or(count);
    if used != count {
        eprintln!("note: {set} has {used} points, the nearest to {count} that it can have");
    }
    if first.checked_add(used - 1).is_none() {
        return Err(Failure::Usage(format!(
            "{used} points from index {first} on pass the last index, {}",
            u64::MAX
        )));
    }
    let standard = arguments
        .csv
        .as_ref()
        .is_some_and(|path| path.as_os_str() == "-");
    if standard || (arguments.csv.is_none() && arguments.png.is_none()) {
        print(points.as_ref(), arguments, used, io::stdout().lock())?;
    } else if let Some(path) = &arguments.csv {
        let at = |error: io::Error| Failure::File(path.clone(), error.to_string());
        let file = File::create(path).map_err(at)?;
        print(points.as_ref(), arguments, used, file).map_err(at)?;
    }
    if let Some(path) = &arguments.png {
        draw(points.as_ref(), arguments, used)?
            .save(path)
            .map_err(|error| Failure::File(path.clone(), error.to_string()))?;
    }
    Ok(())
}

/// Writes the points with 17 significant digits, which tell every number apart.
fn print(
    points: &dyn PointSet,
    arguments: &Arguments,
    count: u64,
    out: impl Write,
) -> io::Result<()> {
    /// Coordinates that are computed at once.
    const BLOCK: u64 = 1 << 14;
    let mut out = BufWriter::new(out);
    let width = arguments.dims as usize;
    let rows = (BLOCK / u64::from(arguments.dims)).clamp(1, count);
    let mut block = vec![0.0; usize::try_from(rows).unwrap_or(1) * width];
    let mut done = 0;
    while done < count {
        let rows = rows.min(count - done);
        let block = &mut block[..usize::try_from(rows).unwrap_or(1) * width];
        points.fill(arguments.first + done, 0..arguments.dims, block);
        for row in block.chunks_exact(width) {
            for (column, u) in row.iter().enumerate() {
                let comma = if column == 0 { "" } else { "," };
                write!(out, "{comma}{u:.16e}")?;
            }
            writeln!(out)?;
        }
        done += rows;
    }
    out.flush()
}

fn draw(
    points: &dyn PointSet,
    arguments: &Arguments,
    count: u64,
) -> Result<image::RgbImage, Failure> {
    /// More dots than this make no picture.
    const MOST: u64 = 1 << 16;
    if count > MOST {
        return Err(Failure::Usage(format!(
            "a picture shows at most {MOST} points; there are {count}"
        )));
    }
    let mut panels = Vec::new();
    for &[x, y] in &arguments.project {
        if arguments.dims > 1 && x.max(y) >= arguments.dims {
            return Err(Failure::Usage(format!(
                "the dimensions {x},{y} are not below --dims {}",
                arguments.dims
            )));
        }
        let project = |points: &dyn PointSet| -> Vec<[f64; 2]> {
            (0..count)
                .map(|place| {
                    let index = arguments.first + place;
                    // One dimension is drawn against the index.
                    if arguments.dims == 1 {
                        return [place as f64 / count as f64, points.coordinate(index, 0)];
                    }
                    [x, y].map(|dimension| points.coordinate(index, dimension))
                })
                .collect()
        };
        let choice = arguments.choice;
        let strata = [x, y].map(|dimension| strata(arguments, count, dimension));
        // The spectrum of random sets is that of many of them.
        let replicates = (0..16).map(|replicate| {
            let seed = choice.seed.wrapping_add(replicate);
            let replicate = sets::Choice { seed, ..choice };
            Ok(project(
                replicate
                    .build(arguments.set, arguments.dims, arguments.count)?
                    .as_ref(),
            ))
        });
        let replicates = replicates.collect::<Result<Vec<_>, estimand::Error>>()?;
        panels.push([
            picture::scatter(&project(points), strata),
            picture::shades(&periodogram::power(&replicates)),
        ]);
    }
    Ok(picture::side_by_side(&panels))
}

/// How many strata the set has along an axis.
fn strata(arguments: &Arguments, count: u64, dimension: u32) -> u64 {
    let Arguments {
        set, dims, choice, ..
    } = *arguments;
    match set {
        sets::Set::Stratified => {
            Stratified::new(count, dims, choice.seed).map_or(1, |grid| grid.cells(dimension))
        }
        sets::Set::MultiJittered => {
            MultiJittered::new(count, choice.seed).map_or(1, |grid| grid.cells(dimension))
        }
        sets::Set::OrthogonalArray => count.isqrt(),
        sets::Set::NRooks => count,
        sets::Set::Hammersley if dimension == 0 => count,
        _ => 1,
    }
}
