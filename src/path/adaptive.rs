//! More samples where the picture needs them, without bias.

use glam::{DVec3, Vec3};

use super::bsdf::Bsdf;
use super::filter::Filter;
use super::light::{Environment, Light};
use super::sensor::Sensor;
use super::{Image, Unfinished, View};
use crate::{Error, ErrorBar, Estimate, Estimator, MonteCarlo, Outcome, hash};

/// How many samples an adaptive picture takes, and how many of them look first.
///
/// A pixel that decides by its own samples whether it needs more of them stops where they happen to agree, and is too
/// dark on average where bright paths are rare.[^kirk] So every pixel is two halves with samples of their own, whose means
/// are averaged. The first samples of all pixels of the one half, the pilot, decide how many samples the pixels of the
/// *other* half get: in proportion to the standard deviation, which is best for the mean square error of the whole
/// picture. No sample has a say in its own number; the picture has no bias, and no sample is thrown away.
///
/// ```
/// use estimand::path::{Adaptive, scenes};
///
/// let view = scenes::cornell_box();
/// let adapted = view.render_adaptive([16, 16], 1, Adaptive::new(64, 16)?)?;
/// let samples: u64 = adapted.samples.iter().sum();
/// assert_eq!(samples, 16 * 16 * 64);
/// assert!(adapted.image.std_error().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [^kirk]: Kirk, David; Arvo, James (1991). *Unbiased Sampling Techniques for Image Synthesis*.
///     <https://doi.org/10.1145/122718.122735>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Adaptive {
    /// Of each half: the mean over the pixels, and the least.
    mean: u64,
    pilot: u64,
}

/// An adaptive picture.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Adapted {
    /// The picture, with its standard errors.
    pub image: Image,
    /// How many samples every pixel got, row by row from the upper left corner.
    pub samples: Vec<u64>,
}

impl Adaptive {
    /// `count` samples a pixel in the mean over the picture, the first `pilot` of every pixel being those that decide. Odd
    /// numbers are rounded up.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a pilot below 4, which has no variance to tell of, or above `count`.
    pub fn new(count: u64, pilot: u64) -> Result<Self, Error> {
        if !(4..=count).contains(&pilot) {
            let given = format_args!("{pilot} of {count}");
            return Err(Error::refused(
                "number of pilot samples",
                "from 4 to the count",
                given,
            ));
        }
        Ok(Self {
            mean: count.div_ceil(2),
            pilot: pilot.div_ceil(2),
        })
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// The picture with independent samples, more of them where it varies more: see [`Adaptive`].
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render).
    pub fn render_adaptive(
        &self,
        size: [u32; 2],
        seed: u64,
        adaptive: Adaptive,
    ) -> Result<Adapted, Unfinished> {
        let Adaptive { mean, pilot } = adaptive;
        let looked = |half: u64| {
            let pilot = |key| MonteCarlo::new(pilot, hash::hash(key, half));
            self.render(size, seed, pilot)
        };
        let pilots = [looked(0)?, looked(1)?];
        // Crosswise.
        let counts = [&pilots[1], &pilots[0]].map(|other| counts(other, mean, pilot));
        let place = |[x, y]: [u32; 2]| y as usize * size[0] as usize + x as usize;
        let errors = [0, 1].map(|half| pilots[half].std_error());
        let estimate = |position, key| -> Outcome<Vec3> {
            let place = place(position);
            let mut halves = [0, 1].map(|half| Part {
                count: pilot,
                mean: pilots[half].pixels()[place],
                std_error: errors[half]
                    .as_ref()
                    .map_or(DVec3::ZERO, |e| e.pixels()[place]),
            });
            for (half, part) in (0..).zip(&mut halves) {
                let more = counts[half][place] - pilot;
                if more > 0 {
                    let production = MonteCarlo::new(more, hash::hash(key, 2 + half as u64));
                    *part = part.and(&Part::of(
                        &production.estimate(&self.pixel(position, size))?,
                    ));
                }
            }
            let [one, other] = halves;
            let mut estimate =
                Estimate::new(0.5 * (one.mean + other.mean), one.count + other.count);
            let squares = one.std_error * one.std_error + other.std_error * other.std_error;
            estimate.std_error = Some(0.5 * squares.map(f64::sqrt));
            estimate.error_bar = ErrorBar::SampleVariance;
            Ok(estimate)
        };
        let image = Image::of_pixels(size, seed, estimate)?;
        let [one, other] = counts;
        let samples = one
            .iter()
            .zip(other)
            .map(|(one, other)| one + other)
            .collect();
        Ok(Adapted { image, samples })
    }
}

/// What some independent samples gave.
#[derive(Clone, Copy)]
struct Part {
    count: u64,
    mean: DVec3,
    std_error: DVec3,
}

impl Part {
    fn of(estimate: &Estimate<DVec3>) -> Self {
        Self {
            count: estimate.used,
            mean: estimate.mean,
            std_error: estimate.std_error.unwrap_or(DVec3::ZERO),
        }
    }

    /// Both together, as if their samples had been one list.[^chan]
    ///
    /// [^chan]: Chan, Tony; Golub, Gene; LeVeque, Randall (1983). *Algorithms for Computing the Sample Variance*.
    ///     <https://doi.org/10.1080/00031305.1983.10483115>
    fn and(&self, other: &Self) -> Self {
        let (here, there) = (self.count as f64, other.count as f64);
        let all = here + there;
        let delta = other.mean - self.mean;
        let squares = self.std_error * self.std_error * (here * (here - 1.0))
            + other.std_error * other.std_error * (there * (there - 1.0))
            + delta * delta * (here * there / all);
        Self {
            count: self.count + other.count,
            mean: self.mean + delta * (there / all),
            std_error: (squares / (all * (all - 1.0))).map(f64::sqrt),
        }
    }
}

/// How many samples each pixel gets, `mean` in the mean and `least` at least, in proportion to the standard deviations that
/// `pilot` shows: root mean squares over the 3 by 3 pixels around, since few samples may have missed what is rare.
fn counts(pilot: &Image, mean: u64, least: u64) -> Vec<u64> {
    let errors = pilot.std_error().unwrap_or_else(|| pilot.clone());
    let (width, height) = (errors.width(), errors.height());
    let variance: Vec<f64> = errors.pixels().iter().map(|e| e.length_squared()).collect();
    let around = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let deviations: Vec<f64> = (0..variance.len())
        .map(|place| {
            let (columns, rows) = (around(place % width, width), around(place / width, height));
            let pixels = (rows.len() * columns.len()) as f64;
            let squares: f64 = rows
                .flat_map(|y| variance[y * width..][columns.clone()].iter())
                .sum();
            (squares / pixels).sqrt()
        })
        .collect();
    let shares = water_level(&deviations, mean as f64, least as f64);
    // Rounded so that the sums of all pixels so far are right to half a sample, hence the whole is.
    let (mut wanted, mut given) = (0.0, 0);
    shares
        .map(|share| {
            wanted += share;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "positive, and saturates"
            )]
            let count = ((wanted - given as f64).round() as u64).max(least);
            given += count;
            count
        })
        .collect()
}

/// Shares in proportion to `weights`, none below `least`, whose mean is `mean`.
fn water_level(weights: &[f64], mean: f64, least: f64) -> impl Iterator<Item = f64> {
    let total = mean * weights.len() as f64;
    let sum: f64 = weights.iter().sum();
    let even = !(sum > 0.0 && sum.is_finite());
    // The sum grows with the factor; where all are at the least it is too small, without a least it is too large.
    let (mut low, mut high) = (0.0, total / sum);
    for _ in 0..100 {
        let factor = 0.5 * (low + high);
        let given: f64 = weights
            .iter()
            .map(|weight| (factor * weight).max(least))
            .sum();
        if given > total {
            high = factor;
        } else {
            low = factor;
        }
    }
    weights.iter().map(move |weight| {
        if even {
            mean
        } else {
            (low * weight).max(least)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::scenes;
    use crate::points::pixel;

    #[test]
    fn shares_are_in_proportion_above_the_least() {
        let shares: Vec<f64> = water_level(&[0.0, 1.0, 2.0, 3.0], 10.0, 4.0).collect();
        // 4 + 36 / 6 (1 + 2 + 3).
        for (share, expected) in shares.iter().zip([4.0, 6.0, 12.0, 18.0]) {
            assert!((share - expected).abs() < 1e-9, "{shares:?}");
        }
        let even: Vec<f64> = water_level(&[0.0; 3], 5.0, 2.0).collect();
        assert_eq!(even, [5.0; 3]);
    }

    #[test]
    fn parts_are_merged_as_lists_are() {
        let part = |values: &[f64]| {
            let moments: crate::Moments<f64> = values.iter().copied().collect();
            Part {
                count: moments.count(),
                mean: DVec3::splat(moments.mean()),
                std_error: DVec3::splat(moments.std_error().unwrap_or(0.0)),
            }
        };
        let merged = part(&[1.0, 4.0, 2.0]).and(&part(&[7.0]));
        let whole = part(&[1.0, 4.0, 2.0, 7.0]);
        assert_eq!(merged.count, 4);
        assert!((merged.mean - whole.mean).length() < 1e-15);
        assert!((merged.std_error - whole.std_error).length() < 1e-15);
    }

    #[test]
    fn the_budget_is_met_and_goes_where_the_noise_is() {
        let view = scenes::cornell_box();
        let adapted = view
            .render_adaptive([32, 32], 1, Adaptive::new(32, 8).unwrap())
            .unwrap();
        assert_eq!(adapted.samples.iter().sum::<u64>(), 32 * 32 * 32);
        assert_eq!(adapted.image.used(), 32 * 32 * 32);
        assert!(adapted.samples.iter().all(|&count| count >= 8));
        assert!(adapted.samples.iter().any(|&count| count > 64));
        // The samples are those of the pilot where there is no room for more.
        let least = view
            .render_adaptive([4, 4], 1, Adaptive::new(8, 8).unwrap())
            .unwrap();
        assert_eq!(least.samples, [8; 16]);
        assert!(Adaptive::new(8, 3).is_err() && Adaptive::new(8, 9).is_err());
    }

    #[test]
    fn a_pixel_is_what_its_halves_say() {
        // Every sample of a furnace has the mean 1, so that whatever is done to the means of halves keeps it.
        let view = scenes::furnace();
        let adapted = view
            .render_adaptive([16, 16], 3, Adaptive::new(256, 64).unwrap())
            .unwrap();
        let errors = adapted.image.std_error().unwrap();
        let squares: f64 = errors.pixels().iter().map(|error| error.x * error.x).sum();
        let z = (adapted.image.mean().x - 1.0) / (squares.sqrt() / 256.0);
        assert!(z.abs() < 4.6, "{z}");
        let key = pixel::seed([0, 0], 3);
        let half = |half| {
            MonteCarlo::new(32, hash::hash(key, half)).estimate(&view.pixel([0, 0], [16, 16]))
        };
        assert!(half(0).unwrap().mean != half(1).unwrap().mean);
    }
}
