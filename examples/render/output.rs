//! Pictures and figures.

use std::error::Error;
use std::path::{Path, PathBuf};

use estimand::path::Image;
use serde_json::json;

use crate::Arguments;
use crate::render::Job;
use crate::state::State;

/// What there is to be written.
pub(crate) struct Report<'a> {
    pub(crate) job: &'a Job<'a>,
    pub(crate) work: Work,
    pub(crate) reference: Option<&'a Image>,
    pub(crate) left_out: &'a [String],
    pub(crate) load_seconds: f64,
    /// How long the pilot of the roulette took.
    pub(crate) pilot_seconds: f64,
}

/// A picture and what it took.
pub(crate) struct Work {
    pub(crate) image: Image,
    pub(crate) paths: u64,
    /// Whether samples were dealt to the pixels, as the first ones told.
    pub(crate) dealt: bool,
    /// How many pixels are black because no path of them was finite.
    pub(crate) without_value: u64,
    /// How many of the paths were not finite and are left out.
    pub(crate) rejected: u64,
    pub(crate) seconds: f64,
    /// The error relative to the mean, as estimated.
    pub(crate) noise: Option<f64>,
}

impl Work {
    pub(crate) fn of(state: &State) -> Result<Self, estimand::Error> {
        Ok(Self {
            image: state.image()?,
            paths: state.paths,
            dealt: state.allocation.is_some(),
            without_value: state.without_value(),
            rejected: state.rejected,
            seconds: state.seconds,
            noise: state.noise(),
        })
    }
}

/// That pictures have names of formats that can be written.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    for file in &arguments.out {
        if !is(file, "exr") && !is(file, "png") {
            return Err(format!("{}: a picture ends in .exr or .png", file.display()).into());
        }
    }
    match &arguments.std_error {
        Some(file) if !is(file, "exr") => {
            Err(format!("{}: standard errors end in .exr", file.display()).into())
        }
        _ => Ok(()),
    }
}

fn is(file: &Path, extension: &str) -> bool {
    file.extension()
        .is_some_and(|other| other.eq_ignore_ascii_case(extension))
}

pub(crate) fn write(arguments: &Arguments, report: &Report<'_>) -> Result<(), Box<dyn Error>> {
    let mut pictures = arguments.out.clone();
    if pictures.is_empty() && arguments.json.is_none() && arguments.std_error.is_none() {
        let name = arguments.scene.file_stem().unwrap_or("picture".as_ref());
        pictures.push(PathBuf::from(name).with_extension("exr"));
    }
    for file in &pictures {
        match is(file, "png") {
            true => report.work.image.write_png(file)?,
            false => report.work.image.write_exr(file)?,
        }
    }
    if let Some(file) = &arguments.std_error {
        let errors = report
            .work
            .image
            .std_error()
            .ok_or("there are no standard errors: they need two replicates")?;
        errors.write_exr(file)?;
    }
    let to_stdout = arguments.json.as_deref() == Some(Path::new("-"));
    if let Some(file) = &arguments.json {
        let text = serde_json::to_string_pretty(&figures(arguments, report)?)? + "\n";
        if to_stdout {
            print!("{text}");
        } else {
            std::fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))?;
        }
    }
    if !to_stdout {
        summary(report, &pictures);
    }
    Ok(())
}

fn figures(
    arguments: &Arguments,
    report: &Report<'_>,
) -> Result<serde_json::Value, Box<dyn Error>> {
    let Report { job, work, .. } = report;
    let image = &work.image;
    let rmse = report.reference.map(|reference| image.rmse(reference));
    let relative = report
        .reference
        .map(|reference| image.relative_mse(reference));
    let pixels = image.pixels().len() as f64;
    Ok(json!({
        "scene": arguments.scene,
        "width": job.size[0],
        "height": job.size[1],
        "spp": work.paths as f64 / pixels,
        "paths": work.paths,
        "seconds": work.seconds,
        "load_seconds": report.load_seconds,
        "pilot_seconds": report.pilot_seconds,
        "paths_per_second": work.paths as f64 / work.seconds,
        "points": job.points.to_string(),
        "left_out": report.left_out,
        "coordinates_per_path": job.coordinates_per_path(),
        "rejected": work.rejected,
        "without_value": work.without_value,
        "dealt": work.dealt,
        "reused_by": job.reused_by,
        "noise": work.noise,
        "rmse": rmse.transpose()?,
        "relative_mse": relative.transpose()?,
    }))
}

fn summary(report: &Report<'_>, pictures: &[PathBuf]) {
    let Report { job, work, .. } = report;
    let [width, height] = job.size;
    let pixels = report.work.image.pixels().len() as f64;
    println!(
        "{width} x {height} pixels, {:.1} samples each, {:.2} s, {:.2} M paths/s",
        work.paths as f64 / pixels,
        work.seconds,
        work.paths as f64 / work.seconds / 1e6,
    );
    if let Some(noise) = work.noise {
        println!("noise {:.3} % of the mean", 100.0 * noise);
    }
    if work.rejected > 0 {
        println!("{} paths were not finite and are left out", work.rejected);
    }
    if work.without_value > 0 {
        println!("{} pixels have no others and are black", work.without_value);
    }
    for file in pictures {
        println!("{}", file.display());
    }
}
