//! More samples where the picture needs them, without bias.

mod allocation;
mod chessboard;
mod dealing;

pub use allocation::Allocation;

use super::bsdf::Bsdf;
use super::filter::Filter;
use super::light::{Environment, Light};
use super::sensor::Sensor;
use super::{Image, Unfinished, View};
use crate::{Error, Estimate, Estimator, hash};
use glam::DVec3;

/// How many samples an adaptive picture takes, and how many of them every pixel gets first.
///
/// Errors of the first samples tell how the others are dealt, without bias: see [`Allocation`].
///
/// ```
/// use estimand::MonteCarlo;
/// use estimand::path::{Adaptive, scenes};
///
/// let view = scenes::cornell_box();
/// let adaptive = Adaptive::new(64, 8)?;
/// let adapted = view.render_adaptive([16, 16], 1, adaptive, |key, count| MonteCarlo::new(count, key))?;
/// assert!(adapted.samples.iter().all(|&count| count >= 8));
/// assert_eq!(adapted.image.used(), adapted.samples.iter().sum::<u64>());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Adaptive {
    count: u64,
    first: u64,
}

/// An adaptive picture.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Adapted {
    /// The picture.
    pub image: Image,
    /// How many samples every pixel got, row by row from the upper left corner.
    pub samples: Vec<u64>,
}

impl Adaptive {
    /// `count` samples a pixel in the mean over the picture, `first` of them in every pixel. An eighth is a good part.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for fewer first ones than 2, which tell of no error, and for more than there are.
    pub fn new(count: u64, first: u64) -> Result<Self, Error> {
        if first < 2 || first > count {
            return Err(Error::refused(
                "number of first samples",
                "at least 2, and at most the count",
                format_args!("{first} of {count}"),
            ));
        }
        Ok(Self { count, first })
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// The picture with more samples where it varies more: `estimator` makes an estimator of a pixel from a seed and a number of samples, for
    /// the first samples and, apart, for those that are added; none is asked for a single one. The picture has the mean of both, weighted by their
    /// numbers, and its standard errors are those of both. Over all pixels there are as many samples as `adaptive` says, but for a few, and where
    /// [`Allocation::counts`] leaves some.
    ///
    /// For nets take [`Allocation`]: their points are better together.
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render), and [`Error::Refused`] for an estimator without standard errors. Once the first samples are there,
    /// [`Unfinished::image`] is the whole picture that they make, whatever stops those that are added.
    pub fn render_adaptive<T: Estimator>(
        &self,
        size: [u32; 2],
        seed: u64,
        adaptive: Adaptive,
        estimator: impl Fn(u64, u64) -> T + Sync,
    ) -> Result<Adapted, Unfinished> {
        let Adaptive { count, first } = adaptive;
        let picture = self.render(size, seed, |key| estimator(key, first))?;
        let allocation = match Allocation::new(&picture, first) {
            Ok(allocation) => allocation,
            Err(reason) => {
                return Err(Unfinished {
                    image: Some(Box::new(picture)),
                    ..Unfinished::from(reason)
                });
            }
        };
        let samples = allocation.counts_without_single_ones(count);
        let added = Image::of_pixels(size, hash::hash(seed, ADDED), |[x, y], key| {
            let count = samples[y as usize * size[0] as usize + x as usize] - first;
            if count == 0 {
                let mut nothing = Estimate::new(DVec3::ZERO, 0);
                nothing.std_error = Some(DVec3::ZERO);
                return Ok(nothing);
            }
            estimator(key, count).estimate(&self.pixel([x, y], size))
        });
        let added = match added {
            Ok(added) => added,
            Err(unfinished) => {
                return Err(Unfinished {
                    image: Some(Box::new(picture)),
                    ..unfinished
                });
            }
        };
        let weights = |pixel: usize| [first, samples[pixel] - first].map(|count| count as f64);
        let image = picture.joined(&added, weights);
        Ok(Adapted { image, samples })
    }
}

/// Tells the seed of the samples that are added from that of the first ones.
const ADDED: u64 = 0x0061_6464_6564;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::scenes;
    use crate::points::{Independent, pixel};
    use crate::{Average, MonteCarlo, Replicated};

    fn plain(key: u64, count: u64) -> MonteCarlo {
        MonteCarlo::new(count, key)
    }

    #[test]
    fn the_budget_is_met_and_goes_where_the_noise_is() {
        let view = scenes::cornell_box();
        let adaptive = Adaptive::new(32, 8).unwrap();
        let adapted = view.render_adaptive([32, 32], 1, adaptive, plain).unwrap();
        let sum: u64 = adapted.samples.iter().sum();
        assert!(sum.abs_diff(32 * 32 * 32) <= 32, "{sum}");
        assert_eq!(adapted.image.used(), sum);
        assert!(
            adapted
                .samples
                .iter()
                .all(|&count| count == 8 || count >= 10)
        );
        assert!(adapted.samples.iter().any(|&count| count > 64));
        for (count, first) in [(8, 0), (8, 1), (8, 9)] {
            assert!(Adaptive::new(count, first).is_err());
        }
        let all_first = Adaptive::new(2, 2).unwrap();
        let adapted = view.render_adaptive([3, 3], 1, all_first, plain).unwrap();
        assert_eq!(adapted.samples, [2; 9]);
        let picture = view.render([3, 3], 1, |key| plain(key, 2)).unwrap();
        assert_eq!(adapted.image.pixels(), picture.pixels());
        let without = view.render_adaptive([3, 3], 1, all_first, |key, count| {
            Average::new(Independent::new(key), count)
        });
        let without = without.unwrap_err();
        let message = without.to_string();
        assert!(message.contains("standard errors"), "{message}");
        assert_eq!(without.image.unwrap().used(), 18);
        let two = Adaptive::new(8, 2).unwrap();
        let stopped = view.render_adaptive([3, 3], 1, two, |key, count| {
            let replicates = if count == 2 { 2 } else { 0 };
            Replicated::new(replicates, 1, Independent::new).seed(key)
        });
        let stopped = stopped.unwrap_err();
        assert!(stopped.position.is_some());
        assert_eq!(stopped.image.unwrap().used(), 18);
        assert!(
            view.render_adaptive([0, 4], 1, all_first, plain)
                .unwrap_err()
                .image
                .is_none()
        );
    }

    #[test]
    fn a_pixel_has_the_samples_of_its_seeds() {
        let view = scenes::furnace();
        let adaptive = Adaptive::new(64, 16).unwrap();
        let adapted = view.render_adaptive([4, 4], 3, adaptive, plain).unwrap();
        let count = adapted.samples[5];
        assert!(count > 17);
        let part = |seed, count| {
            let estimator = plain(pixel::seed([1, 1], seed), count);
            estimator.estimate(&view.pixel([1, 1], [4, 4])).unwrap()
        };
        let parts = [part(3, 16), part(hash::hash(3, ADDED), count - 16)];
        let weights = [16.0, (count - 16) as f64].map(|weight| weight / count as f64);
        let mean = parts[0].mean * weights[0] + parts[1].mean * weights[1];
        assert!((adapted.image.pixels()[5] - mean).length() < 1e-15);
        let errors = parts.map(|part| part.std_error.unwrap().x);
        let error = (errors[0] * weights[0]).hypot(errors[1] * weights[1]);
        let found = adapted.image.std_error().unwrap().pixels()[5].x;
        assert!((found / error - 1.0).abs() < 1e-12);
    }
}
