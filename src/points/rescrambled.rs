//! Paths of any length from a few good dimensions.

use core::ops::Range;
use std::sync::OnceLock;

use super::block::{Block, vectorised};
use super::scramble::{
    Columns, DigitOrder, ENDINGS, Ending, NestedHash, first_half, scramble, scramble_endings,
};
use super::sobol::{multiplied, table};
use super::{PointSet, Sobol};
use crate::Error;
use crate::hash::{GOLDEN, hash, mix, unit};

/// The first few dimensions of Sobol's sequence again and again, each time scrambled and shuffled anew: any number of
/// dimensions.[^burley]
///
/// Within a group of `width` dimensions the points are those of a scrambled net; between groups they are
/// independent of one another, apart from being nets. So a light path that reads its coordinates in groups has every
/// one of its decisions well sampled, however long it gets, where late dimensions of a plain Sobol' sequence are
/// correlated for small counts. For an integrand in a fixed number of dimensions that do much together take
/// [`Sobol`] itself.
///
/// With groups of two this is a progressive (0,2) sequence in every pair: any aligned block of `2^m` points has one in
/// every elementary interval of area `2^-m`.[^pmj] Take powers of two.
///
/// Exact at every index; see [`Sobol`] for what holds past 2^53 points. Scrambled by
/// hashing, the first 32 digits for themselves; the order is shuffled among the points from `2^m` to
/// `2^(m + 1) - 1`, so that prefixes remain nets.
///
/// ```
/// use estimand::points::{PointSet, Rescrambled};
///
/// let points = Rescrambled::new(2, 1)?;
/// let mut quarters: Vec<u32> = (0..4).map(|index| (points.coordinate(index, 999) * 4.0) as u32).collect();
/// quarters.sort();
/// assert_eq!(quarters, [0, 1, 2, 3]);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^burley]: Burley, Brent (2020). *Practical Hash-based Owen Scrambling*. <https://jcgt.org/published/0009/04/01/>
///
/// [^pmj]: Christensen, Per; Kensler, Andrew; Kilpatrick, Charlie (2018). *Progressive Multi-Jittered Sample Sequences*.
///     <https://doi.org/10.1111/cgf.13472>
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Rescrambled {
    /// Those of the dimensions of a group, for digits of which the first is the lowest bit.
    matrices: &'static [Columns],
    seed: u64,
}

impl Rescrambled {
    /// Groups of `width` dimensions, with the scrambles that `seed` selects.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a width that [`Sobol::new`] refuses.
    pub fn new(width: u32, seed: u64) -> Result<Self, Error> {
        let width = Sobol::new(width)?.dimensions();
        Ok(Self {
            matrices: table(width, DigitOrder::FirstLowest),
            seed,
        })
    }

    /// The same groups with other scrambles: a copy of two words.
    pub const fn reseeded(&self, seed: u64) -> Self {
        Self { seed, ..*self }
    }

    /// The scrambled digits of the coordinate under the scrambles that `seed` selects.
    #[inline]
    pub(super) fn digits(&self, seed: u64, index: u64, dimension: u32) -> u64 {
        // As usize, which a u32 fits into on every machine that has room for a table.
        let (width, dimension) = (self.matrices.len(), dimension as usize);
        let (group, axis) = (dimension / width, dimension % width);
        let key = hash(seed, group as u64);
        let digits = multiplied(&self.matrices[axis], shuffled(index, key));
        NestedHash::new(axis_key(key, axis)).scrambled(digits)
    }
}

/// What selects the scramble of one dimension of the group of `key`, which is a well mixed word: SplitMix64's numbers.
#[inline]
const fn axis_key(key: u64, axis: usize) -> u64 {
    mix(key.wrapping_add(GOLDEN.wrapping_mul(axis as u64 + 1)))
}

/// The index of the point that comes `index`-th: below its leading one the bits are scrambled, each by those above
/// it.
///
/// What becomes of the leading one and the zeros before it only moves the whole block of points, as the scrambles of
/// the coordinates do already.
#[inline]
fn shuffled(index: u64, key: u64) -> u64 {
    below_leading(index, scramble(index, key))
}

/// `index`, with those of the bits in `scrambled` that are below its leading one.
#[inline(always)]
const fn below_leading(index: u64, scrambled: u64) -> u64 {
    let below = match index.leading_zeros() {
        63.. => 0,
        zeros => u64::MAX >> (zeros + 1),
    };
    (index & !below) | (scrambled & below)
}

impl PointSet for Rescrambled {
    #[inline]
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        unit(self.digits(self.seed, index, dimension))
    }

    fn radix(&self) -> Option<u32> {
        Some(2)
    }

    fn fill(&self, first: u64, dimensions: Range<u32>, out: &mut [f64]) {
        let mut block = Block::new(first, dimensions, out, u32::MAX, 0);
        if block.count() == 0 {
            return;
        }
        vectorised(
            #[inline(always)]
            || {
                let mut axes = self.matrices;
                while !axes.is_empty() {
                    let axis = self.matrices.len() - axes.len();
                    // As many at once as make whole vectors.
                    axes = if let Some((four, others)) = axes.split_first_chunk::<4>() {
                        let first =
                            (axis == 0).then(|| FIRST_FOUR.get_or_init(|| combinations(four)));
                        self.fill_axes(four, first, axis, &mut block);
                        others
                    } else if let Some((two, others)) = axes.split_first_chunk::<2>() {
                        self.fill_axes(two, None, axis, &mut block);
                        others
                    } else {
                        self.fill_axes(&[axes[0]], None, axis, &mut block);
                        &axes[1..]
                    };
                }
            },
        );
    }
}

/// Points that are computed side by side: those of an aligned block, whose order is shuffled among themselves.
const POINTS: usize = ENDINGS;

/// Coordinates in a vector.
const LANES: usize = 16;

/// The places in a block, each as the ending of an index: its first digit is the lowest bit.
#[expect(clippy::cast_possible_truncation, reason = "places are below 64")]
const PLACES: [Ending; POINTS] = {
    let mut places = [0; POINTS];
    let mut place = 0;
    while place < POINTS {
        let mut bit = 0;
        while bit < BITS {
            places[place] |= ((place >> bit & 1) << (BITS - 1 - bit)) as Ending;
            bit += 1;
        }
        place += 1;
    }
    places
};

/// Bits of a place.
const BITS: usize = POINTS.ilog2() as usize;

impl Rescrambled {
    /// Writes the coordinates in the dimensions from `axis` on, `N` of them, of every group of the block. The
    /// [`combinations`] of the matrices may be known.
    #[inline(always)]
    fn fill_axes<const N: usize>(
        &self,
        matrices: &[Columns; N],
        known: Option<&[[u32; N]; POINTS]>,
        axis: usize,
        block: &mut Block<'_>,
    ) {
        let (width, stride) = (self.matrices.len(), block.width);
        let (start, end) = (
            block.dimensions.start as usize,
            block.dimensions.end as usize,
        );
        let mut made = None;
        let mut words = [[0_u32; N]; POINTS];
        let mut coordinates = [[0.0; N]; POINTS];
        for group in start / width..end.div_ceil(width) {
            // Those of the dimensions that are asked for.
            let dimension = group * width + axis;
            let asked = dimension.max(start)..end.min(dimension.saturating_add(N));
            if asked.is_empty() {
                continue;
            }
            let table = known.unwrap_or_else(|| made.get_or_insert_with(|| combinations(matrices)));
            let key = hash(self.seed, group as u64);
            let mut scrambles = [NestedHash::default(); N];
            for (above, scramble) in scrambles.iter_mut().enumerate() {
                *scramble = NestedHash::new(axis_key(key, axis + above));
            }

            let mut index = block.first;
            let mut out = &mut *block.out;
            while !out.is_empty() {
                let left = POINTS - within_block(index);
                let (rows, later) = out.split_at_mut(out.len().min(left * stride));
                let count = rows.len() / stride;
                // What the points have in common, and what tells them apart.
                let first = index - within_block(index) as u64;
                let mut places = PLACES;
                let above = below_leading(first, scramble_endings(first, key, &mut places));
                if first == 0 {
                    // The leading one of a place is the lowest in its ending.
                    for (shuffled, place) in places.iter_mut().zip(PLACES) {
                        let kept = place ^ place.wrapping_sub(1);
                        *shuffled = (place & kept) | (*shuffled & !kept);
                    }
                }
                let mut common = [(NestedHash::default(), 0, 0); N];
                for (axis, columns) in matrices.iter().enumerate() {
                    let (scramble, digits) = (scrambles[axis], multiplied(columns, above));
                    common[axis] = (scramble, first_half(digits), scramble.last_half(digits));
                }
                let mut lanes = [(NestedHash::default(), 0, 0); LANES];
                for (lane, of_lane) in lanes.iter_mut().enumerate() {
                    *of_lane = common[lane % N];
                }
                for (word, &place) in words.iter_mut().zip(&places[POINTS - left..][..count]) {
                    *word = table[within_block(place.into())];
                }
                let vectors = words.as_flattened().chunks_exact(LANES);
                let results = coordinates.as_flattened_mut().chunks_exact_mut(LANES);
                for (us, words) in results.zip(vectors).take((count * N).div_ceil(LANES)) {
                    for (lane, u) in us.iter_mut().enumerate() {
                        let (scramble, first, last) = lanes[lane];
                        *u = unit(scramble.digits(first ^ words[lane], last));
                    }
                }
                let rows = rows.chunks_exact_mut(stride);
                if asked.len() == N {
                    for (row, coordinates) in rows.zip(&coordinates) {
                        row[asked.start - start..][..N].copy_from_slice(coordinates);
                    }
                } else {
                    for (row, coordinates) in rows.zip(&coordinates) {
                        row[asked.start - start..][..asked.len()].copy_from_slice(
                            &coordinates[asked.start - dimension..][..asked.len()],
                        );
                    }
                }
                index = index.wrapping_add(count as u64);
                out = later;
            }
        }
    }
}

/// The table of the first four dimensions, which takes as long to make as the coordinates of a few points.
static FIRST_FOUR: OnceLock<[[u32; 4]; POINTS]> = OnceLock::new();

/// The place of a point in its aligned block.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "a remainder of a small number"
)]
fn within_block(index: u64) -> usize {
    (index % POINTS as u64) as usize
}

/// What the low bits of an index add to the digits of every dimension, for each [ending](Ending) of an index.
#[inline(always)]
fn combinations<const N: usize>(matrices: &[Columns; N]) -> [[u32; N]; POINTS] {
    let mut table = [[0; N]; POINTS];
    for bit in 0..BITS {
        let (done, next) = table.split_at_mut(1 << bit);
        for (done, next) in done.iter().zip(next) {
            for ((next, done), columns) in next.iter_mut().zip(done).zip(matrices) {
                *next = done ^ first_half(columns[BITS - 1 - bit]);
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octaves_are_shuffled_within_themselves() {
        for key in 0..20 {
            let key = hash(1, key);
            for octave in 0..10 {
                let mut seen: Vec<u64> = ((1 << octave)..(2 << octave))
                    .map(|index| shuffled(index, key))
                    .collect();
                assert!(octave < 4 || seen.windows(2).any(|pair| pair[0] > pair[1]));
                seen.sort_unstable();
                assert!(seen.into_iter().eq((1 << octave)..(2 << octave)));
            }
            assert_eq!(shuffled(0, key), 0);
            assert_eq!(shuffled(u64::MAX, key) >> 63, 1);
        }
    }
}
