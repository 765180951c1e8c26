//! Points for all pixels of an image at once, whose errors are spread as blue noise.

use core::ops::Range;

use super::PointSet;
use super::block::{Aligned, Block, Rows, TOGETHER, vectorised};
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
    /// The points in the dimensions `2 pair` and `2 pair + 1`, of the image number `image`.
    #[inline(always)]
    fn pair(&self, image: u64, pair: u32) -> Pair {
        let key = hash(hash(self.image.seed, image), u64::from(pair));
        Pair {
            axes: [0, 1].map(|axis| hash(!key, axis)),
            curve: Curve::new(key).followed_by(self.pixel, 32),
        }
    }
}

impl PointSet for BlueNoisePixel {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let samples = self.image.samples;
        let pair = self.pair(index >> samples, dimension / 2);
        let place = pair.curve.followed_by(index, samples).shuffled;
        pair.coordinate(place, dimension as usize % 2)
    }

    fn size(&self) -> Option<u64> {
        Some(1 << self.image.samples)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(first, dimensions, out, u32::MAX, 0);
        let pairs = block.dimensions.start / 2..block.dimensions.end.div_ceil(2);
        // For all tiles: it takes a while to clear it.
        let mut room = Room {
            axes: Aligned([[[0.0; LANES]; 2]; PAIRS]),
            rows: Rows::new(),
        };
        for tile in pairs.clone().step_by(PAIRS) {
            #[expect(clippy::cast_possible_truncation, reason = "below the number of lanes")]
            let pairs = tile..pairs.end.min(tile + PAIRS as u32);
            vectorised(
                #[inline(always)]
                || self.fill_tile(&mut block, pairs, &mut room),
            );
        }
    }
}

/// Room for the coordinates of some samples, axis by axis, and side by side.
struct Room {
    axes: Aligned<[[[f64; LANES]; 2]; PAIRS]>,
    rows: Rows<LANES>,
}

/// Pairs of dimensions that are computed before their coordinates are put in their places.
const PAIRS: usize = TOGETHER / 2;

/// Samples that are computed at once.
const LANES: usize = 64;

/// As many as are computed in any case: a vector of the widest.
const GROUP: usize = 8;

impl BlueNoisePixel {
    /// Writes the coordinates in the dimensions of `pairs`, [`PAIRS`] at most, into their columns of the block.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "below the number of lanes")]
    fn fill_tile(&self, block: &mut Block<'_>, pairs: Range<u32>, room: &mut Room) {
        let samples = self.image.samples;
        // The first pair may begin before the block.
        let Range { start, end } = block.dimensions;
        let first = start.max(2 * pairs.start);
        let skipped = (first - 2 * pairs.start) as usize;
        let columns =
            (first - start) as usize..(end.min(pairs.end.saturating_mul(2)) - start) as usize;
        // The digits of an index in base 4 begin at its highest bit, so that blocks that share all but the last few of them have as
        // many bits as are left over from base 4, and an even number.
        let bits = samples.min(LANES.ilog2() - samples % 2);
        let lanes = 1 << bits;
        let mut curves = [const { None }; PAIRS];
        let mut image = None;
        let (mut index, mut out) = (block.first, &mut *block.out);
        while !out.is_empty() {
            if image != Some(index >> samples) {
                image = Some(index >> samples);
                for (place, pair) in curves.iter_mut().zip(pairs.clone()) {
                    *place = Some(self.pair(index >> samples, pair));
                }
            }
            for (pair, room) in curves.iter().flatten().zip(&mut room.axes.0) {
                pair.write(index >> bits, samples - bits, bits, room);
            }
            let place = (index % lanes) as usize;
            let now = (lanes as usize - place).min(out.len() / block.width);
            let (rows, later) = out.split_at_mut(now * block.width);
            let rows = rows.chunks_exact_mut(block.width);
            let axes = room.axes.0.as_flattened();
            let coordinates =
                core::array::from_fn(|axis| &axes[(axis + skipped).min(axes.len() - 1)]);
            room.rows.write(coordinates, place, rows, columns.clone());
            index = index.wrapping_add(now as u64);
            out = later;
        }
    }
}

/// A net in two dimensions, and the place of a pixel in it.
struct Pair {
    /// What selects the scrambles.
    axes: [u64; 2],
    /// Up to the pixel.
    curve: Curve,
}

impl Pair {
    #[inline(always)]
    fn coordinate(&self, place: u64, axis: usize) -> f64 {
        let digits = if axis == 0 { place } else { pascal(place) };
        unit(scramble_reversed(digits, self.axes[axis]))
    }

    /// Writes the coordinates of all samples with the lowest `above` bits of `index` before their last `bits` bits.
    #[inline(always)]
    fn write(&self, index: u64, above: u32, bits: u32, room: &mut [[f64; LANES]; 2]) {
        let curve = self.curve.followed_by(index, above);
        let places = curve.followed_by_all(bits);
        let groups = (1_usize << bits).div_ceil(GROUP);
        for (axis, room) in room.iter_mut().enumerate() {
            let places = places.as_chunks::<GROUP>().0.iter().take(groups);
            for (us, places) in room.as_chunks_mut::<GROUP>().0.iter_mut().zip(places) {
                for (u, &place) in us.iter_mut().zip(places) {
                    *u = self.coordinate(curve.shuffled << bits | u64::from(place), axis);
                }
            }
        }
    }
}

/// The second dimension of Sobol's points: the digits that its generator matrix, Pascal's triangle modulo 2, makes of the
/// bits of an index, the first digit in the lowest bit. The first dimension has the bits themselves.
///
/// The triangle is made of four squares, three of which are alike and one is 0; so are they in turn.
#[inline(always)]
const fn pascal(mut word: u64) -> u64 {
    word ^= word >> 32;
    word ^= word >> 16 & 0x0000_ffff_0000_ffff;
    word ^= word >> 8 & 0x00ff_00ff_00ff_00ff;
    word ^= word >> 4 & 0x0f0f_0f0f_0f0f_0f0f;
    word ^= word >> 2 & 0x3333_3333_3333_3333;
    word ^ word >> 1 & 0x5555_5555_5555_5555
}

/// A place on the Morton curve whose digits in base 4 are permuted, each by a permutation that those above it choose: the four
/// squares that make a larger one, and the samples of a pixel, come in an order of their own everywhere.
#[derive(Clone, Copy)]
struct Curve {
    /// What selects the permutations.
    prepared: u64,
    /// The digits as they were, after a one that tells how many they are.
    digits: u64,
    shuffled: u64,
}

impl Curve {
    /// Before the first digit.
    #[inline(always)]
    const fn new(key: u64) -> Self {
        Self {
            prepared: prepare(key),
            digits: 1,
            shuffled: 0,
        }
    }

    /// With the lowest `bits` bits of `word`, 32 at most, as its next digits. Where their number is odd, the last digit is in base 2.
    #[inline(always)]
    fn followed_by(self, word: u64, bits: u32) -> Self {
        let below = |bits: u32| (1_u64 << bits) - 1;
        let word = word & below(bits);
        let before = |left: u32| self.digits << (bits - left) | word >> left;
        let mut shuffled = self.shuffled << bits;
        // From the last digit on; all of them are independent of one another.
        let mut left = bits % 2;
        if left == 1 {
            shuffled |= permute_2(self.order(before(1)), word & 1);
        }
        while left < bits {
            let image = permute_4(self.order(before(left + 2)), word >> left & 3);
            shuffled |= image << left;
            left += 2;
        }
        Self {
            digits: self.digits << bits | word,
            shuffled,
            ..self
        }
    }

    /// What all numbers of `bits` bits, those of a lane at most, become as the next digits.
    #[expect(clippy::cast_possible_truncation, reason = "of a few bits, cut apart")]
    #[inline(always)]
    fn followed_by_all(self, bits: u32) -> [u16; LANES] {
        let mut images = [0; LANES];
        let mut done = 0;
        while done + 1 < bits {
            // From the last ones on, since what they become takes more room, and from their place on.
            for group in (0..(1_usize << done).div_ceil(GROUP)).rev() {
                let (nodes, words) = self.nodes(&images, done, group);
                let mut fours = [0; GROUP];
                for ((four, &image), &word) in fours.iter_mut().zip(&nodes).zip(&words) {
                    let image = |digit| u64::from(image) << 2 | permute_4(word, digit);
                    *four = image(0) | image(1) << 16 | image(2) << 32 | image(3) << 48;
                }
                let images = images.as_chunks_mut().0[group * GROUP..].iter_mut();
                for (images, four) in images.zip(fours) {
                    *images = [0, 16, 32, 48].map(|shift| (four >> shift) as u16);
                }
            }
            done += 2;
        }
        if done < bits {
            for group in (0..(1_usize << done).div_ceil(GROUP)).rev() {
                let (nodes, words) = self.nodes(&images, done, group);
                let images = images.as_chunks_mut().0[group * GROUP..].iter_mut();
                for ((two, image), word) in images.zip(nodes).zip(words) {
                    *two = [0, 1].map(|digit| image << 1 | permute_2(word, digit) as u16);
                }
            }
        }
        images
    }

    /// Some of the numbers of `bits` bits that may come next: what they have become, and what chooses the permutations of the digits
    /// after them.
    #[inline(always)]
    fn nodes(self, images: &[u16; LANES], bits: u32, group: usize) -> ([u16; GROUP], [u64; GROUP]) {
        let nodes = images.as_chunks().0[group];
        let mut words = [0; GROUP];
        for (word, node) in words.iter_mut().zip((group * GROUP) as u64..) {
            *word = self.order(self.digits << bits | node);
        }
        (nodes, words)
    }

    /// What chooses the permutation of the digit that comes after the `digits`.
    #[inline(always)]
    const fn order(self, digits: u64) -> u64 {
        prepare(hash_prepared(self.prepared, digits))
    }
}

/// The image of `digit`, below 4, under the permutation that [`permute`](crate::hash::permute) makes of a key that `word` is prepared from:
/// the same three swaps, without a branch.
#[inline(always)]
const fn permute_4(word: u64, digit: u64) -> u64 {
    // 2^64 / 3, rounded up, and its double.
    const THIRDS: [u64; 2] = [0x5555_5555_5555_5556, 0xaaaa_aaaa_aaaa_aaab];
    let image = swapped(digit, 3, word >> 62);
    let word = word << 2;
    let third = (word >= THIRDS[0]) as u64 + (word >= THIRDS[1]) as u64;
    let image = swapped(image, 2, third);
    swapped(image, 1, word.wrapping_mul(3) >> 63)
}

/// The same for digits below 2.
#[inline(always)]
const fn permute_2(word: u64, digit: u64) -> u64 {
    swapped(digit, 1, word >> 63)
}

/// Where a number is after `last` and `place`, which is no larger, have changed places.
#[inline(always)]
const fn swapped(number: u64, last: u64, place: u64) -> u64 {
    if number == last {
        place
    } else if number == place {
        last
    } else {
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::permute;
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
    fn digits_are_permuted_as_by_the_loop() {
        for key in (0..200).map(|key| hash(3, key)) {
            for digit in 0..4 {
                assert_eq!(permute_4(prepare(key), digit), permute(digit, 4, key));
            }
            for digit in 0..2 {
                assert_eq!(permute_2(prepare(key), digit), permute(digit, 2, key));
            }
        }
    }

    #[test]
    fn the_axes_are_those_of_sobol() {
        let sobol = table(2, DigitOrder::FirstLowest);
        for word in (0..200).map(|word| hash(4, word)) {
            assert_eq!(multiplied(&sobol[0], word), word);
            assert_eq!(multiplied(&sobol[1], word), pascal(word));
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
