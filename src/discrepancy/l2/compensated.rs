//! Sums that keep what rounding takes from them.

/// A sum in twice the working precision: the unevaluated sum of two numbers.[^knuth]
///
/// [^knuth]: Knuth, Donald (1997). *The Art of Computer Programming*, volume 2, section 4.2.2, theorem B.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Compensated {
    high: f64,
    low: f64,
}

impl From<f64> for Compensated {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Compensated {
    pub(super) const ZERO: Self = Self {
        high: 0.0,
        low: 0.0,
    };

    #[inline]
    pub(super) fn add(&mut self, term: f64) {
        let sum = self.high + term;
        let virtually = sum - self.high;
        self.low += (self.high - (sum - virtually)) + (term - virtually);
        self.high = sum;
    }

    pub(super) fn merge(&mut self, other: Self) {
        self.add(other.high);
        self.add(other.low);
    }

    pub(super) fn value(self) -> f64 {
        self.high + self.low
    }

    /// The sum times a number.
    pub(super) fn times(self, factor: f64) -> Self {
        let mut product = multiply(self.high, factor);
        product.low += self.low * factor;
        product
    }

    /// The sum divided by a number, with the remainder of the division carried on.
    pub(super) fn over(self, divisor: f64) -> Self {
        let quotient = self.high / divisor;
        let product = multiply(quotient, divisor);
        let remainder = (self.high - product.high) - product.low + self.low;
        Self {
            high: quotient,
            low: remainder / divisor,
        }
    }
}

/// The product of two numbers without rounding.[^dekker]
///
/// [^dekker]: Dekker, T. J. (1971). *A Floating-Point Technique for Extending the Available Precision*.
///     <https://doi.org/10.1007/BF01397083>
fn multiply(a: f64, b: f64) -> Compensated {
    let split = |x: f64| {
        let shifted = x * 134_217_729.0;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let high = a * b;
    let low = a_low * b_low - (((high - a_high * b_high) - a_low * b_high) - a_high * b_low);
    Compensated { high, low }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_takes_is_kept() {
        let mut sum = Compensated::ZERO;
        for term in [1.0, 1e-20, -1.0, 1e-20] {
            sum.add(term);
        }
        assert_eq!(sum.value(), 2e-20);
        // 1/3 to twice the precision, times 3, less 1.
        let mut sum = Compensated::from(1.0).over(3.0).times(3.0);
        sum.add(-1.0);
        assert!(sum.value().abs() < 1e-32, "{sum:?}");
    }
}
