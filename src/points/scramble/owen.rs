//! Nested uniform scrambling.

use super::digit_permutation::permute_nonzero;
use super::{BinaryScramble, DigitScramble};
use crate::hash::{GOLDEN, hash, mix};

/// Nested uniform scrambling: every digit is permuted by a random permutation that is chosen by all the digits
/// before it.[^owen]
///
/// The strongest randomisation: every point is uniform, elementary intervals are kept, and the variance of an average over
/// a scrambled net falls faster than `1/count` for every integrand with a variance, up to `count^(-3)` for smooth
/// ones. Exact up to the quality of the hash: nothing in it is approximated, down to the last bit in
/// base 2, and to intervals of length 2^-50 or less in other bases. [`HashedOwen`](super::HashedOwen) is
/// much faster in base 2.
///
/// ```
/// use estimand::points::{Halton, Owen, PointSet, Sobol};
///
/// let net = Sobol::new(2)?.scrambled(Owen { seed: 1 });
/// let halton = Halton::new(2)?.scrambled(Owen { seed: 1 });
/// // The first two points lie in different halves still.
/// assert_ne!(net.coordinate(0, 0) < 0.5, net.coordinate(1, 0) < 0.5);
/// assert_ne!(halton.coordinate(0, 0) < 0.5, halton.coordinate(1, 0) < 0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^owen]: Owen, Art (1995). *Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences*.
///     <https://doi.org/10.1007/978-1-4612-2552-2_19>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owen {
    /// What selects the permutations.
    pub seed: u64,
}

impl BinaryScramble for Owen {
    fn seed(&self) -> u64 {
        self.seed
    }

    #[inline(always)]
    fn scramble(&self, key: u64, digits: u64) -> u64 {
        // 54 digits, one more than a coordinate has. Written out, so that many are computed side by side.
        digits
            ^ six_flips::<0>(key, digits)
            ^ six_flips::<6>(key, digits)
            ^ six_flips::<12>(key, digits)
            ^ six_flips::<18>(key, digits)
            ^ six_flips::<24>(key, digits)
            ^ six_flips::<30>(key, digits)
            ^ six_flips::<36>(key, digits)
            ^ six_flips::<42>(key, digits)
            ^ six_flips::<48>(key, digits)
    }
}

/// Which of the six binary digits after the first `LEVEL` are flipped, in their places.
///
/// A node of the tree of digits is a string of digits, and its permutation is one bit: to flip or not. The 63 nodes
/// from a string of `LEVEL` digits to those five digits longer have the bits of one hash of the string. They are
/// numbered as a heap: the root is 1, and the children of `n` are `2 n` and `2 n + 1`.
#[inline(always)]
fn six_flips<const LEVEL: u32>(key: u64, digits: u64) -> u64 {
    // The digits before, and those with the next six, after a one that tells how many they are.
    let before = (digits >> 1 | 1 << 63) >> (63 - LEVEL);
    let nodes = mix(key ^ before.wrapping_mul(GOLDEN));
    let node = (digits << LEVEL >> 58) | 1 << 6;
    let flips = (nodes >> (node >> 6) & 1) << 5
        | (nodes >> (node >> 5) & 1) << 4
        | (nodes >> (node >> 4) & 1) << 3
        | (nodes >> (node >> 3) & 1) << 2
        | (nodes >> (node >> 2) & 1) << 1
        | (nodes >> (node >> 1) & 1);
    flips << (58 - LEVEL)
}

impl DigitScramble for Owen {
    const NESTED: bool = true;

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

    #[inline]
    fn after(&self, key: u64, place: u32, digit: u32) -> u64 {
        hash(key, u64::from(place) << 32 | u64::from(digit))
    }
}
