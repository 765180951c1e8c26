//! Nested scrambling by a hash that carries only from earlier digits to later ones.

use super::BinaryScramble;

/// Nested scrambling, nearly uniform, in a few multiplications.[^laine] [^burley]
///
/// The digits are read as an integer with the first digit lowest, where sums and products carry from earlier to later
/// digits only: so whatever is computed is a nested scramble, and keeps elementary intervals exactly. What is
/// approximate is the choice of the permutations, which is not uniform over all nested ones. In practice
/// errors are those of [`Owen`](super::Owen); take that one where the theorems must hold.
///
/// ```
/// use estimand::points::{HashedOwen, PointSet, Sobol};
///
/// let points = Sobol::new(2)?.scrambled(HashedOwen { seed: 1 });
/// assert_ne!(points.coordinate(0, 0) < 0.5, points.coordinate(1, 0) < 0.5);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^laine]: Laine, Samuli; Karras, Tero (2011). *Stratified Sampling for Stochastic Transparency*.
///     <https://doi.org/10.1111/j.1467-8659.2011.01978.x>
///
/// [^burley]: Burley, Brent (2020). *Practical Hash-based Owen Scrambling*. <https://jcgt.org/published/0009/04/01/>
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HashedOwen {
    /// What selects the scramble.
    pub seed: u64,
}

impl BinaryScramble for HashedOwen {
    fn seed(&self) -> u64 {
        self.seed
    }

    #[inline(always)]
    fn scramble(&self, key: u64, digits: u64) -> u64 {
        scramble(digits, key)
    }
}

/// The nested scramble that `key`, which must be well mixed, selects.
#[inline(always)]
pub(in crate::points) fn scramble(digits: u64, key: u64) -> u64 {
    laine_karras(digits.reverse_bits(), key).reverse_bits()
}

/// A keyed bijection of words in which a bit depends on no higher bit. The key must be well mixed.
///
/// The sequence of steps is Vegdahl's for 32 bits,[^vegdahl] with the multipliers lengthened to 64.
///
/// [^vegdahl]: Vegdahl, Nathan (2021). *Building a Better LK Hash*.
///     <https://psychopath.io/post/2021_01_30_building_a_better_lk_hash>
#[inline(always)]
fn laine_karras(mut word: u64, key: u64) -> u64 {
    word ^= word.wrapping_mul(0x9fb2_1c65_3d20_adea);
    word = word.wrapping_add(key);
    word = word.wrapping_mul((key >> 32) | 1);
    word ^= word.wrapping_mul(0xd6e8_feb8_0552_6c56);
    word ^= word.wrapping_mul(0xa0761d6478bd642e_u64 & !1);
    word
}
