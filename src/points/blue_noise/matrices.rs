//! The generator matrices of a group of dimensions.

use core::array;
use std::sync::LazyLock;

use super::curve::SAMPLES;
use crate::points::scramble::{Columns, first_half};
use crate::points::sobol::{generator, van_der_corput};

/// Dimensions of a group.
pub(super) const WIDTH: u32 = 4;

/// What the generator matrices make of places: digits of which the first is the lowest bit.
pub(super) struct Tables {
    /// What each bit of a place adds.
    columns: [[u64; WIDTH as usize]; 64],
    /// The digits of places below [`SAMPLES`].
    pub(super) near: [[u32; WIDTH as usize]; SAMPLES],
}

pub(super) static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let matrices = matrices();
    let columns = array::from_fn(|bit| array::from_fn(|axis| matrices[axis][bit].reverse_bits()));
    let near = array::from_fn(|place| digits_by(&columns, place as u64).map(first_half));
    Tables { columns, near }
});

/// The generator matrices of a group: those of Sobol's first four polynomials.
///
/// The directions of the last are not Joe's and Kuo's 1, 3 and 1. Among four points the first digit can be one of two sums of bits
/// only, so that of four dimensions some have it in common: here the first and the last, and the two between; with Joe's and Kuo's the last
/// three. So eight points have 1.2 to 1.5 times the mean squared error of pairs of dimensions in pictures with those, 0.98 to 1.09 times with
/// these, and the same with both from sixteen on. Of the polynomials and directions up to degree five
/// that were tried they have the least squared worst-case error for functions whose Walsh coefficients fall as 4^-digits, interactions
/// weighted by a half for each dimension: in the mean of its logarithm over 4, 8, 16 and up to 256 points, those that are no power of
/// four counting half.
fn matrices() -> [Columns; WIDTH as usize] {
    [
        van_der_corput(),
        generator(0, &[1]),
        generator(1, &[1, 3]),
        generator(1, &[1, 1, 3]),
    ]
}

/// The digits of the point at a place.
#[inline(always)]
pub(super) fn digits(place: u64) -> [u64; WIDTH as usize] {
    digits_by(&TABLES.columns, place)
}

/// The same, by the columns of the matrices.
#[inline(always)]
fn digits_by(columns: &[[u64; WIDTH as usize]; 64], place: u64) -> [u64; WIDTH as usize] {
    let mut digits = [0; WIDTH as usize];
    let mut rest = place;
    while rest != 0 {
        let column = &columns[rest.trailing_zeros() as usize % 64];
        for (digits, column) in digits.iter_mut().zip(column) {
            *digits ^= column;
        }
        rest &= rest - 1;
    }
    digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash;
    use crate::points::scramble::DigitOrder;
    use crate::points::sobol::{multiplied, table};

    #[test]
    fn the_dimensions_are_those_of_sobol() {
        // The fourth by the recurrence of x^3 + x + 1, on the number of 64 digits that a column is.
        let last = matrices()[3];
        assert_eq!(last[..3], [1 << 63, 1 << 62, 3 << 61]);
        for k in 3..64 {
            assert_eq!(last[k], last[k - 2] ^ last[k - 3] ^ last[k - 3] >> 3);
        }
        // The first three are those of Joe and Kuo, too.
        let sobol = table(3, DigitOrder::FirstLowest);
        for word in (0..200).map(|word| hash(4, word)) {
            for (axis, matrix) in sobol.iter().enumerate() {
                assert_eq!(multiplied(matrix, word), digits(word)[axis]);
            }
            let near = word % SAMPLES as u64;
            let place = usize::try_from(near).unwrap();
            let apart = TABLES.near[place];
            let rest = digits(word - near);
            for axis in 0..4 {
                assert_eq!(digits(word)[axis], rest[axis] ^ u64::from(apart[axis]));
            }
        }
    }
}
