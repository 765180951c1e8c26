//! The quality parameter t of digital nets.

use super::Points;
use crate::{Error, reduce};

/// The least `t` for which the points are a `(t, m, d)`-net in `base`: all elementary intervals of volume `base^(t - m)` hold
/// `base^t` of the `base^m` points.[^niederreiter]
///
/// An elementary interval is a product of intervals `[a / base^k, (a + 1) / base^k)`, with a `k` for every dimension. A `t` of 0
/// is best; `m` says nothing and is met by all points.
///
/// Time `O(n m)` times the number of ways to share `m - t` digits among the dimensions. In bases that are no power of two,
/// coordinates within `2^-50` of a boundary of intervals, relative to it, are taken to be on it, since `f64` cannot
/// represent them.
///
/// ```
/// use estimand::discrepancy::{Points, t_value};
///
/// // Hammersley's points are a (0, m, 2)-net.
/// let hammersley = [[0.0, 0.0], [0.25, 0.5], [0.5, 0.25], [0.75, 0.75]];
/// assert_eq!(t_value(&Points::from_arrays(&hammersley)?, 2)?, 0);
///
/// // Points on the diagonal are stratified along the axes and nowhere else.
/// let diagonal = [[0.0, 0.0], [0.25, 0.25], [0.5, 0.5], [0.75, 0.75]];
/// assert_eq!(t_value(&Points::from_arrays(&diagonal)?, 2)?, 1);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Refused`] for a base below 2, and a count that is no power of the base.
///
/// [^niederreiter]: Niederreiter, Harald (1987). *Point Sets and Sequences with Small Discrepancy*.
///     Monatshefte für Mathematik 104, 273-337.
pub fn t_value(points: &Points<'_>, base: u32) -> Result<u32, Error> {
    if base < 2 {
        return Err(Error::refused("base of a net", "at least 2", base));
    }
    let count = points.count() as u64;
    let m = count.ilog(u64::from(base));
    if u64::from(base).pow(m) != count {
        return Err(Error::refused(
            "count of points of a net",
            "a power of its base",
            format_args!("{count}, in base {base}"),
        ));
    }
    // The first number of digits that some way of sharing it finds unevenly filled ends the search.
    for digits in 1..=m {
        let mut shares = Vec::new();
        share(digits, points.dimensions(), &mut Vec::new(), &mut shares);
        let even = reduce::each(shares.len() as u64, |job| {
            let share = &shares[usize::try_from(job).expect("a share is in memory")];
            evenly_filled(points, base, share)
        });
        if even.contains(&false) {
            return Ok(m + 1 - digits);
        }
    }
    Ok(0)
}

/// All ways to share `digits` among `dimensions`.
fn share(digits: u32, dimensions: usize, so_far: &mut Vec<u32>, shares: &mut Vec<Vec<u32>>) {
    if dimensions == 1 {
        so_far.push(digits);
        shares.push(so_far.clone());
        so_far.pop();
        return;
    }
    for here in 0..=digits {
        so_far.push(here);
        share(digits - here, dimensions - 1, so_far, shares);
        so_far.pop();
    }
}

/// Whether the elementary intervals with so many digits along each dimension hold equally many points.
fn evenly_filled(points: &Points<'_>, base: u32, digits: &[u32]) -> bool {
    let cells: Vec<u64> = digits.iter().map(|&k| u64::from(base).pow(k)).collect();
    let intervals = usize::try_from(cells.iter().product::<u64>()).expect("at most one a point");
    let each = points.count() / intervals;
    let mut filled = vec![0_usize; intervals];
    // The slack is nothing where the products are exact.
    let slack = if base.is_power_of_two() {
        1.0
    } else {
        1.0 + 4.0 * f64::EPSILON
    };
    points.rows().all(|row| {
        let interval = row.iter().zip(&cells).fold(0, |interval, (&x, &cells)| {
            #[expect(clippy::cast_possible_truncation, reason = "in [0, cells]")]
            let cell = (x * cells as f64 * slack) as u64;
            interval * cells + cell.min(cells - 1)
        });
        let filled = &mut filled[usize::try_from(interval).expect("below the intervals")];
        *filled += 1;
        *filled <= each
    })
}
