//! Integrands that break estimators, with their integrals in closed form.

use std::f64::consts::{PI, TAU};

use estimand::{Integrand, Sampler};

type Function = Box<dyn Fn(&[f64]) -> f64 + Send + Sync>;

/// One integrand: a function of `dims` coordinates, and its integral.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) dims: u32,
    pub(crate) integral: f64,
    function: Function,
    /// What to use where sampling without knowledge of the integrand fails.
    pub(crate) instead: &'static str,
}

impl Integrand for Case {
    type Value = f64;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> f64 {
        let mut short = [0.0; 8];
        let dims = self.dims as usize;
        match short.get_mut(..dims) {
            Some(point) => {
                point.fill_with(|| u.next_1d());
                (self.function)(point)
            }
            None => {
                let point: Vec<f64> = (0..dims).map(|_| u.next_1d()).collect();
                (self.function)(&point)
            }
        }
    }

    fn dimensions(&self) -> u32 {
        self.dims
    }
}

fn case(
    name: impl Into<String>,
    dims: u32,
    integral: f64,
    instead: &'static str,
    function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
) -> Case {
    Case {
        name: name.into(),
        dims,
        integral,
        function: Box::new(function),
        instead,
    }
}

/// All of them.
pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let place = "importance sampling around the place of the peak";
    for width in [1e-2, 1e-3, 1e-4, 1e-6, 1e-8] {
        // The tails beyond the cube are below 1e-300.
        let whole = TAU * width * width;
        let peak = move |x: &[f64], centre: f64| {
            let square: f64 = x.iter().map(|x| ((x - centre) / width).powi(2)).sum();
            (-0.5 * square).exp()
        };
        cases.push(case(
            format!("peak, width {width:e}, centre"),
            2,
            whole,
            place,
            move |x| peak(x, 0.5),
        ));
        cases.push(case(
            format!("peak, width {width:e}, corner"),
            2,
            0.25 * whole,
            place,
            move |x| peak(x, 0.0),
        ));
    }
    let variable = "a change of variables by its antiderivative";
    for exponent in [0, 2, 4, 6, 8] {
        let c = 10_f64.powi(exponent);
        cases.push(case(
            format!("exp(-{c:e} x)"),
            1,
            -(-c).exp_m1() / c,
            variable,
            move |x| (-c * x[0]).exp(),
        ));
    }
    for exponent in [0, 2, 4, 6, 8] {
        let e = 10_f64.powi(-exponent);
        let integral = (1.0 / e).atan() / e;
        cases.push(case(
            format!("1 / ({e:e}^2 + x^2)"),
            1,
            integral,
            variable,
            move |x| 1.0 / (e * e + x[0] * x[0]),
        ));
    }
    for a in [-0.4, -0.5, -0.6, -0.75, -0.9, -0.99] {
        let name = format!("x^{a}");
        cases.push(case(name, 1, 1.0 / (1.0 + a), variable, move |x| {
            x[0].powf(a)
        }));
    }
    for periods in [1, 10, 1000, 100_000] {
        let k = f64::from(periods);
        let name = format!("oscillation, {periods} periods");
        let instead = "more points than periods";
        cases.push(case(name, 1, 1.0, instead, move |x| {
            1.0 + (TAU * k * x[0] + 1.0).cos()
        }));
    }
    for exponent in 1..=7 {
        let volume = 10_f64.powi(-exponent);
        let side = volume.cbrt();
        let name = format!("indicator of volume {volume:e}");
        let instead = "a bound (Bounded), or importance sampling";
        cases.push(case(name, 3, volume, instead, move |x| {
            f64::from(u8::from(x.iter().all(|&x| x < side)))
        }));
    }
    let fine = "any";
    cases.push(case("mean 1e9, deviation 1", 1, 1e9, fine, |x| {
        1e9 + 12_f64.sqrt() * (x[0] - 0.5)
    }));
    cases.push(case("+-1e16, alternating", 1, 0.0, fine, |x| {
        if (x[0] * 64.0) % 2.0 < 1.0 {
            1e16
        } else {
            -1e16
        }
    }));
    cases.push(case("subnormal", 1, 0.5e-310, fine, |x| 1e-310 * x[0]));
    cases.push(case("scale 1e-300", 1, 0.5e-300, fine, |x| 1e-300 * x[0]));
    cases.push(case("scale 1e300", 1, 0.5e300, fine, |x| 1e300 * x[0]));
    cases.push(case("constant 3.25", 1, 3.25, fine, |_| 3.25));
    cases.push(case("zero", 1, 0.0, fine, |_| 0.0));
    for dims in [1, 10, 100, 1000] {
        let d = f64::from(dims);
        cases.push(case(
            format!("sum of {dims} coordinates"),
            dims,
            0.5 * d,
            fine,
            |x| x.iter().sum(),
        ));
        let name = format!("product of {dims} factors");
        cases.push(case(name, dims, 1.0, fine, move |x| {
            x.iter().map(|x| 1.0 + (2.0 * x - 1.0) / d.sqrt()).product()
        }));
    }
    cases.push(case("1 / (1 + x^2)", 1, PI / 4.0, fine, |x| {
        1.0 / (1.0 + x[0] * x[0])
    }));
    cases
}
