//! How many samples each pixel of a picture gets.

/// How samples are to be dealt to the pixels of a picture, as a pilot has shown: more where values spread more.
///
/// No pixel gets less than an eighth of the mean, since a pilot of few samples may have missed what is rare, none more than 64 times the mean,
/// since it may have met it, and none nothing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct Allocation {
    /// In proportion to what the deviations in and around each pixel are taken for: the largest is 1.
    deviations: Vec<f64>,
    used: u64,
}

/// The least and the most that a pixel gets, in parts of the mean.
const LEAST: f64 = 0.125;
const MOST: f64 = 64.0;

impl Allocation {
    /// Deviations that are all zero, or not all finite, tell nothing: then all pixels are alike.
    pub(super) fn new(mut deviations: Vec<f64>, used: u64) -> Self {
        let largest = deviations.iter().copied().fold(0.0, f64::max);
        let usable = largest > 0.0 && deviations.iter().all(|deviation| deviation.is_finite());
        for deviation in &mut deviations {
            *deviation = if usable { *deviation / largest } else { 1.0 };
        }
        Self { deviations, used }
    }

    /// How many samples the pilot took.
    pub fn used(&self) -> u64 {
        self.used
    }

    /// How many samples each pixel gets, row by row, `mean` in the mean, 1 if that is 0: in proportion to the standard deviation, which is
    /// best for the mean square error of the whole picture with independent samples; the pilot, which is uncertain, tells its power of 3/4.
    pub fn counts(&self, mean: u64) -> Vec<u64> {
        let mean = mean.max(1) as f64;
        let [least, most] = [(LEAST * mean).ceil(), MOST * mean];
        let share = |factor: f64, deviation: f64| (factor * deviation).clamp(least, most);
        let given = |log: f64| {
            self.deviations
                .iter()
                .map(|&d| share(log.exp(), d))
                .sum::<f64>()
        };
        // The largest deviation is 1: from all at the least to all at the most, but those of deviation zero.
        let positive = self.deviations.iter().copied().filter(|&d| d > 0.0);
        let range = [least.ln(), (most / positive.fold(1.0, f64::min)).ln()];
        let [log, _] = between(range, mean * self.deviations.len() as f64, given);
        let factor = log.exp();
        // Rounded so that the sums of all pixels so far are right to half a sample, hence the whole is.
        let (mut wanted, mut given) = (0.0, 0.0);
        let count = |&deviation: &f64| {
            wanted += share(factor, deviation);
            let count = (wanted - given).round().max(least);
            given += count;
            whole(count)
        };
        self.deviations.iter().map(count).collect()
    }

    /// The same for nets, which are best in powers of `radix` points: each number is one, the next to its share, so that it may be below
    /// the least or above the most by the root of the radix.
    ///
    /// The numbers go with a lower power of the deviation, 10/11: right where the variance falls as the number to the power of -6/5. That of
    /// three scenes fell as the powers from -1.1 to -1.2 between 64 and 256 samples a pixel.
    ///
    /// # Panics
    ///
    /// If the radix is below 2.
    pub fn powers(&self, mean: u64, radix: u32) -> Vec<u64> {
        assert!(radix >= 2, "a radix of {radix}");
        let (mean, base) = (mean.max(1) as f64, f64::from(radix));
        // Everything in logarithms to the base.
        let weights: Vec<f64> = self
            .deviations
            .iter()
            .map(|d| 10.0 / 11.0 * d.log(base))
            .collect();
        let limits = [(LEAST * mean).max(1.0), MOST * mean].map(|limit| limit.log(base));
        let powers: Vec<f64> = (0..=i32::from(u8::MAX))
            .map(|exponent| base.powi(exponent))
            .collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between zero and the most, which is below the last power"
        )]
        let power = |factor: f64, weight: f64| {
            powers[usize::from((factor + weight).clamp(limits[0], limits[1]).round() as u8)]
        };
        let given = |factor: f64| weights.iter().map(|&w| power(factor, w)).sum::<f64>();
        // The largest weight is 0 or less: with these all are at the least or, but those of weight zero, at the most.
        let lowest = weights
            .iter()
            .copied()
            .filter(|w| w.is_finite())
            .fold(0.0, f64::min);
        let target = mean * weights.len() as f64;
        let [low, high] = between([limits[0] - 1.0, limits[1] - lowest + 1.0], target, given);
        // What is left goes to some of the pixels for which the two differ, spread evenly.
        let (few, many) = (given(low), given(high));
        let part = if many > few {
            ((target - few) / (many - few)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let (mut wanted, mut spent) = (0.0, 0.0);
        let count = |&weight: &f64| {
            let (fewer, more) = (power(low, weight), power(high, weight));
            let step = more - fewer;
            wanted += part * step;
            if step > 0.0 && wanted - spent >= 0.5 * step {
                spent += step;
                return whole(more);
            }
            whole(fewer)
        };
        weights.iter().map(count).collect()
    }
}

/// Steps of the search for a factor.
const STEPS: usize = 60;

/// Two neighbouring places between `low` and `high` at which `given`, which grows, is at most `target` and above it.
fn between([mut low, mut high]: [f64; 2], target: f64, given: impl Fn(f64) -> f64) -> [f64; 2] {
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if given(middle) > target {
            high = middle;
        } else {
            low = middle;
        }
    }
    [low, high]
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and saturates"
)]
fn whole(share: f64) -> u64 {
    share.round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_follow_the_deviations() {
        let allocation = |deviations: &[f64]| Allocation::new(deviations.to_vec(), 0);
        // An eighth of 16 for the first; 62 for eight parts.
        assert_eq!(allocation(&[0.0, 1.0, 2.0, 5.0]).counts(16), [2, 8, 15, 39]);
        // None gets more than 64 times the mean: there is more for the others.
        let mut rare = vec![1e-9; 99];
        rare.push(1.0);
        let counts = allocation(&rare).counts(10);
        assert_eq!((counts[99], counts.iter().sum::<u64>()), (640, 1000));
        assert!(counts[..99].iter().all(|&count| count == 3 || count == 4));
        // What tells nothing.
        for deviation in [0.0, 3.0, 1e-300, f64::INFINITY, f64::NAN] {
            let even = allocation(&[deviation; 5]);
            assert_eq!(
                (even.counts(7), even.powers(8, 2)),
                (vec![7; 5], vec![8; 5])
            );
            assert_eq!(
                (even.counts(0), even.powers(1, 3)),
                (vec![1; 5], vec![1; 5])
            );
        }
        let _ = allocation(&[1.0, 2.0]).counts(u64::MAX);
        let _ = allocation(&[1.0, 2.0]).powers(u64::MAX, 2);
    }

    #[test]
    fn powers_keep_the_mean() {
        let steep = (0..4096).map(|i| (f64::from(i) / 500.0).exp()).collect();
        for deviations in [steep, vec![1.0; 4096], vec![0.0; 4096]] {
            let allocation = Allocation::new(deviations, 0);
            for (mean, radix) in [(64, 2), (56, 2), (6, 2), (1, 2), (64, 3), (64, 101)] {
                let counts = allocation.powers(mean, radix);
                let radix = u64::from(radix);
                let is_power = |count: u64| radix.pow(count.ilog(radix)) == count;
                assert!(
                    counts.iter().all(|&count| is_power(count)),
                    "{mean} {radix}"
                );
                let (given, most) = (counts.iter().sum::<u64>(), counts.iter().max());
                // Half of the step that the pixel that is next would make.
                let off = given.abs_diff(4096 * mean);
                let step = (radix - 1) * most.unwrap();
                assert!(2 * off <= step, "{mean} {radix}: {given}");
            }
        }
    }

    /// The variance of a picture whose pixels have the given ones with a sample each.
    fn variance(deviations: &[f64], counts: &[u64], power: f64) -> f64 {
        let pixels = deviations.iter().zip(counts);
        pixels
            .map(|(deviation, &count)| deviation * deviation * (count as f64).powf(-power))
            .sum()
    }

    #[test]
    fn the_variance_is_near_the_least() {
        let deviations: Vec<f64> = (0..4096).map(|i| 1.0 + f64::from(i % 64)).collect();
        let allocation = Allocation::new(deviations.clone(), 0);
        // Lagrange: the counts in proportion to the deviations to the power 2 / (1 + power).
        let least = |power: f64| {
            let shares = deviations.iter().map(|d| d.powf(2.0 / (1.0 + power)));
            let sum: f64 = shares.sum();
            (sum / (4096.0 * 64.0)).powf(power) * sum
        };
        let plain = variance(&deviations, &allocation.counts(64), 1.0) / least(1.0);
        assert!((1.0..1.02).contains(&plain), "{plain}");
        // Counts off by up to the root of two cost some 6 %.
        let nets = variance(&deviations, &allocation.powers(64, 2), 1.2) / least(1.2);
        assert!((1.0..1.08).contains(&nets), "{nets}");
        let even = variance(&deviations, &[64; 4096], 1.0) / least(1.0);
        assert!(even > 1.2, "{even}");
    }
}
