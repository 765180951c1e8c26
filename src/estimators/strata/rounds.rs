//! The points of many strata, dealt out in rounds.

/// So many points in each stratum, dealt out in rounds: two each in the first, and with each further one four times as many
/// as with those before it, in proportion to what they are due.
pub(super) struct Rounds {
    due: Vec<u64>,
    total: u64,
}

impl Rounds {
    /// `due[k]` points in stratum `k`, two at least.
    pub(super) fn new(due: Vec<u64>) -> Self {
        let total = due.iter().sum();
        Self { due, total }
    }

    /// How many rounds there are.
    pub(super) fn number(&self) -> u32 {
        (0..)
            .find(|&round| self.about(round) >= self.total)
            .map_or(0, |round| round + 1)
    }

    /// About how many points there are after `round`.
    fn about(&self, round: u32) -> u64 {
        let first = 2 * self.due.len() as u64;
        4_u64
            .checked_pow(round)
            .map_or(u64::MAX, |times| first.saturating_mul(times))
    }

    /// The part of all points that there is after `round`.
    fn part(&self, round: u32) -> f64 {
        self.about(round) as f64 / self.total as f64
    }

    /// How many points each stratum has before `round`.
    fn sofar(&self, round: u32) -> impl Iterator<Item = u64> {
        let part = round.checked_sub(1).map(|last| self.part(last));
        let sofar = move |&due| part.map_or(0, |part| dealt(part, due));
        self.due.iter().map(sofar)
    }

    /// How many points there are before `round`.
    pub(super) fn before(&self, round: u32) -> u64 {
        self.sofar(round).sum()
    }

    /// How many points each stratum gets in `round`.
    pub(super) fn counts(&self, round: u32) -> Vec<u64> {
        let part = self.part(round);
        let dealt = self.due.iter().map(|&due| dealt(part, due));
        dealt
            .zip(self.sofar(round))
            .map(|(after, before)| after - before)
            .collect()
    }
}

/// How many of the points that a stratum is `due` it has when there is a `part` of all.
fn dealt(part: f64, due: u64) -> u64 {
    if part >= 1.0 {
        return due;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of what is due"
    )]
    let here = (due as f64 * part) as u64;
    here.clamp(2, due)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_deal_out_what_is_due() {
        for due in [
            vec![2, 2, 2],
            vec![3, 2, 2],
            vec![2, 1000, 37, 3],
            vec![5; 100],
            vec![u64::MAX / 8; 3],
        ] {
            let rounds = Rounds::new(due.clone());
            let mut dealt = vec![0; due.len()];
            for round in 0..rounds.number() {
                assert_eq!(rounds.before(round), dealt.iter().sum::<u64>());
                for (dealt, here) in dealt.iter_mut().zip(rounds.counts(round)) {
                    *dealt += here;
                }
                assert!(dealt.iter().all(|&dealt| dealt >= 2));
            }
            assert_eq!(dealt, due);
        }
        assert_eq!(Rounds::new(vec![512; 512]).number(), 5);
    }
}
