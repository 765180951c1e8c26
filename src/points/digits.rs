//! One base of a set whose coordinates are mirrored digits.

use super::radical_inverse::BELOW_ONE;
use super::scramble::DigitScramble;

/// The largest denominator whose multiples the digits of an index are kept to: with any base below 2^20 the digits before it
/// stop at a power above 2^43, and are followed by the rest of the shift as a fraction.
const FINEST: u64 = 1 << 63;

/// Coordinates that are computed at once.
pub(super) const SLACK: usize = 8;

/// A base, and what is computed from it once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    base: u32,
    /// `2^64 / base`, rounded up: multiplying by it divides small numbers by the base.
    reciprocal: u64,
    /// While the denominator of a fraction is below this, there is room for one digit more.
    room: u64,
    /// How many digits are split off first: as many as the largest power up to 1024 has, one at least.
    leading: u32,
    /// That power of the base.
    power: u32,
    /// The reciprocal of that power.
    inverse: f64,
}

/// Indices below this are divided by multiplying, if the base is below 2^20: the reciprocal is too large by less
/// than 1, the product by less than `index / 2^64`, and less than `1 / base` changes no whole part.
const SMALL: u64 = 1 << 44;

impl Base {
    pub(super) fn new(base: u32) -> Self {
        let leading = 1024_u32.ilog(base).max(1);
        let power = base.pow(leading);
        Self {
            base,
            reciprocal: u64::MAX / u64::from(base) + 1,
            room: FINEST / u64::from(base),
            leading,
            power,
            inverse: 1.0 / f64::from(power),
        }
    }

    pub(super) fn base(&self) -> u32 {
        self.base
    }

    /// The scrambled radical inverse of `index`.
    #[inline]
    pub(super) fn inverse<S: DigitScramble>(&self, scramble: &S, key: u64, index: u64) -> f64 {
        self.fraction(
            scramble,
            key,
            Places {
                base: self,
                rest: index,
            },
        )
    }

    /// The scrambled radical inverses of consecutive indices, from `first` on, where digits are not nested.
    ///
    /// The first digits come from a table of all their values; the other digits are the same in a run of indices. The last
    /// [`SLACK`] numbers of `out` are no results.
    pub(super) fn inverses<S: DigitScramble>(
        &self,
        scramble: &S,
        key: u64,
        table: &[f64],
        first: u64,
        out: &mut [f64],
    ) {
        let power = u64::from(self.power);
        let (mut run, mut start) = (first / power, to_index(first % power));
        let mut done = 0;
        while done + SLACK < out.len() {
            let mut digits = Places {
                base: self,
                rest: run,
            };
            let mut scrambled = Scrambled::new(self, scramble, key);
            scrambled.skip(self.leading);
            let rest = self.rest(&mut scrambled, &mut digits);
            let length = self.power().min(start + out.len() - SLACK - done) - start;
            // Whole vectors: what they write past the end of the run, the next one overwrites.
            let vectors = out[done..].chunks_exact_mut(SLACK);
            for (u, leading) in vectors
                .zip(table[start..].chunks_exact(SLACK))
                .take(length.div_ceil(SLACK))
            {
                for (u, &leading) in u.iter_mut().zip(leading) {
                    *u = self.join(leading, rest);
                }
            }
            done += length;
            start = 0;
            run += 1;
        }
    }

    /// What the first digits of all indices below the power of the base make, where digits are not nested; then
    /// [`SLACK`] numbers without meaning.
    pub(super) fn table<S: DigitScramble>(&self, scramble: &S, key: u64) -> Vec<f64> {
        let mut table = vec![0.0];
        let mut scrambled = Scrambled::new(self, scramble, key);
        let mut weight = f64::from(self.power);
        for _ in 0..self.leading {
            weight *= 1.0 / f64::from(self.base);
            weight = weight.round();
            let below = table.len();
            let digits: Vec<f64> = (0..u64::from(self.base))
                .map(|digit| scrambled.image(digit) as f64 * weight)
                .collect();
            scrambled.skip(1);
            for &digit in &digits[1..] {
                for place in 0..below {
                    table.push(table[place] + digit);
                }
            }
            for entry in &mut table[..below] {
                *entry += digits[0];
            }
        }
        // Room to read whole vectors.
        table.resize(table.len() + SLACK, 0.0);
        table
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
        let mut scrambled = Scrambled::new(self, scramble, key);
        for _ in 0..self.leading {
            scrambled.push(digits.next().unwrap_or(0));
        }
        let leading = core::mem::take(&mut scrambled.mirrored);
        self.join(leading as f64, self.rest(&mut scrambled, &mut digits))
    }

    /// The fraction that the digits after the first make.
    #[inline(always)]
    fn rest<S: DigitScramble>(
        &self,
        scrambled: &mut Scrambled<'_, S>,
        digits: &mut impl Iterator<Item = u64>,
    ) -> f64 {
        let base = u64::from(self.base);
        let mut denominator = 1;
        while denominator < self.room
            && let Some(digit) = digits.next()
        {
            scrambled.push(digit);
            denominator *= base;
        }
        (scrambled.mirrored as f64 + scrambled.tail()) / denominator as f64
    }

    #[inline(always)]
    fn join(&self, leading: f64, rest: f64) -> f64 {
        ((leading + rest) * self.inverse).min(BELOW_ONE)
    }

    /// How many entries with a meaning the [`table`](Self::table) has.
    pub(super) fn power(&self) -> usize {
        self.power as usize
    }
}

fn to_index(remainder: u64) -> usize {
    usize::try_from(remainder).expect("a remainder is below the power of the base, a u32")
}

/// The digits of an index, lowest first, down to the last that is not 0.
struct Places<'a> {
    base: &'a Base,
    rest: u64,
}

impl Iterator for Places<'_> {
    type Item = u64;

    #[inline(always)]
    fn next(&mut self) -> Option<u64> {
        if self.rest == 0 {
            return None;
        }
        let base = u64::from(self.base.base);
        let quotient = if self.rest < SMALL && base < 1 << 20 {
            let product = u128::from(self.rest) * u128::from(self.base.reciprocal);
            high(product)
        } else {
            self.rest / base
        };
        let digit = self.rest - quotient * base;
        self.rest = quotient;
        Some(digit)
    }
}

#[inline(always)]
fn high(product: u128) -> u64 {
    (product >> 64) as u64
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
    #[inline(always)]
    fn new(base: &Base, scramble: &'a S, key: u64) -> Self {
        Self {
            base: base.base,
            scramble,
            key,
            shift: scramble.shift(key),
            place: 0,
            mirrored: 0,
        }
    }

    /// The image of `digit` at the place that comes next.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "digits are below the base, a u32"
    )]
    fn image(&self, digit: u64) -> u64 {
        let base = u64::from(self.base);
        let shift = high(u128::from(self.shift) * u128::from(base));
        if digit == 0 {
            return shift;
        }
        let permuted = self
            .scramble
            .permute(self.key, self.base, self.place, digit as u32);
        let sum = shift + u64::from(permuted);
        if sum >= base { sum - base } else { sum }
    }

    /// Goes on to the place after the next `count`, where digits are not nested.
    #[inline(always)]
    fn skip(&mut self, count: u32) {
        for _ in 0..count {
            self.shift = self.shift.wrapping_mul(self.base.into());
        }
        self.place += count;
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "digits are below the base, a u32"
    )]
    fn push(&mut self, digit: u64) {
        self.mirrored = self.mirrored * u64::from(self.base) + self.image(digit);
        if S::NESTED && digit != 0 {
            self.key = self.scramble.after(self.key, self.place, digit as u32);
            self.shift = self.scramble.shift(self.key);
            self.place += 1;
        } else {
            self.skip(1);
        }
    }

    /// The digits that follow those so far if all the rest of the index are 0, as a fraction in `[0, 1]`.
    #[inline]
    fn tail(&self) -> f64 {
        self.shift as f64 * (1.0 / 18_446_744_073_709_551_616.0)
    }
}
