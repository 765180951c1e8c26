//! Counter-based mixing of integers: the randomness of every randomised point set.
//!
//! Pure functions, value-stable: a change of one bit of their results is a breaking change.

/// A bijection of the 64-bit words that sends neighbouring words far apart.
///
/// Two rounds of xor-shift and multiply with the constants of "variant 13".[^stafford] It maps 0 to 0:
/// callers that count from 0 add a key first, as [`hash`] does.
///
/// [^stafford]: Stafford, David (2011). *Better Bit Mixing: Improving on MurmurHash3's 64-bit Finalizer*.
///     <https://zimbry.blogspot.com/2011/09/better-bit-mixing-improving-on.html>
#[inline]
pub const fn mix(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// The golden ratio as a 64-bit odd fraction: the increment of the Weyl sequence in SplitMix64.[^steele]
///
/// [^steele]: Steele, Guy; Lea, Doug; Flood, Christine (2014). *Fast Splittable Pseudorandom Number
///     Generators*. <https://doi.org/10.1145/2660193.2660195>
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A word that depends on every bit of `key` and of `word`. For a fixed `key` it is a bijection of `word`.
///
/// Seeds of blocks, replicates, pixels and dimensions are derived with this, never by adding multiples
/// of a constant to a seed.
#[inline]
pub const fn hash(key: u64, word: u64) -> u64 {
    hash_prepared(prepare(key), word)
}

/// What [`hash`] makes of its key, for many words.
#[inline]
pub(crate) const fn prepare(key: u64) -> u64 {
    mix(key.wrapping_add(GOLDEN))
}

/// The [`hash`] of a word with a key that is [prepared](prepare).
#[inline]
pub(crate) const fn hash_prepared(prepared: u64, word: u64) -> u64 {
    mix(prepared ^ word.wrapping_mul(GOLDEN).wrapping_add(GOLDEN))
}

/// The top 53 bits of a word as a number in `[0, 1)`, truncated: never `1.0`.
///
/// ```
/// use estimand::hash::unit;
///
/// assert_eq!(unit(1 << 63), 0.5);
/// assert!(unit(u64::MAX) < 1.0);
/// ```
#[inline]
pub const fn unit(word: u64) -> f64 {
    const SCALE: f64 = 1.0 / (1_u64 << 53) as f64;
    (word >> 11) as f64 * SCALE
}

/// The top 24 bits of a word as a number in `[0, 1)`, truncated: never `1.0`.
#[inline]
pub const fn unit_f32(word: u64) -> f32 {
    const SCALE: f32 = 1.0 / (1_u32 << 24) as f32;
    (word >> 40) as f32 * SCALE
}

/// The image of `index` under a random permutation of `0..count` that `key` selects.
///
/// Constant memory, any count. Up to 16 every permutation is equally likely, to one part in a million; more are
/// permuted by a keyed bijection of the next power of two, walked along its cycle until it falls inside `0..count`
/// (fewer than two steps on average),[^black] in which pairs of images are as good as uniform.
///
/// # Panics
///
/// If `index >= count`.
///
/// ```
/// use estimand::hash::permute;
///
/// let mut image: Vec<u64> = (0..10).map(|index| permute(index, 10, 42)).collect();
/// image.sort();
/// assert_eq!(image, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
/// ```
///
/// [^black]: Black, John; Rogaway, Phillip (2002). *Ciphers with Arbitrary Finite Domains*.
///     <https://doi.org/10.1007/3-540-45760-7_9>
#[inline]
pub const fn permute(index: u64, count: u64, key: u64) -> u64 {
    assert!(index < count, "permute: the index must be below the count");
    if count <= FEW {
        return shuffle(index, count, key);
    }
    let bijection = Bijection::new(key);
    let bits = u64::BITS - (count - 1).leading_zeros();
    let mut image = index;
    loop {
        image = bijection.apply(image, bits);
        if image < count {
            return image;
        }
    }
}

/// So few that they are shuffled one by one: on small sets of words the rounds of the bijection mix too little.
pub(crate) const FEW: u64 = TABLE as u64;

/// The same for tables.
pub(crate) const TABLE: usize = 16;

/// Where Fisher and Yates' shuffle of `0..count` puts `index`.
#[inline]
const fn shuffle(index: u64, count: u64, key: u64) -> u64 {
    let mut swaps = Swaps::new(count, key);
    let mut image = index;
    while let Some([last, place]) = swaps.next() {
        if image == last {
            image = place;
        } else if image == place {
            image = last;
        }
    }
    image
}

/// Where the shuffle of `0..count`, [`FEW`] at most, puts all of them: what [`permute`] makes of each, in the time of one.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "few numbers")]
pub(crate) fn shuffled(count: u64, key: u64) -> [u32; TABLE] {
    debug_assert!(count <= FEW);
    // Who is at each place.
    let mut numbers = [0; TABLE];
    for (number, place) in numbers.iter_mut().zip(0_u32..) {
        *number = place;
    }
    let mut swaps = Swaps::new(count, key);
    while let Some([last, place]) = swaps.next() {
        numbers.swap(last as usize, place as usize);
    }
    let mut images = [0; TABLE];
    for (place, &number) in (0..).zip(&numbers) {
        images[number as usize] = place;
    }
    images
}

/// The swaps of Fisher and Yates' shuffle: each of the last of the numbers that are left with one of them.
struct Swaps {
    word: u64,
    left: u64,
}

impl Swaps {
    #[inline]
    const fn new(count: u64, key: u64) -> Self {
        Self {
            // 16! is below 2^45: one word has enough randomness for all the swaps.
            word: mix(key.wrapping_add(GOLDEN)),
            left: count,
        }
    }

    #[inline]
    const fn next(&mut self) -> Option<[u64; 2]> {
        if self.left <= 1 {
            return None;
        }
        let product = self.word as u128 * self.left as u128;
        self.word = self.word.wrapping_mul(self.left);
        self.left -= 1;
        Some([self.left, (product >> 64) as u64])
    }
}

/// Rounds of a [`Bijection`]: with one fewer, pairs of images are visibly not uniform among 32 words.
pub(crate) const ROUNDS: usize = 6;

/// A keyed bijection of the words of any number of bits.
///
/// Rounds of steps that are bijective each: add, multiply by an odd number, xor the upper half into the lower. All
/// arithmetic is modulo 2^bits, so that words of up to 32 bits need no more than 32 of the numbers' bits.
pub(crate) struct Bijection {
    pub(crate) summands: [u64; ROUNDS],
    pub(crate) multipliers: [u64; ROUNDS],
    pub(crate) last: u64,
}

impl Bijection {
    /// The bijection that `key` selects.
    #[inline]
    pub(crate) const fn new(key: u64) -> Self {
        // Odd numbers without a pattern in their digits; the upper bits of the products serve.
        const FACTORS: [u64; ROUNDS] = [
            GOLDEN,
            0xd134_2543_de82_ef95,
            0xaf25_1af3_b0f0_25b5,
            0x8cb9_2ba7_2f3d_8dd7,
            0xc2b2_ae3d_27d4_eb4f,
            0xe703_7ed1_a0b4_28db,
        ];
        let key = mix(key.wrapping_add(GOLDEN));
        let (mut summands, mut multipliers) = ([0; ROUNDS], [0; ROUNDS]);
        let mut round = 0;
        while round < ROUNDS {
            let product = key.wrapping_mul(FACTORS[round]);
            summands[round] = product >> 29;
            multipliers[round] = (product >> 7) | 1;
            round += 1;
        }
        let last = key.wrapping_mul(0x1d8e_4e27_c47d_124f) >> 31;
        Self {
            summands,
            multipliers,
            last,
        }
    }

    /// The image of a word of `bits` bits, 1 to 64.
    #[inline]
    pub(crate) const fn apply(&self, word: u64, bits: u32) -> u64 {
        let mask = u64::MAX >> (u64::BITS - bits);
        let half = bits.div_ceil(2);
        let mut word = word;
        let mut round = 0;
        while round < ROUNDS {
            word = word.wrapping_add(self.summands[round]);
            word = word.wrapping_mul(self.multipliers[round]) & mask;
            word ^= word >> half;
            round += 1;
        }
        word.wrapping_add(self.last) & mask
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mix_agrees_with_splitmix64() {
        // Outputs of the reference program splitmix64.c (Vigna 2015, public domain) for the seed
        // 1234567: output k is the finalizer applied to seed + k * golden ratio.
        let expected = [
            6457827717110365317_u64,
            3203168211198807973,
            9817491932198370423,
        ];
        for (k, &word) in (1..).zip(&expected) {
            assert_eq!(
                mix(1_234_567_u64.wrapping_add(GOLDEN.wrapping_mul(k))),
                word
            );
        }
    }

    #[test]
    fn units_are_below_one_for_every_top_pattern() {
        // All numbers that single precision can get.
        for top in 0..1_u64 << 24 {
            let word = (top << 40) | (u64::MAX >> 24);
            assert!(unit(word) < 1.0 && unit_f32(word) < 1.0);
        }
        assert_eq!(unit(u64::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(unit_f32(u64::MAX), 1.0 - f32::EPSILON / 2.0);
    }

    #[test]
    fn one_bit_in_flips_half_of_the_bits_out() {
        // For each input bit the mean number of flipped output bits over 1000 words; its standard
        // deviation is 4/sqrt(1000) = 0.13, so 32 +- 1 is beyond 7 sigma for each of 64 cases.
        for bit in 0..64 {
            let flipped: u32 = (0..1000_u64)
                .map(|word| (hash(5, word) ^ hash(5, word ^ (1 << bit))).count_ones())
                .sum();
            assert!(
                (f64::from(flipped) / 1000.0 - 32.0).abs() < 1.0,
                "bit {bit}"
            );
        }
    }

    #[test]
    fn permutations_are_permutations() {
        for count in (1..70).chain([127, 128, 129, 1000]) {
            for key in 0..5 {
                let mut seen = vec![false; usize::try_from(count).unwrap()];
                for index in 0..count {
                    let image = usize::try_from(permute(index, count, key)).unwrap();
                    assert!(!core::mem::replace(&mut seen[image], true), "{count} {key}");
                }
            }
        }
        assert!(permute(u64::MAX - 1, u64::MAX, 1) < u64::MAX);
    }

    #[test]
    fn permutations_are_uniform_in_pairs() {
        // Over 100 000 keys, (p(i), p(j)) must fall evenly on the n (n - 1) ordered pairs. Chi-square with
        // n (n - 1) - 1 degrees of freedom; the bound mean + 6 standard deviations has a false-positive
        // rate below 1e-6 for each of the cases.
        const KEYS: u64 = 100_000;
        for count in [2_u64, 3, 4, 5, 7, 8, 9, 16, 17, 31, 32, 33, 64] {
            for (i, j) in [
                (0, 1),
                (0, count - 1),
                (count / 2, 0),
                (count / 2, count / 4),
            ] {
                if i == j || j >= count {
                    continue;
                }
                let n = usize::try_from(count).unwrap();
                let mut histogram = vec![0_u32; n * n];
                for key in 0..KEYS {
                    let pair = permute(i, count, key) * count + permute(j, count, key);
                    histogram[usize::try_from(pair).unwrap()] += 1;
                }
                let pairs = (count * (count - 1)) as f64;
                let expected = KEYS as f64 / pairs;
                let chi2: f64 = (0..n * n)
                    .filter(|cell| cell / n != cell % n)
                    .map(|cell| (f64::from(histogram[cell]) - expected).powi(2) / expected)
                    .sum();
                let bound = pairs - 1.0 + 6.0 * (2.0 * pairs).sqrt();
                assert!(
                    chi2 < bound,
                    "count {count}, positions {i} {j}: chi2 {chi2} >= {bound}"
                );
            }
        }
    }
}
