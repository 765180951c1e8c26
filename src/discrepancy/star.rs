//! The star discrepancy, and what kind of number an answer is.

mod cell;
mod cells;
mod descent;
mod grid;
mod line;
mod plane;
mod search;
mod separable;
mod sweep;
mod threshold_accepting;

use super::Points;

pub use search::{Star, star};

/// A star discrepancy, or what is known of it, with the box that shows it.
///
/// Values are exact up to the rounding of `f64`: a few units in the last place of the volume, at most
/// `(d + 2) 2^-53`.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
#[non_exhaustive]
pub enum StarDiscrepancy {
    /// The star discrepancy itself.
    Exact {
        /// The star discrepancy.
        value: f64,
        /// The box whose local discrepancy it is.
        attained: AnchoredBox,
    },
    /// Two numbers that it lies between.
    Bounds {
        /// The local discrepancy of a box, so that the star discrepancy is no less.
        lower: f64,
        /// The star discrepancy is no more.
        upper: f64,
        /// The box whose local discrepancy is `lower`.
        attained: AnchoredBox,
    },
    /// A number that it is not below.
    LowerBound {
        /// The local discrepancy of a box, so that the star discrepancy is no less.
        value: f64,
        /// That box.
        attained: AnchoredBox,
    },
}

impl StarDiscrepancy {
    /// The largest number that the star discrepancy is known not to be below.
    pub fn lower(&self) -> f64 {
        match *self {
            Self::Exact { value, .. } | Self::LowerBound { value, .. } => value,
            Self::Bounds { lower, .. } => lower,
        }
    }

    /// The smallest number that the star discrepancy is known not to be above; `None` if nothing is known but the
    /// trivial 1.
    pub fn upper(&self) -> Option<f64> {
        match *self {
            Self::Exact { value, .. } => Some(value),
            Self::Bounds { upper, .. } => Some(upper),
            Self::LowerBound { .. } => None,
        }
    }

    /// The box whose local discrepancy is [`lower`](Self::lower).
    pub fn attained(&self) -> &AnchoredBox {
        match self {
            Self::Exact { attained, .. }
            | Self::Bounds { attained, .. }
            | Self::LowerBound { attained, .. } => attained,
        }
    }
}

/// A box with one corner at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct AnchoredBox {
    /// The corner opposite to the origin.
    pub corner: Vec<f64>,
    /// Whether the faces through that corner belong to the box.
    pub boundary: Boundary,
    /// How many of the points are inside.
    pub inside: usize,
}

impl AnchoredBox {
    /// The box with all points inside counted.
    pub(super) fn new(points: &Points<'_>, corner: Vec<f64>, boundary: Boundary) -> Self {
        let inside = points
            .rows()
            .filter(|row| {
                row.iter().zip(&corner).all(|(x, y)| match boundary {
                    Boundary::Open => x < y,
                    Boundary::Closed => x <= y,
                })
            })
            .count();
        Self {
            corner,
            boundary,
            inside,
        }
    }

    /// The volume of the box.
    pub fn volume(&self) -> f64 {
        self.corner.iter().product()
    }

    /// By how much the volume exceeds the share of the `count` points inside, or the share the volume.
    pub(super) fn excess(&self, count: usize) -> f64 {
        let share = self.inside as f64 / count as f64;
        match self.boundary {
            Boundary::Open => self.volume() - share,
            Boundary::Closed => share - self.volume(),
        }
    }
}

/// Whether the faces of a box that do not touch the origin belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// They do not, and too few points are inside.
    Open,
    /// They do, and too many points are inside.
    Closed,
}
