//! Nested scrambles that are computed with words of 32 bits, of which a vector holds twice as many as of 64 and whose products are cheaper.

/// A scramble of the digits of coordinates, of which the first is the lowest bit of a word. Each digit is flipped or not as those
/// before it choose.
///
/// The first 32 digits go through Vegdahl's hash of Laine's and Karras's kind,[^vegdahl] the others through the same with other
/// numbers. A word from halfway through the first is added to these: the 33rd digit depends on all 32, each later one on one fewer.
///
/// [^vegdahl]: Vegdahl, Nathan (2021). *Building a Better LK Hash*.
///     <https://psychopath.io/post/2021_01_30_building_a_better_lk_hash>
#[derive(Clone, Copy, Default)]
pub(in crate::points) struct NestedHash {
    sum: u32,
    product: u32,
}

/// The first 32 digits.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the other digits are left out"
)]
pub(in crate::points) const fn first_half(digits: u64) -> u32 {
    digits as u32
}

impl NestedHash {
    /// The one that `key` selects, which must be well mixed.
    #[inline(always)]
    pub(in crate::points) const fn new(key: u64) -> Self {
        Self {
            sum: first_half(key),
            product: first_half(key >> 32) | 1,
        }
    }

    /// The 32 digits, of which each depends on those before it, and the word halfway there, whose highest bit depends on all.
    #[inline(always)]
    const fn nested(self, mut word: u32) -> (u32, u32) {
        word ^= word.wrapping_mul(0x3d20_adea);
        let mixed = word.wrapping_add(self.sum).wrapping_mul(self.product);
        word = mixed ^ mixed.wrapping_mul(0x0552_6c56);
        (word ^ word.wrapping_mul(0x53a2_2864), mixed)
    }

    /// The digits after the first 32, scrambled as far as those do not decide.
    #[inline(always)]
    pub(in crate::points) const fn last_half(self, digits: u64) -> u32 {
        // Other numbers: what becomes of the same words must not be the same.
        let other = Self {
            sum: self.product.rotate_left(16),
            product: self.sum | 1,
        };
        other.nested(first_half(digits >> 32)).0.reverse_bits()
    }

    /// The scrambled digits, of which the first is the highest bit, if the first 32 were those of `first`; the others come from
    /// [`last_half`](Self::last_half).
    #[inline(always)]
    pub(in crate::points) const fn digits(self, first: u32, last: u32) -> u64 {
        let (first, mixed) = self.nested(first);
        (first.reverse_bits() as u64) << 32 | (mixed ^ last) as u64
    }

    /// The same of all digits.
    #[inline(always)]
    pub(in crate::points) const fn scrambled(self, digits: u64) -> u64 {
        self.digits(first_half(digits), self.last_half(digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash;

    /// The digits of the coordinate, as a number of 53 bits.
    fn scrambled(digits: u64, key: u64) -> u64 {
        NestedHash::new(key).scrambled(digits) >> 11
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
        for digit in 0..52_u32 {
            let mut flips = [0_i32; 53];
            for sample in 0..4096 {
                let (word, key) = (hash(3, sample), hash(4, sample));
                let changed = scrambled(word, key) ^ scrambled(word ^ 1 << digit, key);
                for (place, flips) in (0..53_u32).zip(&mut flips) {
                    *flips += i32::from(changed << (11 + place) >> 63 == 1);
                }
            }
            for (place, &flips) in (0..).zip(&flips) {
                // Of the digits after the first 32 each depends on fewer of those, and on all between.
                if place > digit && (digit >= 32 || place < 63 - digit) {
                    assert!((flips - 2048_i32).abs() < 384, "{digit} {place}: {flips}");
                }
            }
        }
    }

    #[test]
    fn no_word_is_scrambled_to_fewer_digits() {
        // Of 2^19 numbers of 53 bits two are the same with a probability of 2e-5 for each word; of 32 bits 32 pairs are.
        for word in [0, 1, u64::MAX] {
            let mut seen: Vec<u64> = (0..1 << 19)
                .map(|key| scrambled(word, hash(5, key)))
                .collect();
            seen.sort_unstable();
            assert!(seen.windows(2).all(|pair| pair[0] != pair[1]), "{word}");
        }
    }
}
