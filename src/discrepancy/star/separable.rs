//! The largest excess in a cell of corners where every point is undecided along one dimension at most.

use super::Boundary;
use super::grid::Grid;

/// Finds the best corner of a separable cell by dynamic programming over the dimensions: for every number of points
/// inside, the largest volume of an open box or the smallest of a closed one.[^dobkin]
///
/// Its lists are kept from one cell to the next.
///
/// [^dobkin]: Dobkin, David; Eppstein, David; Mitchell, Don (1996). *Computing the Discrepancy with Applications to
///     Supersampling Patterns*. ACM Transactions on Graphics 15(4), 354-376.
#[derive(Default)]
pub(super) struct Separable {
    /// The ranks of the undecided points, dimension by dimension.
    ranks: Vec<Vec<u32>>,
    /// The best volume for every number of points inside, after the dimensions so far.
    volumes: Vec<f64>,
    next: Vec<f64>,
    /// For every dimension and number of points inside, the index chosen and the points it lets in.
    choices: Vec<Vec<(u32, u32)>>,
}

impl Separable {
    pub(super) fn clear(&mut self, dimensions: usize) {
        self.ranks.resize(dimensions, Vec::new());
        self.choices.resize(dimensions, Vec::new());
        self.ranks.iter_mut().for_each(Vec::clear);
    }

    /// Adds a point that is undecided along one dimension.
    pub(super) fn push(&mut self, dimension: usize, rank: u32) {
        self.ranks[dimension].push(rank);
    }

    /// The largest excess of the cell from `low` to `high` with `sure` points inside besides the undecided ones.
    pub(super) fn solve(&mut self, grid: &Grid, low: &[u32], high: &[u32], sure: u32) -> Best {
        self.volumes.clear();
        self.volumes.push(1.0);
        for dimension in 0..low.len() {
            self.dimension(grid, dimension, low[dimension], high[dimension]);
        }
        let mut best = Best {
            excess: f64::NEG_INFINITY,
            inside: 0,
        };
        for (inside, &volume) in (0..).zip(&self.volumes) {
            if volume.is_finite() {
                let excess = grid.excess(volume, sure + inside);
                if excess > best.excess {
                    best = Best { excess, inside };
                }
            }
        }
        best
    }

    fn dimension(&mut self, grid: &Grid, dimension: usize, low: u32, high: u32) {
        let open = grid.boundary() == Boundary::Open;
        let worst = if open {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        };
        let ranks = &mut self.ranks[dimension];
        let choices = &mut self.choices[dimension];
        choices.clear();
        if ranks.is_empty() {
            let index = if open { high } else { low };
            let end = grid.end(dimension, index);
            self.volumes.iter_mut().for_each(|volume| *volume *= end);
            choices.push((index, 0));
            return;
        }
        ranks.sort_unstable();
        let before = self.volumes.len();
        self.next.clear();
        self.next.resize(before + ranks.len(), worst);
        choices.resize(before + ranks.len(), (low, 0));
        let mut offer = |index: u32, points: usize| {
            let end = grid.end(dimension, index);
            let choice = (index, u32::try_from(points).unwrap_or(u32::MAX));
            let places = self.next[points..].iter_mut().zip(&mut choices[points..]);
            for (&volume, (place, chosen)) in self.volumes.iter().zip(places) {
                let volume = volume * end;
                if if open {
                    volume > *place
                } else {
                    volume < *place
                } {
                    (*place, *chosen) = (volume, choice);
                }
            }
        };
        // An open box grows until it would let in the next point; a closed one shrinks to the last it lets in.
        if open {
            for (points, &rank) in ranks.iter().enumerate() {
                if points == 0 || ranks[points - 1] < rank {
                    offer(rank, points);
                }
            }
            offer(high, ranks.len());
        } else {
            offer(low, 0);
            for (points, &rank) in (1..).zip(ranks.iter()) {
                if ranks.get(points).is_none_or(|&next| rank < next) {
                    offer(rank + 1, points);
                }
            }
        }
        core::mem::swap(&mut self.volumes, &mut self.next);
    }

    /// The corner of what [`solve`](Self::solve) found last.
    pub(super) fn corner(&self, best: Best) -> Vec<u32> {
        let mut inside = best.inside;
        let mut corner: Vec<u32> = (self.choices.iter().rev())
            .map(|choices| {
                let (index, points) = match choices[..] {
                    [only] => only,
                    _ => choices[inside as usize],
                };
                inside -= points;
                index
            })
            .collect();
        corner.reverse();
        corner
    }
}

/// The best corner of a separable cell: its excess, and the undecided points inside.
#[derive(Clone, Copy)]
pub(super) struct Best {
    pub(super) excess: f64,
    inside: u32,
}
