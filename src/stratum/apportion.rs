//! How points are shared out among strata.

use core::convert::Infallible;
use core::iter;

use crate::reduce;

/// Shares `count` points out, two to each of the `strata` at the least: of the others the part `even` goes to all alike, the
/// rest in proportion to their scores. The rounding is carried on from one to the next, so that none are lost; scores
/// that are all zero share evenly. The numbers of points up to and with each stratum.
///
/// There must be two points for each.
pub(crate) fn apportion<S: Sync>(
    strata: &[S],
    score: impl Fn(&S) -> f64 + Sync,
    even: f64,
    count: u64,
) -> Vec<u64> {
    let scores = reduce::in_blocks(strata, |_, block| {
        let scores: Vec<f64> = block.iter().map(&score).collect();
        let sum = scores.iter().sum();
        Scores { each: scores, sum }
    });
    let sum: f64 = scores.iter().map(|block| block.sum).sum();
    let told = sum > 0.0 && sum.is_finite();
    let even = if told { even } else { 1.0 };
    let (alike, by_score) = (even / strata.len() as f64, (1.0 - even) / sum);
    let part = |score: f64, number: f64| alike * number + if told { by_score * score } else { 0.0 };
    let free = count.saturating_sub(2 * strata.len() as u64);
    // The shares up to the beginning of each block, and up to the end of the last.
    let mut share = 0.0;
    let ends = scores.iter().map(|block| {
        share += part(block.sum, block.each.len() as f64);
        share
    });
    let mut bounds: Vec<f64> = iter::once(0.0).chain(ends).collect();
    // Whatever rounding has made of it.
    if let Some(end) = bounds.last_mut() {
        *end = 1.0;
    }
    let before = scores.iter().scan(0, |strata, block| {
        let before = *strata;
        *strata += block.each.len() as u64;
        Some(before)
    });
    let before: Vec<u64> = before.collect();
    let job = |place: u64| {
        let place = usize::try_from(place).expect("below a length");
        let (block, mut share) = (&scores[place], bounds[place]);
        let [mut given, last] = [share, bounds[place + 1]].map(|share| nearest(share, free));
        let two_each = (before[place] + 1..).map(|strata| 2 * strata);
        let ends = block.each.iter().zip(two_each).map(|(&score, two_each)| {
            share += part(score, 1.0);
            given = nearest(share, free).clamp(given, last);
            two_each + given
        });
        let mut ends: Vec<u64> = ends.collect();
        // Up to where the next block begins, even if the sum over this one was rounded to a little less.
        if let Some(end) = ends.last_mut() {
            *end += last - given;
        }
        ends
    };
    let mut all = Vec::with_capacity(strata.len());
    let taken: Result<(), Infallible> = reduce::in_order(scores.len() as u64, job, |ends| {
        all.extend(ends);
        Ok(())
    });
    let Ok(()) = taken;
    all
}

/// How many points a stratum has, if `ends` are their numbers up to and with each.
#[inline]
pub(crate) fn between(ends: &[u64], stratum: usize) -> u64 {
    let before = stratum.checked_sub(1).map_or(0, |before| ends[before]);
    ends[stratum] - before
}

/// Shares `count` points out among so many strata, all of them alike.
pub(crate) fn evenly(strata: usize, count: u64) -> Vec<u64> {
    apportion(&vec![(); strata], |()| 1.0, 1.0, count)
}

/// The scores of some strata.
struct Scores {
    each: Vec<f64>,
    sum: f64,
}

/// The `share` of the points that are `free`, to the nearest.
fn nearest(share: f64, free: u64) -> u64 {
    let points = share * free as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of the count"
    )]
    let down = points as u64;
    // `f64::round` is a call of a function, which takes as long as the rest.
    let up = points - down as f64 >= 0.5;
    down.saturating_add(up.into()).min(free)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_shared_out_to_the_last() {
        let apportion = |scores: &[f64], even, count| {
            let ends = apportion(scores, |score| *score, even, count);
            let counts = (0..ends.len()).map(|stratum| between(&ends, stratum));
            counts.collect::<Vec<u64>>()
        };
        let by = |scores: &[f64], count| apportion(scores, 0.0, count);
        assert_eq!(by(&[1.0, 1.0, 1.0], 10), [3, 4, 3]);
        assert_eq!(by(&[0.0, 0.0], 5), [3, 2]);
        assert_eq!(by(&[0.0, 3.0, 1.0], 14), [2, 8, 4]);
        assert_eq!(by(&[f64::INFINITY, 1.0], 4), [2, 2]);
        assert_eq!(apportion(&[0.0, 2.0], 0.5, 104), [27, 77]);
        assert_eq!(evenly(1000, 12_345).last(), Some(&12_345));
        let scores: Vec<f64> = (1..10_000).map(|k| 1.0 / f64::from(k)).collect();
        let blocks = by(&scores, 1 << 40);
        assert_eq!(blocks.iter().sum::<u64>(), 1 << 40);
        assert!(blocks.is_sorted_by(|here, next| here + 1 >= *next));
    }
}
