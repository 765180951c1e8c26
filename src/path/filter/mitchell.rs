//! Cubic filters.

use super::Profile;
use crate::Error;

/// The cubic filters of Mitchell and Netravali, two pixels wide on each side.[^mitchell]
///
/// [^mitchell]: Mitchell, Don; Netravali, Arun (1988). *Reconstruction Filters in Computer Graphics*.
///     <https://doi.org/10.1145/54852.378514>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mitchell {
    b: f64,
    c: f64,
}

impl Mitchell {
    /// The filter with the two parameters of the source, which recommends a third for both.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for parameters outside `[0, 1]`.
    pub fn new(b: f64, c: f64) -> Result<Self, Error> {
        for parameter in [b, c] {
            if !(0.0..=1.0).contains(&parameter) {
                return Err(Error::refused(
                    "parameter of a cubic filter",
                    "in [0, 1]",
                    parameter,
                ));
            }
        }
        Ok(Self { b, c })
    }

    /// The spline of Catmull and Rom: sharper, with more ringing.[^catmull]
    ///
    /// [^catmull]: Catmull, Edwin; Rom, Raphael (1974). *A Class of Local Interpolating Splines*.
    ///     <https://doi.org/10.1016/B978-0-12-079050-0.50020-5>
    pub const fn catmull_rom() -> Self {
        Self { b: 0.0, c: 0.5 }
    }
}

impl Profile for Mitchell {
    fn radius(&self) -> f64 {
        2.0
    }

    fn value(&self, x: f64) -> f64 {
        let (x, b, c) = (x.abs(), self.b, self.c);
        let [cube, square, line, constant] = if x < 1.0 {
            [
                12.0 - 9.0 * b - 6.0 * c,
                -18.0 + 12.0 * b + 6.0 * c,
                0.0,
                6.0 - 2.0 * b,
            ]
        } else if x < 2.0 {
            [
                -b - 6.0 * c,
                6.0 * b + 30.0 * c,
                -12.0 * b - 48.0 * c,
                8.0 * b + 24.0 * c,
            ]
        } else {
            return 0.0;
        };
        (((cube * x + square) * x + line) * x + constant) / 6.0
    }
}
