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

    pub(super) fn base(&self) -> u32 {
        self.base
    }

    /// The scrambled radical inverse of `index`.
    #[inline]
    pub(super) fn inverse<S: DigitScramble>(&self, scramble: &S, key: u64, index: u64) -> f64 {
        self.fraction(scramble, key, Places::new(self.base, index))
    }

    /// The number in `[0, 1)` with the scrambled `digits` after the radix point.
    ///
    /// The first digits make an integer below a power of the base, the others a fraction: their sum, divided by the
    /// power. Four roundings, so that the value is within 2^-51 of the exact one, relatively;
    /// where they would add up to 1.0, the number below is taken. The split is by place, not by how many
    /// digits there are, so that blocks of points can share their fraction.
    #[inline]
    pub(super) fn fraction<S: DigitScramble>(
        &self,
        scramble: &S,
        key: u64,
        mut digits: impl Iterator<Item = u64>,
    ) -> f64 {
        let base = u64::from(self.base);
        let mut scrambled = Scrambled::new(self.base, scramble, key);
        for _ in 0..self.leading {
            scrambled.push(digits.next().unwrap_or(0));
        }
        let first = core::mem::take(&mut scrambled.mirrored);
        let mut denominator = 1;
        while denominator < FINEST / base
            && let Some(digit) = digits.next()
        {
            scrambled.push(digit);
            denominator *= base;
        }
        let fraction = (scrambled.mirrored as f64 + scrambled.tail()) / denominator as f64;
        ((first as f64 + fraction) * self.inverse).min(BELOW_ONE)
    }
}

/// The digits of an index, lowest first, down to the last that is not 0.
struct Places {
    base: u64,
    rest: u64,
}

impl Places {
    #[inline]
    fn new(base: u32, index: u64) -> Self {
        Self {
            base: base.into(),
            rest: index,
        }
    }
}

impl Iterator for Places {
    type Item = u64;

    #[inline]
    fn next(&mut self) -> Option<u64> {
        (self.rest != 0).then(|| {
            let digit = self.rest % self.base;
            self.rest /= self.base;
            digit
        })
    }
}

/// Digits that are being scrambled, from the first place on.
struct Scrambled<'a, S> {
    base: u32,
    scramble: &'a S,
    key: u64,
    /// What is left of the shift, a fraction of 2^64.
    shift: u64,
    place: u32,
    /// The scrambled digits so far, as an integer.
    mirrored: u64,
}

impl<'a, S: DigitScramble> Scrambled<'a, S> {
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
