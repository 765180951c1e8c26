//! A set of corners, and the points that it leaves undecided.

use super::grid::Grid;

/// The corners from `low` to `high`, both included.
pub(super) struct Cell {
    pub(super) low: Vec<u32>,
    pub(super) high: Vec<u32>,
    /// Points inside for all corners.
    pub(super) sure: u32,
    pub(super) undecided: Vec<Undecided>,
    /// No excess in the cell is above this one.
    pub(super) bound: f64,
}

/// A point that is inside for some corners of a cell and not for others.
#[derive(Clone, Copy)]
pub(super) struct Undecided {
    pub(super) point: u32,
    /// The dimensions along which that is so.
    pub(super) along: u64,
}

impl Cell {
    pub(super) fn all(grid: &Grid) -> Self {
        let dimensions = grid.dimensions();
        let low = vec![grid.first(); dimensions];
        let high: Vec<u32> = (0..dimensions).map(|j| grid.last(j)).collect();
        let mut cell = Self {
            low,
            high,
            sure: 0,
            undecided: Vec::new(),
            bound: 1.0,
        };
        let count = u32::try_from(grid.count()).expect("fewer than 2^32 points");
        for point in 0..count {
            let row = grid.row(point);
            if (0..dimensions).any(|j| row[j] >= cell.high[j]) {
                continue;
            }
            let along = (0..dimensions)
                .filter(|&j| row[j] >= cell.low[j])
                .fold(0, |along, j| along | 1 << j);
            if along == 0 {
                cell.sure += 1;
            } else {
                cell.undecided.push(Undecided { point, along });
            }
        }
        cell
    }
}
