//! Points inside equal strata of the unit interval.

use super::finite::CHUNK;
use super::radical_inverse::BELOW_ONE;
use crate::hash::{hash_prepared, unit};

/// The point at the fraction `offset`, in `[0, 1)`, of the stratum `stratum` of `count` equal ones.
///
/// In `[0, 1)`: the quotient is rounded once, from a number below 1; where it rounds to 1.0, as it can past
/// 2^52 strata, the largest number below is taken.
#[inline]
pub(super) fn within(stratum: u64, count: u64, offset: f64) -> f64 {
    ((stratum as f64 + offset) / count as f64).min(BELOW_ONE)
}

/// The points [`within`] the `strata` of `count`, at the offsets that a prepared key makes of `words`.
#[inline(always)]
pub(super) fn write_within(
    strata: &[u32; CHUNK],
    count: u64,
    prepared: u64,
    words: &[u32; CHUNK],
    out: &mut [f64; CHUNK],
) {
    let (divisor, inverse) = (count as f64, 1.0 / count as f64);
    for ((u, &stratum), &word) in out.iter_mut().zip(strata).zip(words) {
        *u = f64::from(stratum) + unit(hash_prepared(prepared, word.into()));
    }
    if count.is_power_of_two() {
        // Exact, and faster than to divide.
        out.iter_mut().for_each(|u| *u = below_one(*u * inverse));
    } else {
        out.iter_mut().for_each(|u| *u = below_one(*u / divisor));
    }
}

/// One instruction, as `f64::min` is not: there is no NaN here.
#[inline(always)]
fn below_one(u: f64) -> f64 {
    if u < BELOW_ONE { u } else { BELOW_ONE }
}

/// Divides numbers below 2^32 by one that is, without a division.
#[derive(Clone, Copy)]
pub(super) struct Divisor {
    divisor: u32,
    inverse: f64,
}

/// A quotient, rounded down, and what is left.
#[derive(Clone, Copy)]
pub(super) struct Quotient {
    pub(super) whole: u32,
    pub(super) rest: u32,
}

impl Divisor {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "below 2^32")]
    pub(super) fn new(divisor: u64) -> Self {
        debug_assert!((1..1 << 32).contains(&divisor));
        Self {
            divisor: divisor as u32,
            inverse: 1.0 / divisor as f64,
        }
    }

    /// The half keeps the quotient away from whole numbers, by half of the inverse at least: more than the
    /// roundings of a quotient below 2^32 amount to.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number below 2^32"
    )]
    pub(super) fn divide(self, number: u32) -> Quotient {
        let whole = ((f64::from(number) + 0.5) * self.inverse) as u32;
        Quotient {
            whole,
            rest: number.wrapping_sub(whole.wrapping_mul(self.divisor)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_are_whole() {
        let numbers = [
            0,
            1,
            2,
            1000,
            65_535,
            65_536,
            1 << 31,
            u32::MAX - 1,
            u32::MAX,
        ];
        let divisors = (1..3000).chain([65_535, 65_536, 65_537, 1 << 31, u32::MAX]);
        for divisor in divisors {
            // The multiples of the divisor and their neighbours are where a rounding would show.
            let last = u32::MAX / divisor * divisor;
            for number in numbers
                .into_iter()
                .chain([last, last - 1, divisor, divisor - 1])
            {
                let Quotient { whole, rest } = Divisor::new(divisor.into()).divide(number);
                assert_eq!((whole, rest), (number / divisor, number % divisor));
            }
        }
    }
}
