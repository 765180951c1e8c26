//! Points for all pixels of an image at once, whose errors are spread as blue noise.

use core::ops::Range;

use super::PointSet;
use super::block::Block;
use super::scramble::{Columns, DigitOrder, scramble_reversed};
use super::sobol::{multiplied, table};
use crate::Error;
use crate::hash::{hash, permute, unit};

/// One net for all pixels of an image, dealt to them along a shuffled Morton curve: neighbouring pixels get points
/// that complement one another.[^ahmed]
///
/// Each pixel's own points are a net; so are those of every aligned square of 2 by 2, 4 by 4 and more pixels together. The
/// error of the image is thereby of high frequency, blue noise, which the eye and every filter average away. At few
/// samples a pixel it looks markedly better than independent pixels; the error of a single pixel is the same. The
/// benefit is lost when rendering stops before all samples of a pixel are taken.
///
/// Dimensions come in pairs, each a net of its own in two dimensions with an order of its own: any number of them.
/// [`pixel`](Self::pixel) gives the points of one pixel.
///
/// ```
/// use estimand::points::{BlueNoise, PointSet};
///
/// let image = BlueNoise::new(4, 1)?;
/// let points = image.pixel([3, 5]);
/// assert_eq!(points.size(), Some(4));
/// assert!((0.0..1.0).contains(&points.coordinate(3, 10)));
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^ahmed]: Ahmed, Abdalla; Wonka, Peter (2020). *Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via
///     Hierarchical Ordering of Pixels*. <https://doi.org/10.1145/3414685.3417881>
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct BlueNoise {
    /// Those of a pair, for digits of which the first is the lowest bit.
    matrices: &'static [Columns],
    /// The logarithm of the number of samples for each pixel.
    samples: u32,
    seed: u64,
}

impl BlueNoise {
    /// `samples` samples for each pixel, with the points that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a number of samples that is no power of two, or above 2^32.
    pub fn new(samples: u64, seed: u64) -> Result<Self, Error> {
        if !(samples.is_power_of_two() && samples <= 1 << 32) {
            return Err(Error::refused(
                "number of samples for each pixel",
                "a power of two up to 2^32",
                samples,
            ));
        }
        Ok(Self {
            matrices: table(2, DigitOrder::FirstLowest),
            samples: samples.trailing_zeros(),
            seed,
        })
    }

    /// The points of the pixel `pixel`, whose coordinates are taken modulo 2^16.
    pub fn pixel(&self, pixel: [u32; 2]) -> BlueNoisePixel {
        BlueNoisePixel {
            image: *self,
            first: morton(pixel) << self.samples,
        }
    }
}

/// The place of a pixel on the Morton curve: the low 16 bits of its coordinates, interleaved.
fn morton(pixel: [u32; 2]) -> u64 {
    let [x, y] = pixel.map(|coordinate| {
        (0..16).fold(0, |spread, bit| {
            spread | (u64::from(coordinate) >> bit & 1) << (2 * bit)
        })
    });
    x | y << 1
}

/// The points of one pixel of an image, made by [`BlueNoise::pixel`].
///
/// An index at or past the size belongs to another, independent image.
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct BlueNoisePixel {
    image: BlueNoise,
    first: u64,
}

impl BlueNoisePixel {
    /// The points in the dimensions `2 pair` and `2 pair + 1`, of the image number `image`.
    #[inline]
    fn pair(&self, image: u64, pair: u32) -> Pair {
        let BlueNoise {
            matrices,
            samples,
            seed,
        } = self.image;
        let key = hash(hash(seed, image), u64::from(pair));
        Pair {
            matrices,
            samples,
            key,
            pixel: Curve::START.followed_by(self.first >> samples, 32, key),
        }
    }
}

impl PointSet for BlueNoisePixel {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let pair = self.pair(index >> self.image.samples, dimension / 2);
        pair.coordinate(pair.place(index), dimension % 2)
    }

    fn size(&self) -> Option<u64> {
        Some(1 << self.image.samples)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let block = Block::new(first, dimensions, out, u32::MAX, 0);
        let Range { start, end } = block.dimensions;
        let size = 1 << self.image.samples;
        let (mut index, mut out) = (first, block.out);
        while !out.is_empty() {
            // The rows of one image after the other.
            let left = size - (index & (size - 1));
            let room = usize::try_from(left).unwrap_or(usize::MAX);
            let (now, later) = out.split_at_mut(out.len().min(room.saturating_mul(block.width)));
            for pair in start / 2..end.div_ceil(2) {
                let axes = start.max(2 * pair)..end.min((2 * pair).saturating_add(2));
                let pair = self.pair(index >> self.image.samples, pair);
                for (row, sample) in now.chunks_exact_mut(block.width).zip(index..) {
                    let place = pair.place(sample);
                    for dimension in axes.clone() {
                        row[(dimension - start) as usize] = pair.coordinate(place, dimension % 2);
                    }
                }
            }
            index = index.wrapping_add(left);
            out = later;
        }
    }
}

/// A net in two dimensions, and the place of a pixel in it.
struct Pair {
    matrices: &'static [Columns],
    samples: u32,
    key: u64,
    pixel: Curve,
}

impl Pair {
    /// The place in the net of a sample of the pixel: only the lowest bits of the index count.
    #[inline]
    fn place(&self, index: u64) -> u64 {
        self.pixel
            .followed_by(index, self.samples, self.key)
            .shuffled
    }

    #[inline]
    fn coordinate(&self, place: u64, axis: u32) -> f64 {
        unit(scramble_reversed(
            multiplied(&self.matrices[axis as usize], place),
            hash(!self.key, u64::from(axis)),
        ))
    }
}

/// A place on the Morton curve whose digits in base 4 are permuted, each by a permutation that those above it choose: the four
/// squares that make a larger one, and the samples of a pixel, come in an order of their own everywhere.
#[derive(Clone, Copy)]
struct Curve {
    /// The digits as they were, after a one that tells how many they are.
    digits: u64,
    shuffled: u64,
}

impl Curve {
    /// Before the first digit.
    const START: Self = Self {
        digits: 1,
        shuffled: 0,
    };

    /// With the lowest `bits` bits of `word` as its next digits. Where their number is odd, the last digit is in base 2.
    #[inline]
    fn followed_by(self, word: u64, bits: u32, key: u64) -> Self {
        let Self {
            mut digits,
            mut shuffled,
        } = self;
        let mut left = bits;
        while left > 0 {
            let width = left.min(2);
            left -= width;
            let digit = word >> left & ((1 << width) - 1);
            let image = permute(digit, 1 << width, hash(key, digits));
            shuffled = shuffled << width | image;
            digits = digits << width | digit;
        }
        Self { digits, shuffled }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_square_of_pixels_has_a_net() {
        for samples in [1, 2, 4, 8] {
            let image = BlueNoise::new(samples, 7).unwrap();
            for (side, [x0, y0]) in [(1, [5, 2]), (2, [6, 2]), (4, [8, 20])] {
                let pixels = (0..side * side).map(|k| [x0 + k % side, y0 + k / side]);
                let count = samples * u64::from(side * side);
                for pair in [0, 4] {
                    let points: Vec<[f64; 2]> = pixels
                        .clone()
                        .flat_map(|pixel| {
                            let points = image.pixel(pixel);
                            (0..samples)
                                .map(|sample| {
                                    [0, 1].map(|d| points.coordinate(sample, 2 * pair + d))
                                })
                                .collect::<Vec<_>>()
                        })
                        .collect();
                    let levels = count.trailing_zeros();
                    for level in 0..=levels {
                        let (columns, rows) =
                            (f64::from(1 << level), f64::from(1 << (levels - level)));
                        let mut cells: Vec<[u64; 2]> = points
                            .iter()
                            .map(|[u, v]| {
                                [
                                    (u * columns).floor().to_bits(),
                                    (v * rows).floor().to_bits(),
                                ]
                            })
                            .collect();
                        cells.sort_unstable();
                        cells.dedup();
                        assert_eq!(cells.len() as u64, count, "{samples} {side} {level}");
                    }
                }
            }
        }
    }

    #[test]
    fn other_numbers_of_samples_are_refused() {
        for samples in [0, 3, 1 << 33] {
            assert!(BlueNoise::new(samples, 1).is_err());
        }
        let many = BlueNoise::new(1 << 32, 1).unwrap();
        let u = many.pixel([u32::MAX; 2]).coordinate(u64::MAX, 1);
        assert!((0.0..1.0).contains(&u));
    }
}
