//! The power spectrum of points in the unit square.

/// The highest frequency, in cycles over the square.
pub(crate) const HIGHEST: usize = 64;

/// Frequencies along an axis: from `-HIGHEST` to `HIGHEST`.
pub(crate) const SIDE: usize = 2 * HIGHEST + 1;

/// `|sum of exp(-2 pi i k . x)|^2 / count` for all whole frequencies `k`, averaged over the `sets`: 1 everywhere for independent
/// points, but for frequency 0, which is left at 0. One row after the other, from the lowest frequency on.
pub(crate) fn power(sets: &[Vec<[f64; 2]>]) -> Vec<f64> {
    let mut power = vec![0.0; SIDE * SIDE];
    for points in sets {
        let mut sums = vec![[0.0; 2]; SIDE * SIDE];
        for &[x, y] in points {
            let (xs, ys) = (waves(x), waves(y));
            for (row, &[c, s]) in sums.chunks_exact_mut(SIDE).zip(&ys) {
                for (sum, &[re, im]) in row.iter_mut().zip(&xs) {
                    sum[0] += c * re - s * im;
                    sum[1] += c * im + s * re;
                }
            }
        }
        let scale = 1.0 / (points.len() * sets.len()) as f64;
        for (power, [re, im]) in power.iter_mut().zip(sums) {
            *power += scale * (re * re + im * im);
        }
    }
    power[SIDE * HIGHEST + HIGHEST] = 0.0;
    power
}

/// The waves of all frequencies along one axis, at `u`: cosine and sine.
fn waves(u: f64) -> Vec<[f64; 2]> {
    (0..SIDE)
        .map(|place| {
            let frequency = place as f64 - HIGHEST as f64;
            let (sine, cosine) = (-std::f64::consts::TAU * frequency * u).sin_cos();
            [cosine, sine]
        })
        .collect()
}
