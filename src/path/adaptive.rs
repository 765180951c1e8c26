//! More samples where the picture needs them, without bias.

use core::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

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

/// How samples are to be dealt to the pixels of a picture, as a pilot has shown: more where values spread more.
///
/// No pixel gets less than an eighth of the mean, since a pilot of few samples may have missed what is rare, none more than 64 times the mean,
/// since it may have met it, and none nothing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct Allocation {
    /// In proportion to the standard deviation of single samples in and around each pixel: the largest is 1.
    deviations: Vec<f64>,
}

/// The least and the most that a pixel gets, in parts of the mean.
const LEAST: f64 = 0.125;
const MOST: f64 = 64.0;

impl Allocation {
    /// Deviations that are all zero, or not all finite, tell nothing: then all pixels are alike.
    fn new(mut deviations: Vec<f64>) -> Self {
        let largest = deviations.iter().copied().fold(0.0, f64::max);
        let usable = largest > 0.0 && deviations.iter().all(|deviation| deviation.is_finite());
        for deviation in &mut deviations {
            *deviation = if usable { *deviation / largest } else { 1.0 };
        }
        Self { deviations }
    }

    /// How many samples each pixel gets, row by row, `mean` in the mean, 1 if that is 0: in proportion to the standard deviation, which is
    /// best for the mean square error of the whole picture with independent samples.
    pub fn counts(&self, mean: u64) -> Vec<u64> {
        let mean = mean.max(1) as f64;
        let least = (LEAST * mean).ceil();
        let level = Level::new(&self.deviations, least, MOST * mean);
        let factor = level.factor(mean);
        // Rounded so that the sums of all pixels so far are right to half a sample, hence the whole is.
        let (mut wanted, mut given) = (0.0, 0.0);
        let count = |&deviation: &f64| {
            wanted += level.share(factor, deviation);
            let count = (wanted - given).round().max(least);
            given += count;
            whole(count)
        };
        self.deviations.iter().map(count).collect()
    }

    /// The same for nets, which are best in powers of `radix` points: each number is one, the next to its share, so that it may be below
    /// the least or above the most by the root of the radix.
    ///
    /// The numbers go with a lower power of the deviation, 6/7: right where the variance falls as the number to the power of -4/3, as it
    /// does in pixels with scrambled nets, about.
    ///
    /// # Panics
    ///
    /// If the radix is below 2.
    pub fn powers(&self, mean: u64, radix: u32) -> Vec<u64> {
        assert!(radix >= 2, "a radix of {radix}");
        let (mean, base) = (mean.max(1) as f64, f64::from(radix));
        // Everything in logarithms to the base.
        let weights: Vec<f64> = self
            .deviations
            .iter()
            .map(|d| 6.0 / 7.0 * d.log(base))
            .collect();
        let limits = [(LEAST * mean).max(1.0), MOST * mean].map(|limit| limit.log(base));
        let powers: Vec<f64> = (0..=i32::from(u8::MAX))
            .map(|exponent| base.powi(exponent))
            .collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between zero and the most, which is below the last power"
        )]
        let power = |factor: f64, weight: f64| {
            powers[usize::from((factor + weight).clamp(limits[0], limits[1]).round() as u8)]
        };
        let given = |factor: f64| weights.iter().map(|&w| power(factor, w)).sum::<f64>();
        // The largest weight is 0 or less: with these all are at the least or, but those of weight zero, at the most.
        let lowest = weights
            .iter()
            .copied()
            .filter(|w| w.is_finite())
            .fold(0.0, f64::min);
        let (mut low, mut high) = (limits[0] - 1.0, limits[1] - lowest + 1.0);
        let target = mean * weights.len() as f64;
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if given(middle) > target {
                high = middle;
            } else {
                low = middle;
            }
        }
        // What is left goes to some of the pixels for which the two differ, spread evenly.
        let (few, many) = (given(low), given(high));
        let part = if many > few {
            ((target - few) / (many - few)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let (mut wanted, mut spent) = (0.0, 0.0);
        let count = |&weight: &f64| {
            let (fewer, more) = (power(low, weight), power(high, weight));
            let step = more - fewer;
            wanted += part * step;
            if step > 0.0 && wanted - spent >= 0.5 * step {
                spent += step;
                return whole(more);
            }
            whole(fewer)
        };
        weights.iter().map(count).collect()
    }
}

/// Steps of the search for a factor.
const STEPS: usize = 30;

/// Shares in proportion to weights, within limits.
struct Level {
    /// Falling, with the sums of those before each, and of all.
    weights: Vec<f64>,
    sums: Vec<f64>,
    least: f64,
    most: f64,
}

impl Level {
    fn new(weights: &[f64], least: f64, most: f64) -> Self {
        let mut weights = weights.to_vec();
        weights.sort_unstable_by(|a, b| b.total_cmp(a));
        let mut sum = 0.0;
        let before = |weight: &f64| {
            let before = sum;
            sum += weight;
            before
        };
        let mut sums: Vec<f64> = weights.iter().map(before).collect();
        sums.push(sum);
        Self {
            weights,
            sums,
            least,
            most,
        }
    }

    #[inline]
    fn share(&self, factor: f64, weight: f64) -> f64 {
        (factor * weight).clamp(self.least, self.most)
    }

    /// What the weights are to be multiplied by so that the mean of the shares is `mean`, as far as the limits allow.
    fn factor(&self, mean: f64) -> f64 {
        let count = self.weights.len();
        let total = mean.clamp(self.least, self.most) * count as f64;
        let given = |factor: f64| {
            let large = self.weights.partition_point(|&w| factor * w > self.most);
            let small = self.weights.partition_point(|&w| factor * w > self.least);
            self.most * large as f64
                + factor * (self.sums[small] - self.sums[large])
                + self.least * (count - small) as f64
        };
        // The largest weight is 1. Logarithms, since the smallest may be tiny.
        let smallest = self
            .weights
            .iter()
            .rev()
            .find(|&&w| w > 0.0)
            .unwrap_or(&1.0);
        let (mut low, mut high) = (self.least.ln(), (self.most / smallest).ln());
        for _ in 0..2 * STEPS {
            let middle = 0.5 * (low + high);
            if given(middle.exp()) > total {
                high = middle;
            } else {
                low = middle;
            }
        }
        low.exp()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and saturates"
)]
fn whole(share: f64) -> u64 {
    share.round() as u64
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
    fn counts_follow_the_deviations() {
        let allocation = |deviations: &[f64]| Allocation::new(deviations.to_vec());
        // An eighth of 16 for the first; 62 for eight parts.
        assert_eq!(allocation(&[0.0, 1.0, 2.0, 5.0]).counts(16), [2, 8, 15, 39]);
        // None gets more than 64 times the mean: there is more for the others.
        let mut rare = vec![1e-9; 99];
        rare.push(1.0);
        let counts = allocation(&rare).counts(10);
        assert_eq!((counts[99], counts.iter().sum::<u64>()), (640, 1000));
        assert!(counts[..99].iter().all(|&count| count == 3 || count == 4));
        // What tells nothing.
        for deviation in [0.0, 3.0, 1e-300, f64::INFINITY, f64::NAN] {
            let even = allocation(&[deviation; 5]);
            assert_eq!(
                (even.counts(7), even.powers(8, 2)),
                (vec![7; 5], vec![8; 5])
            );
            assert_eq!(
                (even.counts(0), even.powers(1, 3)),
                (vec![1; 5], vec![1; 5])
            );
        }
        let _ = allocation(&[1.0, 2.0]).counts(u64::MAX);
        let _ = allocation(&[1.0, 2.0]).powers(u64::MAX, 2);
    }

    #[test]
    fn powers_keep_the_mean() {
        let steep = (0..4096).map(|i| (f64::from(i) / 500.0).exp()).collect();
        for deviations in [steep, vec![1.0; 4096], vec![0.0; 4096]] {
            let allocation = Allocation::new(deviations);
            for (mean, radix) in [(64, 2), (56, 2), (6, 2), (1, 2), (64, 3), (64, 101)] {
                let counts = allocation.powers(mean, radix);
                let radix = u64::from(radix);
                let is_power = |count: u64| radix.pow(count.ilog(radix)) == count;
                assert!(
                    counts.iter().all(|&count| is_power(count)),
                    "{mean} {radix}"
                );
                let (given, step) = (counts.iter().sum::<u64>(), counts.iter().max());
                let off = given.abs_diff(4096 * mean);
                assert!(off <= *step.unwrap(), "{mean} {radix}: {given}");
            }
        }
    }

    /// The variance of a picture whose pixels have the given ones with a sample each.
    fn variance(deviations: &[f64], counts: &[u64], power: f64) -> f64 {
        let pixels = deviations.iter().zip(counts);
        pixels
            .map(|(deviation, &count)| deviation * deviation * (count as f64).powf(-power))
            .sum()
    }

    #[test]
    fn the_variance_is_near_the_least() {
        let deviations: Vec<f64> = (0..4096).map(|i| 1.0 + f64::from(i % 64)).collect();
        let allocation = Allocation::new(deviations.clone());
        // Lagrange: the counts in proportion to the deviations to the power 2 / (1 + power).
        let least = |power: f64| {
            let shares = deviations.iter().map(|d| d.powf(2.0 / (1.0 + power)));
            let sum: f64 = shares.sum();
            (sum / (4096.0 * 64.0)).powf(power) * sum
        };
        let plain = variance(&deviations, &allocation.counts(64), 1.0) / least(1.0);
        assert!((1.0..1.02).contains(&plain), "{plain}");
        // Counts off by up to the root of two cost some 6 %.
        let nets = variance(&deviations, &allocation.powers(64, 2), 4.0 / 3.0) / least(4.0 / 3.0);
        assert!((1.0..1.08).contains(&nets), "{nets}");
        let even = variance(&deviations, &[64; 4096], 1.0) / least(1.0);
        assert!(even > 1.2, "{even}");
    }

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
