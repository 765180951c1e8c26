//! Learning when paths should end, from some that went before.

use core::ops::Range;

use glam::{Vec3, Vec3A};

use super::{Rule, TOLD_APART, place};
use crate::path::bsdf::Bsdf;
use crate::path::filter::Filter;
use crate::path::light::{Environment, Light};
use crate::path::render::check_size;
use crate::path::reuse::Diffuse;
use crate::path::sensor::Sensor;
use crate::path::{Paths, View};
use crate::points::{Independent, PointSet, pixel};
use crate::{Error, Moments, Sampler, each};

/// Looks on while a path is followed.
pub(crate) trait Witness {
    /// The path is at a point that may scatter light, `diffuse` if it does so ideally: what it carries, and what it has gathered.
    #[inline(always)]
    fn scatters(
        &mut self,
        _segment: u32,
        _diffuse: &dyn Fn() -> Option<Diffuse>,
        _throughput: &mut Vec3A,
        _radiance: &mut Vec3A,
    ) {
    }

    /// The path goes on after a segment: what it carried before the roulette, the weight the roulette gave it, and what it has
    /// gathered.
    #[inline(always)]
    fn goes_on(&mut self, _segment: u32, _carried: f32, _weight: f32, _radiance: Vec3A) {}
}

/// Nobody looks on.
impl Witness for () {}

/// The steps of a path, in their order.
#[derive(Default)]
pub(crate) struct Steps(Vec<Step>);

struct Step {
    segment: u32,
    carried: f32,
    weight: f32,
    radiance: Vec3A,
}

impl Witness for Steps {
    fn goes_on(&mut self, segment: u32, carried: f32, weight: f32, radiance: Vec3A) {
        self.0.push(Step {
            segment,
            carried,
            weight,
            radiance,
        });
    }
}

/// Pixels along an edge of the picture that are looked at, at most.
const LOOKED_AT: u32 = 128;

/// Paths whose second moments are known from a few bright ones are not ended more eagerly than this.
const SMALLEST: f64 = 0.1;

/// Each round learns from paths that end as the one before has taught.
const ROUNDS: u64 = 2;

/// What was seen of the paths after each segment.
#[derive(Clone, Copy, Default)]
struct Seen {
    /// The sum of the squares of what paths brought from there on, each over what it carried.
    gain: f64,
    /// The sum of the segments they still had, each times what it carried.
    cost: f64,
}

/// What the paths of some pixels have shown.
#[derive(Default)]
struct Tally {
    seen: [Seen; TOLD_APART],
    segments: f64,
    paths: f64,
    variance: f64,
    pixels: f64,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        for (seen, other) in self.seen.iter_mut().zip(&other.seen) {
            seen.gain += other.gain;
            seen.cost += other.cost;
        }
        self.segments += other.segments;
        self.paths += other.paths;
        self.variance += other.variance;
        self.pixels += other.pixels;
    }

    /// A path that took the given steps to `radiance`, and counts `scale`.
    fn path(&mut self, steps: &Steps, radiance: Vec3, scale: f32) {
        let steps = &steps.0;
        self.paths += 1.0;
        self.segments += 1.0 + steps.len() as f64;
        for (taken, step) in steps.iter().enumerate() {
            let carried = f64::from(step.carried);
            let weight = f64::from(step.weight);
            let brought = square((radiance - Vec3::from(step.radiance)) * scale);
            // A survivor stands for as many as its weight says, each of which would have brought less by it.
            let gain = brought / (weight * carried);
            let cost = (steps.len() - taken) as f64 * weight * carried;
            if gain.is_finite() && cost.is_finite() {
                let seen = &mut self.seen[place(step.segment)];
                seen.gain += gain;
                seen.cost += cost;
            }
        }
    }

    /// The factors that make the product of variance and time least, if there is anything to be learned.
    ///
    /// A path that carries `t` survives with probability `f t`. What it brings, `t L`, then adds `E[(t L)^2] / (f t)` to the variance
    /// `V` of a path of the picture, and its further segments `C` cost `f t C` of the time `T`. The product is least where
    /// `f^2` is the ratio of the two over that of `V` and `T`. That holds for paths whose survival is not certain, with the other
    /// factors as they are; all paths are counted, so that the least is met about.
    fn factors(&self) -> Option<[f64; TOLD_APART]> {
        let variance = self.variance / self.pixels;
        let time = self.segments / self.paths;
        if !(variance > 0.0 && time > 0.0 && (variance / time).is_finite()) {
            return None;
        }
        Some(self.seen.map(|Seen { gain, cost }| {
            // No path came here: by throughput.
            if !(cost > 0.0) {
                return 1.0;
            }
            (gain / cost * time / variance).sqrt().max(SMALLEST)
        }))
    }
}

fn square(color: Vec3) -> f64 {
    color.as_dvec3().length_squared() / 3.0
}

/// One path of a pixel, as `paths` has it, at the given point: what it brings, and what that counts in the picture.
type Follow<'a> = dyn Fn(Paths, [u32; 2], &mut dyn Sampler, &mut Steps) -> (Vec3, f32) + Sync + 'a;

/// `paths` with a rule that was learned from `count` paths in each of some pixels of a picture of `size`.
fn learn(
    mut paths: Paths,
    size: [u32; 2],
    count: u64,
    seed: u64,
    follow: &Follow<'_>,
) -> Result<Paths, Error> {
    if count < 2 {
        return Err(Error::refused(
            "number of pilot paths a pixel",
            "at least 2",
            count,
        ));
    }
    check_size(size)?;
    for round in 0..ROUNDS {
        let first = round * count;
        if let Some(factors) = look(paths, size, first..first + count, seed, follow).factors() {
            paths.roulette = Rule::learned(factors);
        }
    }
    Ok(paths)
}

/// What the paths with the given numbers show, in each of some pixels.
fn look(
    paths: Paths,
    size: [u32; 2],
    numbers: Range<u64>,
    seed: u64,
    follow: &Follow<'_>,
) -> Tally {
    let steps = size.map(|length| length.div_ceil(LOOKED_AT));
    let looked_at = [0, 1].map(|axis| u64::from(size[axis].div_ceil(steps[axis])));
    let row = |y: u64| {
        let mut tally = Tally::default();
        let mut taken = Steps::default();
        for x in 0..looked_at[0] {
            #[expect(clippy::cast_possible_truncation, reason = "inside the picture")]
            let position = [x as u32 * steps[0], y as u32 * steps[1]];
            let points = Independent::new(pixel::seed(position, seed));
            let mut values = Moments::new();
            for index in numbers.clone() {
                taken.0.clear();
                let (radiance, scale) =
                    follow(paths, position, &mut points.point(index), &mut taken);
                if radiance.is_finite() {
                    tally.path(&taken, radiance, scale);
                    values.push((radiance * scale).as_dvec3());
                }
            }
            if let Some(variance) = values.variance() {
                tally.variance += variance.element_sum() / 3.0;
                tally.pixels += 1.0;
            }
        }
        tally
    };
    let mut all = Tally::default();
    for tally in each(looked_at[1], row) {
        all.add(&tally);
    }
    all
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// The [paths](Self::paths) of the view, ended by Russian roulette as it pays: a pilot of `count` paths in each of up to 128 x
    /// 128 pixels of a picture of `size`, twice over, tells how much light paths still bring after each segment and how
    /// many segments they still have. The probability of survival is what a path carries times a factor for the
    /// segment, chosen so that the product of variance and work is about least. Factors are 0.1 at least, since a pilot may have
    /// missed rare light. It takes the place of [`Paths::roulette_from`], which undoes it.
    ///
    /// Its limit: the variance is that of independent points. Good sets have less, and for them too many paths are ended: the Cornell box
    /// with scrambled Sobol' points has less than half of the efficiency then. Where it pays is measured in `benches/README.md`. The
    /// factors hold for the whole picture, and work is counted in segments.[^rath]
    ///
    /// Unbiased, if the picture has another seed than the pilot. Where a round sees no variance the paths stay as they are.
    ///
    /// ```
    /// use estimand::{MonteCarlo, path::scenes};
    ///
    /// let mut view = scenes::cornell_box();
    /// view.paths = view.learn_roulette([32, 32], 4, 1)?;
    /// let picture = view.render([32, 32], 2, |key| MonteCarlo::new(16, key))?;
    /// assert!(picture.mean().x > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for fewer than 2 paths a pixel, and for a picture without pixels.
    ///
    /// [^rath]: Rath, Alexander; Grittmann, Pascal; Herholz, Sebastian; Weier, Philippe; Slusallek, Philipp (2022).
    ///     *EARS: Efficiency-Aware Russian Roulette and Splitting*. <https://doi.org/10.1145/3528223.3530168>
    pub fn learn_roulette(&self, size: [u32; 2], count: u64, seed: u64) -> Result<Paths, Error> {
        learn(
            self.paths,
            size,
            count,
            seed,
            &|paths, position, u, taken| {
                let mut pixel = self.pixel(position, size);
                pixel.paths = paths;
                pixel.follow(u, taken)
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MonteCarlo;
    use crate::path::{Image, scenes};

    #[test]
    fn factors_by_hand() {
        let step = |segment, carried, weight, radiance| Step {
            segment,
            carried,
            weight,
            radiance: Vec3A::splat(radiance),
        };
        let mut tally = Tally {
            variance: 0.5,
            pixels: 2.0,
            ..Tally::default()
        };
        // Three segments, of which the roulette after the second doubled what came of the third.
        let steps = Steps(vec![step(1, 0.5, 1.0, 1.0), step(2, 0.25, 2.0, 2.0)]);
        tally.path(&steps, Vec3::splat(6.0), 0.5);
        // And one.
        tally.path(&Steps::default(), Vec3::splat(9.0), 0.5);
        // T = 4 / 2, V = 0.25. After the first segment (0.5 (6 - 1))^2 / 0.5 over 2 * 0.5, after the second (0.5 (6 - 2))^2 / (2 * 0.25)
        // over 1 * 2 * 0.25.
        let factors = tally.factors().unwrap();
        assert!((factors[0] - (12.5_f64 / 1.0 * 2.0 / 0.25).sqrt()).abs() < 1e-12);
        assert!((factors[1] - (8.0_f64 / 0.5 * 2.0 / 0.25).sqrt()).abs() < 1e-12);
        assert_eq!(factors[2..], [1.0; TOLD_APART - 2]);
        assert!(Tally::default().factors().is_none());
    }

    /// The rule that is learned has a smaller product of variance and segments than rules that end paths more or less eagerly, the
    /// one by throughput among them.
    #[test]
    fn what_is_learned_pays() {
        let view = scenes::cornell_box();
        let size = [32, 32];
        let learned = view.learn_roulette(size, 64, 1).unwrap();
        let product = |rule: Rule| {
            let paths = Paths {
                roulette: rule,
                ..learned
            };
            let tally = look(paths, size, 0..512, 2, &|paths, position, u, taken| {
                let mut pixel = view.pixel(position, size);
                pixel.paths = paths;
                pixel.follow(u, taken)
            });
            tally.variance / tally.pixels * tally.segments / tally.paths
        };
        let scaled = |scale: f64| Rule::learned(learned.roulette.factors.map(|f| scale * f));
        let best = product(scaled(1.0));
        for (name, rule) in [
            ("throughput", Rule::of_throughput(5)),
            ("eager", scaled(0.3)),
            ("hesitant", scaled(4.0)),
        ] {
            let other = product(rule);
            assert!(other > 1.1 * best, "{name}: {other} beside {best}");
        }
    }

    /// The mean over all pixels, red, in standard errors from what it should be; false alarms at 4.6 once in 240 000 runs each.
    #[test]
    fn what_is_learned_has_no_bias() {
        let size = [24, 24];
        let z = |picture: &Image, mean: f64, error: f64| {
            let errors = picture.std_error().unwrap();
            let squares: f64 = errors.pixels().iter().map(|error| error.x * error.x).sum();
            (picture.mean().x - mean) / (squares.sqrt() / 576.0).hypot(error)
        };
        // A furnace has the radiance 1 everywhere.
        let mut furnace = scenes::furnace();
        furnace.paths = furnace.learn_roulette(size, 8, 1).unwrap();
        let picture = furnace
            .render(size, 2, |key| MonteCarlo::new(256, key))
            .unwrap();
        assert!(z(&picture, 1.0, 0.0).abs() < 4.6);

        let mut view = scenes::cornell_box();
        let usual = view
            .render(size, 3, |key| MonteCarlo::new(512, key))
            .unwrap();
        let error = usual.mean().x / z(&usual, 0.0, 0.0);
        // From very few paths, so that it is far from the best.
        view.paths = view.learn_roulette([2, 2], 2, 5).unwrap();
        assert!(view.paths != Paths::default());
        let picture = view
            .render(size, 4, |key| MonteCarlo::new(512, key))
            .unwrap();
        assert!(z(&picture, usual.mean().x, error).abs() < 4.6);
    }

    #[test]
    fn wrong_pilots_are_refused() {
        let view = scenes::cornell_box();
        let error = view.learn_roulette([8, 8], 1, 1).unwrap_err();
        assert!(
            error.to_string().contains("at least 2; it was 1"),
            "{error}"
        );
        let error = view.learn_roulette([0, 8], 2, 1).unwrap_err();
        assert!(error.to_string().contains("0 x 8"), "{error}");
    }
}
