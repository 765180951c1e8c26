//! Rendering with more samples where the picture needs them.

use std::error::Error;
use std::time::Instant;

use estimand::path::Adaptive;

use crate::output::Work;
use crate::render::Job;

/// Samples of each pixel that decide, at most.
const PILOT: u64 = 16;

/// Renders all of the picture at once, with `count` samples a pixel in the mean.
pub(crate) fn run(job: &Job<'_>, count: u64) -> Result<Work, Box<dyn Error>> {
    let start = Instant::now();
    let adaptive = Adaptive::new(count, PILOT.min(count))?;
    let adapted = job.picture.adaptive(job.size, job.seed, adaptive)?;
    let seconds = start.elapsed().as_secs_f64();
    let noise = adapted.image.std_error().map(|errors| {
        let squares: f64 = errors.pixels().iter().map(|e| e.length_squared()).sum();
        let mean = adapted.image.mean().element_sum() / 3.0;
        (squares / (3 * errors.pixels().len()) as f64).sqrt() / mean.abs()
    });
    Ok(Work {
        paths: adapted.image.used(),
        seconds,
        rejected: adapted.image.rejected(),
        noise: noise.filter(|noise| noise.is_finite()),
        image: adapted.image,
    })
}
