//! The power spectrum of a list of points.

use core::f64::consts::TAU;

use super::Points;
use crate::{Error, reduce};

/// The power of a list of points in the plane at all frequencies up to a largest one: `| sum_i exp(-2 pi j f x_i) |^2 / n` at
/// every pair of whole numbers `f`.[^dippe]
///
/// Independent points have a power of 1 in expectation everywhere but at frequency 0, where it is `n`. Dark around the
/// centre, "blue noise", means that low frequencies are well integrated; peaks mean structure that can alias.
///
/// Time `O(n k^2)` and memory `O(k^2)` for the largest frequency `k`.
///
/// ```
/// use estimand::discrepancy::{Periodogram, Points};
///
/// // A grid of 2 x 2 integrates all frequencies exactly that are not both even; at those all four waves are 1, and the
/// // power is 4^2 / 4.
/// let grid = [[0.0, 0.0], [0.0, 0.5], [0.5, 0.0], [0.5, 0.5]];
/// let spectrum = Periodogram::new(&Points::from_arrays(&grid)?, 2)?;
/// assert!(spectrum.power(1, 0) < 1e-30);
/// assert!((spectrum.power(-2, 2) - 4.0).abs() < 1e-14);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^dippe]: Dippé, Mark; Wold, Erling Henry (1985). *Antialiasing Through Stochastic Sampling*.
///     Computer Graphics 19(3), 69-78.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodogram {
    /// Rows of the second frequency from `-largest` to `largest`, for the first one from 0 to `largest`.
    powers: Vec<Vec<f64>>,
    largest: u32,
}

impl Periodogram {
    /// The powers at all frequencies from `-largest` to `largest` along both dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for points of other than two dimensions, and for a largest frequency above 2^15.
    pub fn new(points: &Points<'_>, largest: u32) -> Result<Self, Error> {
        if points.dimensions() != 2 {
            return Err(Error::refused(
                "number of dimensions",
                "2 for a periodogram",
                points.dimensions(),
            ));
        }
        if largest > 1 << 15 {
            return Err(Error::refused("largest frequency", "at most 2^15", largest));
        }
        let powers = reduce::each(u64::from(largest) + 1, |first| {
            row(points, first as f64, largest as usize)
        });
        Ok(Self { powers, largest })
    }

    /// The largest frequency.
    pub fn largest(&self) -> u32 {
        self.largest
    }

    /// The power at a frequency.
    ///
    /// # Panics
    ///
    /// If a frequency is beyond the largest one.
    pub fn power(&self, first: i32, second: i32) -> f64 {
        // Powers of real weights are the same at opposite frequencies.
        let second = if first < 0 { -second } else { second };
        let column = i64::from(self.largest) + i64::from(second);
        let column = usize::try_from(column).expect("the frequency is at least the least");
        self.powers[first.unsigned_abs() as usize][column]
    }

    /// The mean power over all frequencies whose length rounds to 0, 1, 2, up to the largest.
    pub fn radial_mean(&self) -> Vec<f64> {
        let mut rings = vec![(0.0, 0_u32); self.largest as usize + 1];
        let largest = i32::try_from(self.largest).expect("at most 2^15");
        for first in -largest..=largest {
            for second in -largest..=largest {
                let length = f64::from(first).hypot(f64::from(second)).round();
                #[expect(clippy::cast_possible_truncation, reason = "a small whole number")]
                if let Some((sum, count)) = rings.get_mut(length as usize) {
                    *sum += self.power(first, second);
                    *count += 1;
                }
            }
        }
        let mean = |(sum, count)| sum / f64::from(count);
        rings.into_iter().map(mean).collect()
    }
}

/// The powers at one first frequency and all second ones.
fn row(points: &Points<'_>, first: f64, largest: usize) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; 2 * largest + 1];
    for point in points.rows() {
        // The phase, less whole turns, which are exact here.
        let turns = first * point[0];
        let (sin, cos) = (TAU * (turns - turns.floor())).sin_cos();
        let (step_sin, step_cos) = (TAU * point[1]).sin_cos();
        let turn =
            |[re, im]: [f64; 2], sin: f64| [re * step_cos - im * sin, re * sin + im * step_cos];
        let (mut up, mut down) = ([cos, sin], [cos, sin]);
        sums[largest] = [sums[largest][0] + cos, sums[largest][1] + sin];
        for k in 1..=largest {
            up = turn(up, step_sin);
            down = turn(down, -step_sin);
            for (at, value) in [(largest + k, up), (largest - k, down)] {
                sums[at] = [sums[at][0] + value[0], sums[at][1] + value[1]];
            }
        }
    }
    let count = points.count() as f64;
    sums.into_iter()
        .map(|[re, im]| (re * re + im * im) / count)
        .collect()
}
