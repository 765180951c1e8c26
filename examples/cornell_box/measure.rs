//! The measurements: time and error of a picture.

use std::error::Error;
use std::fmt::Write;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use estimand::hash::hash;
use estimand::path::bsdf::Lambertian;
use estimand::path::light::{AreaLights, NoEnvironment};
use estimand::path::sensor::Pinhole;
use estimand::path::{Image, View};
use indicatif::{ProgressBar, ProgressStyle};

use crate::points::Points;

/// The scene of this program.
pub(crate) type Room = View<Lambertian, AreaLights, NoEnvironment, Pinhole>;

/// One point of a curve.
pub(crate) struct Measurement {
    /// Samples per pixel asked for, and used.
    pub(crate) spp: u64,
    pub(crate) used: u64,
    /// The shortest time that one picture took.
    pub(crate) seconds: f64,
    /// Over all repetitions.
    pub(crate) rmse: f64,
    pub(crate) relative_mse: f64,
    /// Pictures rendered, each with a seed of its own.
    pub(crate) repetitions: u64,
}

impl Measurement {
    /// Whether more than a tenth of the squared error is the reference's.
    pub(crate) fn noisy(&self, reference_noise: f64) -> bool {
        !(reference_noise.powi(2) < 0.1 * self.rmse.powi(2))
    }

    /// The error without the reference's share; `None` if that is half of it or more.
    pub(crate) fn own_rmse(&self, reference_noise: f64) -> Option<f64> {
        let (square, noise) = (self.rmse.powi(2), reference_noise.powi(2));
        (noise < 0.5 * square).then(|| (square - noise).sqrt())
    }
}

/// What one point set does.
pub(crate) struct Curve {
    pub(crate) points: Points,
    pub(crate) samples: Vec<Measurement>,
}

impl Curve {
    /// The slope of the logarithm of the error over that of the time.
    pub(crate) fn slope(&self, reference_noise: f64) -> Option<f64> {
        self.slope_over(reference_noise, |sample| sample.seconds)
    }

    /// The slope over the logarithm of the number of samples.
    pub(crate) fn slope_over_samples(&self, reference_noise: f64) -> Option<f64> {
        self.slope_over(reference_noise, |sample| sample.used as f64)
    }

    /// By least squares; `None` for fewer than two measurements.
    fn slope_over(&self, reference_noise: f64, cost: impl Fn(&Measurement) -> f64) -> Option<f64> {
        let line: Vec<[f64; 2]> = self
            .samples
            .iter()
            .filter_map(|sample| {
                let error = sample.own_rmse(reference_noise)?;
                Some([cost(sample).ln(), error.ln()])
            })
            .collect();
        if line.len() < 2 {
            return None;
        }
        let count = line.len() as f64;
        let mean = |axis: usize| line.iter().map(|point| point[axis]).sum::<f64>() / count;
        let (x, y) = (mean(0), mean(1));
        let covariance: f64 = line
            .iter()
            .map(|point| (point[0] - x) * (point[1] - y))
            .sum();
        let variance: f64 = line.iter().map(|point| (point[0] - x).powi(2)).sum();
        (variance > 0.0).then(|| covariance / variance)
    }
}

/// Short pictures are rendered again until this time is filled, so that clock and chance count less.
const LEAST_TIME: Duration = Duration::from_millis(400);

/// Renders and compares.
pub(crate) struct Meter<'a> {
    room: &'a Room,
    size: u32,
    seed: u64,
    reference: &'a Image,
    stop: &'a AtomicBool,
}

impl<'a> Meter<'a> {
    pub(crate) fn new(
        room: &'a Room,
        size: u32,
        seed: u64,
        reference: &'a Image,
        stop: &'a AtomicBool,
    ) -> Self {
        Self {
            room,
            size,
            seed,
            reference,
            stop,
        }
    }

    /// The root of the mean squared standard error of the reference.
    pub(crate) fn reference_noise(&self) -> f64 {
        let errors = self.reference.std_error().expect("it was read with them");
        let squares: f64 = errors
            .pixels()
            .iter()
            .map(|error| error.length_squared())
            .sum();
        (squares / (3 * errors.pixels().len()) as f64).sqrt()
    }

    /// One curve for each point set, and of all first pictures the one with the smallest error.
    ///
    /// All sets are measured at one sample count before any is at the next, so that a run that is stopped has
    /// curves of the same length.
    pub(crate) fn measure(
        &self,
        points: &[Points],
        spp: &[u64],
    ) -> Result<(Vec<Curve>, Option<Image>), Box<dyn Error>> {
        let pixels = u64::from(self.size).pow(2);
        let bar = ProgressBar::new(pixels * spp.iter().sum::<u64>() * points.len() as u64);
        bar.set_style(ProgressStyle::with_template(
            "{msg:24} {wide_bar} {percent:>3} % {per_sec:>16} {eta:>4} left",
        )?);
        bar.enable_steady_tick(Duration::from_millis(200));
        let mut curves: Vec<Curve> = points
            .iter()
            .map(|&points| Curve {
                points,
                samples: Vec::new(),
            })
            .collect();
        let mut best: Option<(f64, Image)> = None;
        for &spp in spp {
            for curve in &mut curves {
                bar.set_message(format!("{} {spp} spp", curve.points.name()));
                let (measurement, image) = self.one(curve.points, spp, &bar)?;
                let Some(measurement) = measurement else {
                    bar.abandon();
                    // Better a part of a picture than none.
                    return Ok((curves, Some(best.map_or(image, |(_, image)| image))));
                };
                let rmse = image.rmse(self.reference)?;
                if best.as_ref().is_none_or(|(least, _)| rmse < *least) {
                    best = Some((rmse, image));
                }
                curve.samples.push(measurement);
            }
        }
        bar.finish_and_clear();
        Ok((curves, best.map(|(_, image)| image)))
    }

    /// One point of a curve, and the picture of its first repetition: how many more there are depends on the machine,
    /// that one does not. No point if it was stopped before the first was whole.
    fn one(
        &self,
        points: Points,
        spp: u64,
        bar: &ProgressBar,
    ) -> Result<(Option<Measurement>, Image), Box<dyn Error>> {
        let (mut squares, mut relative, mut repetitions) = (0.0, 0.0, 0);
        let mut fastest = Duration::MAX;
        let start = Instant::now();
        let before = bar.position();
        let mut first = None;
        let first = loop {
            let rows = AtomicU64::new(0);
            let proceed = |_| {
                let row = rows.fetch_add(1, Ordering::Relaxed);
                if repetitions == 0 {
                    bar.set_position(before + row * u64::from(self.size) * spp);
                }
                !self.stop.load(Ordering::Relaxed)
            };
            let started = Instant::now();
            let seed = hash(self.seed, repetitions);
            let image = points.render_while(self.room, self.size, spp, seed, proceed)?;
            let time = started.elapsed();
            if self.stop.load(Ordering::Relaxed) {
                match first {
                    Some(first) => break first,
                    None => return Ok((None, image)),
                }
            }
            fastest = fastest.min(time);
            squares += image.rmse(self.reference)?.powi(2);
            relative += image.relative_mse(self.reference)?;
            repetitions += 1;
            let image = first.unwrap_or(image);
            if start.elapsed() >= LEAST_TIME {
                break image;
            }
            first = Some(image);
        };
        bar.set_position(before + u64::from(self.size).pow(2) * spp);
        let count = repetitions as f64;
        let measurement = Measurement {
            spp,
            used: first.used() / u64::from(self.size).pow(2),
            seconds: fastest.as_secs_f64(),
            rmse: (squares / count).sqrt(),
            relative_mse: relative / count,
            repetitions,
        };
        Ok((Some(measurement), first))
    }
}

/// What the slopes should be.
const THEORY: &str = "
The last columns are the slopes of log RMSE over log seconds and over log samples, with the
reference's own noise taken out of the RMSE. Over time they also hold the cost of setting up the
points of a pixel, which counts at few samples.
In theory -0.5 over samples for plain Monte Carlo. The other sets fall faster as long as few
coordinates matter, and less so the more samples there are: a pixel with an edge in it allows
-0.75 to grids and nets in its two coordinates, N rooks remove what depends on one coordinate
alone, and what the later bounces add falls with -0.5 for all.
";

/// The measurements in columns, and what must be known to read them.
pub(crate) fn table(curves: &[Curve], reference_noise: f64) -> String {
    let mut text = format!(
        "{:<12} {:>6} {:>10} {:>11} {:>13} {:>9} {:>9}\n",
        "points", "spp", "seconds", "RMSE", "relative MSE", "/ time", "/ samples"
    );
    let (mut any_noisy, mut any_other) = (false, false);
    for curve in curves {
        let last = curve.samples.len().saturating_sub(1);
        for (row, sample) in curve.samples.iter().enumerate() {
            let name = if row == 0 { curve.points.name() } else { "" };
            let last = |slope: Option<f64>| {
                slope
                    .filter(|_| row == last)
                    .map_or_else(String::new, |slope| format!("{slope:.2}"))
            };
            let over_time = last(curve.slope(reference_noise));
            let over_samples = last(curve.slope_over_samples(reference_noise));
            let noisy = if sample.noisy(reference_noise) {
                "*"
            } else {
                " "
            };
            any_noisy |= sample.noisy(reference_noise);
            any_other |= sample.used != sample.spp;
            let spp = if sample.used == sample.spp {
                sample.spp.to_string()
            } else {
                format!("~{}", sample.used)
            };
            let line = format!(
                "{name:<12} {spp:>6} {:>10.4} {:>10.5}{noisy} {:>13.6} {over_time:>9} {over_samples:>9}",
                sample.seconds, sample.rmse, sample.relative_mse
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
    text.push_str(THEORY);
    let _ = writeln!(
        text,
        "The reference's own noise is an RMSE of {reference_noise:.5}."
    );
    if any_noisy {
        let _ = writeln!(
            text,
            "* More than a tenth of the squared error is the reference's."
        );
    }
    if any_other {
        let _ = writeln!(text, "~ The grid nearest to the sample count has another.");
    }
    text
}
