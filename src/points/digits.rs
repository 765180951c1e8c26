//! One base of a set whose coordinates are mirrored digits.

use super::radical_inverse::BELOW_ONE;
use super::scramble::DigitScramble;

/// The largest denominator whose multiples the digits of an index are kept to: with any base below 2^20 the digits before it
/// stop at a power above 2^43, and are followed by the rest of the shift as a fraction.
const FINEST: u64 = 1 << 63;

/// Coordinates that are computed at once; every table has more.
pub(super) const CHUNK: usize = 32;

/// How many times that in a column.
pub(super) const CHUNKS: usize = 8;

/// The coordinates in one dimension of points with consecutive indices.
pub(super) type Column = [[f64; CHUNK]; CHUNKS];

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
        if self.base == 2 && !S::NESTED {
            return self.binary(scramble.shift(key), index);
        }
        self.fraction(scramble, key, Places::new(self, index))
    }

    /// The same in base 2, where digits are not nested: all at once. There is only one permutation that keeps 0, and
    /// the shift is added without carries.
    #[inline]
    fn binary(&self, shift: u64, index: u64) -> f64 {
        let digits = index.reverse_bits() ^ shift;
        let leading = digits >> (u64::BITS - self.leading);
        // The digits of the index after the first, and all of the shift after those.
        let count = u64::BITS - (index >> self.leading).leading_zeros();
        let (digits, shift) = (digits << self.leading, shift << self.leading);
        let mirrored = digits.checked_shr(u64::BITS - count).unwrap_or(0);
        let tail = fraction_of_word(shift << count);
        let scale = f64::from_bits((1023 - u64::from(count)) << 52);
        self.join(leading as f64, (mirrored as f64 + tail) * scale)
    }

    /// The scrambled radical inverses of `count` consecutive indices, from `first` on, where digits are not nested. They are
    /// the first numbers of `column`; others in it have no meaning.
    ///
    /// The first digits come from a table of all their values; the other digits are the same in a run of indices.
    #[inline(always)]
    pub(super) fn inverses<S: DigitScramble>(
        &self,
        scramble: &S,
        key: u64,
        table: &[f64],
        first: u64,
        count: usize,
        column: &mut Column,
    ) {
        let power = u64::from(self.power);
        let (place, power) = (to_index(first % power), to_index(power));
        let mut runs = Runs::new(self, scramble, key, first / u64::from(self.power));
        // Each run is longer than a chunk.
        let mut rests = [0.0; CHUNKS + 2];
        let chunks = count.div_ceil(CHUNK);
        let touched = (place + count).div_ceil(power);
        for rest in &mut rests[..touched] {
            *rest = runs.next();
        }
        write_runs(&mut column[..chunks], table, place, &rests, self);
    }

    /// What the first digits of all indices below the power of the base make, where digits are not nested; then the first
    /// [`CHUNK`] of them again.
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
        table.extend_from_within(..CHUNK);
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

    /// What the possible digits in the first place make, where digits are not nested, to be joined with
    /// [`later`](Self::later) ones.
    pub(super) fn firsts<S: DigitScramble>(
        &self,
        scramble: &S,
        key: u64,
    ) -> impl Iterator<Item = f64> {
        let scrambled = Scrambled::new(self, scramble, key);
        let weight = u64::from(self.power / self.base);
        (0..u64::from(self.base)).map(move |digit| (scrambled.image(digit) * weight) as f64)
    }

    /// What the digits after the first place make, where digits are not nested.
    pub(super) fn later<S: DigitScramble>(
        &self,
        scramble: &S,
        key: u64,
        mut digits: impl Iterator<Item = u64>,
    ) -> Later {
        let mut scrambled = Scrambled::new(self, scramble, key);
        scrambled.skip(1);
        for _ in 1..self.leading {
            scrambled.push(digits.next().unwrap_or(0));
        }
        let leading = core::mem::take(&mut scrambled.mirrored);
        Later {
            leading: leading as f64,
            rest: self.rest(&mut scrambled, &mut digits),
        }
    }

    /// The [`fraction`](Self::fraction) of a first digit and the later ones.
    #[inline(always)]
    pub(super) fn joined(&self, first: f64, later: Later) -> f64 {
        self.join(first + later.leading, later.rest)
    }

    /// The fraction that the digits after the first make.
    #[inline(always)]
    fn rest<S: DigitScramble>(
        &self,
        scrambled: &mut Scrambled<'_, S>,
        digits: &mut impl Iterator<Item = u64>,
    ) -> f64 {
        let denominator = self.push_all(scrambled, digits, 1);
        (scrambled.mirrored as f64 + scrambled.tail()) / denominator as f64
    }

    /// Pushes digits as long as there are some, and there is room for them after those that make `denominator`. Returns the
    /// denominator of all.
    #[inline(always)]
    fn push_all<S: DigitScramble>(
        &self,
        scrambled: &mut Scrambled<'_, S>,
        digits: &mut impl Iterator<Item = u64>,
        mut denominator: u64,
    ) -> u64 {
        while denominator < self.room
            && let Some(digit) = digits.next()
        {
            scrambled.push(digit);
            denominator *= u64::from(self.base);
        }
        denominator
    }

    #[inline(always)]
    fn join(&self, leading: f64, rest: f64) -> f64 {
        join(leading, rest, self.inverse)
    }

    /// How many entries with a meaning the [`table`](Self::table) has.
    pub(super) fn power(&self) -> usize {
        self.power as usize
    }
}

/// What all digits but the first make: an integer, and a fraction.
#[derive(Clone, Copy)]
pub(super) struct Later {
    leading: f64,
    rest: f64,
}

#[inline(always)]
fn join(leading: f64, rest: f64, inverse: f64) -> f64 {
    // One instruction, as `f64::min` is not: there is no NaN here.
    let u = (leading + rest) * inverse;
    if u < BELOW_ONE { u } else { BELOW_ONE }
}

/// Joins the first digits, from `place` in the table on, with the other digits of one run after the other.
#[inline(always)]
fn write_runs(
    mut chunks: &mut [[f64; CHUNK]],
    table: &[f64],
    mut place: usize,
    rests: &[f64; CHUNKS + 2],
    base: &Base,
) {
    let (power, inverse) = (base.power(), base.inverse);
    let mut run = 0;
    // A loop that the compiler leaves alone: it would put chunks into vectors, in the place of what is in a chunk.
    while let Some((chunk, later)) = chunks.split_first_mut() {
        let mut us: [f64; CHUNK] = *table[place..].first_chunk().expect("the table goes on");
        let (left, now, next) = (power - place, rests[run], rests[run + 1]);
        for (lane, u) in us.iter_mut().enumerate() {
            *u = join(*u, if lane < left { now } else { next }, inverse);
        }
        *chunk = us;
        place += CHUNK;
        if place >= power {
            place -= power;
            run += 1;
        }
        chunks = later;
    }
}

/// What the digits after the first make, in one run of indices that share them after the other, where digits are not
/// nested.
struct Runs<'a, S> {
    base: &'a Base,
    scramble: &'a S,
    key: u64,
    /// The number of the run, but for its first digit, and that.
    upper: u64,
    digit: u64,
    /// At the place of that digit.
    scrambled: Scrambled<'a, S>,
    /// What the upper digits make, scrambled: an integer and the fraction that follows, over a denominator.
    mirrored: u64,
    tail: f64,
    /// The denominator, and what a first digit of 1 adds to the integer.
    denominator: u64,
    weight: u64,
}

impl<'a, S: DigitScramble> Runs<'a, S> {
    /// From the run number `run` on.
    #[inline(always)]
    fn new(base: &'a Base, scramble: &'a S, key: u64, run: u64) -> Self {
        let mut scrambled = Scrambled::new(base, scramble, key);
        scrambled.skip(base.leading);
        let mut runs = Self {
            base,
            scramble,
            key,
            upper: run / u64::from(base.base),
            digit: run % u64::from(base.base),
            scrambled,
            mirrored: 0,
            tail: 0.0,
            denominator: 1,
            weight: 1,
        };
        runs.set_upper();
        runs
    }

    #[inline(always)]
    fn set_upper(&mut self) {
        let mut scrambled = Scrambled::new(self.base, self.scramble, self.key);
        scrambled.skip(self.base.leading + 1);
        let mut digits = Places::new(self.base, self.upper);
        let base = u64::from(self.base.base);
        self.denominator = self.base.push_all(&mut scrambled, &mut digits, base);
        self.weight = self.denominator / base;
        self.mirrored = scrambled.mirrored;
        self.tail = scrambled.tail();
    }

    /// The fraction of the next run.
    #[inline(always)]
    fn next(&mut self) -> f64 {
        let base = u64::from(self.base.base);
        let fraction = if self.upper == 0 && self.digit == 0 {
            // No digit at all, and all of the shift.
            self.scrambled.tail()
        } else {
            let mirrored = self.scrambled.image(self.digit) * self.weight + self.mirrored;
            (mirrored as f64 + self.tail) / self.denominator as f64
        };
        self.digit += 1;
        if self.digit == base {
            self.digit = 0;
            self.upper += 1;
            self.set_upper();
        }
        fraction
    }
}

fn to_index(remainder: u64) -> usize {
    usize::try_from(remainder).expect("a remainder is below the power of the base, a u32")
}

/// The digits of an index, lowest first, down to the last that is not 0.
struct Places {
    base: u64,
    reciprocal: u64,
    rest: u64,
    /// Whether multiplying by the reciprocal does.
    small: bool,
}

impl Places {
    #[inline(always)]
    fn new(base: &Base, index: u64) -> Self {
        Self {
            base: base.base.into(),
            reciprocal: base.reciprocal,
            rest: index,
            small: index < SMALL && base.base < 1 << 20,
        }
    }
}

impl Iterator for Places {
    type Item = u64;

    #[inline(always)]
    fn next(&mut self) -> Option<u64> {
        if self.rest == 0 {
            return None;
        }
        let quotient = if self.small {
            high(u128::from(self.rest) * u128::from(self.reciprocal))
        } else {
            self.rest / self.base
        };
        let digit = self.rest - quotient * self.base;
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
        fraction_of_word(self.shift)
    }
}

/// A fraction of 2^64, in `[0, 1]`.
#[inline(always)]
fn fraction_of_word(word: u64) -> f64 {
    word as f64 * (1.0 / 18_446_744_073_709_551_616.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash;
    use crate::points::{DigitPermutation, DigitalShift, Plain};

    #[test]
    fn binary_digits_are_mirrored_at_once_as_one_by_one() {
        fn check(scramble: &impl DigitScramble) {
            let base = Base::new(2);
            for bits in 0..64 {
                for key in 0..200 {
                    let index = hash(key, bits) >> bits;
                    for index in [index, 1 << bits, u64::MAX >> bits] {
                        assert_eq!(
                            base.inverse(scramble, key, index),
                            base.fraction(scramble, key, Places::new(&base, index)),
                            "{index}"
                        );
                    }
                }
            }
        }
        check(&Plain);
        check(&DigitalShift { seed: 1 });
        check(&DigitPermutation { seed: 1 });
    }
}
