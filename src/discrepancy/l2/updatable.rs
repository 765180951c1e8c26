//! An L2 discrepancy that follows its points one change at a time.

use super::compensated::Compensated;
use super::{L2, assemble};
use crate::Error;
use crate::discrepancy::Points;

/// An [`L2`] discrepancy that is kept while points are added or replaced, in `O(d n)` each: for greedy and
/// exchange searches for better point sets.
///
/// ```
/// use estimand::discrepancy::{L2, Points, UpdatableL2};
///
/// let mut design = UpdatableL2::new(L2::Centred, &Points::from_rows(&[0.25, 0.75, 0.75, 0.25], 2)?);
/// design.add(&[0.5, 0.5])?;
/// design.replace(0, &[0.2, 0.8])?;
///
/// let afresh = L2::Centred.squared(&design.points());
/// assert!((design.squared() - afresh).abs() < 1e-15);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct UpdatableL2 {
    kind: L2,
    rows: Vec<f64>,
    dimensions: usize,
    singles: Compensated,
    pairs: Compensated,
}

impl UpdatableL2 {
    /// The discrepancy of a list of points, to be changed.
    pub fn new(kind: L2, points: &Points<'_>) -> Self {
        let (singles, pairs) = kind.sums(points);
        Self {
            kind,
            rows: points.rows().flatten().copied().collect(),
            dimensions: points.dimensions(),
            singles,
            pairs,
        }
    }

    /// The square of the discrepancy.
    pub fn squared(&self) -> f64 {
        let count = self.rows.len() / self.dimensions;
        let mean = self.kind.mean(self.dimensions);
        assemble(count, mean, self.singles, self.pairs)
    }

    /// The discrepancy: the root of the [square](Self::squared).
    pub fn root(&self) -> f64 {
        self.squared().sqrt()
    }

    /// The points as they are now.
    pub fn points(&self) -> Points<'_> {
        Points::from_rows(&self.rows, self.dimensions).expect("all points were checked")
    }

    /// Adds a point at the end.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a point of another dimension, and a coordinate that is NaN or outside `[0, 1]`.
    pub fn add(&mut self, point: &[f64]) -> Result<(), Error> {
        self.check(point)?;
        self.count(point, 1.0);
        self.rows.extend_from_slice(point);
        Ok(())
    }

    /// Puts a point in the place of another.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for an index of no point, a point of another dimension, and a coordinate that is NaN or
    /// outside `[0, 1]`.
    pub fn replace(&mut self, index: usize, point: &[f64]) -> Result<(), Error> {
        self.check(point)?;
        let count = self.rows.len() / self.dimensions;
        if index >= count {
            return Err(Error::refused(
                "index of the point to replace",
                "below the count of points",
                format_args!("{index}, of {count}"),
            ));
        }
        let place = index * self.dimensions..(index + 1) * self.dimensions;
        let last = self.rows.len() - self.dimensions;
        // The point in question goes last, leaves, and lets the other take its place.
        let old = self.rows[place.clone()].to_vec();
        self.rows.copy_within(last.., place.start);
        let moved = self.rows.split_off(last);
        self.count(&old, -1.0);
        self.count(point, 1.0);
        if place.start < last {
            self.rows[place].copy_from_slice(point);
            self.rows.extend(moved);
        } else {
            self.rows.extend_from_slice(point);
        }
        Ok(())
    }

    fn check(&self, point: &[f64]) -> Result<(), Error> {
        if point.len() != self.dimensions {
            return Err(Error::refused(
                "number of coordinates of a point",
                "that of the other points",
                format_args!("{}, not {}", point.len(), self.dimensions),
            ));
        }
        Points::from_rows(point, self.dimensions).map(|_| ())
    }

    /// Counts a point that is not among the rows in or out of the sums.
    fn count(&mut self, point: &[f64], sign: f64) {
        let (single, with_itself, with_others) = self
            .kind
            .sums_with(point, self.rows.chunks_exact(self.dimensions));
        self.singles.add(sign * single);
        self.pairs.add(sign * with_itself);
        self.pairs.merge(with_others.times(2.0 * sign));
    }
}
