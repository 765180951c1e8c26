//! The strata of VEGAS.

use crate::stratum;

/// The strata: a grid of cells, equal along each axis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Grid {
    /// How many cells each axis has. The strata are numbered with the first axis fastest.
    cells: Vec<u64>,
    pub(super) strata: usize,
}

impl Grid {
    /// As many cells as leave eight points to each: the same along all axes, or one more along the first ones. Where they are
    /// more than the `bins` of an axis, no cell lies in two bins: the jump of the map between them would decide the error.
    pub(super) fn new(dimensions: usize, count: u64, bins: usize) -> Self {
        let most = (count / 8).clamp(1, 1 << 16);
        let mut cells = vec![1; dimensions];
        let mut strata = 1;
        for axis in (0..dimensions).cycle() {
            let more = strata / cells[axis] * (cells[axis] + 1);
            if more > most {
                break;
            }
            cells[axis] += 1;
            strata = more;
        }
        let bins = bins as u64;
        for cells in &mut cells {
            if *cells > bins {
                *cells -= *cells % bins;
            }
        }
        let strata: u64 = cells.iter().product();
        Self {
            cells,
            strata: usize::try_from(strata).expect("at most 2^16"),
        }
    }

    /// As many points in each, `count` in all: their numbers up to and with each stratum.
    pub(super) fn evenly(&self, count: u64) -> Vec<u64> {
        stratum::evenly(self.strata, count)
    }

    /// The axes under a map of `bins` bins, at the first stratum.
    pub(super) fn axes(&self, bins: usize) -> Vec<Axis> {
        let numbers = (0_u32..).step_by(bins);
        let axis = |(&cells, first): (&u64, u32)| Axis {
            cell: 0.0,
            cells,
            reciprocal: ONE.div_ceil(cells),
            scale: bins as f64 / cells as f64,
            first,
        };
        self.cells.iter().zip(numbers).map(axis).collect()
    }
}

/// Goes to the place of `stratum`.
#[inline]
pub(super) fn enter(stratum: usize, place: &mut [Axis]) {
    // A machine takes many times as long to divide as to multiply. The reciprocal is too large by less than 2^-32, the quotient
    // by less than 2^-16, since there are 2^16 strata at most: not enough to reach the next whole number, which is `1 / cells` away.
    let mut rest = stratum as u64;
    for axis in place {
        let above = (rest * axis.reciprocal) / ONE;
        axis.cell = (rest - above * axis.cells) as f64;
        rest = above;
    }
}

/// The one of numbers in fixed point.
const ONE: u64 = 1 << 32;

/// Where a stratum is along an axis.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub(super) cell: f64,
    /// How many cells there are.
    cells: u64,
    /// In units of 1 over [`ONE`], rounded up.
    reciprocal: u64,
    /// Bins a cell.
    pub(super) scale: f64,
    /// The number of its first bin among those of all axes.
    pub(super) first: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strata_have_eight_points_and_places_of_their_own() {
        for (dimensions, count, bins, cells) in [
            (1, 80, 50, vec![10]),
            (1, 8 * 128, 17, vec![119]),
            (2, 8 * 110, 10, vec![10, 10]),
            (2, 8 * 110, 5, vec![10, 10]),
            (2, 8 * 110, 11, vec![11, 10]),
            (3, 8 * 30, 50, vec![3, 3, 3]),
            (3, 8 * 36, 50, vec![4, 3, 3]),
            (10, 8 * 7, 1, vec![2, 2, 1, 1, 1, 1, 1, 1, 1, 1]),
            (2, 7, 3, vec![1, 1]),
            (1, 8 << 16, 1 << 17, vec![1 << 16]),
            (2, 8 << 16, 1000, vec![256, 256]),
            (3, 8 << 16, 1000, vec![40, 40, 40]),
            (0, 100, 3, vec![]),
        ] {
            let grid = Grid::new(dimensions, count, bins);
            assert_eq!(grid.cells, cells);
            assert_eq!(grid.strata as u64, cells.iter().product::<u64>());
            let mut axes = grid.axes(5);
            assert!(
                (0..)
                    .step_by(5)
                    .zip(&axes)
                    .all(|(first, axis)| axis.first == first)
            );
            let places: std::collections::BTreeSet<Vec<u64>> = (0..grid.strata)
                .map(|stratum| {
                    enter(stratum, &mut axes);
                    let numbers = axes.iter().rev().zip(grid.cells.iter().rev());
                    let number =
                        |number, (axis, cells): (&Axis, &u64)| number * *cells as f64 + axis.cell;
                    assert_eq!(numbers.fold(0.0, number), stratum as f64);
                    axes.iter().map(|axis| axis.cell.to_bits()).collect()
                })
                .collect();
            assert_eq!(places.len(), grid.strata);
        }
    }
}
