//! Points for all pixels of an image at once, whose errors are spread as blue noise.

mod curve;
mod matrices;

use core::ops::Range;

use super::PointSet;
use super::block::{Block, TOGETHER, vectorised};
use super::scramble::{NestedHash, first_half};
use crate::Error;
use crate::hash::{hash, unit};

use curve::{Curve, SAMPLES};
use matrices::{TABLES, WIDTH, digits};

/// One net for all pixels of an image, dealt to them along a shuffled Morton curve: neighbouring pixels get points
/// that complement one another.[^ahmed]
///
/// In each group of four dimensions each pixel's own points are a net; so are those of every aligned square of 2 by 2, 4 by 4 and up to 256 by 256 pixels together. The
/// error of the image is thereby of high frequency, blue noise, which the eye and every filter average away. At few
/// samples a pixel it looks markedly better than independent pixels; the error of a single pixel is the same. The
/// benefit is lost when rendering stops before all samples of a pixel are taken.
///
/// Pixels complement one another in the first 16 dimensions, which decide most of an image, and within squares of 256 by 256 pixels. Otherwise their
/// nets know nothing of one another, which takes about half the time where coordinates are computed one by one.
///
/// Dimensions come in groups of four, each a net of its own with an order of its own: any number of them. The first two of a
/// group have the quality parameter 0, the last two among up to eight points, all four at most 2 among up to 128 and 3 among more: decisions in two
/// dimensions are best drawn from the first two or the last two.
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
    /// The net of the dimensions of a group, of the image number `image`, up to the pixel.
    #[inline(always)]
    fn net(&self, image: u64, group: u32) -> Net {
        let image = hash(self.image.seed, image);
        let shared = group < SHARED / WIDTH;
        // What pixels have in common that share dimensions, or the pixel alone.
        let own = if shared {
            self.pixel / TILE
        } else {
            self.pixel
        };
        // Groups that are shared and others have other numbers.
        let key = hash(hash(image, own), group.into());
        let curve = Curve::new(key);
        Net {
            key,
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
        let net = self.net(index >> samples, dimension / WIDTH);
        let place = net.curve.followed_by(index, samples).shuffled();
        let axis = dimension % WIDTH;
        unit(
            net.scramble(axis.into())
                .scrambled(digits(place)[axis as usize]),
        )
    }

    fn size(&self) -> Option<u64> {
        Some(1 << self.image.samples)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(first, dimensions, out, u32::MAX, 0);
        vectorised(
            #[inline(always)]
            || {
                let (first, end) = (block.dimensions.start / WIDTH, block.dimensions.end);
                for group in (first..end.div_ceil(WIDTH)).step_by(GROUPS) {
                    self.fill_groups(&mut block, group);
                }
            },
        );
    }
}

impl BlueNoisePixel {
    /// Writes the coordinates in the dimensions of [`GROUPS`] groups, as far as they are asked for, into their columns of the block.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "below the number of samples, and of dimensions in a row"
    )]
    fn fill_groups(&self, block: &mut Block<'_>, group: u32) {
        let samples = self.image.samples;
        let Range { start, end } = block.dimensions;
        let dimension = group * WIDTH;
        let asked = start.max(dimension)..end.min(dimension.saturating_add(TOGETHER as u32));
        let lanes = (asked.start - dimension) as usize..(asked.end - dimension) as usize;
        let column = (asked.start - start) as usize;
        // The digits of an index in base 4 begin at its highest bit, so that blocks that share all but the last few of them have as
        // many bits as are left over from base 4, and an even number.
        let bits = samples.min(SAMPLES.ilog2() - samples % 2);
        let (near, width) = (&TABLES.near, block.width);
        let mut nets: Option<(u64, [Net; GROUPS])> = None;
        let (mut index, mut out) = (block.first, &mut *block.out);
        while !out.is_empty() {
            let image = index >> samples;
            let nets = match &nets {
                Some((of, nets)) if *of == image => nets,
                _ => {
                    let mut made = [Net::default(); GROUPS];
                    for (net, next) in made.iter_mut().zip(0..) {
                        // Past the last group there are dimensions that nobody asks for.
                        *net = self.net(image, group + next);
                    }
                    &nets.insert((image, made)).1
                }
            };
            let mut common = Lanes::default();
            let mut places = [[0; SAMPLES]; GROUPS];
            for (number, (net, places)) in nets.iter().zip(&mut places).enumerate() {
                let curve = net.curve.followed_by(index >> bits, samples - bits);
                // What the points have in common, and what tells them apart.
                common.set(number, net, curve.shuffled() << bits);
                *places = curve.all_that_follow(bits);
            }
            let place = (index % (1 << bits)) as usize;
            let now = ((1 << bits) - place).min(out.len() / width);
            let (rows, later) = out.split_at_mut(now * width);
            let digits = |point: usize, group: usize| {
                near[usize::from(places[group][point % SAMPLES]) % SAMPLES]
            };
            let points = (place..).step_by(ROWS);
            for (rows, point) in rows.chunks_mut(ROWS * width).zip(points) {
                let mut apart = [[0; WIDTH as usize]; ROWS * GROUPS];
                for (number, apart) in apart.iter_mut().enumerate() {
                    *apart = digits(point + number / GROUPS, number % GROUPS);
                }
                let coordinates = common.coordinates(apart.as_flattened());
                for (row, coordinates) in rows.chunks_exact_mut(width).zip(&coordinates) {
                    // In one vector, where all are asked for.
                    if lanes.len() == TOGETHER {
                        row[column..][..TOGETHER].copy_from_slice(coordinates);
                    } else {
                        row[column..][..lanes.len()].copy_from_slice(&coordinates[lanes.clone()]);
                    }
                }
            }
            index = index.wrapping_add(now as u64);
            out = later;
        }
    }
}

/// Groups whose coordinates are computed side by side.
const GROUPS: usize = TOGETHER / WIDTH as usize;

/// Points whose coordinates are.
const ROWS: usize = 2;

/// What some points have in common, dimension by dimension, once for each of the points that go together.
#[derive(Default)]
struct Lanes {
    scrambles: [[NestedHash; TOGETHER]; ROWS],
    first: [[u32; TOGETHER]; ROWS],
    last: [[u32; TOGETHER]; ROWS],
}

impl Lanes {
    #[inline(always)]
    fn set(&mut self, group: usize, net: &Net, place: u64) {
        let lanes = group * WIDTH as usize..;
        for ((lane, axis), digits) in lanes.zip(0..).zip(digits(place)) {
            let scramble = net.scramble(axis);
            for row in 0..ROWS {
                self.scrambles[row][lane] = scramble;
                self.first[row][lane] = first_half(digits);
                self.last[row][lane] = scramble.last_half(digits);
            }
        }
    }

    /// The coordinates of the points that are told apart from others by some digits.
    #[inline(always)]
    fn coordinates(&self, apart: &[u32]) -> [[f64; TOGETHER]; ROWS] {
        let mut coordinates = [[0.0; TOGETHER]; ROWS];
        let scrambles = self.scrambles.as_flattened();
        let (first, last) = (self.first.as_flattened(), self.last.as_flattened());
        for (lane, u) in coordinates.as_flattened_mut().iter_mut().enumerate() {
            *u = unit(scrambles[lane].digits(first[lane] ^ apart[lane], last[lane]));
        }
        coordinates
    }
}

/// The net of a group of dimensions.
#[derive(Clone, Copy, Default)]
struct Net {
    key: u64,
    curve: Curve,
}

impl Net {
    #[inline(always)]
    fn scramble(&self, axis: u64) -> NestedHash {
        NestedHash::new(hash(!self.key, axis))
    }
}

#[cfg(test)]
mod tests {
    use core::array;

    use super::*;

    /// How many of the points are in each of the boxes that halve the axes so many times, if it is the same number everywhere.
    fn equal_counts(points: &[[f64; 4]], halvings: [i32; 4]) -> Option<usize> {
        let mut counts = std::collections::BTreeMap::new();
        for point in points {
            let cell: [u64; 4] =
                array::from_fn(|axis| (point[axis] * 2_f64.powi(halvings[axis])).floor().to_bits());
            *counts.entry(cell).or_insert(0) += 1;
        }
        let count = points.len() >> halvings.iter().sum::<i32>();
        counts
            .values()
            .all(|&in_box| in_box == count)
            .then_some(count)
    }

    #[test]
    fn every_square_of_pixels_has_a_net() {
        for samples in [1, 2, 4, 8] {
            let image = BlueNoise::new(samples, 7).unwrap();
            for (side, [x0, y0], groups) in [
                (1, [5, 2], [0, 3, 4, 1000]),
                (2, [6, 2], [0, 1, 2, 3]),
                (4, [8, 20], [0, 1, 2, 3]),
            ] {
                let pixels = (0..side * side).map(|k| [x0 + k % side, y0 + k / side]);
                let levels = (samples * u64::from(side * side)).ilog2() as i32;
                for group in groups {
                    let points: Vec<[f64; 4]> = pixels
                        .clone()
                        .flat_map(|pixel| {
                            let points = image.pixel(pixel);
                            (0..samples).map(move |sample| {
                                [0, 1, 2, 3].map(|axis| points.coordinate(sample, 4 * group + axis))
                            })
                        })
                        .collect();
                    // The quality parameter of the first two dimensions, and of each, is 0; of all four, by counting, this.
                    let quality = [0, 0, 1, 2, 1, 2, 2, 2][levels as usize];
                    for first in 0..=levels {
                        assert_eq!(
                            equal_counts(&points, [first, levels - first, 0, 0]),
                            Some(1)
                        );
                    }
                    // So have the last two among eight points.
                    if levels <= 3 {
                        for last in 0..=levels {
                            let halvings = [0, 0, levels - last, last];
                            assert_eq!(equal_counts(&points, halvings), Some(1));
                        }
                    }
                    for axis in 0..4 {
                        let mut halvings = [0; 4];
                        halvings[axis] = levels;
                        assert_eq!(equal_counts(&points, halvings), Some(1));
                    }
                    let rest = levels - quality;
                    for cell in 0..(rest + 1).pow(3) {
                        let some = [cell, cell / (rest + 1), cell / (rest + 1).pow(2)]
                            .map(|halvings| halvings % (rest + 1));
                        let last = rest - some.iter().sum::<i32>();
                        if last >= 0 {
                            let halvings = [some[0], some[1], some[2], last];
                            assert_eq!(
                                equal_counts(&points, halvings),
                                Some(1 << quality),
                                "{halvings:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn squares_of_256_pixels_have_a_net() {
        let image = BlueNoise::new(1, 3).unwrap();
        let pixels = (0..1 << 16).map(|k| [256 + k % 256, k / 256]);
        let points: Vec<[f64; 4]> = pixels
            .map(|pixel| [12, 13, 14, 15].map(|axis| image.pixel(pixel).coordinate(0, axis)))
            .collect();
        for halvings in [[16, 0, 0, 0], [8, 8, 0, 0], [3, 13, 0, 0], [0, 0, 16, 0]] {
            assert_eq!(equal_counts(&points, halvings), Some(1));
        }
    }

    #[test]
    fn pixels_repeat_after_65536() {
        let image = BlueNoise::new(1, 3).unwrap();
        let of = |pixel| image.pixel(pixel).coordinate(0, 0).to_bits();
        for bit in 0..16 {
            for other in [[5 ^ 1 << bit, 9], [5, 9 ^ 1 << bit]] {
                assert_ne!(of([5, 9]), of(other), "{bit}");
            }
        }
        assert_eq!(of([5, 9]), of([5 + (1 << 16), 9]));
        assert_eq!(of([5, 9]), of([5, 9 + (1 << 17)]));
    }

    #[test]
    fn dimensions_and_images_know_nothing_of_one_another() {
        // Chi-square with 15 degrees of freedom over 1024 seeds; the bound has a false-positive rate of 3e-7, for each pair.
        for (one, other) in [
            ((0, 0), (0, 1)),
            ((0, 0), (0, 3)),
            ((0, 2), (0, 6)),
            ((0, 16), (0, 20)),
            ((0, 16), (0, 18)),
            ((0, 1), (4, 1)),
            ((0, 17), (4, 17)),
        ] {
            let mut cells = [0_i32; 16];
            for seed in 0..1024 {
                let points = BlueNoise::new(4, seed).unwrap().pixel([3, 4]);
                let quarter = |(index, dimension)| {
                    let u = points.coordinate(index, dimension);
                    [0.25, 0.5, 0.75]
                        .into_iter()
                        .filter(|&end| u >= end)
                        .count()
                };
                cells[4 * quarter(one) + quarter(other)] += 1;
            }
            let squares: i32 = cells.iter().map(|count| (count - 64).pow(2)).sum();
            assert!(squares < 60 * 64, "{one:?} {other:?}: {squares}");
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
    fn other_numbers_of_samples_are_refused() {
        for samples in [0, 3, 1 << 33] {
            assert!(BlueNoise::new(samples, 1).is_err());
        }
        let many = BlueNoise::new(1 << 32, 1).unwrap();
        let u = many.pixel([u32::MAX; 2]).coordinate(u64::MAX, 1);
        assert!((0.0..1.0).contains(&u));
    }
}
