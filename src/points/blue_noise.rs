//! Points for all pixels of an image at once, whose errors are spread as blue noise.

use core::ops::Range;

use super::PointSet;
use super::block::{Block, TOGETHER, vectorised};
use super::scramble::scramble_reversed;
use crate::Error;
use crate::hash::{hash, hash_prepared, prepare, unit};

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
            samples: samples.trailing_zeros(),
            seed,
        })
    }

    /// The points of the pixel `pixel`, whose coordinates are taken modulo 2^16.
    pub fn pixel(&self, pixel: [u32; 2]) -> BlueNoisePixel {
        BlueNoisePixel {
            image: *self,
            pixel: morton(pixel),
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
    /// The place of the pixel on the Morton curve.
    pixel: u64,
}

impl BlueNoisePixel {
    /// The points in the `N` dimensions from `first` on, of the image number `image`.
    #[inline(always)]
    fn axes<const N: usize>(&self, image: u64, first: u32) -> Axes<N> {
        let image = hash(self.image.seed, image);
        let (mut prepared, mut scrambles, mut second) = ([0; N], [0; N], [0; N]);
        for (lane, above) in (0..N).zip(0..) {
            // Those past the last dimension are not asked for.
            let dimension = first.wrapping_add(above);
            let key = hash(image, u64::from(dimension / 2));
            prepared[lane] = prepare(key);
            scrambles[lane] = hash(!key, u64::from(dimension % 2));
            second[lane] = u64::from(dimension % 2).wrapping_neg();
        }
        let curve = Curve {
            prepared,
            digits: 1,
            shuffled: [0; N],
        };
        Axes {
            scrambles,
            second,
            curve: curve.followed_by(self.pixel, 32),
        }
    }
}

impl PointSet for BlueNoisePixel {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let samples = self.image.samples;
        let axes = self.axes::<1>(index >> samples, dimension);
        axes.coordinates(axes.curve.followed_by(index, samples).shuffled)[0]
    }

    fn size(&self) -> Option<u64> {
        Some(1 << self.image.samples)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(first, dimensions, out, u32::MAX, 0);
        // For all tiles: it takes a while to clear it.
        let mut places = [[0; TOGETHER]; SAMPLES];
        vectorised(
            #[inline(always)]
            || {
                for first in block.dimensions.clone().step_by(TOGETHER) {
                    self.fill_tile(&mut block, first, &mut places);
                }
            },
        );
    }
}

/// Samples whose places on the curve are found together.
const SAMPLES: usize = 64;

impl BlueNoisePixel {
    /// Writes the coordinates in the dimensions from `first` on, [`TOGETHER`] at most, into their columns of the block.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "below the number of samples"
    )]
    fn fill_tile(
        &self,
        block: &mut Block<'_>,
        first: u32,
        places: &mut [[u64; TOGETHER]; SAMPLES],
    ) {
        let samples = self.image.samples;
        let Range { start, end } = block.dimensions;
        let columns = (first - start) as usize
            ..(end.min(first.saturating_add(TOGETHER as u32)) - start) as usize;
        // The digits of an index in base 4 begin at its highest bit, so that blocks that share all but the last few of them have as
        // many bits as are left over from base 4, and an even number.
        let bits = samples.min(SAMPLES.ilog2() - samples % 2);
        let mut axes: Option<(u64, Axes<TOGETHER>)> = None;
        let (mut index, mut out) = (block.first, &mut *block.out);
        while !out.is_empty() {
            let image = index >> samples;
            let axes = match &axes {
                Some((of, axes)) if *of == image => axes,
                _ => &axes.insert((image, self.axes(image, first))).1,
            };
            let curve = axes.curve.followed_by(index >> bits, samples - bits);
            curve.followed_by_all(bits, places);
            let place = (index % (1 << bits)) as usize;
            let places = &mut places[place..1 << bits];
            let now = places.len().min(out.len() / block.width);
            let (rows, later) = out.split_at_mut(now * block.width);
            let rows = rows.chunks_exact_mut(block.width);
            if columns.len() == TOGETHER {
                for (row, &mut place) in rows.zip(places) {
                    row[columns.start..][..TOGETHER].copy_from_slice(&axes.coordinates(place));
                }
            } else {
                // Whole vectors first, in the place of what they are made of: some of each is left out.
                for place in places.iter_mut().take(now) {
                    *place = axes.coordinates(*place).map(f64::to_bits);
                }
                for (row, bits) in rows.zip(places) {
                    for (u, &bits) in row[columns.clone()].iter_mut().zip(bits.iter()) {
                        *u = f64::from_bits(bits);
                    }
                }
            }
            index = index.wrapping_add(now as u64);
            out = later;
        }
    }
}

/// Some dimensions of an image, each of a net in two, and the place of a pixel in them.
struct Axes<const N: usize> {
    /// What selects the scrambles.
    scrambles: [u64; N],
    /// All bits, where a dimension is the second of its net.
    second: [u64; N],
    /// Up to the pixel.
    curve: Curve<N>,
}

impl<const N: usize> Axes<N> {
    /// The coordinates of the samples at some places on the curve.
    #[inline(always)]
    fn coordinates(&self, places: [u64; N]) -> [f64; N] {
        let mut digits = places;
        for (digits, &second) in digits.iter_mut().zip(&self.second) {
            *digits = pascal(*digits, second);
        }
        let mut coordinates = [0.0; N];
        let keyed = digits.into_iter().zip(&self.scrambles);
        for (u, (digits, &key)) in coordinates.iter_mut().zip(keyed) {
            *u = unit(scramble_reversed(digits, key));
        }
        coordinates
    }
}

/// The second dimension of Sobol's points: the digits that its generator matrix, Pascal's triangle modulo 2, makes of the
/// bits of an index, the first digit in the lowest bit. The first dimension has the bits themselves: `second` has no bits for
/// that one, and all for the other.
///
/// The triangle is made of four squares, three of which are alike and one is 0; so are they in turn.
#[inline(always)]
const fn pascal(mut word: u64, second: u64) -> u64 {
    word ^= word >> 32 & second;
    word ^= word >> 16 & 0x0000_ffff_0000_ffff & second;
    word ^= word >> 8 & 0x00ff_00ff_00ff_00ff & second;
    word ^= word >> 4 & 0x0f0f_0f0f_0f0f_0f0f & second;
    word ^= word >> 2 & 0x3333_3333_3333_3333 & second;
    word ^ word >> 1 & 0x5555_5555_5555_5555 & second
}

/// A place on the Morton curve whose digits in base 4 are permuted, each by a permutation that those above it choose: the four
/// squares that make a larger one, and the samples of a pixel, come in an order of their own everywhere. So it does in
/// each of some dimensions.
#[derive(Clone, Copy)]
struct Curve<const N: usize> {
    /// What selects the permutations.
    prepared: [u64; N],
    /// The digits as they were, after a one that tells how many they are.
    digits: u64,
    shuffled: [u64; N],
}

impl<const N: usize> Curve<N> {
    /// With the lowest `bits` bits of `word`, 32 at most, as its next digits. Where their number is odd, the last digit is in base 2.
    #[inline(always)]
    fn followed_by(mut self, word: u64, bits: u32) -> Self {
        if bits == 0 {
            return self;
        }
        // In memory, digit by digit: what goes from one digit to the next lane by lane would not be computed in vectors.
        let mut images = [[0; N]; 16];
        let mut left = bits;
        let mut done = 0;
        while left > 0 {
            let base = left.min(2);
            left -= base;
            let digit = word >> left & ((1 << base) - 1);
            images[done] = self.order().images([0; N], digit, base);
            for image in &mut images[done] {
                *image <<= left;
            }
            done += 1;
            self.digits = self.digits << base | digit;
        }
        for place in &mut self.shuffled {
            *place <<= bits;
        }
        for images in &images[..done] {
            for (place, image) in self.shuffled.iter_mut().zip(images) {
                *place |= image;
            }
        }
        self
    }

    /// What it becomes when all numbers of `bits` bits, those of a sample at most, come next.
    #[inline(always)]
    fn followed_by_all(&self, bits: u32, places: &mut [[u64; N]; SAMPLES]) {
        places[0] = self.shuffled;
        let mut done = 0;
        while done < bits {
            let base = (bits - done).min(2);
            // From the last ones on, since what they become takes more room, and from their place on.
            for node in (0..1_usize << done).rev() {
                let (before, order) = (places[node], self.following(node as u64, done).order());
                let images = &mut places[node << base..][..1 << base];
                for (image, digit) in images.iter_mut().zip(0..) {
                    *image = order.images(before, digit, base);
                }
            }
            done += base;
        }
    }

    /// With other digits after its own, of which nothing is shuffled.
    #[inline(always)]
    fn following(&self, digits: u64, bits: u32) -> Self {
        Self {
            digits: self.digits << bits | digits,
            ..*self
        }
    }

    /// The permutations of the digit that comes after the `digits`.
    #[inline(always)]
    fn order(&self) -> Order<N> {
        let mut order = Order {
            shifts: [0; N],
            linear: [0; N],
        };
        let lanes = order.shifts.iter_mut().zip(&mut order.linear);
        for ((shift, linear), &prepared) in lanes.zip(&self.prepared) {
            let word = hash_prepared(prepared, self.digits);
            let map = ((word & 0xffff_ffff) * 6) >> 32;
            (*shift, *linear) = (word >> 62, LINEAR >> (8 * map));
        }
        order
    }
}

/// Permutations of the digits below 4: all of them are affine maps of two bits. For a digit below 2 a shift by the upper bit does.
struct Order<const N: usize> {
    shifts: [u64; N],
    /// The images of the four digits under a linear map, two bits each, and more that has no meaning.
    linear: [u64; N],
}

/// The six invertible maps of two bits: each has the images of 0, 1, 2 and 3.
const LINEAR: u64 = {
    let (mut maps, mut word) = (0, 0);
    // Images of 1 and of 2 that are neither 0 nor alike.
    let mut pair = 0;
    while pair < 16 {
        let (one, two) = (pair % 4, pair / 4);
        if one != 0 && two != 0 && one != two {
            word |= (one << 2 | two << 4 | (one ^ two) << 6) << (8 * maps);
            maps += 1;
        }
        pair += 1;
    }
    word
};

impl<const N: usize> Order<N> {
    /// Some places, each followed by the image of `digit`, which is one of `base` bits.
    #[inline(always)]
    fn images(&self, mut places: [u64; N], digit: u64, base: u32) -> [u64; N] {
        let lanes = self.shifts.iter().zip(&self.linear);
        for (place, (shift, linear)) in places.iter_mut().zip(lanes) {
            let image = if base == 2 {
                (linear >> (2 * digit) & 3) ^ shift
            } else {
                digit ^ (shift >> 1)
            };
            *place = *place << base | image;
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::scramble::DigitOrder;
    use crate::points::sobol::{multiplied, table};

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
    fn every_permutation_is_as_likely_as_the_others() {
        // Chi-square with 23 and 1 degrees of freedom; the bounds have a false-positive rate of 1e-6 each.
        const KEYS: u32 = 24_000;
        for (base, likely, bound) in [(2, 24, 70.6), (1, 2, 23.9)] {
            let mut seen = std::collections::BTreeMap::new();
            for key in (0..KEYS).map(u64::from) {
                let curve = Curve {
                    prepared: [prepare(hash(3, key))],
                    // After some digits, or none.
                    digits: 1 + key % 3,
                    shuffled: [0],
                };
                let images: Vec<_> = (0..1 << base)
                    .map(|digit| curve.followed_by(digit, base).shuffled)
                    .collect();
                *seen.entry(images).or_insert(0) += 1;
            }
            assert_eq!(seen.len(), likely);
            let expected = f64::from(KEYS) / likely as f64;
            let squares = seen
                .values()
                .map(|&count: &u32| (f64::from(count) - expected).powi(2) / expected);
            assert!(squares.sum::<f64>() < bound, "{seen:?}");
            for images in seen.keys() {
                let mut sorted = images.clone();
                sorted.sort_unstable();
                assert!(sorted.iter().map(|[image]| *image).eq(0..1 << base));
            }
        }
    }

    #[test]
    fn the_axes_are_those_of_sobol() {
        let sobol = table(2, DigitOrder::FirstLowest);
        for word in (0..200).map(|word| hash(4, word)) {
            assert_eq!(multiplied(&sobol[0], word), pascal(word, 0));
            assert_eq!(multiplied(&sobol[1], word), pascal(word, u64::MAX));
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
