//! What has been rendered so far.

use std::time::Duration;

use estimand::Error;
use estimand::path::{Allocation, Image};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::plan::Pass;

/// What has been rendered so far: all of some passes, and some rows of one.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct State {
    width: usize,
    /// How many passes are complete, and how many samples a pixel has in them.
    pub(crate) passes: u64,
    pub(crate) samples: u64,
    /// Of all pixels: the mean over the passes, weighted by their samples.
    mean: Vec<[f64; 3]>,
    /// Of all pixels: the sum of squared deviations of some parts from it, weighted alike, and of how many parts.
    deviation: Vec<[f64; 3]>,
    parts: u64,
    /// The pass that is not complete, and its rows.
    pub(crate) pass: Option<Pass>,
    rows: Vec<Option<Row>>,
    /// How samples are dealt to the pixels, once a pilot has told.
    pub(crate) allocation: Option<Allocation>,
    /// Evaluations of all that is here and of the pilot.
    pub(crate) paths: u64,
    /// How many values of the picture were not finite.
    pub(crate) rejected: u64,
    /// The time that it took, and how much of it the pilot.
    pub(crate) seconds: f64,
    pub(crate) pilot_seconds: f64,
}

/// A row of a pass.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(crate) struct Row {
    pub(crate) mean: Vec<[f64; 3]>,
    pub(crate) paths: u64,
    pub(crate) rejected: u64,
}

impl State {
    pub(crate) fn new([width, height]: [u32; 2]) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self {
            width,
            passes: 0,
            samples: 0,
            mean: vec![[0.0; 3]; width * height],
            deviation: vec![[0.0; 3]; width * height],
            parts: 0,
            pass: None,
            rows: vec![None; height],
            allocation: None,
            paths: 0,
            rejected: 0,
            seconds: 0.0,
            pilot_seconds: 0.0,
        }
    }

    /// Whether it is of a picture of that size, and all there.
    pub(crate) fn is_of(&self, [width, height]: [u32; 2]) -> bool {
        let [width, height] = [width as usize, height as usize];
        let pixels = width * height;
        let rows = self.rows.iter().flatten();
        self.width == width
            && self.rows.len() == height
            && [self.mean.len(), self.deviation.len()] == [pixels; 2]
            && rows.map(|row| row.mean.len()).all(|pixels| pixels == width)
            && self.pass.as_ref().is_none_or(Pass::is_sound)
    }

    /// Keeps what a pilot says, if it was not stopped.
    pub(crate) fn look(&mut self, says: Option<Allocation>, took: Duration) {
        self.paths += says.as_ref().map_or(0, Allocation::used);
        self.allocation = says;
        self.pilot_seconds += took.as_secs_f64();
    }

    /// The pass that was begun, or the next one, which is begun then.
    pub(crate) fn begin(&mut self, next: impl FnOnce(&Self) -> Option<Pass>) -> Option<Pass> {
        self.pass = self.pass.take().or_else(|| next(self));
        self.pass.clone()
    }

    /// Whether a row of the present pass is there.
    pub(crate) fn has(&self, row: usize) -> bool {
        self.rows[row].is_some()
    }

    /// How much of the present pass is there, in `[0, 1]`.
    pub(crate) fn part(&self) -> f64 {
        let there = self.rows.iter().filter(|row| row.is_some()).count();
        there as f64 / self.rows.len() as f64
    }

    pub(crate) fn add(&mut self, at: usize, row: Row) {
        self.paths += row.paths;
        self.rejected += row.rejected;
        self.rows[at] = Some(row);
    }

    /// Takes what is there as one part, whose own parts are forgotten: they were too small to tell of it.
    pub(crate) fn forget_parts(&mut self) {
        self.deviation.fill([0.0; 3]);
        self.parts = self.parts.min(1);
    }

    /// Merges the rows of a complete pass of so many samples into the picture.
    pub(crate) fn complete(&mut self, samples: u64) {
        self.pass = None;
        self.passes += 1;
        self.parts += 1;
        self.samples += samples;
        let weight = samples as f64;
        let share = weight / self.samples as f64;
        let rows = self.rows.iter_mut().map(Option::take);
        let values = rows.flat_map(|row| row.unwrap_or_default().mean);
        for ((mean, deviation), value) in self.mean.iter_mut().zip(&mut self.deviation).zip(values)
        {
            for channel in 0..3 {
                let off = value[channel] - mean[channel];
                mean[channel] += off * share;
                deviation[channel] += weight * off * (value[channel] - mean[channel]);
            }
        }
    }

    /// The root-mean-square error of the pixels over the mean, as estimated; `None` before there are two parts.
    pub(crate) fn noise(&self) -> Option<f64> {
        let divisor = self.divisor()?;
        let squares: f64 = self.deviation.as_flattened().iter().sum();
        let sum: f64 = self.mean.as_flattened().iter().sum();
        let count = (3 * self.mean.len()) as f64;
        let noise = (squares / divisor / count).sqrt() / (sum / count).abs();
        noise.is_finite().then_some(noise)
    }

    /// What deviations are divided by to be squared standard errors.
    fn divisor(&self) -> Option<f64> {
        (self.parts > 1).then(|| (self.parts - 1) as f64 * self.samples as f64)
    }

    /// The picture: of complete passes, or of the rows of the first one, black elsewhere.
    pub(crate) fn image(&self) -> Result<Image, Error> {
        let mut pixels: Vec<DVec3> = self.mean.iter().copied().map(DVec3::from).collect();
        if self.passes == 0 {
            for (row, pixels) in self.rows.iter().zip(pixels.chunks_mut(self.width)) {
                let values = row.iter().flat_map(|row| &row.mean);
                for (pixel, &value) in pixels.iter_mut().zip(values) {
                    *pixel = DVec3::from(value);
                }
            }
        }
        let image = Image::new(self.width, pixels)?;
        let Some(divisor) = self.divisor() else {
            return Ok(image);
        };
        let error = |deviation: &[f64; 3]| DVec3::from(deviation.map(|sum| (sum / divisor).sqrt()));
        let errors = self.deviation.iter().map(error).collect();
        image.with_std_error(Image::new(self.width, errors)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a pass of a row of one pixel.
    fn after(state: &mut State, samples: u64, value: f64) {
        let row = Row {
            mean: vec![[value; 3]],
            ..Row::default()
        };
        state.add(0, row);
        state.complete(samples);
    }

    #[test]
    fn two_halves_tell_of_the_noise() {
        let mut state = State::new([1, 1]);
        for (samples, value) in [(1, 9.0), (1, 1.0), (2, 3.0)] {
            after(&mut state, samples, value);
            assert_eq!(state.noise().is_some(), state.samples > 1);
        }
        // 5 in the mean of the first two, 3 of the other two.
        assert_eq!((state.passes, state.samples, state.parts), (3, 4, 3));
        let mut halves = state.clone();
        halves.forget_parts();
        assert_eq!(halves.noise(), None);
        after(&mut halves, 4, 6.0);
        // 4 before, 6 now.
        assert_eq!((halves.parts, halves.noise()), (2, Some(1.0 / 5.0)));
    }

    #[test]
    fn a_pass_that_was_begun_is_ended_after_resuming() {
        let pass = |first| Pass {
            set: 0,
            points: 8,
            part: first..8,
        };
        let mut state = State::new([1, 2]);
        assert_eq!(state.begin(|_| Some(pass(4))), Some(pass(4)));
        let row = Row {
            mean: vec![[1.0; 3]],
            paths: 4,
            rejected: 0,
        };
        state.add(1, row);
        let saved = serde_json::to_string(&state).unwrap();
        let mut resumed: State = serde_json::from_str(&saved).unwrap();
        assert!(resumed.is_of([1, 2]) && !resumed.is_of([2, 1]) && resumed.has(1));
        assert_eq!(resumed.begin(|_| panic!("one is open")), Some(pass(4)));
        resumed.complete(4);
        assert_eq!(resumed.begin(|_| None), None);
        for damage in [
            Pass {
                points: 0,
                ..pass(4)
            },
            Pass {
                part: std::ops::Range { start: 9, end: 8 },
                ..pass(4)
            },
        ] {
            resumed.pass = Some(damage);
            assert!(!resumed.is_of([1, 2]));
        }
    }
}
