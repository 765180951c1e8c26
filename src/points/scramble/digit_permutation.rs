//! A random permutation of the digits at every place.

use super::DigitScramble;
use crate::hash::{hash, mix, permute};

/// A random permutation of the digits for every dimension and every place, the same whatever the other digits
/// are.[^owen]
///
/// Computed by hashing: no tables, whatever the base. The cheapest randomisation that breaks up the diagonal
/// stripes of Halton's points in large bases; take it there by default.
///
/// ```
/// use estimand::points::{DigitPermutation, Halton, PointSet};
///
/// let points = Halton::new(20)?.scrambled(DigitPermutation { seed: 1 });
/// assert_ne!(points.coordinate(0, 19), 0.0);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^owen]: Owen, Art (2017). *A randomized Halton algorithm in R*. <https://arxiv.org/abs/1706.02808>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DigitPermutation {
    /// What selects the permutations.
    pub seed: u64,
}

impl DigitScramble for DigitPermutation {
    const NESTED: bool = false;

    fn seed(&self) -> u64 {
        self.seed
    }

    #[inline]
    fn shift(&self, key: u64) -> u64 {
        mix(key)
    }

    #[inline]
    fn permute(&self, key: u64, base: u32, place: u32, digit: u32) -> u32 {
        permute_nonzero(hash(key, u64::from(place)), base, digit)
    }
}

/// The image of `digit` under a permutation of `1..base`.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "below the base, a u32")]
pub(super) fn permute_nonzero(key: u64, base: u32, digit: u32) -> u32 {
    permute(u64::from(digit - 1), u64::from(base - 1), key) as u32 + 1
}
