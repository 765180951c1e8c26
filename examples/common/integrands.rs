//! Integrands by name, with their integrals in closed form where there is one.

use std::f64::consts::{PI, TAU};
use std::fmt;

use clap::ValueEnum;
use estimand::warp::{Normal, Warp};
use estimand::{Integrand, Sampler};

/// The integrands that a program can be told to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Family {
    /// Genz 1: cos(2 pi u + a sum x)
    Oscillatory,
    /// Genz 2: product of 1 / (a^-2 + (x - u)^2)
    ProductPeak,
    /// Genz 3: (1 + a sum x)^-(d + 1)
    CornerPeak,
    /// Genz 4: exp(-a^2 sum (x - u)^2)
    Gaussian,
    /// Genz 5: exp(-a sum |x - u|)
    Continuous,
    /// Genz 6: exp(a sum x), but 0 where the first or second coordinate is at least u
    Discontinuous,
    /// Keister: pi^(d/2) times the mean of cos |x| over a normal distribution of variance 1/2
    Keister,
    /// The random-walk integral of GSL's manual, in three dimensions
    RandomWalk,
    /// 1 in a box of side `width` around u, and 0 elsewhere
    Indicator,
    /// exp(-sum (x - u)^2 / (2 width^2))
    Peak,
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.to_possible_value();
        f.write_str(&value.map_or_else(String::new, |value| value.get_name().to_owned()))
    }
}

/// One integrand: a family with its parameters, the same in all dimensions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Problem {
    pub(crate) family: Family,
    pub(crate) dims: u32,
    /// Difficulty.
    pub(crate) a: f64,
    /// Place.
    pub(crate) u: f64,
    pub(crate) width: f64,
}

impl Problem {
    /// The family's usual instance in `dims` dimensions.
    pub(crate) fn new(family: Family, dims: u32) -> Self {
        let a = match family {
            Family::Oscillatory | Family::CornerPeak => 1.0,
            Family::ProductPeak | Family::Gaussian => 5.0,
            _ => 2.0,
        };
        Self {
            family,
            dims: if family == Family::RandomWalk {
                3
            } else {
                dims
            },
            a,
            u: 0.5,
            width: 0.01,
        }
    }

    /// The integral, where it is known in closed form: not for parameters at which the form is 0 / 0.
    pub(crate) fn integral(&self) -> Option<f64> {
        self.closed_form().filter(|integral| integral.is_finite())
    }

    fn closed_form(&self) -> Option<f64> {
        let Self {
            a, u, width, dims, ..
        } = *self;
        let d = f64::from(dims);
        let power = |x: f64| x.powf(d);
        Some(match self.family {
            Family::Oscillatory => {
                (TAU * u + 0.5 * d * a).cos()
                    * ((0.5 * a).sin() / (0.5 * a)).powi(dims.cast_signed())
            }
            Family::ProductPeak => power(a * ((a * (1.0 - u)).atan() + (a * u).atan())),
            Family::CornerPeak => (1..=dims).map(|k| 1.0 / (1.0 + f64::from(k) * a)).product(),
            Family::Gaussian => power(0.5 * PI.sqrt() / a * (erf(a * (1.0 - u)) + erf(a * u))),
            Family::Continuous => power((2.0 - (-a * u).exp() - (-a * (1.0 - u)).exp()) / a),
            Family::Discontinuous => {
                let (part, whole) = ((a * u).exp_m1() / a, a.exp_m1() / a);
                part.powf(d.min(2.0)) * whole.powf((d - 2.0).max(0.0))
            }
            // From the radial integral.
            Family::Keister => match dims {
                1 => 1.380_388_447_043_143,
                2 => 1.808_186_429_263_619,
                3 => 2.168_309_102_165_48,
                _ => return None,
            },
            // Gamma(1/4)^4 / (4 pi^3): GSL's manual.
            Family::RandomWalk => 1.393_203_929_685_676_9,
            Family::Indicator => {
                let side = (u + 0.5 * width).min(1.0) - (u - 0.5 * width).max(0.0);
                power(side.max(0.0))
            }
            Family::Peak => {
                let scale = width * 2.0_f64.sqrt();
                power(0.5 * scale * PI.sqrt() * (erf((1.0 - u) / scale) + erf(u / scale)))
            }
        })
    }
}

impl Integrand for Problem {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, sampler: &mut S) -> f64 {
        let Self {
            a, u, width, dims, ..
        } = *self;
        let mut sum =
            |f: &dyn Fn(f64) -> f64| -> f64 { (0..dims).map(|_| f(sampler.next_1d())).sum() };
        match self.family {
            Family::Oscillatory => (TAU * u + a * sum(&|x| x)).cos(),
            Family::ProductPeak => {
                let least = 1.0 / (a * a);
                (0..dims)
                    .map(|_| 1.0 / (least + (sampler.next_1d() - u).powi(2)))
                    .product()
            }
            Family::CornerPeak => (1.0 + a * sum(&|x| x)).powi(-dims.cast_signed() - 1),
            Family::Gaussian => (-a * a * sum(&|x| (x - u) * (x - u))).exp(),
            Family::Continuous => (-a * sum(&|x| (x - u).abs())).exp(),
            Family::Discontinuous => {
                let (mut inside, mut total) = (true, 0.0);
                for dimension in 0..dims {
                    let x = sampler.next_1d();
                    inside &= dimension > 1 || x < u;
                    total += x;
                }
                if inside { (a * total).exp() } else { 0.0 }
            }
            Family::Keister => {
                let normal = Normal::new(0.0, std::f64::consts::FRAC_1_SQRT_2);
                let Ok(normal) = normal else { return f64::NAN };
                let square = sum(&|x| normal.sample([x]).powi(2));
                PI.powf(0.5 * f64::from(dims)) * square.sqrt().cos()
            }
            Family::RandomWalk => {
                // Infinite at the origin, which unscrambled points hit.
                let [x, y, z] = std::array::from_fn(|_| (PI * sampler.next_1d()).cos());
                let rest = 1.0 - x * y * z;
                if rest > 0.0 {
                    1.0 / rest
                } else {
                    f64::INFINITY
                }
            }
            Family::Indicator => {
                let mut inside = true;
                for _ in 0..dims {
                    inside &= (sampler.next_1d() - u).abs() < 0.5 * width;
                }
                f64::from(u8::from(inside))
            }
            Family::Peak => (-0.5 / (width * width) * sum(&|x| (x - u) * (x - u))).exp(),
        }
    }

    fn dimensions(&self) -> u32 {
        self.dims
    }
}

/// The error function, by its series; 1 or -1 past 6, where it differs by less than 1e-16.
fn erf(x: f64) -> f64 {
    if x.abs() > 6.0 {
        return x.signum();
    }
    let (mut term, mut sum) = (x, x);
    for n in 1..200 {
        term *= 2.0 * x * x / f64::from(2 * n + 1);
        sum += term;
    }
    2.0 / PI.sqrt() * (-x * x).exp() * sum
}
