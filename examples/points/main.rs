//! Prints the points of a set, and draws them.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use estimand::discrepancy::{Periodogram, Points};
use estimand::points::{MultiJittered, PointSet, Stratified};

#[path = "../common/sets.rs"]
mod sets;

mod picture;

/// Prints the points of a set as comma-separated values, one point a line, and draws their projections on
/// pairs of dimensions, each beside its periodogram.
#[derive(Parser)]
struct Arguments {
    /// The set
    #[arg(value_enum)]
    set: sets::Set,
    /// In how many dimensions, 65536 at most; 2 unless it is said, and 1 of van-der-corput
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    dims: Option<u32>,
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
    /// A pair of dimensions to draw, as in `0,1`; may be given several times. One dimension is drawn against the index
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
    let Arguments { set, first, .. } = *arguments;
    let points = arguments.points(arguments.choice)?;
    let count = points.size().unwrap_or(arguments.count);
    if count != arguments.count {
        let asked = arguments.count;
        eprintln!("note: {set} has {count} points, the nearest to {asked} that it can have");
    }
    if first.checked_add(count - 1).is_none() {
        return Err(Failure::Usage(format!(
            "{count} points from index {first} on pass the last index, {}",
            u64::MAX
        )));
    }
    // The picture first: who reads the coordinates may stop before their end.
    if let Some(path) = &arguments.png {
        draw(points.as_ref(), arguments, count)?
            .save(path)
            .map_err(|error| Failure::File(path.clone(), error.to_string()))?;
    }
    let standard = arguments
        .csv
        .as_ref()
        .is_some_and(|path| path.as_os_str() == "-");
    if standard || (arguments.csv.is_none() && arguments.png.is_none()) {
        print(points.as_ref(), arguments, count, io::stdout().lock())?;
    } else if let Some(path) = &arguments.csv {
        let at = |error: io::Error| Failure::File(path.clone(), error.to_string());
        let file = File::create(path).map_err(at)?;
        print(points.as_ref(), arguments, count, file).map_err(at)?;
    }
    Ok(())
}

impl Arguments {
    fn dims(&self) -> u32 {
        self.dims.unwrap_or(match self.set {
            sets::Set::VanDerCorput => 1,
            _ => 2,
        })
    }

    /// The set, randomised as `choice` says.
    fn points(&self, choice: sets::Choice) -> Result<Box<dyn PointSet>, estimand::Error> {
        choice.build(self.set, self.dims(), self.count)
    }
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
    let dims = arguments.dims();
    let width = dims as usize;
    let rows = (BLOCK / u64::from(dims)).clamp(1, count);
    let mut block = vec![0.0; usize::try_from(rows).unwrap_or(1) * width];
    let mut done = 0;
    while done < count {
        let rows = rows.min(count - done);
        let block = &mut block[..usize::try_from(rows).unwrap_or(1) * width];
        points.fill(arguments.first + done, 0..dims, block);
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
    let dims = arguments.dims();
    let projections = match dims {
        1 => &[[0, 0]],
        _ => arguments.project.as_slice(),
    };
    if let Some([x, y]) = projections
        .iter()
        .find(|pair| pair.iter().any(|&d| d >= dims))
    {
        return Err(Failure::Usage(format!(
            "the dimensions {x},{y} are not below the number of dimensions, {dims}"
        )));
    }
    let mut panels = Vec::new();
    for &[x, y] in projections {
        let project = |points: &dyn PointSet| -> Vec<[f64; 2]> {
            (0..count)
                .map(|place| {
                    let index = arguments.first + place;
                    // One dimension is drawn against the index.
                    let across = match dims {
                        1 => place as f64 / count as f64,
                        _ => points.coordinate(index, x),
                    };
                    [across, points.coordinate(index, y)]
                })
                .collect()
        };
        let plane = project(points);
        let mut spectra = vec![spectrum(&plane)?];
        // The spectrum of random sets is that of many of them.
        for replicate in 1..16 {
            let seed = arguments.choice.seed.wrapping_add(replicate);
            let choice = sets::Choice {
                seed,
                ..arguments.choice
            };
            let other = project(arguments.points(choice)?.as_ref());
            if other == plane {
                break;
            }
            spectra.push(spectrum(&other)?);
        }
        let strata = [x, y].map(|dimension| strata(arguments, count, dimension));
        panels.push([picture::scatter(&plane, strata), picture::shades(&spectra)]);
    }
    Ok(picture::side_by_side(&panels))
}

fn spectrum(points: &[[f64; 2]]) -> Result<Periodogram, estimand::Error> {
    Periodogram::new(&Points::from_arrays(points)?, picture::HIGHEST)
}

/// How many strata the set has along an axis.
fn strata(arguments: &Arguments, count: u64, dimension: u32) -> u64 {
    let seed = arguments.choice.seed;
    match arguments.set {
        sets::Set::Stratified => {
            Stratified::new(count, arguments.dims(), seed).map_or(1, |grid| grid.cells(dimension))
        }
        sets::Set::MultiJittered => {
            MultiJittered::new(count, seed).map_or(1, |grid| grid.cells(dimension))
        }
        sets::Set::OrthogonalArray => count.isqrt(),
        sets::Set::NRooks => count,
        sets::Set::Hammersley if dimension == 0 => count,
        _ => 1,
    }
}
