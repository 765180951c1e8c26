//! Weights for combining two techniques that can draw the same sample.[^veach]
//!
//! Of a sample that one technique has drawn with density `own`, and that the other would have drawn with density
//! `other`. The weights of both for the same sample add up to 1. An infinite `own`, that of a single direction,
//! has weight 1.
//!
//! [^veach]: Veach, Eric; Guibas, Leonidas (1995). *Optimally Combining Sampling Techniques for Monte Carlo
//!     Rendering*. <https://doi.org/10.1145/218380.218498>

/// The balance heuristic: `own / (own + other)`.
#[inline]
pub fn balance(own: f32, other: f32) -> f32 {
    1.0 / (1.0 + other / own)
}

/// The power heuristic with the exponent 2: `own^2 / (own^2 + other^2)`.
#[inline]
pub fn power(own: f32, other: f32) -> f32 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_add_up_to_one_and_stand_extremes() {
        for heuristic in [balance, power] {
            for (a, b) in [(1.0, 3.0), (1e-30, 1e30), (2.0, 0.0)] {
                assert!((heuristic(a, b) + heuristic(b, a) - 1.0).abs() < 1e-6);
            }
            assert_eq!(heuristic(f32::INFINITY, 5.0), 1.0);
            assert_eq!(heuristic(5.0, f32::INFINITY), 0.0);
        }
        assert_eq!(balance(1.0, 3.0), 0.25);
        assert_eq!(power(1.0, 3.0), 0.1);
    }
}
