//! Circular correlations by the fast Fourier transform.

use core::f64::consts::TAU;

/// A complex number: its real and its imaginary part.
type Complex = [f64; 2];

/// The circular correlations of one sequence with others.
pub(super) struct Correlation {
    length: usize,
    /// Powers of the root of unity whose order is the length of the transform, a power of two.
    roots: Vec<Complex>,
    /// That of the sequence.
    spectrum: Vec<Complex>,
}

impl Correlation {
    /// Those with `sequence`.
    pub(super) fn new(sequence: &[f64]) -> Self {
        let length = sequence.len();
        // Lengths other than powers of two are laid out once and nearly once more, so that nothing wraps.
        let size = if length.is_power_of_two() {
            length
        } else {
            (2 * length - 1).next_power_of_two()
        };
        let roots: Vec<Complex> = (0..size / 2)
            .map(|power| {
                let (sine, cosine) = (-TAU * power as f64 / size as f64).sin_cos();
                [cosine, sine]
            })
            .collect();
        let mut spectrum = vec![[0.0; 2]; size];
        let periodic = sequence.iter().cycle().take(size.min(2 * length - 1));
        for (place, &number) in spectrum.iter_mut().zip(periodic) {
            place[0] = number;
        }
        transform(&mut spectrum, &roots);
        Self {
            length,
            roots,
            spectrum,
        }
    }

    /// `sum over i of other[i] sequence[(i + shift) % length]` for every shift below the length.
    pub(super) fn with(&self, other: &[f64]) -> Vec<f64> {
        let size = self.spectrum.len();
        let mut product = vec![[0.0; 2]; size];
        for (place, &number) in product.iter_mut().zip(other) {
            place[0] = number;
        }
        transform(&mut product, &self.roots);
        // The transform of the conjugate is the conjugate of the inverse, but for a factor.
        for ([re, im], [a, b]) in product.iter_mut().zip(&self.spectrum) {
            [*re, *im] = [*re * a + *im * b, *im * a - *re * b];
        }
        transform(&mut product, &self.roots);
        let scale = 1.0 / size as f64;
        product[..self.length]
            .iter()
            .map(|[re, _]| re * scale)
            .collect()
    }
}

/// Cooley and Tukey's transform of a power of two of numbers, in place: `sum over k of numbers[k] roots[j k]`.
fn transform(numbers: &mut [Complex], roots: &[Complex]) {
    let size = numbers.len();
    for place in 0..size {
        let mirrored = place.reverse_bits() >> 1 >> (usize::BITS - 1 - size.trailing_zeros());
        if place < mirrored {
            numbers.swap(place, mirrored);
        }
    }
    let mut half = 1;
    while half < size {
        let stride = size / (2 * half);
        for both in numbers.chunks_exact_mut(2 * half) {
            let (low, high) = both.split_at_mut(half);
            for ((low, high), [c, s]) in low.iter_mut().zip(high).zip(roots.iter().step_by(stride))
            {
                let turned = [high[0] * c - high[1] * s, high[0] * s + high[1] * c];
                *high = [low[0] - turned[0], low[1] - turned[1]];
                *low = [low[0] + turned[0], low[1] + turned[1]];
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{hash, unit};

    #[test]
    fn correlations_are_the_sums_that_they_stand_for() {
        for length in [1_usize, 2, 3, 4, 5, 8, 13, 64, 100, 127, 128] {
            let random =
                |key| -> Vec<f64> { (0..length).map(|k| unit(hash(key, k as u64))).collect() };
            let (sequence, other) = (random(1), random(2));
            let fast = Correlation::new(&sequence).with(&other);
            assert_eq!(fast.len(), length);
            for (shift, fast) in fast.into_iter().enumerate() {
                let plain: f64 = (0..length)
                    .map(|i| other[i] * sequence[(i + shift) % length])
                    .sum();
                assert!(
                    (fast - plain).abs() < 1e-12,
                    "{length} {shift}: {fast} for {plain}"
                );
            }
        }
    }
}
