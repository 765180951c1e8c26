//! Renders the Cornell box with several point sets, and measures their errors against run time.

mod measure;
mod plot;
#[path = "../common/pixel_points.rs"]
#[allow(dead_code, reason = "shared with the other programs")]
mod points;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Parser;
use estimand::path::{Image, scenes};
use serde_json::json;

use measure::{Curve, Measurement, Meter};
use points::Points;

/// Renders the Cornell box with several point sets and compares their errors against run time.
///
/// The error is that of the picture against a reference image by Mitsuba 3. Ctrl-C stops early and keeps what is
/// there.
#[derive(Parser)]
struct Arguments {
    /// Width and height of the picture in pixels; a divisor of the reference's, which has 256
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..))]
    size: u32,
    /// Samples per pixel, one curve point each
    #[arg(long, value_delimiter = ',', default_values_t = [1, 4, 16, 64, 256],
          value_parser = clap::value_parser!(u64).range(1..))]
    spp: Vec<u64>,
    /// Point sets, one curve each
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Points::ALL)]
    points: Vec<Points>,
    /// Selects the randomisation of the points
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; 0 for as many as there are processors
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Where the pictures and the plots go
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Also write the figures as JSON; `-` for the standard output, instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Mitsuba's picture, relative to the root of the repository.
const REFERENCE: &str = "reference/images/cornell_box.exr";
const REFERENCE_ERROR: &str = "reference/images/cornell_box_std_error.exr";

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let reference = reference(arguments.size)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| format!("{}: {error}", arguments.out.display()))?;
    use_threads(arguments.threads)?;
    static STOP: AtomicBool = AtomicBool::new(false);
    ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed))?;

    let view = scenes::cornell_box();
    let mut spp = arguments.spp.clone();
    spp.sort_unstable();
    spp.dedup();
    let meter = Meter::new(&view, arguments.size, arguments.seed, &reference, &STOP);
    let (curves, best) = meter.measure(&arguments.points, &spp)?;
    let stopped = STOP.load(Ordering::Relaxed);

    let stem = |name: &str| arguments.out.join(name);
    if let Some(best) = &best {
        best.write_png(stem("cornell_box.png"))?;
        best.write_exr(stem("cornell_box.exr"))?;
    }
    let noise = meter.reference_noise();
    plot::svg(&stem("error_against_run_time.svg"), &curves, noise)?;
    plot::png(&stem("error_against_run_time.png"), &curves, noise)?;

    let to_stdout = arguments.json.as_deref() == Some(Path::new("-"));
    if !to_stdout {
        print!("{}", measure::table(&curves, noise));
        println!(
            "\nPictures and plots are in {}.{}",
            arguments.out.display(),
            if stopped { " Stopped early." } else { "" }
        );
    }
    if let Some(file) = &arguments.json {
        let text = serde_json::to_string_pretty(&data(arguments, noise, &curves))? + "\n";
        if to_stdout {
            print!("{text}");
        } else {
            std::fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))?;
        }
    }
    Ok(())
}

/// Sets the number of threads; 0 for as many as there are processors.
#[cfg(feature = "parallel")]
fn use_threads(threads: usize) -> Result<(), Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()?;
    Ok(())
}

/// Without the feature `parallel` there is one thread.
#[cfg(not(feature = "parallel"))]
fn use_threads(threads: usize) -> Result<(), Box<dyn Error>> {
    match threads {
        0 | 1 => Ok(()),
        _ => Err(format!("built without the feature `parallel`: no {threads} threads").into()),
    }
}

#[cfg(feature = "parallel")]
fn threads_in_use() -> usize {
    rayon::current_num_threads()
}

#[cfg(not(feature = "parallel"))]
fn threads_in_use() -> usize {
    1
}

/// The reference at the given size, with its standard errors.
fn reference(size: u32) -> Result<Image, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let image = Image::read_exr(root.join(REFERENCE))?
        .with_std_error(Image::read_exr(root.join(REFERENCE_ERROR))?)?;
    let (width, size) = (image.width(), size as usize);
    if !width.is_multiple_of(size) {
        return Err(format!("the size must divide {width}, the reference's; it was {size}").into());
    }
    Ok(image.downsampled(width / size)?)
}

fn data(arguments: &Arguments, noise: f64, curves: &[Curve]) -> serde_json::Value {
    let sample = |sample: &Measurement| {
        json!({
            "spp": sample.spp,
            "used": sample.used,
            "seconds": sample.seconds,
            "rmse": sample.rmse,
            "relative_mse": sample.relative_mse,
            "repetitions": sample.repetitions,
            "reference_noise_counts": sample.noisy(noise),
        })
    };
    json!({
        "reference": REFERENCE,
        "reference_rmse": noise,
        "size": arguments.size,
        "seed": arguments.seed,
        "threads": threads_in_use(),
        "curves": curves.iter().map(|curve| json!({
            "points": curve.points.name(),
            "samples": curve.samples.iter().map(sample).collect::<Vec<_>>(),
            "slope": curve.slope(noise),
            "slope_over_samples": curve.slope_over_samples(noise),
        })).collect::<Vec<_>>(),
    })
}
