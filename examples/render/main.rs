//! Renders scene files of Mitsuba 3.

mod checkpoint;
mod output;
mod plan;
mod points;
mod progress;
mod render;
mod state;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Parser;
use estimand::hash;
use estimand::mitsuba::{self, Instance};
use estimand::path::{Image, Paths};

use checkpoint::Checkpoint;
use output::{Report, Work};
use plan::Plan;
use points::Points;
use render::Job;

/// Renders a scene file of Mitsuba 3.
///
/// Without --spp, --time or --noise it takes the number of samples that the file asks for. Ctrl-C stops early, writes what is
/// there, if the scene is loaded and the pilot of --learn-roulette over, and exits with 130.
#[derive(Parser)]
struct Arguments {
    /// The scene, an XML file
    scene: PathBuf,
    /// A value for a parameter of the scene
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parameter)]
    define: Vec<(String, String)>,
    /// Samples per pixel
    #[arg(long, value_name = "N", group = "length", value_parser = clap::value_parser!(u64).range(1..))]
    spp: Option<u64>,
    /// Stops after this time of rendering
    #[arg(long, value_name = "SECONDS", group = "length", value_parser = positive)]
    time: Option<f64>,
    /// Stops when the root-mean-square error of the pixels, as it is estimated, is below this part of the mean. Of sequences it is estimated from
    /// parts of one set of points, each of 64 where there are more than 128, and is rather too large: by a sixth in the Cornell box at 128. With --adaptive pixels of a sequence are told by halves
    #[arg(long, value_name = "RELATIVE_ERROR", group = "length", value_parser = positive)]
    noise: Option<f64>,
    /// The points of the pixels; the default is blue-noise, and rescrambled with --adaptive, --reuse, --time and --noise
    #[arg(long, value_enum, value_name = "SET")]
    points: Option<Points>,
    /// Into how many independent renders the samples of --spp are split, whose spread gives the error: 16 with --std-error, otherwise 2 if the
    /// points are a finite set. Sequences, and blue noise where --spp is a power of two, are rendered in two parts of one set, which tell of more noise than
    /// there is: by a tenth to a fifth, of blue noise by up to two fifths at 64 samples and two thirds at eight. With --adaptive the first samples are two renders of their own, and there are at least
    /// three
    #[arg(long, value_name = "N", conflicts_with_all = ["time", "noise"], value_parser = clap::value_parser!(u64).range(1..))]
    replicates: Option<u64>,
    /// Selects the randomisation of the points
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Threads; 0 for as many as there are processors
    #[arg(long, value_name = "T", default_value_t = 0)]
    threads: usize,
    /// Where the picture goes, as OpenEXR or PNG by the name's ending; may be given more than once
    #[arg(long, value_name = "FILE.exr|.png")]
    out: Vec<PathBuf>,
    /// Where the standard errors of the pixels go
    #[arg(long, value_name = "FILE.exr")]
    std_error: Option<PathBuf>,
    /// A picture to compare with
    #[arg(long, value_name = "FILE.exr")]
    reference: Option<PathBuf>,
    /// Takes more samples where the picture varies more, as the first ones of the pixels around show: 16 in every pixel with --time and --noise,
    /// otherwise an eighth of all, but a power of two from 2 to 64. --spp is the mean over the picture then, at least 2. Not with blue noise, which
    /// has as many points in every pixel
    #[arg(long)]
    adaptive: bool,
    /// Reuses each path for so many pixels, 1 to 16, drawn from four times as many columns: less noise in the same time where light is scattered ideally
    /// diffusely more than once. These pixels err alike then, so that a mean over some columns is less certain than theirs say. 8 is a good number, 16 with
    /// --adaptive
    #[arg(long, value_name = "PIXELS", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=16))]
    reuse: u32,
    /// Ends paths by Russian roulette as a pilot of so many paths a pixel, in at most 128 x 128 pixels and twice over, shows that it pays
    /// with independent points; others may lose by it. Takes the place of `rr_depth`; its time is told apart, as that of loading is
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    learn_roulette: Option<u64>,
    /// Loads the scene as the type that can render every scene, instead of the smallest that is enough
    #[arg(long)]
    general: bool,
    /// Saves the work every few seconds, and goes on with it if the file is there
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Writes what was done as JSON; `-` for the standard output
    #[arg(long, value_name = "FILE|-")]
    json: Option<PathBuf>,
}

impl Arguments {
    /// The points that are asked for. Blue noise needs as many in every pixel, and their number beforehand; what it does for the eye is lost
    /// where pixels err alike.
    fn points(&self) -> Result<Points, &'static str> {
        let unknown = self.adaptive || self.time.is_some() || self.noise.is_some();
        let alike = self.reuse > 1;
        match self.points {
            Some(Points::BlueNoise) if self.adaptive => Err(
                "blue noise has as many points in every pixel: take other --points with --adaptive",
            ),
            Some(points) => Ok(points),
            None if unknown || alike => Ok(Points::Rescrambled),
            None => Ok(Points::BlueNoise),
        }
    }
}

/// The exit code after Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;

/// Tells the seed of the pilot from that of the picture.
const PILOT: u64 = 0x0070_696c_6f74;

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Whether there is work that would be lost without a proper end: not while a scene is loaded, or a pilot is under way.
static RENDERING: AtomicBool = AtomicBool::new(false);

fn interrupt() {
    STOP.store(true, Ordering::Relaxed);
    if !RENDERING.load(Ordering::Relaxed) {
        std::process::exit(INTERRUPTED.into());
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) if STOP.load(Ordering::Relaxed) => ExitCode::from(INTERRUPTED),
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    use_threads(arguments.threads)?;
    output::check(arguments)?;
    let points = arguments.points()?;
    let reference = arguments
        .reference
        .as_ref()
        .map(Image::read_exr)
        .transpose()?;
    ctrlc::set_handler(interrupt)?;

    let start = Instant::now();
    let overrides: Vec<_> = arguments
        .define
        .iter()
        .map(|(name, value)| (name.as_str(), value.as_str()))
        .collect();
    let description = mitsuba::read(&arguments.scene, &overrides)?;
    let instance = match arguments.general {
        true => Instance::General,
        false => Instance::Smallest,
    };
    let mut loaded = description.load(instance)?;
    let load_seconds = start.elapsed().as_secs_f64();
    if let Some(reference) = &reference {
        let size = [reference.width(), reference.height()];
        if size != loaded.size.map(|length| length as usize) {
            return Err(format!(
                "the reference has {} x {} pixels, the picture {} x {}",
                size[0], size[1], loaded.size[0], loaded.size[1]
            )
            .into());
        }
    }

    let of_the_file = description.sensors[0].sampler.sample_count.into();
    let plan = Plan::new(arguments, points, of_the_file)?;
    let start = Instant::now();
    if let Some(count) = arguments.learn_roulette {
        // Paths of its own, not those of the picture.
        let seed = hash::hash(arguments.seed, PILOT);
        loaded.picture.learn_roulette(loaded.size, count, seed)?;
    }
    let pilot_seconds = start.elapsed().as_secs_f64();
    loaded.picture.reuse_paths(arguments.reuse)?;

    let checkpoint = arguments.checkpoint.as_deref().map(|file| {
        Checkpoint::new(
            file,
            &format!(
                "{description:?} {plan:?} {points} {} {:?} {}",
                arguments.seed, arguments.learn_roulette, arguments.reuse
            ),
        )
    });
    let job = Job {
        picture: &*loaded.picture,
        size: loaded.size,
        points,
        seed: arguments.seed,
        plan,
        reused_by: arguments.reuse,
        columns: Paths::default()
            .reused_by(arguments.reuse)?
            .columns_together(),
        checkpoint: checkpoint.as_ref(),
        stop: &STOP,
    };
    RENDERING.store(true, Ordering::Relaxed);
    let work = Work::of(&job.run()?)?;
    output::write(
        arguments,
        &Report {
            job: &job,
            work,
            reference: reference.as_ref(),
            left_out: &loaded.left_out,
            load_seconds,
            pilot_seconds,
        },
    )
}

fn parameter(text: &str) -> Result<(String, String), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("a parameter is given as NAME=VALUE")?;
    Ok((name.to_owned(), value.to_owned()))
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(value),
        _ => Err("it must be a number above 0".to_owned()),
    }
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
