//! Independent points; the error bar is their sample variance's.

use core::fmt;
use core::marker::PhantomData;
use core::ops::Range;

use rand::rngs::Xoshiro256PlusPlus;
use rand::{Rng, SeedableRng};

use crate::evaluate::{BLOCK, Source, Visit};
use crate::tallied::{Tallied, tallied};
use crate::tally::Tally;
use crate::warning::{Warning, diagnose};
use crate::{Error, ErrorBar, Estimate, NonFinite, Sampler, Stream, Value, hash};

/// The mean over independent uniform points, with the standard error of their sample variance.
///
/// The error falls as `count^(-1/2)`, whatever the dimension and however rough the integrand, as long as its
/// square has an integral.
///
/// The points come from a generator of `rand`: by default [`Xoshiro256PlusPlus`], whose words are documented
/// to stay the same in every version and on every machine. It is seeded anew, from a hash, for every block of
/// 1024 points, so that the estimate does not depend on the number of threads.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube};
///
/// use rand::rngs::Xoshiro128PlusPlus;
///
/// let square = cube(|[x]| x * x);
/// let estimate = MonteCarlo::new(100_000, 1).estimate(&square)?;
/// assert!((estimate.mean - 1.0 / 3.0).abs() < 4.0 * estimate.std_error.unwrap());
///
/// let other = MonteCarlo::new(100_000, 1).generator::<Xoshiro128PlusPlus>().estimate(&square)?;
/// assert_ne!(estimate.mean, other.mean);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors of the estimate
///
/// [`Error::Refused`] for a count of 0; see [`Estimator::estimate`](crate::Estimator::estimate).
#[must_use]
pub struct MonteCarlo<R = Xoshiro256PlusPlus> {
    count: u64,
    seed: u64,
    non_finite: NonFinite,
    generator: PhantomData<fn() -> R>,
}

impl MonteCarlo {
    /// `count` independent points, selected by `seed`.
    pub const fn new(count: u64, seed: u64) -> Self {
        Self {
            count,
            seed,
            non_finite: NonFinite::Fail,
            generator: PhantomData,
        }
    }
}

impl<R> MonteCarlo<R> {
    /// The same with the points of another generator.
    pub const fn generator<T: Rng + SeedableRng>(self) -> MonteCarlo<T> {
        let Self {
            count,
            seed,
            non_finite,
            ..
        } = self;
        MonteCarlo {
            count,
            seed,
            non_finite,
            generator: PhantomData,
        }
    }

    /// The same with another rule for values that are not finite.
    pub const fn non_finite(mut self, rule: NonFinite) -> Self {
        self.non_finite = rule;
        self
    }
}

impl<R: Rng + SeedableRng> Tallied for MonteCarlo<R> {
    type Source<'a>
        = Streams<R>
    where
        R: 'a;

    fn sources(&self) -> Result<Vec<Streams<R>>, Error> {
        if self.count == 0 {
            return Err(Error::refused("count", "at least 1", 0));
        }
        Ok(vec![Streams::new(self.seed)])
    }

    fn counts(&self, _: &[Streams<R>], evaluations: u64) -> Vec<u64> {
        vec![evaluations]
    }

    fn requested(&self) -> u64 {
        self.count
    }

    fn policy(&self) -> NonFinite {
        self.non_finite
    }

    fn summary<V: Value>(&self, tallies: &[Tally<V>]) -> Option<Estimate<V>> {
        let [tally] = tallies else { return None };
        let moments = tally.moments();
        let count = moments.count();
        let rejected = tally.rejected();
        let std_error = moments.std_error();
        let mut warnings = diagnose(tally, std_error);
        warnings.extend(Warning::of_sample(count));
        warnings.extend(Warning::of_rejected(rejected));
        (count > 0).then(|| Estimate {
            std_error,
            error_bar: ErrorBar::SampleVariance,
            requested: self.count,
            rejected,
            warnings,
            ..Estimate::new(moments.mean(), tally.used())
        })
    }
}

tallied!([R: Rng + SeedableRng] MonteCarlo<R>);

impl<R> fmt::Debug for MonteCarlo<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MonteCarlo")
            .field("count", &self.count)
            .field("seed", &self.seed)
            .field("non_finite", &self.non_finite)
            .finish_non_exhaustive()
    }
}

impl<R> Clone for MonteCarlo<R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R> Copy for MonteCarlo<R> {}

/// One generator a block, each seeded with all the bits it takes.
pub(crate) struct Streams<R> {
    seed: u64,
    generator: PhantomData<fn() -> R>,
}

impl<R> Streams<R> {
    pub(super) const fn new(seed: u64) -> Self {
        Self {
            seed,
            generator: PhantomData,
        }
    }
}

impl<R: Rng + SeedableRng> Streams<R> {
    /// The stream of the block of the point `index`, past the first `drawn` coordinates.
    pub(super) fn stream(&self, index: u64, drawn: u64) -> Stream<R> {
        let block = index / BLOCK * BLOCK;
        let mut stream = Stream(seeded::<R>(hash::hash(self.seed, block)));
        for _ in 0..drawn {
            stream.next_1d();
        }
        stream
    }
}

impl<R: Rng + SeedableRng> Source for Streams<R> {
    fn points(&self, indices: Range<u64>, drawn: u64, _: u32, visit: &mut impl Visit) {
        let mut stream = self.stream(indices.start, drawn);
        visit.stream(indices, &mut stream, |_| ());
    }
}

/// A generator with all the bits of its seed hashed from `key`.
pub(super) fn seeded<R: SeedableRng>(key: u64) -> R {
    let mut seed = R::Seed::default();
    for (word, bytes) in (0..).zip(seed.as_mut().chunks_mut(8)) {
        bytes.copy_from_slice(&hash::hash(key, word).to_le_bytes()[..bytes.len()]);
    }
    R::from_seed(seed)
}
