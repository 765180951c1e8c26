//! How many evaluations are made between two questions to clock and callback.

/// Seconds between two questions.
const PATIENCE: f64 = 0.05;

/// The same, where less would leave threads idle.
const MOST: f64 = 1.0;

pub(super) struct Pace {
    /// How many evaluations are next.
    pub(super) stride: u64,
    /// How long those before took, and how many times as many these are.
    before: Option<(f64, f64)>,
    /// Those that a thread makes at a time.
    portion: u64,
    threads: usize,
}

impl Pace {
    pub(super) fn new(portion: u64, threads: usize) -> Self {
        Self {
            stride: 16,
            before: None,
            portion: portion.max(1),
            threads,
        }
    }

    /// After a stride that took so many `seconds` for so many evaluations.
    pub(super) fn adapt(&mut self, seconds: f64, made: u64) {
        // What takes as long for fewer evaluations, or for more, is done once a stride: it is worth a longer one.
        let in_vain = self.before.is_some_and(|(before, times)| {
            (seconds - before).abs() < 0.5 * (before * times - before).abs()
        });
        let stride = if seconds < PATIENCE || in_vain {
            self.stride.saturating_mul(2)
        } else {
            (self.stride / 2).max(self.least(seconds, made))
        };
        let times = stride as f64 / self.stride as f64;
        self.before = (stride != self.stride).then_some((seconds, times));
        self.stride = stride;
    }

    /// A portion for each thread, if that does not take too long.
    fn least(&self, seconds: f64, made: u64) -> u64 {
        let busy = made.div_ceil(self.portion).clamp(1, self.threads as u64);
        let each = seconds * busy as f64 / made.max(1) as f64;
        if self.threads > 1 && each * self.portion as f64 <= MOST {
            self.portion.saturating_mul(self.threads as u64)
        } else {
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where strides end that take `once` seconds, and `each` for every portion of a thread; how long one takes there.
    fn settled(once: f64, each: f64, threads: usize) -> (u64, f64) {
        let portion = 1024;
        let mut pace = Pace::new(portion, threads);
        let mut last = 0.0;
        for _ in 0..60 {
            // What does not fill a portion is made by one thread.
            let portions = pace.stride as f64 / portion as f64;
            let alone = portions.min(1.0).max(portions / threads as f64);
            last = once + each * alone * portion as f64;
            pace.adapt(last, pace.stride);
        }
        (pace.stride, last)
    }

    #[test]
    fn clock_and_callback_are_asked_often_and_threads_have_work() {
        // Quick: a twentieth of a second, within a factor of two.
        let (stride, seconds) = settled(0.0, 1e-6, 2);
        assert!(
            stride > 50_000 && (0.02..0.11).contains(&seconds),
            "{seconds}"
        );
        // A portion takes half a second: both threads have one.
        assert_eq!(settled(0.0, 5e-4, 2).0, 2048);
        assert_eq!(settled(0.0, 5e-4, 64).0, 65_536);
        // A portion takes a minute: one evaluation after the other, and so does a single thread.
        assert_eq!(settled(0.0, 0.06, 64).0, 1);
        assert!(settled(0.0, 5e-4, 1).0 <= 128);
        // A tenth of a second goes by before the first evaluation: at least a third of the time is for the others.
        let (stride, seconds) = settled(0.1, 1e-6, 1);
        assert!(seconds > 0.15 && seconds < 1.0, "{stride} in {seconds}");
    }
}
