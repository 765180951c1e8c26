//! Randomisations of digits: one file each, typed by the family of digits that they are made for.
//!
//! | randomisation | binary digits | digits in any base | what it is |
//! |---|---|---|---|
//! | [`Plain`] | yes | yes | none |
//! | [`DigitalShift`] | yes | yes | one random number is added, digit by digit |
//! | [`DigitPermutation`] | | yes | a random permutation at every place |
//! | [`LinearMatrix`] | yes | | a random triangular matrix, then a digital shift |
//! | [`Owen`] | yes | yes | a random permutation at every node of the tree of digits |
//! | [`HashedOwen`] | yes | | nearly the same, in a few multiplications |
//!
//! All of them keep the elementary intervals of the set, and move every point, the origin included, to a
//! uniformly distributed place. Do not drop the origin or "burn in" a scrambled set: both destroy what the
//! set promises.[^owen]
//!
//! # Writing your own
//!
//! Implement [`BinaryScramble`] or [`DigitScramble`], or both; every set of the family takes it.
//!
//! [^owen]: Owen, Art (2020). *On dropping the first Sobol' point*. <https://arxiv.org/abs/2008.08051>

use crate::hash::hash;

mod digit_permutation;
mod digital_shift;
mod hashed_owen;
mod linear_matrix;
mod nested_hash;
mod owen;

pub use digit_permutation::DigitPermutation;
pub use digital_shift::DigitalShift;
pub use hashed_owen::HashedOwen;
pub(super) use hashed_owen::{ENDINGS, Ending, scramble, scramble_endings};
pub use linear_matrix::LinearMatrix;
pub(super) use nested_hash::{NestedHash, first_half};
pub use owen::Owen;

/// The generator matrix over the two-element field that makes the binary digits of one dimension: column `k` is what bit
/// `k` of the index adds, its first digit in the highest bit.
pub type Columns = [u64; 64];

/// In which order a word holds the digits of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DigitOrder {
    /// The first digit is the highest bit: the word is the coordinate, times 2^64.
    FirstHighest,
    /// The first digit is the lowest bit: sums and products carry from earlier digits to later ones.
    FirstLowest,
}

/// A randomisation of binary digits: of [`Sobol`](super::Sobol)'s and of every other net in base 2.
///
/// A pair that makes no sense does not compile:
///
/// ```compile_fail
/// use estimand::points::{DigitPermutation, Sobol};
///
/// let points = Sobol::new(2)?.scrambled(DigitPermutation { seed: 1 });
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait BinaryScramble: Sync {
    /// In which order [`prepare`](Self::prepare) and [`scramble`](Self::scramble) are given the digits.
    const ORDER: DigitOrder = DigitOrder::FirstHighest;

    /// What selects this randomisation among its like.
    fn seed(&self) -> u64;

    /// What selects the randomisation of `dimension`.
    #[inline]
    fn key(&self, dimension: u32) -> u64 {
        hash(self.seed(), u64::from(dimension))
    }

    /// The part of the randomisation that is linear over the two-element field: what takes the place of the columns of the
    /// dimension of `key`, asked for once. `None` if they stay, as they do by default; then all sets share them.
    fn prepare(&self, key: u64, columns: &Columns) -> Option<Columns> {
        let _ = (key, columns);
        None
    }

    /// The rest of it, for every point: the scrambled digits, from those that the [prepared](Self::prepare) columns make.
    /// The first scrambled digit is the highest bit.
    fn scramble(&self, key: u64, digits: u64) -> u64;
}

/// A randomisation of the digits of numbers in any base: of [`Halton`](super::Halton)'s and its like.
///
/// The digit `a` at some place becomes `(s + p(a)) mod base`. Here `s` is the digit at that place of a random
/// number, the *shift*, and `p` a permutation that keeps 0 where it is; every permutation has exactly one such form.
/// So the digits 0 without end that follow the last digit of an index become the rest of the
/// shift, at no cost.
///
/// A pair that makes no sense does not compile:
///
/// ```compile_fail
/// use estimand::points::{Halton, HashedOwen};
///
/// let points = Halton::new(2)?.scrambled(HashedOwen { seed: 1 });
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait DigitScramble: Sync {
    /// Whether the permutation of a digit depends on the digits before it.
    const NESTED: bool;

    /// What selects this randomisation among its like.
    fn seed(&self) -> u64;

    /// What selects the randomisation of `dimension`.
    #[inline]
    fn key(&self, dimension: u32) -> u64 {
        hash(self.seed(), u64::from(dimension))
    }

    /// The random number whose digits are added from the first place on, or from the place on after that
    /// which made the key in [`after`](Self::after): a fraction of 2^64.
    fn shift(&self, key: u64) -> u64;

    /// The image of `digit`, which is among `1..base`, at `place`: among `1..base`.
    fn permute(&self, key: u64, base: u32, place: u32, digit: u32) -> u32;

    /// The key for the places after a `digit` that is not 0; only asked for if [`NESTED`](Self::NESTED).
    fn after(&self, key: u64, place: u32, digit: u32) -> u64 {
        let _ = (place, digit);
        key
    }
}

/// No randomisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plain;

impl BinaryScramble for Plain {
    fn seed(&self) -> u64 {
        0
    }

    #[inline]
    fn key(&self, _: u32) -> u64 {
        0
    }

    #[inline(always)]
    fn scramble(&self, _: u64, digits: u64) -> u64 {
        digits
    }
}

impl DigitScramble for Plain {
    const NESTED: bool = false;

    fn seed(&self) -> u64 {
        0
    }

    #[inline]
    fn key(&self, _: u32) -> u64 {
        0
    }

    #[inline]
    fn shift(&self, _: u64) -> u64 {
        0
    }

    #[inline]
    fn permute(&self, _: u64, _: u32, _: u32, digit: u32) -> u32 {
        digit
    }
}
