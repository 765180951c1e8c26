//! The Morton curve through the pixels of an image and their samples, in orders of its own everywhere.

use crate::hash::hash_prepared;

/// Samples whose places on the curve are found together.
pub(super) const SAMPLES: usize = 64;

/// A place on the Morton curve whose digits in base 4 are permuted, each by a permutation that those above it choose: the four
/// squares that make a larger one, and the samples of a pixel, come in an order of their own everywhere. So it does in
/// each of some dimensions.
#[derive(Clone, Copy)]
pub(super) struct Curve<const N: usize> {
    /// What selects the permutations.
    pub(super) prepared: [u64; N],
    /// The digits as they were, after a one that tells how many they are.
    pub(super) digits: u64,
    pub(super) shuffled: [u64; N],
}

impl<const N: usize> Curve<N> {
    /// With the lowest `bits` bits of `word`, 32 at most, as its next digits. Where their number is odd, the last digit is in base 2.
    #[inline(always)]
    pub(super) fn followed_by(mut self, word: u64, bits: u32) -> Self {
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

    /// The ends of the places that follow when all numbers of `bits` bits come next, those of a sample at most.
    #[inline(always)]
    pub(super) fn all_that_follow(&self, bits: u32, places: &mut [[u64; N]; SAMPLES]) {
        places[0] = [0; N];
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
    use crate::hash::{hash, prepare};

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
}
