//! Random permutations of many numbers at once.

use super::block::vectorised;
use super::finite::CHUNK;
use crate::hash::{Bijection, FEW, ROUNDS, TABLE, shuffled};
use crate::reduce;

/// The random permutation of `0..count` that [`permute`](crate::hash::permute) makes of a key, for a count up to 2^32.
pub(super) struct Permutation {
    count: u64,
    kind: Kind,
}

enum Kind {
    /// The images of few numbers.
    Table([u32; TABLE]),
    Walk(Walk),
}

impl Permutation {
    #[inline(always)]
    pub(super) fn new(count: u64, key: u64) -> Self {
        debug_assert!(count <= 1 << 32);
        let kind = if count <= FEW {
            Kind::Table(shuffled(count, key))
        } else {
            Kind::Walk(Walk::new(key))
        };
        Self { count, kind }
    }

    /// Puts their images in the places of `numbers`, all of them below the count.
    #[inline(always)]
    pub(super) fn apply(&self, numbers: &mut [u32; CHUNK]) {
        match &self.kind {
            Kind::Table(images) => {
                for number in numbers {
                    *number = images[*number as usize % images.len()];
                }
            }
            Kind::Walk(walk) => {
                let bits = Bits::of(self.count);
                for number in &mut *numbers {
                    *number = walk.step(*number, bits);
                }
                walk_on(numbers, self.count, |number| walk.step(number, bits));
            }
        }
    }
}

/// The images of all numbers below `count` under the random permutation that [`permute`](crate::hash::permute) makes of `key`:
/// block after block, with what `look` finds in each of them.
///
/// # Panics
///
/// For a count above 2^32.
#[expect(clippy::cast_possible_truncation, reason = "below 2^32")]
pub(crate) fn permuted<T: Send>(
    count: u64,
    key: u64,
    look: impl Fn(&[u32]) -> T + Sync,
) -> Vec<(Vec<u32>, T)> {
    /// Numbers that are permuted side by side with others.
    const BLOCK: u64 = 1024;
    assert!(count <= 1 << 32, "permuted: the count is 2^32 at most");
    reduce::each(count.div_ceil(BLOCK), |block| {
        let numbers = BLOCK * block..count.min(BLOCK * (block + 1));
        let mut images = Vec::with_capacity(BLOCK as usize);
        vectorised(
            #[inline(always)]
            || {
                let permutation = Permutation::new(count, key);
                for first in numbers.clone().step_by(CHUNK) {
                    let number = |lane: usize| (first + lane as u64).min(count - 1) as u32;
                    let mut chunk = core::array::from_fn(number);
                    permutation.apply(&mut chunk);
                    let here = (numbers.end - first).min(CHUNK as u64) as usize;
                    images.extend_from_slice(&chunk[..here]);
                }
            },
        );
        let found = look(&images);
        (images, found)
    })
}

/// Takes the numbers past the count on along their cycles, until all are below it.
#[inline(always)]
fn walk_on(numbers: &mut [u32; CHUNK], count: u64, step: impl Fn(u32) -> u32) {
    if count.is_power_of_two() {
        return;
    }
    // Which they are, collected without a branch for each: half of them may be.
    let (mut lanes, mut left) = ([0; CHUNK], 0);
    for (lane, &number) in numbers.iter().enumerate() {
        lanes[left] = lane;
        left += usize::from(u64::from(number) >= count);
    }
    while left > 0 {
        let mut still = 0;
        for place in 0..left {
            let lane = lanes[place];
            numbers[lane] = step(numbers[lane]);
            lanes[still] = lane;
            still += usize::from(u64::from(numbers[lane]) >= count);
        }
        left = still;
    }
}

/// Of the numbers that a bijection maps.
#[derive(Clone, Copy)]
struct Bits {
    mask: u32,
    half: u32,
}

impl Bits {
    /// The numbers below the next power of two, for a count from 2 to 2^32.
    #[inline(always)]
    fn of(count: u64) -> Self {
        let bits = u64::BITS - (count - 1).leading_zeros();
        Self {
            mask: u32::MAX >> (u32::BITS - bits),
            half: bits.div_ceil(2),
        }
    }
}

/// A [`Bijection`] of words of up to 32 bits.
struct Walk {
    summands: [u32; ROUNDS],
    multipliers: [u32; ROUNDS],
    last: u32,
}

impl Walk {
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "arithmetic modulo 2^32 needs no more"
    )]
    fn new(key: u64) -> Self {
        let bijection = Bijection::new(key);
        Self {
            summands: bijection.summands.map(|summand| summand as u32),
            multipliers: bijection.multipliers.map(|multiplier| multiplier as u32),
            last: bijection.last as u32,
        }
    }

    #[inline(always)]
    fn step(&self, number: u32, Bits { mask, half }: Bits) -> u32 {
        let mut word = number;
        for (summand, &multiplier) in self.summands.iter().zip(&self.multipliers) {
            word = word.wrapping_add(*summand).wrapping_mul(multiplier) & mask;
            word ^= word >> half;
        }
        word.wrapping_add(self.last) & mask
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, permute};

    #[test]
    fn all_are_permuted_as_each_is() {
        for count in (0..=17).chain([64, 100, 128, 3125]) {
            for key in 0..5 {
                let blocks = permuted(count, key, <[u32]>::len);
                let lengths = blocks
                    .iter()
                    .map(|(images, length)| (images.len(), *length));
                assert!(lengths.into_iter().all(|(here, length)| here == length));
                let images: Vec<u32> = blocks.into_iter().flat_map(|(images, _)| images).collect();
                let each = (0..count).map(|number| permute(number, count, key));
                assert!(images.into_iter().map(u64::from).eq(each), "{count}");
            }
        }
    }

    #[test]
    fn many_are_permuted_as_one_is() {
        for count in (1..16).chain([16, 17, 31, 32, 33, 100, 1 << 16, (1 << 31) + 1, 1 << 32]) {
            for key in 0..20 {
                let words: [u64; CHUNK] =
                    core::array::from_fn(|lane| hash(key, lane as u64) % count);
                let numbers = words.map(|word| u32::try_from(word).unwrap());

                let mut same = numbers;
                Permutation::new(count, key).apply(&mut same);
                for lane in 0..CHUNK {
                    assert_eq!(u64::from(same[lane]), permute(words[lane], count, key));
                }
            }
        }
    }
}
