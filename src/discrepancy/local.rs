//! The local discrepancy: one box, and in one dimension all of them.

use super::Points;
use crate::Error;

/// The local discrepancy `| vol [0, y) - #{x in [0, y)} / n |` at the corner `y` of an anchored box.
///
/// In one dimension this is `| x - n / N |`, with `n` of `N` points below `x`. The [star discrepancy](super::star) is
/// its supremum over all corners.[^niederreiter]
///
/// ```
/// use estimand::discrepancy::{Points, local};
///
/// let points = Points::from_rows(&[0.1, 0.2, 0.7], 1)?;
/// // Two of three points are below 0.5.
/// assert!((local(&points, &[0.5])? - (2.0 / 3.0 - 0.5)).abs() < 1e-15);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Refused`] for a corner of another dimension than the points', or outside `[0, 1]^d`.
///
/// [^niederreiter]: Niederreiter, Harald (1992). *Random Number Generation and Quasi-Monte Carlo Methods*, chapter 2.
///     <https://doi.org/10.1137/1.9781611970081>
pub fn local(points: &Points<'_>, corner: &[f64]) -> Result<f64, Error> {
    if corner.len() != points.dimensions() {
        return Err(Error::refused(
            "number of coordinates of the corner",
            "that of the points",
            format_args!("{}, not {}", corner.len(), points.dimensions()),
        ));
    }
    if let Some(outside) = corner.iter().find(|y| !(0.0..=1.0).contains(*y)) {
        return Err(Error::refused(
            "coordinate of the corner",
            "in [0, 1]",
            outside,
        ));
    }
    let inside = points
        .rows()
        .filter(|row| row.iter().zip(corner).all(|(x, y)| x < y))
        .count();
    let volume: f64 = corner.iter().product();
    Ok((volume - inside as f64 / points.count() as f64).abs())
}

/// The local discrepancy of points in one dimension as a function of the corner: a curve of straight pieces.
///
/// Between two neighbouring [`knots`](Self::knots) the signed local discrepancy `y - n(y) / N` rises with slope 1; at a
/// knot it falls by the share of the points there.
///
/// ```
/// use estimand::discrepancy::{LocalCurve, Points};
///
/// // At 1/4 there is no point below, and one of two at or below: 1/4 - 0 and 1/4 - 1/2.
/// let curve = LocalCurve::new(&Points::from_rows(&[0.75, 0.25], 1)?)?;
/// let knots = curve.knots();
/// assert_eq!((knots[1].corner, knots[1].below, knots[1].above), (0.25, 0.25, -0.25));
/// assert_eq!(curve.knots().len(), 4);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LocalCurve {
    knots: Vec<Knot>,
}

/// A corner at which the local discrepancy jumps, or an end of the unit interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Where: the end `y` of the interval, in `[0, 1]`.
    pub corner: f64,
    /// The signed local discrepancy of `[0, y)`.
    pub below: f64,
    /// The signed local discrepancy of `[0, y]`: the limit from above, except at the end 1.
    pub above: f64,
}

impl LocalCurve {
    /// The curve of points in one dimension.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for points of more dimensions.
    pub fn new(points: &Points<'_>) -> Result<Self, Error> {
        if points.dimensions() != 1 {
            return Err(Error::refused(
                "number of dimensions",
                "1 for the curve of the local discrepancy",
                points.dimensions(),
            ));
        }
        let mut sorted: Vec<f64> = points.column(0).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let count = sorted.len() as f64;
        let mut knots = Vec::with_capacity(sorted.len() + 2);
        let mut inside = 0_usize;
        if sorted[0] > 0.0 {
            knots.push(Knot {
                corner: 0.0,
                below: 0.0,
                above: 0.0,
            });
        }
        for ties in sorted.chunk_by(|a, b| a == b) {
            let corner = ties[0];
            let below = corner - inside as f64 / count;
            inside += ties.len();
            let above = corner - inside as f64 / count;
            knots.push(Knot {
                corner,
                below,
                above,
            });
        }
        if sorted[sorted.len() - 1] < 1.0 {
            knots.push(Knot {
                corner: 1.0,
                below: 0.0,
                above: 0.0,
            });
        }
        Ok(Self { knots })
    }

    /// The knots from corner 0 to corner 1, each corner once.
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }
}
