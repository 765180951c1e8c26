//! A look at a picture that tells where it varies.

use core::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use crate::path::bsdf::Bsdf;
use crate::path::filter::Filter;
use crate::path::light::{Environment, Light};
use crate::path::render::check_size;
use crate::path::sensor::Sensor;
use crate::path::{Share, Unfinished, View};
use crate::points::{PointSet, pixel};
use crate::{Error, Incomplete, NonFinite, each, hash};

/// The side of the squares of pixels in each of which the pilot looks at one. What is around a pixel tells of it as well as its
/// own few samples would.
pub(super) const SIDE: u32 = 3;

/// How the means of two sets of points differ, in one pixel of each square of pixels.
pub(super) struct Pilot {
    size: [u32; 2],
    /// How many samples it took.
    pub(super) used: u64,
    /// The squares of the differences.
    squares: Vec<f64>,
}

/// How many squares of pixels there are along the axes.
fn grid(size: [u32; 2]) -> [u32; 2] {
    size.map(|pixels| pixels.div_ceil(SIDE))
}

impl Pilot {
    /// Takes the means over two sets of `count` points each, made by `points` from seeds: what they differ by is the error of such a
    /// set. `None` if `proceed` returns `false`, which ends it.
    pub(super) fn new<P, B, L, E, C, F>(
        view: &View<B, L, E, C, F>,
        size: [u32; 2],
        seed: u64,
        count: u64,
        points: &(impl Fn(u64) -> Result<P, Error> + Sync),
        proceed: &(impl Fn() -> bool + Sync),
    ) -> Result<Option<Self>, Unfinished>
    where
        P: PointSet,
        B: Bsdf,
        L: Light,
        E: Environment,
        C: Sensor,
        F: Filter,
    {
        check_size(size)?;
        let [columns, rows] = grid(size);
        let stopped = AtomicBool::new(false);
        let row = |y: u32| -> Result<(Vec<f64>, u64), Unfinished> {
            if stopped.load(Ordering::Relaxed) || !proceed() {
                stopped.store(true, Ordering::Relaxed);
                return Ok((Vec::new(), 0));
            }
            let mut shares = Vec::with_capacity(2 * columns as usize);
            for x in 0..columns {
                let position = within([x, y], size, seed);
                for set in 0..2 {
                    let points = points(pixel::seed(position, hash::hash(seed, set)))?;
                    shares.push(Share {
                        position,
                        points,
                        count,
                    });
                }
            }
            let mut used = 0;
            let mut means = Vec::with_capacity(shares.len());
            let outcomes = view.averages(size, &shares, NonFinite::Reject);
            for (outcome, share) in outcomes.into_iter().zip(&shares) {
                means.push(match outcome {
                    Ok(estimate) => {
                        used += estimate.used;
                        estimate.mean
                    }
                    // The pixels around tell.
                    Err(Incomplete {
                        reason: Error::NothingLeft { rejected },
                        ..
                    }) => {
                        used += rejected;
                        DVec3::ZERO
                    }
                    Err(Incomplete { reason, so_far }) => {
                        return Err(Unfinished {
                            reason,
                            position: Some(share.position),
                            so_far,
                            image: None,
                        });
                    }
                });
            }
            let (pairs, _) = means.as_chunks();
            let squares = pairs.iter().map(|[a, b]| a.distance_squared(*b));
            Ok((squares.collect(), used))
        };
        let rows = each(rows.into(), |y| {
            row(u32::try_from(y).expect("fewer rows than those of the picture"))
        });
        let (mut squares, mut used) = (Vec::new(), 0);
        for row in rows {
            let (more, evaluations) = row?;
            squares.extend(more);
            used += evaluations;
        }
        let pilot = Self {
            size,
            used,
            squares,
        };
        Ok((!stopped.into_inner()).then_some(pilot))
    }

    /// What the deviations of the pixels are to be taken for, row by row, up to a factor.
    ///
    /// Few samples may have met what is rare, or missed it. So the root of the mean of the squares nearby, which is right where there
    /// are enough samples and otherwise led by the one that met something, is moderated by the mean of the roots
    /// further around, which is not, in the geometric mean of both. And that is taken to the power of 3/4: less than 1, because it is
    /// uncertain. With 1, samples of a scene of caustics were dealt so much by chance that its variance was 1.13 times that of even ones.
    pub(super) fn deviations(&self) -> Vec<f64> {
        let [columns, _] = grid(self.size).map(|count| count as usize);
        let mut near = self.squares.clone();
        let mut around: Vec<f64> = near.iter().map(|square| square.sqrt()).collect();
        blur(&mut near, columns, NEAR);
        blur(&mut around, columns, AROUND);
        let deviations: Vec<f64> = near
            .iter()
            .zip(&around)
            .map(|(near, around)| (near.sqrt() * around).sqrt().powf(DAMPING))
            .collect();
        let [width, height] = self.size.map(|pixels| pixels as usize);
        let side = SIDE as usize;
        (0..height)
            .flat_map(|y| {
                let row = &deviations[y / side * columns..][..columns];
                (0..width).map(|x| row[x / side])
            })
            .collect()
    }
}

/// One of the pixels in a square.
fn within(square: [u32; 2], size: [u32; 2], seed: u64) -> [u32; 2] {
    let word = hash::hash(pixel::seed(square, seed), u64::MAX);
    core::array::from_fn(|axis| {
        let first = square[axis] * SIDE;
        let side = u64::from(SIDE.min(size[axis] - first));
        let part = word >> (32 * axis) & 0xffff_ffff;
        first + u32::try_from((part * side) >> 32).expect("less than the side")
    })
}

/// The power of the deviations that is given for them.
const DAMPING: f64 = 0.75;

/// How often the mean is taken, near and around: standard deviations of 1.2 and 3.5 squares.
const NEAR: usize = 3;
const AROUND: usize = 24;

/// Takes the mean of each number and those beside it, with half the weight each, along rows and columns of a table, several times.
/// What would be outside is as what is at the edge.
fn blur(table: &mut [f64], columns: usize, times: usize) {
    let rows = table.len() / columns;
    for _ in 0..times {
        for row in table.chunks_exact_mut(columns) {
            smooth(row, 1);
        }
        for column in 0..columns {
            smooth(&mut table[column..][..(rows - 1) * columns + 1], columns);
        }
    }
}

/// The same along one line of it.
fn smooth(line: &mut [f64], stride: usize) {
    let last = line.len() - 1;
    let mut before = line[0];
    for place in (0..line.len()).step_by(stride) {
        let own = line[place];
        let after = line[(place + stride).min(last)];
        line[place] = 0.25 * before + 0.5 * own + 0.25 * after;
        before = own;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::scenes;
    use crate::points::Independent;

    fn deviations(size: [u32; 2], squares: Vec<f64>) -> Vec<f64> {
        let pilot = Pilot {
            size,
            used: 0,
            squares,
        };
        pilot.deviations()
    }

    #[test]
    fn what_is_even_stays_and_what_stands_out_is_moderated() {
        for size in [[1, 1], [7, 1], [1, 8], [30, 20]] {
            let [columns, rows] = grid(size);
            let even = deviations(size, vec![4.0; (columns * rows) as usize]);
            assert_eq!(even, vec![2_f64.powf(0.75); (size[0] * size[1]) as usize]);
        }
        // One square of a thousand: near it binomial weights, 5/16 along each axis, around it those of 48 coins.
        let size = [300, 300];
        let mut squares = vec![0.0; 10_000];
        squares[50 * 100 + 50] = 1.0;
        let found = deviations(size, squares);
        let middle = 48_u32;
        let heads: f64 = (1..=24)
            .map(|k| f64::from(middle / 2 + k) / f64::from(k) / 4.0)
            .product();
        let expected = (0.3125 * heads * heads).powf(0.375);
        assert!((found[151 * 300 + 150] / expected - 1.0).abs() < 1e-12);
        // Four squares off there is nothing near.
        assert_eq!(found[151 * 300 + 163], 0.0);
        assert!(found[151 * 300 + 160] > 0.0);
    }

    #[test]
    fn one_pixel_of_every_square_is_looked_at() {
        let size = [8, 4];
        let [columns, rows] = grid(size);
        assert_eq!([columns, rows], [3, 2]);
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..500 {
            for square in [[0, 0], [2, 0], [2, 1]] {
                let [x, y] = within(square, size, seed);
                assert_eq!([x / SIDE, y / SIDE], square);
                assert!(x < 8 && y < 4);
                seen.insert([x, y]);
            }
        }
        // All of them: nine, six and two. One is left out with a chance of 9 (8/9)^500, 2e-25.
        assert_eq!(seen.len(), 17);
    }

    #[test]
    fn a_pilot_counts_its_samples_and_can_be_stopped() {
        let view = scenes::cornell_box();
        let points = |key| Ok(Independent::new(key));
        let pilot = |proceed: bool| Pilot::new(&view, [7, 7], 1, 5, &points, &|| proceed).unwrap();
        let done = pilot(true).unwrap();
        assert_eq!((done.used, done.squares.len()), (9 * 2 * 5, 9));
        assert!(done.squares.iter().any(|&square| square > 0.0));
        assert!(pilot(false).is_none());
        let none = Pilot::new(&view, [7, 7], 1, 0, &points, &|| true);
        assert!(none.is_err());
    }
}
