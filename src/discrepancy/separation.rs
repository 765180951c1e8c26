//! The least distance between two points, in the cube and on the torus.

use super::Points;
use crate::reduce;

/// The least Euclidean distance between two of the points, `min_(i < j) |x_i - x_j|`; infinite for a single
/// one.[^johnson]
///
/// Large is good for designs of experiments and for the look of a picture, and says little about integrals. Time
/// between `O(d n log n)` and `O(d n^2)`: only points that are close along the first dimension are compared.
///
/// Below, 0.1 and 0.9 are 0.8 apart, and 0.1 + 1 - 0.9 = 0.2 around the torus.
///
/// ```
/// use estimand::discrepancy::{Points, minimum_distance, toroidal_minimum_distance};
///
/// let points = Points::from_rows(&[0.1, 0.5, 0.9, 0.5], 2)?;
/// assert!((minimum_distance(&points) - 0.8).abs() < 1e-15);
/// assert!((toroidal_minimum_distance(&points) - 0.2).abs() < 1e-15);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^johnson]: Johnson, Mark; Moore, Leslie; Ylvisaker, Donald (1990). *Minimax and Maximin Distance Designs*.
///     <https://doi.org/10.1016/0378-3758(90)90122-B>
pub fn minimum_distance(points: &Points<'_>) -> f64 {
    least(points, false)
}

/// The least Euclidean distance between two of the points on the torus, where 0 and 1 are the same; infinite for a
/// single point.
///
/// `min_(i < j) (sum_k min(t_k, 1 - t_k)^2)^(1/2)` with `t_k = |x_ik - x_jk|`. See [`minimum_distance`].
///
/// ```
/// use estimand::discrepancy::{Points, toroidal_minimum_distance};
///
/// // Across the corner: 1/8 along each dimension.
/// let points = Points::from_rows(&[0.0, 0.0, 0.875, 0.875], 2)?;
/// assert_eq!(toroidal_minimum_distance(&points), 0.03125_f64.sqrt());
/// # Ok::<(), estimand::Error>(())
/// ```
pub fn toroidal_minimum_distance(points: &Points<'_>) -> f64 {
    least(points, true)
}

/// Points whose distances to those after them make a job.
const JOB: usize = 1024;

fn least(points: &Points<'_>, torus: bool) -> f64 {
    let mut sorted: Vec<&[f64]> = points.rows().collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let count = sorted.len();
    let between = |a: f64, b: f64| {
        let t = (a - b).abs();
        if torus { t.min(1.0 - t) } else { t }
    };
    let squared = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(&a, &b)| between(a, b).powi(2)).sum()
    };
    // Neighbours in the order give a first bound.
    let bound = sorted
        .windows(2)
        .map(|pair| squared(pair[0], pair[1]))
        .fold(f64::INFINITY, f64::min);
    let jobs = reduce::each(count.div_ceil(JOB) as u64, |job| {
        let first = usize::try_from(job).expect("a job is in memory") * JOB;
        let mut least = bound;
        for here in first..count.min(first + JOB) {
            // On the torus the points after the last one are the first ones, a turn further.
            let turns = if torus { 2 } else { 1 };
            for at in here + 1..(turns * count).min(here + count) {
                let turn = if at < count { 0.0 } else { 1.0 };
                let there = sorted[at % count];
                if (there[0] + turn - sorted[here][0]).powi(2) >= least {
                    break;
                }
                least = least.min(squared(sorted[here], there));
            }
        }
        least
    });
    jobs.into_iter().fold(bound, f64::min).sqrt()
}
