//! The finite list of points whose discrepancy is asked for.

use core::ops::Range;
use std::borrow::Cow;

use crate::Error;
use crate::points::PointSet;

/// A finite list of points of `[0, 1]^d`, checked once and measured as often as one likes.
///
/// Rows of a slice are borrowed, points of a [`PointSet`] are computed and kept. A coordinate may be `1.0`, though
/// no point set of this crate returns it: point lists of other origin do.
///
/// ```
/// use estimand::discrepancy::Points;
/// use estimand::points::Independent;
///
/// let rows = [0.5, 0.25, 0.75, 0.125];
/// let points = Points::from_rows(&rows, 2)?;
/// assert_eq!((points.count(), points.dimensions()), (2, 2));
/// assert_eq!(points.row(1), [0.75, 0.125]);
///
/// let points = Points::from_set(&Independent::new(1), 0..1000, 3)?;
/// assert_eq!(points.count(), 1000);
///
/// let refused = Points::from_rows(&[0.5, 0.25, f64::NAN, 0.125], 2).unwrap_err();
/// assert_eq!(
///     refused.to_string(),
///     "the coordinate of a point must be in [0, 1]; it was NaN, in dimension 0 of point 1"
/// );
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Points<'a> {
    rows: Cow<'a, [f64]>,
    dimensions: usize,
}

impl<'a> Points<'a> {
    /// The points whose coordinates `rows` lists, one point after the other.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points, no dimensions, a length that is no multiple of `dimensions`, and a coordinate
    /// that is NaN or outside `[0, 1]`.
    pub fn from_rows(rows: &'a [f64], dimensions: usize) -> Result<Self, Error> {
        Self::checked(Cow::Borrowed(rows), dimensions)
    }

    /// The points of a list of arrays.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points, no dimensions, and a coordinate that is NaN or outside `[0, 1]`.
    pub fn from_arrays<const D: usize>(points: &'a [[f64; D]]) -> Result<Self, Error> {
        Self::checked(Cow::Borrowed(points.as_flattened()), D)
    }

    /// The points of a list of slices, which must all have the length of the first.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points, no dimensions, points of different dimensions, and a coordinate that is
    /// NaN or outside `[0, 1]`.
    pub fn from_slices<P: AsRef<[f64]>>(points: &[P]) -> Result<Self, Error> {
        let dimensions = points.first().map_or(1, |point| point.as_ref().len());
        let mut rows = Vec::with_capacity(points.len().saturating_mul(dimensions));
        for (index, point) in points.iter().enumerate() {
            let point = point.as_ref();
            if point.len() != dimensions {
                return Err(Error::refused(
                    "number of coordinates of a point",
                    "that of the first point",
                    format_args!("{} for point {index}, not {dimensions}", point.len()),
                ));
            }
            rows.extend_from_slice(point);
        }
        Self::checked(Cow::Owned(rows), dimensions)
    }

    /// The points `indices` of a set, in its first `dimensions` dimensions.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no points, no dimensions, more dimensions than the set has, more coordinates than
    /// an address space holds, and a coordinate that is NaN or outside `[0, 1]`.
    pub fn from_set(
        set: &(impl PointSet + ?Sized),
        indices: Range<u64>,
        dimensions: u32,
    ) -> Result<Self, Error> {
        if dimensions > set.dimensions() {
            return Err(Error::refused(
                "number of dimensions",
                "at most that of the point set",
                format_args!("{dimensions}, not {}", set.dimensions()),
            ));
        }
        let count = indices.end.saturating_sub(indices.start);
        let mut rows = Vec::new();
        let coordinates = count
            .checked_mul(u64::from(dimensions))
            .and_then(|coordinates| usize::try_from(coordinates).ok())
            .filter(|&coordinates| rows.try_reserve_exact(coordinates).is_ok())
            .ok_or_else(|| {
                Error::refused(
                    "count of points",
                    "small enough for their coordinates to fit into memory",
                    count,
                )
            })?;
        rows.resize(coordinates, 0.0);
        set.fill(indices.start, 0..dimensions, &mut rows);
        Self::checked(Cow::Owned(rows), dimensions as usize)
    }

    fn checked(rows: Cow<'a, [f64]>, dimensions: usize) -> Result<Self, Error> {
        if dimensions == 0 {
            return Err(Error::refused(
                "number of dimensions",
                "at least 1",
                dimensions,
            ));
        }
        if rows.is_empty() {
            return Err(Error::refused("count of points", "at least 1", 0));
        }
        if !rows.len().is_multiple_of(dimensions) {
            return Err(Error::refused(
                "number of coordinates",
                "a multiple of the number of dimensions",
                format_args!("{} for {dimensions} dimensions", rows.len()),
            ));
        }
        let offender = rows
            .iter()
            .position(|coordinate| !(0.0..=1.0).contains(coordinate));
        if let Some(at) = offender {
            let (index, dimension) = (at / dimensions, at % dimensions);
            return Err(Error::refused(
                "coordinate of a point",
                "in [0, 1]",
                format_args!("{}, in dimension {dimension} of point {index}", rows[at]),
            ));
        }
        Ok(Self { rows, dimensions })
    }

    /// How many points there are: at least 1.
    pub fn count(&self) -> usize {
        self.rows.len() / self.dimensions
    }

    /// How many coordinates a point has: at least 1.
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// The coordinates of the point `index`.
    ///
    /// # Panics
    ///
    /// If there is no such point.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.rows[index * self.dimensions..][..self.dimensions]
    }

    /// The points, one after the other.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.rows.chunks_exact(self.dimensions)
    }

    /// One coordinate of all points, in their order.
    pub(super) fn column(&self, dimension: usize) -> impl ExactSizeIterator<Item = f64> {
        self.rows().map(move |row| row[dimension])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Stratified;

    #[test]
    fn what_is_no_list_of_points_is_refused_by_name() {
        let value = |refused: Result<Points<'_>, Error>| match refused {
            Err(Error::Refused { value, .. }) => value,
            other => panic!("{other:?}"),
        };
        assert_eq!(value(Points::from_rows(&[], 2)), "0");
        assert_eq!(value(Points::from_rows(&[0.5], 0)), "0");
        assert_eq!(value(Points::from_rows(&[0.5; 3], 2)), "3 for 2 dimensions");
        let offenders = [-f64::MIN_POSITIVE, 1.0 + f64::EPSILON, f64::INFINITY];
        for offender in offenders {
            assert_eq!(
                value(Points::from_arrays(&[[0.5, 0.5], [0.5, offender]])),
                format!("{offender}, in dimension 1 of point 1")
            );
        }
        let mixed: [&[f64]; 3] = [&[0.1, 0.2], &[0.3, 0.4], &[0.5]];
        assert_eq!(value(Points::from_slices(&mixed)), "1 for point 2, not 2");
        let none: [&[f64]; 0] = [];
        assert_eq!(value(Points::from_slices(&none)), "0");
        let grid = Stratified::new(16, 2, 1).unwrap();
        assert_eq!(value(Points::from_set(&grid, 3..3, 2)), "0");
        assert_eq!(
            value(Points::from_set(&grid, 0..u64::MAX, 2)),
            u64::MAX.to_string()
        );
    }

    #[test]
    fn zero_and_one_are_coordinates() {
        assert!(Points::from_rows(&[0.0, -0.0, 1.0], 1).is_ok());
    }
}
