//! More samples where the picture needs them, without bias.

mod allocation;

use core::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

pub use allocation::Allocation;

use super::bsdf::Bsdf;
use super::filter::Filter;
use super::light::{Environment, Light};
use super::sensor::Sensor;
use super::{Image, Unfinished, View};
use crate::{Error, Estimate, Estimator, Incomplete, MonteCarlo, NonFinite, hash};

/// How many samples an adaptive picture takes, and how many of them look first.
///
/// A pixel that decides by its own samples whether it needs more of them stops where they happen to agree, and is too
/// dark on average where bright paths are rare.[^kirk] So a pilot looks first, with samples of its own, and is no part of the picture:
/// no sample has a say in its own number, and the picture has no bias. See [`Allocation`] for what the pilot decides.
///
/// ```
/// use estimand::MonteCarlo;
/// use estimand::path::{Adaptive, scenes};
///
/// let view = scenes::cornell_box();
/// let adaptive = Adaptive::new(64, 8)?;
/// let adapted = view.render_adaptive([16, 16], 1, adaptive, |key, count| MonteCarlo::new(count, key))?;
/// let samples: u64 = adapted.samples.iter().sum();
/// assert_eq!(samples, 16 * 16 * (64 - 8));
/// assert!(adapted.image.std_error().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [^kirk]: Kirk, David; Arvo, James (1991). *Unbiased Sampling Techniques for Image Synthesis*.
///     <https://doi.org/10.1145/122718.122735>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Adaptive {
    /// The mean over the pixels, those of the pilot included.
    count: u64,
    pilot: u64,
}

/// An adaptive picture.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Adapted {
    /// The picture.
    pub image: Image,
    /// How many samples every pixel got, row by row from the upper left corner, those of the pilot not counted.
    pub samples: Vec<u64>,
}

impl Adaptive {
    /// `count` samples a pixel in the mean over the picture, `pilot` of them in every pixel to decide.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a pilot below 2, which has no variance to tell of, or one that leaves nothing of `count`.
    pub fn new(count: u64, pilot: u64) -> Result<Self, Error> {
        if !(2..count).contains(&pilot) {
            return Err(Error::refused(
                "number of pilot samples",
                "from 2 to below the count",
                format_args!("{pilot} of {count}"),
            ));
        }
        Ok(Self { count, pilot })
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// Renders a pilot of `count` independent samples a pixel, and tells how a picture is to be sampled that takes other ones: those of
    /// other seeds. Values that are not finite are left out of the pilot.
    ///
    /// ```
    /// use estimand::path::{Image, scenes};
    /// use estimand::points::Rescrambled;
    /// use estimand::{Average, Estimator};
    ///
    /// let (view, size) = (scenes::cornell_box(), [16, 16]);
    /// let counts = view.allocate(size, 1, 8)?.powers(32, 2);
    /// let picture = Image::of_pixels(size, 2, |[x, y], key| {
    ///     let points = Rescrambled::new(4, key)?;
    ///     let count = counts[(y * size[0] + x) as usize];
    ///     Average::new(points, count).estimate(&view.pixel([x, y], size))
    /// })?;
    /// assert_eq!(picture.used(), counts.iter().sum::<u64>());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render), and [`Error::Refused`] for a count below 2.
    pub fn allocate(
        &self,
        size: [u32; 2],
        seed: u64,
        count: u64,
    ) -> Result<Allocation, Unfinished> {
        let allocation = self.allocate_while(size, seed, count, |_| true)?;
        Ok(allocation.expect("every row was to be rendered"))
    }

    /// The same, row by row: `proceed` is called with the number of a row, from any thread, before the row is rendered. `None` if it
    /// returns `false` for any.
    ///
    /// # Errors
    ///
    /// As [`allocate`](Self::allocate).
    pub fn allocate_while(
        &self,
        size: [u32; 2],
        seed: u64,
        count: u64,
        proceed: impl Fn(u32) -> bool + Sync,
    ) -> Result<Option<Allocation>, Unfinished> {
        if count < 2 {
            return Err(Error::refused("number of pilot samples", "at least 2", count).into());
        }
        let estimate = |position, key| {
            let pilot = MonteCarlo::new(count, key).non_finite(NonFinite::Reject);
            let (mean, std_error) = match pilot.estimate(&self.pixel(position, size)) {
                Ok(estimate) => (estimate.mean, estimate.std_error),
                Err(Incomplete {
                    reason: Error::NothingLeft { .. },
                    ..
                }) => (DVec3::ZERO, None),
                Err(other) => return Err(other),
            };
            let mut estimate = Estimate::new(mean, count);
            // Of fewer than two values the pixels around tell.
            estimate.std_error = Some(std_error.unwrap_or(DVec3::ZERO));
            Ok(estimate)
        };
        let stopped = AtomicBool::new(false);
        let pilot = Image::of_pixels_while(size, seed, &estimate, &|row| {
            let proceeds = proceed(row);
            stopped.fetch_or(!proceeds, Ordering::Relaxed);
            proceeds
        })?;
        Ok((!stopped.into_inner()).then(|| Allocation::new(deviations(&pilot))))
    }

    /// The picture with more samples where it varies more: `estimator` makes the estimator of a pixel from its seed and the
    /// number of its samples, which are [`Allocation::counts`]. For nets take [`allocate`](Self::allocate) and [`Allocation::powers`]. See
    /// [`Adaptive`].
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render).
    pub fn render_adaptive<T: Estimator>(
        &self,
        size: [u32; 2],
        seed: u64,
        adaptive: Adaptive,
        estimator: impl Fn(u64, u64) -> T + Sync,
    ) -> Result<Adapted, Unfinished> {
        let Adaptive { count, pilot } = adaptive;
        let allocation = self.allocate(size, hash::hash(seed, PILOT), pilot)?;
        let samples = allocation.counts(count - pilot);
        let image = Image::of_pixels(size, seed, |[x, y], key| {
            let count = samples[y as usize * size[0] as usize + x as usize];
            estimator(key, count).estimate(&self.pixel([x, y], size))
        })?;
        Ok(Adapted { image, samples })
    }
}

/// Tells the seed of the pilot from that of the picture.
const PILOT: u64 = 0x0070_696c_6f74;

/// Deviations in proportion to those that a pilot shows: root mean squares over the 3 by 3 pixels around, since few samples may
/// have missed what is rare.
fn deviations(pilot: &Image) -> Vec<f64> {
    let errors = pilot.std_error().expect("every pixel has one");
    let (width, height) = (errors.width(), errors.height());
    let variance: Vec<f64> = errors.pixels().iter().map(|e| e.length_squared()).collect();
    let around = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    (0..variance.len())
        .map(|place| {
            let (columns, rows) = (around(place % width, width), around(place / width, height));
            let pixels = (rows.len() * columns.len()) as f64;
            let squares: f64 = rows
                .flat_map(|y| variance[y * width..][columns.clone()].iter())
                .sum();
            (squares / pixels).sqrt()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::scenes;
    use crate::points::pixel;

    #[test]
    fn the_budget_is_met_and_goes_where_the_noise_is() {
        let view = scenes::cornell_box();
        let adaptive = Adaptive::new(32, 8).unwrap();
        let plain = |key, count| MonteCarlo::new(count, key);
        let adapted = view.render_adaptive([32, 32], 1, adaptive, plain).unwrap();
        assert_eq!(adapted.samples.iter().sum::<u64>(), 32 * 32 * 24);
        assert_eq!(adapted.image.used(), 32 * 32 * 24);
        assert!(adapted.samples.iter().all(|&count| count >= 3));
        assert!(adapted.samples.iter().any(|&count| count > 64));
        assert!(Adaptive::new(8, 1).is_err() && Adaptive::new(8, 8).is_err());
        assert!(view.allocate([4, 4], 1, 1).is_err());
        assert!(view.allocate([0, 4], 1, 2).is_err());
        let halted = view.allocate_while([4, 4], 1, 2, |row| row != 2);
        assert_eq!(halted.unwrap(), None);
    }

    #[test]
    fn a_pixel_has_the_samples_of_its_seed() {
        let view = scenes::furnace();
        let adaptive = Adaptive::new(64, 16).unwrap();
        let plain = |key, count| MonteCarlo::new(count, key);
        let adapted = view.render_adaptive([4, 4], 3, adaptive, plain).unwrap();
        let alone = MonteCarlo::new(adapted.samples[5], pixel::seed([1, 1], 3));
        let alone = alone.estimate(&view.pixel([1, 1], [4, 4])).unwrap();
        assert_eq!(alone.mean, adapted.image.pixels()[5]);
        // The pilot has others.
        let counts = |seed| view.allocate([4, 4], seed, 16).unwrap().counts(48);
        assert_eq!(adapted.samples, counts(hash::hash(3, PILOT)));
        assert_ne!(adapted.samples, counts(3));
    }
}
