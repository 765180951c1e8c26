//! What has been rendered so far.

use estimand::path::{Allocation, Image};
use estimand::{Error, Estimate, Incomplete};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::plan::Pass;

/// The mean of a part of a pixel.
type Mean = Result<Estimate<DVec3>, Incomplete<DVec3>>;

/// What has been rendered so far: all of some passes, and some rows of one.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct State {
    width: usize,
    /// How many passes are complete, and how many samples a pixel has in them, in the mean.
    pub(crate) passes: u64,
    pub(crate) samples: u64,
    pixels: Vec<Pixel>,
    /// The pass that is not complete, and its rows.
    pub(crate) pass: Option<Pass>,
    rows: Vec<Option<Row>>,
    /// How samples are dealt to the pixels, once the first ones have told.
    pub(crate) allocation: Option<Allocation>,
    /// Evaluations of all that is here.
    pub(crate) paths: u64,
    /// How many values of the picture were not finite.
    pub(crate) rejected: u64,
    /// The time that it took.
    pub(crate) seconds: f64,
}

/// A pixel after some passes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
struct Pixel {
    /// How many points were used up.
    points: u64,
    /// How many samples there are: fewer, where a part had no finite value.
    samples: u64,
    /// The mean over them.
    mean: [f64; 3],
    /// The sum of squared deviations of some parts from it, weighted by their samples, and of how many parts.
    deviation: [f64; 3],
    parts: u64,
}

/// A row of a pass.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(crate) struct Row {
    pub(crate) pixels: Vec<[Part; 2]>,
    pub(crate) paths: u64,
    pub(crate) rejected: u64,
}

impl Row {
    /// Adds the mean of a part of a pixel, if the part has samples.
    pub(crate) fn add(&mut self, [x, y]: [u32; 2], part: usize, mean: Mean) -> Result<(), String> {
        let part = &mut self.pixels[x as usize][part];
        if part.samples == 0 {
            return Ok(());
        }
        match mean {
            Ok(estimate) => {
                part.mean = Some(estimate.mean.to_array());
                self.paths += estimate.used;
                self.rejected += estimate.rejected;
            }
            // Other parts may have some.
            Err(Incomplete {
                reason: Error::NothingLeft { rejected },
                ..
            }) => {
                self.paths += rejected;
                self.rejected += rejected;
            }
            Err(error) => return Err(format!("pixel ({x}, {y}): {error}")),
        }
        Ok(())
    }
}

/// Some samples of a pixel.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub(crate) struct Part {
    pub(crate) samples: u64,
    /// Over them, if any is finite.
    pub(crate) mean: Option<[f64; 3]>,
}

impl Pixel {
    /// With some more samples. Where they are as many as those before and tell `by_halves`, the parts of those before are forgotten: they
    /// were too small to tell of it.
    fn add(&mut self, part: Part, by_halves: bool) {
        let samples = part.samples;
        self.points += samples;
        let Some(value) = part.mean else {
            return;
        };
        if by_halves && samples >= self.samples {
            self.deviation = [0.0; 3];
            self.parts = self.parts.min(1);
        }
        self.samples += samples;
        self.parts += 1;
        let weight = samples as f64;
        let share = weight / self.samples as f64;
        for (channel, value) in value.into_iter().enumerate() {
            let off = value - self.mean[channel];
            self.mean[channel] += off * share;
            self.deviation[channel] += weight * off * (value - self.mean[channel]);
        }
    }

    /// The squares of the standard errors; `None` before there are two parts.
    fn squared_errors(&self) -> Option<[f64; 3]> {
        let divisor = (self.parts > 1).then(|| (self.parts - 1) as f64 * self.samples as f64)?;
        Some(self.deviation.map(|sum| sum / divisor))
    }
}

impl State {
    pub(crate) fn new([width, height]: [u32; 2]) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self {
            width,
            passes: 0,
            samples: 0,
            pixels: vec![Pixel::default(); width * height],
            pass: None,
            rows: vec![None; height],
            allocation: None,
            paths: 0,
            rejected: 0,
            seconds: 0.0,
        }
    }

    /// Whether it is of a picture of that size, and all there.
    pub(crate) fn is_of(&self, [width, height]: [u32; 2]) -> bool {
        let [width, height] = [width as usize, height as usize];
        let of_width = |row: &Row| row.pixels.len() == width;
        self.width == width
            && self.rows.len() == height
            && self.pixels.len() == width * height
            && self.rows.iter().flatten().all(of_width)
            && (self.pass.is_some() || self.rows.iter().all(Option::is_none))
            && self.pass.as_ref().is_none_or(Pass::is_sound)
            && (self.allocation.as_ref()).is_none_or(|dealt| dealt.size() == [width, height])
    }

    /// How many points of a pixel are used up.
    pub(crate) fn points_of(&self, [x, y]: [u32; 2]) -> u64 {
        self.pixels[y as usize * self.width + x as usize].points
    }

    /// How many pixels have points, and no finite value at any.
    pub(crate) fn without_value(&self) -> u64 {
        let none = |pixel: &Pixel| pixel.points > 0 && pixel.samples == 0;
        self.seen().filter(none).count() as u64
    }

    /// The pixels after all complete passes, or with the rows of the first one.
    fn seen(&self) -> impl Iterator<Item = Pixel> {
        self.pixels.iter().enumerate().map(|(place, pixel)| {
            let mut pixel = *pixel;
            if let (0, Some(row)) = (self.passes, &self.rows[place / self.width]) {
                for part in row.pixels[place % self.width] {
                    pixel.add(part, false);
                }
            }
            pixel
        })
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

    /// Merges the rows of a complete pass of so many samples in the mean into the picture.
    pub(crate) fn complete(&mut self, samples: u64, by_halves: bool) {
        self.pass = None;
        self.passes += 1;
        self.samples += samples;
        let rows = self.rows.iter_mut().map(Option::take);
        for (row, pixels) in rows.zip(self.pixels.chunks_mut(self.width)) {
            let row = row.unwrap_or_default();
            for (pixel, parts) in pixels.iter_mut().zip(row.pixels) {
                for part in parts {
                    pixel.add(part, by_halves);
                }
            }
        }
    }

    /// The root-mean-square error of the pixels over the mean, as estimated, of those that have two parts; `None` before there are any.
    pub(crate) fn noise(&self) -> Option<f64> {
        let (mut squares, mut sum, mut count) = (0.0, 0.0, 0.0);
        for pixel in &self.pixels {
            if let Some(errors) = pixel.squared_errors() {
                squares += errors.iter().sum::<f64>();
                sum += pixel.mean.iter().sum::<f64>();
                count += 3.0;
            }
        }
        let noise = (squares / count).sqrt() / (sum / count).abs();
        noise.is_finite().then_some(noise)
    }

    /// The picture: of complete passes, or of the rows of the first one, black elsewhere.
    pub(crate) fn image(&self) -> Result<Image, Error> {
        let pixels = self.seen().map(|pixel| DVec3::from(pixel.mean));
        let image = Image::new(self.width, pixels.collect())?;
        let known = || self.pixels.iter().map(Pixel::squared_errors);
        if known().all(|squares| squares.is_none()) {
            return Ok(image);
        }
        let root = |squares: [f64; 3]| DVec3::from(squares.map(f64::sqrt));
        let errors = known().map(|squares| squares.map_or(DVec3::INFINITY, root));
        image.with_std_error(Image::new(self.width, errors.collect())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(samples: u64, value: f64) -> Part {
        Part {
            samples,
            mean: (samples > 0).then_some([value; 3]),
        }
    }

    /// With a pass of a row of one pixel.
    fn after(state: &mut State, samples: u64, value: f64, by_halves: bool) {
        let row = Row {
            pixels: vec![[Part::default(), part(samples, value)]],
            ..Row::default()
        };
        state.add(0, row);
        state.complete(samples, by_halves);
    }

    fn parts(state: &State) -> u64 {
        state.pixels[0].parts
    }

    #[test]
    fn two_halves_tell_of_the_noise() {
        let mut state = State::new([1, 1]);
        for (samples, value) in [(1, 9.0), (1, 1.0), (2, 3.0)] {
            after(&mut state, samples, value, false);
            assert_eq!(state.noise().is_some(), state.samples > 1);
        }
        // 5 in the mean of the first two, 3 of the other two.
        assert_eq!((state.passes, state.samples, parts(&state)), (3, 4, 3));
        assert_eq!(state.points_of([0, 0]), 4);
        let mut halves = state.clone();
        after(&mut halves, 4, 6.0, true);
        // 4 before, 6 now.
        assert_eq!((parts(&halves), halves.noise()), (2, Some(1.0 / 5.0)));
        // Fewer are a part more, none are none.
        after(&mut halves, 2, 5.0, true);
        assert_eq!(parts(&halves), 3);
        after(&mut halves, 0, 0.0, true);
        assert_eq!((parts(&halves), halves.points_of([0, 0])), (3, 10));
        assert_eq!(halves.image().unwrap().pixels()[0], DVec3::splat(5.0));
        // Parts of 4, 4 and 2 with the values 4, 6 and 5: 8 over 2 times 10.
        let error = halves.image().unwrap().std_error().unwrap().pixels()[0];
        assert!((error - DVec3::splat(0.4_f64.sqrt())).length() < 1e-15);
    }

    #[test]
    fn a_pixel_without_a_finite_value_uses_its_points_and_is_told_of() {
        let mut state = State::new([2, 1]);
        let nothing = Part {
            samples: 1,
            mean: None,
        };
        let row = Row {
            pixels: vec![[part(1, 1.0), part(1, 3.0)], [nothing; 2]],
            paths: 4,
            rejected: 2,
        };
        state.add(0, row);
        let begun = state.image().unwrap();
        assert_eq!(begun.pixels(), [DVec3::splat(2.0), DVec3::ZERO]);
        assert_eq!((state.without_value(), begun.std_error()), (1, None));
        state.complete(2, true);
        assert_eq!([0, 1].map(|x| state.points_of([x, 0])), [2, 2]);
        assert_eq!((state.without_value(), state.rejected), (1, 2));
        // Of the other one.
        assert_eq!(state.noise(), Some(0.5));
        let image = state.image().unwrap();
        assert_eq!(image.pixels(), [DVec3::splat(2.0), DVec3::ZERO]);
        let errors = image.std_error().unwrap();
        assert_eq!(errors.pixels(), [DVec3::ONE, DVec3::INFINITY]);
    }

    #[test]
    fn a_pass_that_was_begun_is_ended_after_resuming() {
        let pass = |first| Pass {
            number: 1,
            samples: first..8,
            halved: false,
        };
        let mut state = State::new([1, 2]);
        assert_eq!(state.begin(|_| Some(pass(4))), Some(pass(4)));
        let row = Row {
            pixels: vec![[part(2, 1.0); 2]],
            paths: 4,
            rejected: 0,
        };
        state.add(1, row);
        let saved = serde_json::to_string(&state).unwrap();
        let mut resumed: State = serde_json::from_str(&saved).unwrap();
        assert!(resumed.is_of([1, 2]) && !resumed.is_of([2, 1]) && resumed.has(1));
        assert_eq!(resumed.begin(|_| panic!("one is open")), Some(pass(4)));
        resumed.complete(4, false);
        assert_eq!(resumed.begin(|_| None), None);
        resumed.pass = Some(pass(9));
        assert!(!resumed.is_of([1, 2]));
        resumed.pass = Some(pass(4));
        assert!(resumed.is_of([1, 2]));
        resumed.rows[0] = Some(Row::default());
        assert!(!resumed.is_of([1, 2]));
        resumed.rows[0] = Some(Row {
            pixels: vec![[part(2, 1.0); 2]],
            ..Row::default()
        });
        assert!(resumed.is_of([1, 2]));
        // Rows are of a pass.
        resumed.pass = None;
        assert!(!resumed.is_of([1, 2]));
        resumed.rows[0] = None;
        for (pixels, fits) in [(2, true), (3, false)] {
            let ones = || Image::new(1, vec![DVec3::ONE; pixels]).unwrap();
            let image = ones().with_std_error(ones()).unwrap();
            resumed.allocation = Some(Allocation::new(&image, 2).unwrap());
            assert_eq!(resumed.is_of([1, 2]), fits);
        }
    }
}
