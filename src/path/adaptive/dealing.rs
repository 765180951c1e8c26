//! How many samples the pixels of one colour get, by their deviations, of which the largest is 1.

/// The most that a pixel gets, in multiples of the mean.
const MOST: f64 = 64.0;

/// In proportion to the deviations, `mean` in the mean, none less than `first`.
pub(super) fn counts(deviations: &[f64], first: u64, mean: u64) -> Vec<u64> {
    let [first, mean] = [first, mean.max(first)].map(|count| count as f64);
    let most = MOST * mean;
    let share = |factor: f64, deviation: f64| (factor * deviation).clamp(first, most);
    let given = |log: f64| {
        let factor = log.exp();
        let shares = deviations.iter().map(|&d| share(factor, d));
        shares.sum::<f64>()
    };
    // The largest deviation is 1: from all at the least to all at the most, but those of deviation zero.
    let positive = deviations.iter().copied().filter(|&d| d > 0.0);
    let range = [first.ln(), (most / positive.fold(1.0, f64::min)).ln()];
    let [log, _] = between(range, mean * deviations.len() as f64, given);
    let factor = log.exp();
    // Rounded so that the sums of all pixels so far are right to half a sample, hence the whole is.
    let (mut wanted, mut given) = (0.0, 0.0);
    let count = |&deviation: &f64| {
        wanted += share(factor, deviation);
        let count = (wanted - given).round().max(first);
        given += count;
        whole(count)
    };
    deviations.iter().map(count).collect()
}

/// The same in powers of a radix.
pub(super) fn powers(deviations: &[f64], first: u64, mean: u64, radix: u32) -> Vec<u64> {
    let base = f64::from(radix);
    // Everything in logarithms to the base.
    let weights: Vec<f64> = (deviations.iter())
        .map(|d| 10.0 / 11.0 * d.log(base))
        .collect();
    let powers: Vec<f64> = (0..=i32::from(u8::MAX))
        .map(|exponent| base.powi(exponent))
        .collect();
    // The least that is not less than the pixel has.
    let least = powers.partition_point(|&power| power < first as f64);
    let mean = powers[least].max(mean as f64);
    let limits = [least as f64, (MOST * mean).log(base)];
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between zero and the most, which is below the last power"
    )]
    let power = |factor: f64, weight: f64| {
        // Rounded: a cast cuts off, without a call.
        powers[usize::from(((factor + weight).clamp(limits[0], limits[1]) + 0.5) as u8)]
    };
    let given = |factor: f64| weights.iter().map(|&w| power(factor, w)).sum::<f64>();
    // The largest weight is 0 or less: with these all are at the least or, but those of weight zero, at the most.
    let finite = weights.iter().copied().filter(|w| w.is_finite());
    let lowest = finite.fold(0.0, f64::min);
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
