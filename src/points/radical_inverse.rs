//! The radical inverse of an integer in any base.

/// The largest number below 1.
pub(super) const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// The radical inverse of `index`: its digits in `base`, mirrored at the radix point;[^corput] in `[0, 1)`.
///
/// The number nearest to the exact fraction, or, past about 2^53 points, the largest one below 1 if that would be
/// 1.0. Every base from 2 on, every index; the cost is that of some 64 divisions at most.
///
/// ```
/// use estimand::points::radical_inverse;
///
/// assert_eq!(radical_inverse(2, 6), 0.375); // 110 becomes 0.011
/// assert_eq!(radical_inverse(10, 1234), 0.4321);
/// ```
///
/// # Panics
///
/// If `base` is below 2.
///
/// [^corput]: van der Corput, Johannes (1935). *Verteilungsfunktionen*.
///     <https://dwc.knaw.nl/DL/publications/PU00016669.pdf>
pub fn radical_inverse(base: u32, index: u64) -> f64 {
    assert!(base >= 2, "radical_inverse: the base {base} is below 2");
    // The mirrored integer is below base^digits <= base * index, which fits into 96 bits.
    let (mut mirrored, mut power) = (0, 1);
    let mut rest = index;
    while rest != 0 {
        mirrored = mirrored * u128::from(base) + u128::from(rest % u64::from(base));
        power *= u128::from(base);
        rest /= u64::from(base);
    }
    ratio(mirrored, power)
}

/// The number in `[0, 1)` that is nearest to `numerator / denominator`.
///
/// The numerator must be below the denominator, and that below 2^97.
pub(super) fn ratio(numerator: u128, denominator: u128) -> f64 {
    debug_assert!(numerator < denominator && denominator < 1 << 97);
    const EXACT: u128 = 1 << 53;
    if denominator <= EXACT {
        // Both are exact, so that the quotient is rounded once; it is at most 1 - 2^-53, which is a number.
        return numerator as f64 / denominator as f64;
    }
    if numerator == 0 {
        return 0.0;
    }
    // Scaled by 2^shift the quotient lies in (1/2, 2), so that 56 binary places hold 56 or 57 digits: the 53 that
    // are kept, at least two more, and what is left over marked in the last.
    let shift = numerator.leading_zeros() - denominator.leading_zeros();
    let scaled = numerator << shift;
    let (mut quotient, mut rest) = (scaled / denominator, scaled % denominator);
    for _ in 0..2 {
        let next = rest << 28;
        quotient = (quotient << 28) | (next / denominator);
        rest = next % denominator;
    }
    quotient |= u128::from(rest != 0);
    let scale = f64::from_bits((1023 - 56 - u64::from(shift)) << 52);
    (quotient as f64 * scale).min(BELOW_ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_van_der_corput() {
        // Eighths, in the order of van der Corput (1935).
        let eighths = [0.0, 4.0, 2.0, 6.0, 1.0, 5.0, 3.0, 7.0];
        for (index, eighth) in (0..).zip(eighths) {
            assert_eq!(radical_inverse(2, index), eighth / 8.0);
        }
        let ninths = [0.0, 3.0, 6.0, 1.0, 4.0, 7.0, 2.0, 5.0, 8.0];
        for (index, ninth) in (0..).zip(ninths) {
            assert_eq!(radical_inverse(3, index), ninth / 9.0);
        }
    }

    #[test]
    fn the_last_indices_are_below_one_and_right() {
        for base in (2..200).chain([65_535, 65_536, u32::MAX]) {
            for index in [
                u64::MAX,
                u64::MAX - 1,
                1 << 53,
                1 << 32,
                u64::from(u32::MAX),
            ] {
                let inverse = radical_inverse(base, index);
                assert!((0.0..1.0).contains(&inverse));
                // The leading digits bound the value from both sides.
                let (mut rest, mut low, mut width) = (index, 0.0, 1.0);
                while width > 1e-12 {
                    width /= f64::from(base);
                    low += (rest % u64::from(base)) as f64 * width;
                    rest /= u64::from(base);
                }
                assert!(inverse >= low - 1e-15 && inverse <= low + width + 1e-15);
            }
        }
        assert_eq!(radical_inverse(2, u64::MAX), BELOW_ONE);
        assert_eq!(radical_inverse(2, 1 << 63), 0.5_f64.powi(64));
        // With b = 2^32 - 1, 2^64 - 1 = b (b + 2) = b^2 + 2 b.
        let base = f64::from(u32::MAX);
        let expected = (2.0 + 1.0 / base) / base / base;
        assert!((radical_inverse(u32::MAX, u64::MAX) / expected - 1.0).abs() < 1e-15);
    }

    #[test]
    fn ratios_are_rounded_to_nearest() {
        // Odd multiples of 2^-54 above a half lie half way between two numbers: ties go to even.
        let one = 1_u128 << 60;
        assert_eq!(ratio(one / 2 + (1 << 6), one), 0.5);
        assert_eq!(ratio(one / 2 + (3 << 6), one), 0.5 + f64::EPSILON);
        assert_eq!(ratio(one / 2 + (1 << 6) + 1, one), 0.5 + f64::EPSILON / 2.0);
        assert_eq!(ratio(one - 1, one), BELOW_ONE);
        assert_eq!(ratio(1, one), 0.5_f64.powi(60));
        assert_eq!(ratio(one, 3 * one), 1.0 / 3.0);
    }
}
