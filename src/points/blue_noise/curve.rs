//! The Morton curve through the pixels of an image and their samples, in orders of its own everywhere.

use crate::hash::{hash_prepared, prepare};

/// Samples whose places on the curve are found together.
pub(super) const SAMPLES: usize = 64;

/// A place on the Morton curve whose digits in base 4 are permuted, each by a permutation that those above it choose: the four
/// squares that make a larger one, and the samples of a pixel, come in an order of their own everywhere.
#[derive(Clone, Copy, Default)]
pub(super) struct Curve {
    /// What selects the permutations.
    prepared: u64,
    /// The digits as they were, after a one that tells how many they are.
    digits: u64,
    shuffled: u64,
}

impl Curve {
    /// All of it, in the orders that `key` selects.
    #[inline(always)]
    pub(super) const fn new(key: u64) -> Self {
        Self {
            prepared: prepare(key),
            digits: 1,
            shuffled: 0,
        }
    }

    /// With the lowest `bits` bits of `word` as its next digits. Where their number is odd, the last digit is in base 2.
    #[inline(always)]
    pub(super) const fn followed_by(mut self, word: u64, bits: u32) -> Self {
        let mut left = bits;
        while left > 0 {
            let base = if left == 1 { 1 } else { 2 };
            left -= base;
            let digit = word >> left & ((1 << base) - 1);
            self.shuffled = self.shuffled << base | self.order(0, 0).image(digit, base);
            self.digits = self.digits << base | digit;
        }
        self
    }

    /// Where the digits have come to.
    #[inline(always)]
    pub(super) const fn shuffled(&self) -> u64 {
        self.shuffled
    }

    /// The ends of the places that follow when all numbers of `bits` bits come next, six at most.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "below 64")]
    pub(super) fn all_that_follow(&self, bits: u32) -> [u8; SAMPLES] {
        debug_assert!(bits <= SAMPLES.ilog2(), "{bits} bits");
        let mut places = [0; SAMPLES];
        // Squares of squares, for all of which code is made.
        if bits >= 2 {
            self.follow::<1>(0, &mut places);
        }
        if bits >= 4 {
            self.follow::<4>(2, &mut places);
        }
        if bits >= 6 {
            self.follow::<16>(4, &mut places);
        }
        if bits % 2 == 1 {
            let done = bits - 1;
            // From the last ones on, since what they become takes more room.
            for node in (0..1_usize << done).rev() {
                let (before, order) = (places[node], self.order(node as u64, done));
                places[2 * node] = before << 1 | order.image(0, 1) as u8;
                places[2 * node + 1] = places[2 * node] ^ 1;
            }
        }
        places
    }

    /// Puts behind each of the first `NODES` places, which are of `done` bits, all that may be the next digit.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "four numbers of two bits")]
    fn follow<const NODES: usize>(&self, done: u32, places: &mut [u8; SAMPLES]) {
        // Four places in each word.
        let mut words = [0; NODES];
        for ((word, &place), node) in words.iter_mut().zip(places.iter()).zip(0..) {
            let images = self.order(node, done).images as u32;
            let apart = (images | images << 6 | images << 12 | images << 18) & 0x0303_0303;
            *word = (u32::from(place) * 0x0404_0404) | apart;
        }
        for (four, word) in places.chunks_exact_mut(4).zip(words) {
            four.copy_from_slice(&word.to_le_bytes());
        }
    }

    /// The permutation of the digit that comes after those of its own and `bits` bits more.
    #[inline(always)]
    const fn order(&self, more: u64, bits: u32) -> Order {
        let word = hash_prepared(self.prepared, self.digits << bits | more);
        let map = ((word & 0xffff_ffff) * 6) >> 32;
        Order {
            images: ((LINEAR >> (8 * map)) & 0xff) ^ ((word >> 62) * 0x55),
        }
    }
}

/// A permutation of the digits below 4, or below 2: all of them are affine maps of two bits, or of one.
#[derive(Clone, Copy)]
struct Order {
    /// The images of the four digits, two bits each.
    images: u64,
}

impl Order {
    /// The image of a digit of `base` bits.
    #[inline(always)]
    const fn image(self, digit: u64, base: u32) -> u64 {
        if base == 2 {
            self.images >> (2 * digit) & 3
        } else {
            digit ^ (self.images >> 1 & 1)
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash;

    #[test]
    fn every_permutation_is_as_likely_as_the_others() {
        // Chi-square with 23 and 1 degrees of freedom; the bounds have a false-positive rate of 1e-6 each.
        const KEYS: u32 = 24_000;
        for (base, likely, bound) in [(2, 24, 70.6), (1, 2, 23.9)] {
            let mut seen = std::collections::BTreeMap::new();
            for key in (0..KEYS).map(u64::from) {
                // After some digits, or none.
                let mut curve = Curve::new(hash(3, key));
                curve.digits += key % 3;
                let images: Vec<_> = (0..1 << base)
                    .map(|digit| curve.followed_by(digit, base).shuffled())
                    .collect();
                let together = curve.all_that_follow(base).map(u64::from);
                assert!(together.starts_with(&images));
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
                assert!(sorted.into_iter().eq(0..1 << base));
            }
        }
    }

    #[test]
    fn orders_depend_on_the_digits_above() {
        // Four orders are the same with a probability of 24^-3, for all of ten keys 1e-41.
        let differ = (0..10).any(|key| {
            let order = |digit| {
                let curve = Curve::new(hash(3, key)).followed_by(digit, 2);
                (0..4).map(move |next| curve.followed_by(next, 2).shuffled() % 4)
            };
            (1..4).any(|digit| !order(0).eq(order(digit)))
        });
        assert!(differ);
    }
}
