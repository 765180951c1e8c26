//! Points for all pixels of an image at once, whose errors are spread as blue noise.

mod curve;

use core::ops::Range;

use super::PointSet;
use super::block::{Block, TOGETHER, vectorised};
use super::scramble::scramble_reversed;
use crate::Error;
use crate::hash::{hash, prepare, unit};

use curve::{Curve, SAMPLES};

/// One net for all pixels of an image, dealt to them along a shuffled Morton curve: neighbouring pixels get points
/// that complement one another.[^ahmed]
///
/// Each pixel's own points are a net; so are those of every aligned square of 2 by 2, 4 by 4 and up to 256 by 256 pixels together. The
/// error of the image is thereby of high frequency, blue noise, which the eye and every filter average away. At few
/// samples a pixel it looks markedly better than independent pixels; the error of a single pixel is the same. The
/// benefit is lost when rendering stops before all samples of a pixel are taken.
///
/// Pixels complement one another in the first 16 dimensions, which decide most of an image, and within squares of 256 by 256 pixels. Otherwise their
/// nets know nothing of one another, which takes about half the time where coordinates are computed one by one.
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

/// Dimensions in which pixels complement one another.
const SHARED: u32 = 16;

/// Pixels that do: those of a square, 256 in a row.
const TILE: u64 = 1 << 16;

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
    /// The points in the `N` dimensions from `first` on, of the image number `image`; if the first of them is shared among pixels, those that
    /// are not are not to be asked for.
    #[inline(always)]
    fn axes<const N: usize>(&self, image: u64, first: u32) -> Axes<N> {
        let image = hash(self.image.seed, image);
        let shared = first < SHARED;
        // What pixels have in common that share dimensions, or the pixel alone.
        let own = if shared {
            self.pixel / TILE
        } else {
            self.pixel
        };
        let own = hash(hash(image, shared.into()), own);
        let (mut prepared, mut scrambles, mut second) = ([0; N], [0; N], [0; N]);
        for (lane, above) in (0..N).zip(0..) {
            // Those past the last dimension are not asked for.
            let dimension = first.wrapping_add(above);
            let key = hash(own, u64::from(dimension / 2));
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
            curve: match shared {
                true => curve.followed_by(self.pixel % TILE, TILE.ilog2()),
                false => curve,
            },
        }
    }
}

impl PointSet for BlueNoisePixel {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        let samples = self.image.samples;
        let axes = self.axes::<1>(index >> samples, dimension);
        let place = axes.curve.followed_by(index, samples).shuffled;
        axes.coordinates(axes.digits(place))[0]
    }

    fn size(&self) -> Option<u64> {
        Some(1 << self.image.samples)
    }

    #[expect(clippy::cast_possible_truncation, reason = "a small number")]
    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(first, dimensions, out, u32::MAX, 0);
        // For all tiles: it takes a while to clear it.
        let mut places = [[0; TOGETHER]; SAMPLES];
        vectorised(
            #[inline(always)]
            || {
                let Range { start, end } = block.dimensions;
                for part in [start..end.min(SHARED), start.max(SHARED)..end] {
                    for first in part.clone().step_by(TOGETHER) {
                        let tile = first..part.end.min(first.saturating_add(TOGETHER as u32));
                        self.fill_tile(&mut block, tile, &mut places);
                    }
                }
            },
        );
    }
}

impl BlueNoisePixel {
    /// Writes the coordinates in the dimensions of a tile, [`TOGETHER`] at most, into their columns of the block.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "below the number of samples"
    )]
    fn fill_tile(
        &self,
        block: &mut Block<'_>,
        tile: Range<u32>,
        places: &mut [[u64; TOGETHER]; SAMPLES],
    ) {
        debug_assert!(
            tile.start >= SHARED || tile.end <= SHARED,
            "all of {tile:?} shared, or none"
        );
        let samples = self.image.samples;
        let start = block.dimensions.start;
        let columns = (tile.start - start) as usize..(tile.end - start) as usize;
        // The digits of an index in base 4 begin at its highest bit, so that blocks that share all but the last few of them have as
        // many bits as are left over from base 4, and an even number.
        let bits = samples.min(SAMPLES.ilog2() - samples % 2);
        let mut axes: Option<(u64, Axes<TOGETHER>)> = None;
        let (mut index, mut out) = (block.first, &mut *block.out);
        while !out.is_empty() {
            let image = index >> samples;
            let axes = match &axes {
                Some((of, axes)) if *of == image => axes,
                _ => &axes.insert((image, self.axes(image, tile.start))).1,
            };
            let curve = axes.curve.followed_by(index >> bits, samples - bits);
            // What the points have in common, and what tells them apart.
            let common = axes.digits(curve.shuffled.map(|place| place << bits));
            curve.all_that_follow(bits, places);
            let place = (index % (1 << bits)) as usize;
            let places = &mut places[place..1 << bits];
            let now = places.len().min(out.len() / block.width);
            let (rows, later) = out.split_at_mut(now * block.width);
            let rows = rows.chunks_exact_mut(block.width);
            if columns.len() == TOGETHER {
                for (row, &mut place) in rows.zip(places) {
                    let coordinates = axes.coordinates(axes.digits_near(place, &common));
                    row[columns.start..][..TOGETHER].copy_from_slice(&coordinates);
                }
            } else {
                // Whole vectors first, in the place of what they are made of: some of each is left out.
                for place in places.iter_mut().take(now) {
                    let coordinates = axes.coordinates(axes.digits_near(*place, &common));
                    *place = coordinates.map(f64::to_bits);
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
    /// The digits of the samples at some places on the curve.
    #[inline(always)]
    fn digits(&self, mut places: [u64; N]) -> [u64; N] {
        for (digits, &second) in places.iter_mut().zip(&self.second) {
            *digits = pascal(*digits, second);
        }
        places
    }

    /// The same of places of 8 bits at most after those that have some digits in common.
    #[inline(always)]
    fn digits_near(&self, mut places: [u64; N], common: &[u64; N]) -> [u64; N] {
        let axes = self.second.iter().zip(common);
        for (digits, (&second, &common)) in places.iter_mut().zip(axes) {
            *digits = pascal_of_byte(*digits, second) ^ common;
        }
        places
    }

    /// The coordinates that have some digits before they are scrambled.
    #[inline(always)]
    fn coordinates(&self, digits: [u64; N]) -> [f64; N] {
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
    pascal_of_byte(word, second)
}

/// The same for each byte alone.
#[inline(always)]
const fn pascal_of_byte(mut word: u64, second: u64) -> u64 {
    word ^= word >> 4 & 0x0f0f_0f0f_0f0f_0f0f & second;
    word ^= word >> 2 & 0x3333_3333_3333_3333 & second;
    word ^ word >> 1 & 0x5555_5555_5555_5555 & second
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
            for (side, [x0, y0], pairs) in [
                (1, [5, 2], [0, 4, 8, 1000]),
                (2, [6, 2], [0, 4, 6, 7]),
                (4, [8, 20], [0, 4, 6, 7]),
            ] {
                let pixels = (0..side * side).map(|k| [x0 + k % side, y0 + k / side]);
                let count = samples * u64::from(side * side);
                for pair in pairs {
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
    fn pixels_share_some_dimensions_alone_with_those_of_their_square() {
        let images: Vec<_> = (0..20)
            .map(|seed| BlueNoise::new(1, seed).unwrap())
            .collect();
        let of = |image: &BlueNoise, pixel, dimension| {
            let points: BlueNoisePixel = image.pixel(pixel);
            points.coordinate(0, dimension)
        };
        // Whether the four pixels of a square have one quarter of the axis each.
        let is_net = |image: &BlueNoise, dimension| {
            let pixels = [[254, 2], [255, 2], [254, 3], [255, 3]];
            let quarter = |pixel| (4.0 * of(image, pixel, dimension)).floor().to_bits();
            let mut quarters = pixels.map(quarter);
            quarters.sort_unstable();
            quarters.windows(2).all(|pair| pair[0] < pair[1])
        };
        for dimension in [0, 7, 15] {
            assert!(images.iter().all(|image| is_net(image, dimension)));
        }
        // By chance with a probability of 1e-20.
        for dimension in [16, 17, 40] {
            assert!(!images.iter().all(|image| is_net(image, dimension)));
        }
        for (one, other, dimension) in [
            ([254, 3], [255, 3], 16),
            ([254, 3], [255, 3], 17),
            ([0, 3], [256, 3], 0),
            ([0, 3], [256, 3], 15),
            ([5, 0], [5, 256], 1),
        ] {
            for image in &images {
                let [one, other] = [one, other].map(|pixel| of(image, pixel, dimension));
                assert_ne!(one, other, "dimension {dimension}");
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
