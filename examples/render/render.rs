//! Rendering in passes.

use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use estimand::mitsuba::Picture;
use estimand::path::{Allocation, Share};
use estimand::points::PointSet;
use estimand::{each, hash};

use crate::checkpoint::Checkpoint;
use crate::plan::{Pass, Plan};
use crate::points::Points;
use crate::progress::Progress;
use crate::state::{Part, Row, State};

/// How often the bar is drawn.
const TICK: Duration = Duration::from_millis(100);

/// How often work is saved at most, and how many times longer than saving it must have gone on.
const SAVE: Duration = Duration::from_secs(5);
const SAVE_RATIO: u32 = 20;

/// How many paths of neighbouring pixels are asked for at once, about: many, since lanes are idle at their end, but few enough for
/// Ctrl-C not to wait.
const ASKED: u64 = 4096;

/// A picture to be rendered.
pub(crate) struct Job<'a> {
    pub(crate) picture: &'a dyn Picture,
    pub(crate) size: [u32; 2],
    pub(crate) points: Points,
    pub(crate) seed: u64,
    pub(crate) plan: Plan,
    /// By how many pixels each path is used, and from how many columns they are.
    pub(crate) reused_by: u32,
    pub(crate) columns: u32,
    pub(crate) checkpoint: Option<&'a Checkpoint>,
    pub(crate) stop: &'a AtomicBool,
}

impl Job<'_> {
    /// Renders until the plan is fulfilled or somebody stops it. It goes on with the work of the checkpoint, and leaves
    /// its own there.
    pub(crate) fn run(&self) -> Result<State, Box<dyn Error>> {
        let saved = match self.checkpoint {
            Some(checkpoint) => checkpoint.load(self.size)?,
            None => None,
        };
        let state = Mutex::new(saved.unwrap_or_else(|| State::new(self.size)));
        let finished = AtomicBool::new(false);
        let outcome = std::thread::scope(|scope| {
            let watch = scope.spawn(|| self.watch(&state, &finished));
            // Who waits for the end would wait for ever after a panic, and what was done before would be lost.
            let outcome = catch_unwind(AssertUnwindSafe(|| self.passes(&state)));
            finished.store(true, Ordering::Relaxed);
            let watched = watch
                .join()
                .unwrap_or_else(|_| Err("the progress was lost".to_owned()));
            outcome.map(|outcome| outcome.and(watched))
        });
        let state = state
            .into_inner()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(checkpoint) = self.checkpoint {
            checkpoint.save(&state)?;
        }
        outcome.unwrap_or_else(|panic| resume_unwind(panic))?;
        Ok(state)
    }

    /// One pass after the other.
    fn passes(&self, state: &Mutex<State>) -> Result<(), String> {
        let before = lock(state).seconds;
        let start = Instant::now();
        while !self.stop.load(Ordering::Relaxed) {
            let Some(pass) = lock(state).begin(|state| self.next(state)) else {
                return Ok(());
            };
            let counts = self.counts(state, &pass)?;
            let rows = each(self.size[1].into(), |y| self.row(y, &pass, &counts, state));
            lock(state).seconds = before + start.elapsed().as_secs_f64();
            if rows
                .into_iter()
                .collect::<Result<Vec<_>, _>>()?
                .into_iter()
                .all(|done| done)
            {
                lock(state).complete(pass.count(), self.plan.tells_by_halves());
            }
        }
        Ok(())
    }

    /// How many samples the pixels are to have after a pass: if they are dealt, as the first ones tell.
    fn counts(&self, state: &Mutex<State>, pass: &Pass) -> Result<Counts, String> {
        let mean = pass.samples.end;
        let allocation = {
            let mut state = lock(state);
            let first = self.plan.first.filter(|&first| state.samples == first);
            if let Some(first) = first.filter(|_| state.allocation.is_none()) {
                let dealt = |image| Allocation::of_groups(&image, first, self.columns);
                let allocation = state.image().and_then(dealt);
                state.allocation = Some(allocation.map_err(|e| e.to_string())?);
            }
            state.allocation.clone()
        };
        let Some(allocation) = allocation else {
            return Ok(Counts::Same(mean));
        };
        // Sets of their own have any numbers: only all of them together have those that are dealt.
        let radix = match self.plan.one_set {
            Some(all) => {
                let some = self.points.of_pixel([0, 0], self.seed, all);
                some.map_err(|e| e.to_string())?.radix()
            }
            None => None,
        };
        Ok(Counts::Each(match radix {
            Some(radix) => allocation.powers(mean, radix),
            None => allocation.counts(mean),
        }))
    }

    /// The next pass.
    fn next(&self, state: &State) -> Option<Pass> {
        self.plan
            .next(state.passes, state.samples, state.seconds, state.noise())
    }

    /// Renders a row of a pass, unless it is there or somebody stops it. Says whether it is there.
    fn row(
        &self,
        y: u64,
        pass: &Pass,
        counts: &Counts,
        state: &Mutex<State>,
    ) -> Result<bool, String> {
        let at = usize::try_from(y).map_err(|e| e.to_string())?;
        if lock(state).has(at) {
            return Ok(true);
        }
        let y = u32::try_from(y).map_err(|e| e.to_string())?;
        // One set for all passes, or one for each.
        let set = match self.plan.one_set {
            Some(_) => 0,
            None => pass.number,
        };
        let seed = hash::hash(self.seed, set);
        let width = self.size[0] as usize;
        let before: Vec<_> = {
            let state = lock(state);
            let columns = 0..self.size[0];
            columns.map(|x| state.points_of([x, y])).collect()
        };
        let mut row = Row {
            pixels: vec![[Part::default(); 2]; width],
            ..Row::default()
        };
        let columns = self.columns as usize;
        let mut x = 0;
        while x < width {
            if self.stop.load(Ordering::Relaxed) {
                return Ok(false);
            }
            let mut some = Vec::new();
            let mut paths = 0;
            while x < width && (paths < ASKED || !x.is_multiple_of(columns)) {
                let end = counts.of(at * width + x).max(before[x]);
                let count = end - before[x];
                if count > 0 {
                    #[expect(clippy::cast_possible_truncation, reason = "the width is a u32")]
                    let position = [x as u32, y];
                    let points = match self.plan.one_set {
                        Some(all) => self.points.of_part(position, seed, all, before[x]..end),
                        None => self.points.of_pixel(position, seed, count),
                    };
                    some.push((position, points.map_err(|e| e.to_string())?, count));
                    let cut = pass.cut(before[x]..end);
                    let samples = [cut, count - cut];
                    row.pixels[x] = samples.map(|samples| Part {
                        samples,
                        mean: None,
                    });
                }
                paths = paths.saturating_add(count);
                x += 1;
            }
            let shares: Vec<_> = (some.iter())
                .map(|(position, points, count)| Share {
                    position: *position,
                    points: &**points,
                    count: *count,
                })
                .collect();
            self.means(&shares, &mut row)?;
        }
        lock(state).add(at, row);
        Ok(true)
    }

    /// Adds the means of the parts that the pixels have in a row to it.
    fn means(&self, shares: &[Share<&dyn PointSet>], row: &mut Row) -> Result<(), String> {
        let cut = |share: &Share<&dyn PointSet>| row.pixels[share.position[0] as usize][0].samples;
        if shares.iter().all(|share| cut(share) == 0) {
            let means = self.picture.averages(self.size, shares);
            let mut means = shares.iter().zip(means);
            return means.try_for_each(|(share, mean)| row.add(share.position, 1, mean));
        }
        for (share, means) in
            (shares.iter()).zip(self.picture.averages_in_two(self.size, shares, &cut))
        {
            for (part, mean) in means.into_iter().enumerate() {
                row.add(share.position, part, mean)?;
            }
        }
        Ok(())
    }

    /// Shows the progress and saves the work from time to time, until it is finished.
    fn watch(&self, state: &Mutex<State>, finished: &AtomicBool) -> Result<(), String> {
        let progress = Progress::new();
        let before = lock(state).seconds;
        let start = Instant::now();
        let (mut saved, mut pause) = (Instant::now(), SAVE);
        // It takes a look at every pixel, and changes with the passes alone.
        let (mut passes, mut noise) = (0, None);
        while !finished.load(Ordering::Relaxed) {
            std::thread::sleep(TICK);
            let seconds = before + start.elapsed().as_secs_f64();
            {
                let state = lock(state);
                let next = state.pass.clone().or_else(|| self.next(&state));
                let next = next.map_or(0, |pass| pass.count());
                let done = state.samples as f64 + state.part() * next as f64;
                if passes != state.passes {
                    (passes, noise) = (state.passes, state.noise());
                }
                let fraction = self.plan.fraction(done, seconds, noise);
                progress.show(fraction, state.paths, seconds, noise);
            }
            let Some(checkpoint) = self.checkpoint else {
                continue;
            };
            if saved.elapsed() >= pause {
                let begun = Instant::now();
                let mut copy = lock(state).clone();
                copy.seconds = seconds;
                checkpoint.save(&copy).map_err(|e| e.to_string())?;
                pause = SAVE.max(begun.elapsed() * SAVE_RATIO);
                saved = Instant::now();
            }
        }
        progress.finish();
        Ok(())
    }

    /// The mean number of coordinates of a path, over paths of all parts of the picture.
    pub(crate) fn coordinates_per_path(&self) -> f64 {
        const PATHS: u64 = 4096;
        let mut sum = 0;
        for path in 0..PATHS {
            let word = hash::hash(self.seed, path);
            let position = [(word, 0), (word >> 32, 1)].map(|(word, axis)| {
                let size = u64::from(self.size[axis]);
                u32::try_from(((word & 0xffff_ffff) * size) >> 32).expect("below the size")
            });
            let points = Points::Independent.of_pixel(position, word, 1);
            let points = points.expect("independent points are never refused");
            sum += self.picture.coordinates(position, self.size, &*points, 0);
        }
        sum as f64 / PATHS as f64
    }
}

/// How many samples the pixels are to have after a pass.
enum Counts {
    Same(u64),
    /// Row by row.
    Each(Vec<u64>),
}

impl Counts {
    fn of(&self, pixel: usize) -> u64 {
        match self {
            Self::Same(count) => *count,
            Self::Each(counts) => counts[pixel],
        }
    }
}

/// Also after a panic elsewhere: what is there is whole.
fn lock(state: &Mutex<State>) -> std::sync::MutexGuard<'_, State> {
    state
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner())
}
