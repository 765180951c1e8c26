//! Nested uniform scrambling.

use super::digit_permutation::permute_nonzero;
use super::{BinaryScramble, DigitScramble};
use crate::hash::{hash, mix};

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

/// Binary digits that share one hash: the 63 nodes of a tree of this height fit into one word.
const LEVELS: u32 = 6;

impl BinaryScramble for Owen {
    fn seed(&self) -> u64 {
        self.seed
    }

    /// A node of the tree of digits is a string of digits, and its permutation is one bit: to flip or not. The
    /// bits of the nodes below a string of `6 k` digits, down to `6 k + 5`, are those of one hash of the
    /// string, numbered as a heap: the root is 1, and the children of `n` are `2 n` and `2 n + 1`.
    #[inline]
    fn scramble(&self, key: u64, digits: u64) -> u64 {
        let mut flips = 0;
        let mut level = 0;
        // 54 digits, one more than a coordinate has: with those that follow it would be 60.
        while level < 54 {
            // The digits before, and a one that tells how many they are.
            let prefix = (digits >> 1 | 1 << 63) >> (63 - level);
            let nodes = mix(key ^ prefix.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let below = digits << level;
            let mut step = 0;
            while step < LEVELS {
                let node = (1 << step) | ((below >> 1) >> (63 - step));
                flips |= ((nodes >> node) & 1) << (63 - level - step);
                step += 1;
            }
            level += LEVELS;
        }
        digits ^ flips
    }
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
