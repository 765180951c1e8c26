//! One base of a set whose coordinates are mirrored digits.

use super::radical_inverse::BELOW_ONE;
use super::scramble::DigitScramble;

/// The largest denominator whose multiples the digits of an index are kept to: with any base below 2^20 the digits before it
/// stop at a power above 2^43, and are followed by the rest of the shift as a fraction.
const FINEST: u64 = 1 << 63;

/// A base, and what is computed from it once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    base: u32,
    /// How many digits are split off first: as many as the largest power up to 1024 has, one at least.
    leading: u32,
    /// The reciprocal of that power.
    inverse: f64,
}

impl Base {
    pub(super) fn new(base: u32) -> Self {
        let leading = 1024_u32.ilog(base).max(1);
        let power = f64::from(base.pow(leading));
        Self {
            base,
            leading,

            inverse: 1.0 / power,
        }
    }

    /// The scrambled radical inverse of `index`.
    ///
    /// The first digits make an integer below `power`, the others a fraction: their sum, divided by the
    /// power. Four roundings, so that the value is within 2^-51 of the exact one, relatively;
    /// where they would add up to 1.0, the number below is taken. The split is by place, not by how many
    /// digits an index has, so that blocks of points can share their fraction.
    #[inline]
    pub(super) fn inverse<S: DigitScramble>(&self, scramble: &S, key: u64, index: u64) -> f64 {
        let mut digits = Digits::new(self.base, scramble, key);
        let mut rest = index;
        for _ in 0..self.leading {
            digits.push(rest % u64::from(self.base));
            rest /= u64::from(self.base);
        }
        let first = core::mem::take(&mut digits.mirrored);
        let mut denominator = 1;
        while rest != 0 && denominator < FINEST / u64::from(self.base) {
            digits.push(rest % u64::from(self.base));
            rest /= u64::from(self.base);
            denominator *= u64::from(self.base);
        }
        let fraction = (digits.mirrored as f64 + digits.tail()) / denominator as f64;
        ((first as f64 + fraction) * self.inverse).min(BELOW_ONE)
    }
}

/// Digits that are being scrambled, from the first place on.
struct Digits<'a, S> {
    base: u32,
    scramble: &'a S,
    key: u64,
    /// What is left of the shift, a fraction of 2^64.
    shift: u64,
    place: u32,
    /// The scrambled digits so far, as an integer.
    mirrored: u64,
}

impl<'a, S: DigitScramble> Digits<'a, S> {
    #[inline]
    fn new(base: u32, scramble: &'a S, key: u64) -> Self {
        Self {
            base,
            scramble,
            key,
            shift: scramble.shift(key),
            place: 0,
            mirrored: 0,
        }
    }

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "digits are below the base, the shift takes its low word"
    )]
    fn push(&mut self, digit: u64) {
        let base = u64::from(self.base);
        let product = u128::from(self.shift) * u128::from(base);
        let (mut scrambled, digit) = ((product >> 64) as u64, digit as u32);
        self.shift = product as u64;
        if digit != 0 {
            scrambled += u64::from(
                self.scramble
                    .permute(self.key, self.base, self.place, digit),
            );
            if scrambled >= base {
                scrambled -= base;
            }
            if S::NESTED {
                self.key = self.scramble.after(self.key, self.place, digit);
                self.shift = self.scramble.shift(self.key);
            }
        }
        self.mirrored = self.mirrored * base + scrambled;
        self.place += 1;
    }

    /// The digits that follow those so far if all the rest of the index are 0, as a fraction in `[0, 1]`.
    #[inline]
    fn tail(&self) -> f64 {
        self.shift as f64 * (1.0 / 18_446_744_073_709_551_616.0)
    }
}
