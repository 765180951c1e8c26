//! Generating vectors, made one component after the other.

use super::fourier::Correlation;

/// The components for `count` points in `dimensions` dimensions: each in turn is the one that makes the squared worst-case
/// error the smallest. Both arguments are 1 at least.
pub(super) fn components(count: usize, dimensions: u32) -> Vec<u64> {
    let weights = (1..=dimensions).map(|dimension| 1.0 / f64::from(dimension).powi(2));
    components_by(Search::new(count), count, weights)
}

/// One component for each of the weights.
fn components_by(search: Search, count: usize, weights: impl IntoIterator<Item = f64>) -> Vec<u64> {
    let kernel = kernel(count);
    let mut products = vec![1.0; count];
    let mut vector = Vec::new();
    for weight in weights {
        // In one dimension all are equally good.
        let best = if vector.is_empty() {
            1
        } else {
            search.best(&kernel, &products)
        };
        let mut place = 0;
        for product in &mut products {
            *product *= 1.0 + weight * kernel[place];
            place = (place + best) % count;
        }
        vector.push(best as u64);
    }
    vector
}

/// What the coordinates of all points make in the error, in one dimension.
fn kernel(count: usize) -> Vec<f64> {
    (0..count)
        .map(|index| bernoulli_2(index as f64 / count as f64))
        .collect()
}

/// 2 pi^2 times the second Bernoulli polynomial: the kernel of the periodic functions with one derivative.
pub(super) fn bernoulli_2(u: f64) -> f64 {
    2.0 * core::f64::consts::PI.powi(2) * (u * (u - 1.0) + 1.0 / 6.0)
}

/// How the next component is found.
enum Search {
    /// For any count.
    All,
    /// For powers of a prime: what the components add to the error are circular correlations.
    Orbits(Orbits),
}

/// What one component adds to the squared error: a sum over the points.
struct Candidate {
    component: usize,
    sum: f64,
}

impl Search {
    fn new(count: usize) -> Self {
        Orbits::new(count).map_or(Self::All, Self::Orbits)
    }

    /// The best component after those that have made `products`.
    ///
    /// A component and its negative make mirrored lattices, which are equally good: only the smaller are looked at.
    fn best(&self, kernel: &[f64], products: &[f64]) -> usize {
        let candidates = match self {
            Self::All => all(kernel, products),
            Self::Orbits(orbits) => orbits.candidates(products),
        };
        // Rounding does not choose among those that are equally good.
        let smallest = candidates
            .iter()
            .map(|c| c.sum)
            .fold(f64::INFINITY, f64::min);
        let enough = smallest + 1e-12 * products.iter().sum::<f64>();
        candidates
            .iter()
            .filter(|candidate| candidate.sum <= enough)
            .map(|candidate| candidate.component)
            .min()
            .expect("the smallest is small enough")
    }
}

/// Every component, one after the other.
fn all(kernel: &[f64], products: &[f64]) -> Vec<Candidate> {
    let count = kernel.len();
    (1..=(count / 2).max(1))
        .filter(|&component| coprime(component as u64, count as u64))
        .map(|component| {
            let (mut place, mut sum) = (0, 0.0);
            for product in products {
                sum += product * kernel[place];
                place += component;
                if place >= count {
                    place -= count;
                }
            }
            Candidate { component, sum }
        })
        .collect()
}

pub(super) fn coprime(mut a: u64, mut b: u64) -> bool {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// The numbers below a power of a prime, in the order that multiplying by a generator brings them into.
///
/// Modulo a power of a prime, the numbers that are coprime to it are the powers of one of them, up to their signs. So in
/// the sum over the points `k` of `products[k] kernel[k z]` the component `z` is a power of the generator, and so are the `k` that
/// have the same power of the prime as a factor, but for it: their part of the sum is a circular correlation.
struct Orbits {
    count: usize,
    /// The powers of the generator.
    powers: Vec<usize>,
    levels: Vec<Level>,
}

/// The numbers with the same power of the prime as a factor.
struct Level {
    /// That power of the prime.
    factor: usize,
    /// How many numbers there are, up to their signs.
    length: usize,
    /// Whether a number is its own negative: 1 then, otherwise 2.
    signs: f64,
    kernel: Correlation,
}

impl Orbits {
    /// Those below `count`, if it is a power of a prime, and not 1.
    fn new(count: usize) -> Option<Self> {
        let prime = smallest_factor(count)?;
        let mut rest = count;
        while rest.is_multiple_of(prime) {
            rest /= prime;
        }
        if rest != 1 {
            return None;
        }
        let orbit = (count / prime * (prime - 1) / 2).max(1);
        let powers = (1..count)
            .filter(|generator| !generator.is_multiple_of(prime))
            .map(|generator| powers(generator, count))
            .find(|powers| powers.len() == orbit)
            .expect("the group is cyclic up to signs");
        let whole = kernel(count);
        let mut levels = Vec::new();
        let mut factor = 1;
        while factor < count {
            let modulus = count / factor;
            let length = (modulus / prime * (prime - 1) / 2).max(1);
            let kernel: Vec<f64> = powers[..length]
                .iter()
                .map(|power| whole[power % modulus * factor])
                .collect();
            levels.push(Level {
                factor,
                length,
                signs: if modulus == 2 { 1.0 } else { 2.0 },
                kernel: Correlation::new(&kernel),
            });
            factor *= prime;
        }
        Some(Self {
            count,
            powers,
            levels,
        })
    }

    fn candidates(&self, products: &[f64]) -> Vec<Candidate> {
        // The point 0 adds the same to all.
        let mut sums = vec![products[0] * bernoulli_2(0.0); self.powers.len()];
        for level in &self.levels {
            let modulus = self.count / level.factor;
            let products: Vec<f64> = self.powers[..level.length]
                .iter()
                .map(|power| level.signs * products[power % modulus * level.factor])
                .collect();
            let parts = level.kernel.with(&products);
            for (sum, part) in sums.iter_mut().zip(parts.iter().cycle()) {
                *sum += part;
            }
        }
        self.powers
            .iter()
            .zip(sums)
            .map(|(&power, sum)| Candidate {
                component: power.min(self.count - power),
                sum,
            })
            .collect()
    }
}

/// The smallest prime factor of a number above 1.
fn smallest_factor(number: usize) -> Option<usize> {
    if number < 2 {
        return None;
    }
    let divides = |factor: &usize| number.is_multiple_of(*factor);
    let small = (2..).take_while(|factor| factor * factor <= number);
    small.into_iter().find(divides).or(Some(number))
}

/// The powers of `generator` modulo `count`, from 1 until they repeat up to their signs.
fn powers(generator: usize, count: usize) -> Vec<usize> {
    let (generator, modulus) = (generator as u128, count as u128);
    let mut powers = vec![1];
    loop {
        let last = powers[powers.len() - 1] as u128;
        let next = usize::try_from(last * generator % modulus).expect("below the count");
        if next == 1 || next == count - 1 {
            return powers;
        }
        powers.push(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_find_the_components_that_the_plain_search_finds() {
        let primes = [2, 3, 5, 7, 11, 13, 251, 509, 1021];
        let powers = [4, 8, 9, 16, 25, 27, 49, 64, 243, 343, 625, 1024];
        let weights = || (1..=12).map(|dimension| 1.0 / f64::from(dimension * dimension));
        for count in primes.into_iter().chain(powers) {
            let orbits = Orbits::new(count).expect("a power of a prime");
            assert_eq!(
                components_by(Search::Orbits(orbits), count, weights()),
                components_by(Search::All, count, weights()),
                "{count}"
            );
        }
        for count in [1, 6, 12, 1000, 1023] {
            assert!(Orbits::new(count).is_none(), "{count}");
        }
    }

    /// Vectors that the authors of the fast construction have published a program for: of its output, the first 20 components for a
    /// few numbers of points, all weights being 1/100. As distributed with pySecDec's integrator: `cbcpt_dn1_100` of
    /// <https://github.com/mppmu/qmc>; Borowka et al. (2019), <https://doi.org/10.1016/j.cpc.2019.02.015>.
    const PUBLISHED: [(usize, [u64; 20]); 3] = [
        (
            1021,
            [
                1, 374, 421, 220, 482, 449, 309, 72, 382, 152, 328, 247, 212, 414, 119, 503, 196,
                438, 418, 452,
            ],
        ),
        (
            10_061,
            [
                1, 3850, 2758, 1065, 676, 4224, 1699, 4881, 3515, 2413, 2652, 1876, 4935, 4408,
                2057, 644, 4328, 4629, 2145, 2634,
            ],
        ),
        (
            28_669,
            [
                1, 10974, 7676, 11986, 8567, 3929, 5838, 2524, 9098, 4861, 4326, 6173, 6389, 2145,
                7490, 3546, 12311, 8673, 3957, 10411,
            ],
        ),
    ];

    #[test]
    fn published_vectors_are_found() {
        const WEIGHT: f64 = 0.01;
        for (count, published) in PUBLISHED {
            let found = components_by(Search::new(count), count, [WEIGHT; 20]);
            // Where components are equally good, the other program took another one.
            for dimensions in 1..=20 {
                let [theirs, ours] = [&published[..], &found]
                    .map(|vector| squared_error(count, &vector[..dimensions], WEIGHT));
                assert!(
                    (ours - theirs).abs() <= 1e-9 * theirs,
                    "{count}: {ours} for {theirs}"
                );
            }
            if count == 10_061 {
                assert_eq!(found, published);
            }
        }
    }

    /// Point by point, by its definition.
    fn squared_error(count: usize, vector: &[u64], weight: f64) -> f64 {
        let term = |index: u64| {
            let factor = |component: &u64| {
                let place = index * component % count as u64;
                1.0 + weight * bernoulli_2(place as f64 / count as f64)
            };
            vector.iter().map(factor).product::<f64>() - 1.0
        };
        (0..count as u64).map(term).sum::<f64>() / count as f64
    }
}
