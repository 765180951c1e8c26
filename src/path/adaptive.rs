//! More samples where the picture needs them, without bias.

mod allocation;
mod pilot;

pub use allocation::Allocation;

use super::bsdf::Bsdf;
use super::filter::Filter;
use super::light::{Environment, Light};
use super::sensor::Sensor;
use super::{Image, Unfinished, View};
use crate::points::{Independent, PointSet};
use crate::{Error, Estimator, hash};

use pilot::{Pilot, SIDE};

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
/// // The pilot took 16 samples in each of 36 squares, those at the edge included: 2.25 a pixel.
/// assert_eq!(samples, 16 * 16 * (64 - 3));
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
    /// In each of two sets, in one pixel of each square.
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
    /// `count` samples a pixel in the mean over the picture, of which twice `pilot` in one pixel of every three by three decide how the
    /// others are dealt, one a pixel at least. At the edges the threes may be smaller, and all of a picture may be one: then the pilot takes
    /// a larger part.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a pilot of 0, or one that leaves nothing of `count`.
    pub fn new(count: u64, pilot: u64) -> Result<Self, Error> {
        if pilot == 0 || of_pilot(pilot) >= count {
            return Err(Error::refused(
                "number of pilot samples",
                "at least 1, and two ninths of it below the count",
                format_args!("{pilot} of {count}"),
            ));
        }
        Ok(Self { count, pilot })
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// Renders a pilot, and tells how a picture is to be sampled that takes other samples: those of other seeds. In one pixel of
    /// every square of three by three it compares two sets of `count` points each, which `points` makes of seeds: let them be
    /// of the kind that the picture will have. Values that are not finite are left out.
    ///
    /// ```
    /// use estimand::path::{Image, scenes};
    /// use estimand::points::Rescrambled;
    /// use estimand::{Average, Estimator};
    ///
    /// let (view, size) = (scenes::cornell_box(), [16, 16]);
    /// let points = |key| Rescrambled::new(4, key);
    /// let counts = view.allocate(size, 1, 8, points)?.powers(32, 2);
    /// let picture = Image::of_pixels(size, 2, |[x, y], key| {
    ///     let count = counts[(y * size[0] + x) as usize];
    ///     Average::new(points(key)?, count).estimate(&view.pixel([x, y], size))
    /// })?;
    /// assert_eq!(picture.used(), counts.iter().sum::<u64>());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render), and [`Error::Refused`] for a count of 0.
    pub fn allocate<P: PointSet>(
        &self,
        size: [u32; 2],
        seed: u64,
        count: u64,
        points: impl Fn(u64) -> Result<P, Error> + Sync,
    ) -> Result<Allocation, Unfinished> {
        let allocation = self.allocate_while(size, seed, count, points, || true)?;
        Ok(allocation.expect("nobody stopped it"))
    }

    /// The same, as long as `proceed`, which is called from any thread, every three rows, returns `true`; then `None`.
    ///
    /// # Errors
    ///
    /// As [`allocate`](Self::allocate).
    pub fn allocate_while<P: PointSet>(
        &self,
        size: [u32; 2],
        seed: u64,
        count: u64,
        points: impl Fn(u64) -> Result<P, Error> + Sync,
        proceed: impl Fn() -> bool + Sync,
    ) -> Result<Option<Allocation>, Unfinished> {
        let pilot = Pilot::new(self, size, seed, count, &points, &proceed)?;
        Ok(pilot.map(|pilot| Allocation::new(pilot.deviations(), pilot.used)))
    }

    /// The picture with more samples where it varies more: `estimator` makes the estimator of a pixel from its seed and the
    /// number of its samples, which are [`Allocation::counts`]. The pilot is of independent points. For nets take
    /// [`allocate`](Self::allocate) and [`Allocation::powers`]. See [`Adaptive`].
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
        let points = |key| Ok(Independent::new(key));
        let allocation = self.allocate(size, hash::hash(seed, PILOT), pilot, points)?;
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let spent = allocation.used().div_ceil(pixels);
        let samples = allocation.counts(count.saturating_sub(spent));
        let image = Image::of_pixels(size, seed, |[x, y], key| {
            let count = samples[y as usize * size[0] as usize + x as usize];
            estimator(key, count).estimate(&self.pixel([x, y], size))
        })?;
        Ok(Adapted { image, samples })
    }
}

/// Samples of a pixel in the mean that are those of a pilot, rounded up.
fn of_pilot(pilot: u64) -> u64 {
    let looked_at = u64::from(SIDE * SIDE);
    pilot / looked_at * 2 + (pilot % looked_at * 2).div_ceil(looked_at)
}

/// Tells the seed of the pilot from that of the picture.
const PILOT: u64 = 0x0070_696c_6f74;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MonteCarlo;
    use crate::path::scenes;
    use crate::points::pixel;

    #[test]
    fn the_budget_is_met_and_goes_where_the_noise_is() {
        let view = scenes::cornell_box();
        let adaptive = Adaptive::new(32, 8).unwrap();
        let plain = |key, count| MonteCarlo::new(count, key);
        let adapted = view.render_adaptive([32, 32], 1, adaptive, plain).unwrap();
        // The pilot took 16 samples in each of 121 squares: 1.9 a pixel.
        assert_eq!(adapted.samples.iter().sum::<u64>(), 32 * 32 * 30);
        assert_eq!(adapted.image.used(), 32 * 32 * 30);
        assert!(adapted.samples.iter().all(|&count| count >= 3));
        assert!(adapted.samples.iter().any(|&count| count > 64));
        assert!(Adaptive::new(8, 0).is_err() && Adaptive::new(2, 9).is_err());
        assert!(Adaptive::new(3, 9).is_ok() && Adaptive::new(2, 4).is_ok());
        assert!(Adaptive::new(u64::MAX, u64::MAX).is_ok());
        let points = |key| Ok(Independent::new(key));
        assert!(view.allocate([4, 4], 1, 0, points).is_err());
        assert!(view.allocate([0, 4], 1, 2, points).is_err());
        let halted = view.allocate_while([4, 4], 1, 2, points, || false);
        assert_eq!(halted.unwrap(), None);
        let refused = |_| Err::<Independent, _>(Error::refused("points", "none", 0));
        assert!(view.allocate([4, 4], 1, 2, refused).is_err());
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
        let counts = |seed| {
            let points = |key| Ok(Independent::new(key));
            // Four squares of three pixels or fewer, two sets each: eight samples a pixel.
            view.allocate([4, 4], seed, 16, points)
                .unwrap()
                .counts(64 - 8)
        };
        assert_eq!(adapted.samples, counts(hash::hash(3, PILOT)));
        assert_ne!(adapted.samples, counts(3));
    }
}
