//! Whether two independent pictures of a scene have the same expectation: Welch's test at three scales.

use std::fmt;
use std::path::PathBuf;

use estimand::Moments;
use estimand::path::Image;
use glam::DVec3;

/// The probability that a comparison fails although nothing is wrong, over all of its tests together.
pub(crate) const FALSE_ALARM: f64 = 1e-3;

/// Pixels per side of a tile.
const TILE: usize = 8;

/// Pixels that no path can vary must agree up to the rounding of `f32` sums.
const CONSTANT: f64 = 1e-5;

/// A picture as the mean of independent pictures, with what their spread says at each scale.
pub(crate) struct Batches {
    width: usize,
    scales: [Vec<Moments<DVec3>>; 3],
    samples: u64,
}

/// Pixels, tiles of 8 by 8 pixels, and the whole picture.
const SCALES: [&str; 3] = ["pixel", "tile", "picture"];

impl Batches {
    /// The mean of `count` pictures, each with `samples` per pixel.
    pub(crate) fn new(count: u64, samples: u64, picture: impl Fn(u64) -> Image) -> Self {
        let first = picture(0);
        let width = first.width();
        let mut scales = [Vec::new(), Vec::new(), Vec::new()];
        let mut add = |image: &Image| {
            for (scale, means) in scales.iter_mut().zip(at_scales(image)) {
                scale.resize(means.len(), Moments::new());
                for (moments, mean) in scale.iter_mut().zip(means) {
                    moments.push(mean);
                }
            }
        };
        add(&first);
        for batch in 1..count {
            add(&picture(batch));
        }
        Self {
            width,
            scales,
            samples: count * samples,
        }
    }
}

/// The pixels, the means of the tiles, and the mean of the picture.
fn at_scales(image: &Image) -> [Vec<DVec3>; 3] {
    let tiles = image.downsampled(TILE).expect("whole tiles");
    [
        image.pixels().to_vec(),
        tiles.pixels().to_vec(),
        vec![image.mean()],
    ]
}

/// The reference: a mean and its standard error, of pixels that are independent of one another.
pub(crate) struct Reference {
    pub(crate) name: &'static str,
    pub(crate) image: Image,
    /// Samples per pixel, and the batches they came in.
    pub(crate) samples: u64,
    pub(crate) batches: u64,
    /// By how much the variances of means over many pixels exceed those of independent ones: where a filter spreads each
    /// sample over several pixels, one over the integral of its square. 1 otherwise.
    pub(crate) correlated: f64,
}

/// The outcome of a comparison.
pub(crate) struct Agreement {
    name: String,
    width: usize,
    /// The probability of a deviation as large as the worst one, over all tests together.
    pub(crate) p: f64,
    worst: Finding,
    /// Of every pixel: the least p-value of its components, and whether it is too bright.
    pixels: Vec<(f64, bool)>,
    /// Constant pixels that differ.
    wrong: Vec<usize>,
}

#[derive(Clone, Copy)]
struct Finding {
    scale: usize,
    place: usize,
    component: usize,
    p: f64,
    t: f64,
    relative: f64,
}

impl Reference {
    /// Tests every component of every pixel, tile, and of the mean: Welch's test, with the degrees of freedom of
    /// Welch and Satterthwaite, and Sidak's correction for their number.
    ///
    /// A short run may have missed the rare bright paths of a pixel altogether, and its own variance with them;
    /// the variance that the reference predicts for independent samples then stands in for it. Where it has seen nothing of a tile, as
    /// where light comes with the tail of a filter alone, the spread is at most the one of values up to the brightest pixel which have
    /// the mean of the reference. It only widens the error, so that the rate of false alarms is a bound.
    pub(crate) fn compare(&self, ours: &Batches, label: &str) -> Agreement {
        let means = at_scales(&self.image);
        let errors = self.image.std_error().expect("a reference has errors");
        let variances: Vec<DVec3> = errors.pixels().iter().map(|&error| error * error).collect();
        let variances = Image::new(self.image.width(), variances).expect("the same size");
        let pixels = self.image.pixels().len() as f64;
        // Of means of independent pixels: the mean of their variances, over their number.
        let [fine, tiles, whole] = at_scales(&variances);
        let pixels = pixels / self.correlated;
        let tile = (TILE * TILE) as f64 / self.correlated;
        let tiles = tiles.iter().map(|&v| v / tile).collect();
        let variances = [fine, tiles, vec![whole[0] / pixels]];
        let ratio = self.samples as f64 / ours.samples as f64;
        let brightest = means[0].iter().copied().fold(DVec3::ZERO, DVec3::max);
        let all = self.image.pixels().len();

        let mut worst: Option<Finding> = None;
        let mut tests = 0_u32;
        let mut map = vec![(1.0, false); self.image.pixels().len()];
        let mut wrong = Vec::new();
        // A filter that reaches into neighbouring pixels brings a pixel, with little weight and little noise, what our points of
        // the film rarely meet: pixels alone cannot be compared then.
        let finest = usize::from(self.correlated > 1.0);
        for scale in finest..SCALES.len() {
            for (place, moments) in ours.scales[scale].iter().enumerate() {
                for component in 0..3 {
                    let (mean, expected) =
                        (moments.mean()[component], means[scale][place][component]);
                    let there = variances[scale][place][component];
                    let difference = mean - expected;
                    // Where the reference has seen nothing at all, there may still be what is rarely seen.
                    let constant = there.sqrt() <= 1e-6 * expected.abs();
                    if constant && (expected != 0.0 || mean == 0.0) {
                        if difference.abs() > CONSTANT * expected.abs() && scale == 0 {
                            wrong.push(place);
                        }
                        continue;
                    }
                    tests += 1;
                    let here = moments.variance().expect("several batches")[component]
                        / moments.count() as f64;
                    let unseen = if mean == 0.0 && self.correlated > 1.0 {
                        let samples = ours.samples * (all / means[scale].len()) as u64;
                        expected * brightest[component] / samples as f64
                    } else {
                        0.0
                    };
                    let guarded = here.max(ratio * there).max(unseen);
                    let t = difference / (guarded + there).sqrt();
                    let freedom = (guarded + there).powi(2)
                        / (guarded.powi(2) / (moments.count() - 1) as f64
                            + there.powi(2) / (self.batches - 1) as f64);
                    let p = two_sided(t, freedom);
                    if scale == 0 && p < map[place].0 {
                        map[place] = (p, t > 0.0);
                    }
                    if worst.is_none_or(|worst| p < worst.p) {
                        let relative = difference / expected;
                        worst = Some(Finding {
                            scale,
                            place,
                            component,
                            p,
                            t,
                            relative,
                        });
                    }
                }
            }
        }
        let worst = worst.expect("something varies");
        Agreement {
            name: format!("{}-{label}", self.name),
            width: ours.width,
            p: -(f64::from(tests) * (-worst.p).ln_1p()).exp_m1(),
            worst,
            pixels: map,
            wrong,
        }
    }
}

impl Agreement {
    /// Whether the pictures agree at the level [`FALSE_ALARM`].
    pub(crate) fn holds(&self) -> bool {
        self.p >= FALSE_ALARM && self.wrong.is_empty()
    }

    /// Panics, with the map of p-values written and the worst place named, if they do not agree.
    #[track_caller]
    pub(crate) fn check(&self) {
        assert!(
            self.holds(),
            "{self}\n  map of p-values: {}",
            self.map().display()
        );
    }

    /// Writes the p-values of the pixels as a picture: red where ours is too bright, blue where it is too dark,
    /// full colour from 1e-10 on.
    pub(crate) fn map(&self) -> PathBuf {
        let colour = |&(p, bright): &(f64, bool)| {
            let strength = (-p.max(1e-300).log10() / 10.0).min(1.0);
            if bright {
                DVec3::new(strength, 0.0, 0.0)
            } else {
                DVec3::new(0.0, 0.0, strength)
            }
        };
        let pixels = self.pixels.iter().map(colour).collect();
        let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{}.png", self.name));
        Image::new(self.width, pixels)
            .expect("as many pixels")
            .write_png(&file)
            .expect("the directory is cargo's");
        file
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let worst = self.worst;
        let columns = [self.width, self.width / TILE, 1][worst.scale];
        write!(
            f,
            "{}: p = {:.2e} over all tests; worst {} at column {}, row {}, {}: t = {:.2}, \
             p = {:.1e}, relative difference {:.2e}",
            self.name,
            self.p,
            SCALES[worst.scale],
            worst.place % columns,
            worst.place / columns,
            ["red", "green", "blue"][worst.component],
            worst.t,
            worst.p,
            worst.relative,
        )?;
        match self.wrong[..] {
            [] => Ok(()),
            [first, ..] => write!(
                f,
                "; {} constant values differ, the first at column {}, row {}",
                self.wrong.len(),
                first % self.width,
                first / self.width
            ),
        }
    }
}

/// `P(|T| > |t|)` for Student's t: the incomplete beta function `I_x(freedom / 2, 1 / 2)` at
/// `x = freedom / (freedom + t^2)`, by its continued fraction (DLMF 8.17.22, evaluated by Lentz's method).
fn two_sided(t: f64, freedom: f64) -> f64 {
    let (a, b, x) = (freedom / 2.0, 0.5, freedom / (freedom + t * t));
    let beta = |a: f64, b: f64, x: f64| {
        let log = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln();
        log.exp() / a / fraction(a, b, x)
    };
    if t == 0.0 {
        1.0
    } else if x < (a + 1.0) / (a + b + 2.0) {
        beta(a, b, x)
    } else {
        1.0 - beta(b, a, t * t / (freedom + t * t))
    }
}

/// `1 + d1 / (1 + d2 / (1 + ...))` of DLMF 8.17.22.
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let (mut value, mut c, mut d) = (1.0_f64, 1.0_f64, 0.0_f64);
    for step in 1..1000 {
        let m = f64::from(step / 2);
        let coefficient = if step % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        d = 1.0 / (1.0 + coefficient * d);
        c = 1.0 + coefficient / c;
        value *= c * d;
        if (c * d - 1.0).abs() < 1e-14 {
            break;
        }
    }
    value
}

/// Stirling's series (DLMF 5.11.1), after the argument is raised above 10 by the recurrence.
fn ln_gamma(z: f64) -> f64 {
    if z < 10.0 {
        return ln_gamma(z + 1.0) - z.ln();
    }
    let tail = 1.0 / (12.0 * z) - 1.0 / (360.0 * z.powi(3)) + 1.0 / (1260.0 * z.powi(5))
        - 1.0 / (1680.0 * z.powi(7));
    (z - 0.5) * z.ln() - z + 0.5 * (2.0 * std::f64::consts::PI).ln() + tail
}

#[test]
fn tails_of_students_t() {
    // Two-sided 5 %, 1 % and 0.1 % points, from the usual table; with one degree of freedom the closed form.
    for (freedom, t, p) in [
        (1.0, 12.706, 0.05),
        (5.0, 4.032, 0.01),
        (15.0, 2.131, 0.05),
        (30.0, 3.646, 0.001),
        (1e6, 1.96, 0.05),
    ] {
        assert!(
            (two_sided(t, freedom) / p - 1.0).abs() < 2e-3,
            "{freedom} {t}"
        );
    }
    let far: f64 = 1e8;
    let cauchy = 2.0 / std::f64::consts::PI * (1.0 / far).atan();
    assert!((two_sided(-far, 1.0) / cauchy - 1.0).abs() < 1e-6);
    assert_eq!(two_sided(0.0, 7.0), 1.0);
}
