//! Nested scrambles that are computed with words of 32 bits: twice as many at once, and with cheaper products, as with 64.

use crate::hash::unit;

/// A scramble of the digits of coordinates, of which the first is the lowest bit of a word. Each digit is flipped or not as those
/// before it choose.
///
/// The first 32 digits go through Vegdahl's hash of Laine's and Karras's kind,[^vegdahl] the others through the same; what
/// the first ones have become is hashed into these.
///
/// [^vegdahl]: Vegdahl, Nathan (2021). *Building a Better LK Hash*.
///     <https://psychopath.io/post/2021_01_30_building_a_better_lk_hash>
#[derive(Clone, Copy, Default)]
pub(super) struct Scramble {
    sum: u32,
    product: u32,
}

/// The first 32 digits.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the other digits are left out"
)]
pub(super) const fn first_half(digits: u64) -> u32 {
    digits as u32
}

impl Scramble {
    /// The one that `key` selects, which must be well mixed.
    #[inline(always)]
    pub(super) const fn new(key: u64) -> Self {
        Self {
            sum: first_half(key),
            product: first_half(key >> 32) | 1,
        }
    }

    /// The 32 digits, of which each depends on those before it, and before them a word whose last digits depend on all.
    #[inline(always)]
    const fn nested(self, mut word: u32) -> (u32, u32) {
        word ^= word.wrapping_mul(0x3d20_adea);
        let mixed = word.wrapping_add(self.sum).wrapping_mul(self.product);
        word = mixed ^ mixed.wrapping_mul(0x0552_6c56);
        (word ^ word.wrapping_mul(0x53a2_2864), mixed)
    }

    /// The digits after the first 32, scrambled as far as those do not decide.
    #[inline(always)]
    pub(super) const fn last_half(self, digits: u64) -> u32 {
        self.nested(first_half(digits >> 32)).0.reverse_bits()
    }

    /// The coordinate whose first 32 digits are those of `first`, and whose others come from [`last_half`](Self::last_half).
    #[inline(always)]
    pub(super) const fn coordinate(self, first: u32, last: u32) -> f64 {
        let (first, mixed) = self.nested(first);
        unit((first.reverse_bits() as u64) << 32 | (mixed ^ last) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash;

    /// The digits of the coordinate, as a number of 53 bits.
    #[expect(clippy::cast_possible_truncation, reason = "a whole number of 53 bits")]
    fn scrambled(digits: u64, key: u64) -> u64 {
        let scramble = Scramble::new(key);
        let u = scramble.coordinate(first_half(digits), scramble.last_half(digits));
        assert!((0.0..1.0).contains(&u));
        (u * 2_f64.powi(53)) as u64
    }

    #[test]
    fn later_digits_change_nothing_before_them() {
        for key in (0..50).map(|key| hash(1, key)) {
            let word = hash(2, key);
            for digit in 0..53 {
                let changed = scrambled(word, key) ^ scrambled(word ^ 1 << digit, key);
                assert_eq!(changed.leading_zeros(), 11 + digit);
            }
        }
    }

    #[test]
    fn a_digit_flips_each_later_one_about_half_the_time() {
        // As for `HashedOwen`: over 4096 pairs a later digit changes 2048 times with a standard deviation of 32, and 12 of them
        // are allowed.
        for digit in 0..32_u32 {
            let mut flips = [0_i32; 53];
            for sample in 0..4096 {
                let (word, key) = (hash(3, sample), hash(4, sample));
                let changed = scrambled(word, key) ^ scrambled(word ^ 1 << digit, key);
                for (place, flips) in (0..53_u32).zip(&mut flips) {
                    *flips += i32::from(changed << (11 + place) >> 63 == 1);
                }
            }
            for (place, &flips) in (0..).zip(&flips) {
                // Of the digits after the first 32 each depends on fewer of those.
                if place > digit && place < 63 - digit {
                    assert!((flips - 2048_i32).abs() < 384, "{digit} {place}: {flips}");
                }
            }
        }
    }
}
