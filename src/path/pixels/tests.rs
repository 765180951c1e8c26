//! Pixels together against pixels alone.

use glam::DVec3;

use super::*;
use crate::path::filter::{BoxFilter, Filtered};
use crate::path::scenes;
use crate::path::sensor::{Clipped, FarPlane, Projection};
use crate::points::{BlueNoise, Hammersley, Independent, Rescrambled, pixel};

/// Numbers of points that end within and at batches, that are none, and that are more than are followed together.
const COUNTS: [u64; 9] = [1, 3, 512, 0, 17, 1500, 1024, 2, 600];

#[test]
fn each_pixel_is_as_it_is_alone() {
    let size = [9, 5];
    let view = scenes::cornell_box();
    let shares = |points: fn(u64, u64) -> Box<dyn PointSet>| -> Vec<Share<_>> {
        (0..27)
            .map(|place| {
                let position = [place % 9, place / 9];
                let count = COUNTS[(place as usize * 7) % 9];
                let points = points(pixel::seed(position, 3), count);
                Share {
                    position,
                    points,
                    count,
                }
            })
            .collect()
    };
    let rescrambled = |seed, _| Box::new(Rescrambled::new(4, seed).unwrap()) as Box<dyn PointSet>;
    let independent = |seed, _| Box::new(Independent::new(seed)) as Box<dyn PointSet>;
    // In fewer dimensions than paths read, and of a size of its own.
    let finite =
        |_, count: u64| Box::new(Hammersley::new(count.max(1), 5).unwrap()) as Box<dyn PointSet>;
    for points in [rescrambled, independent, finite] {
        let shares = shares(points);
        let together = view.averages(size, &shares, NonFinite::Fail);
        assert_eq!(together.len(), shares.len());
        for (share, mut outcome) in shares.iter().zip(together) {
            let mut alone = view.alone(size, &share.given(), NonFinite::Fail);
            assert_eq!(alone.is_err(), share.count == 0);
            for outcome in [&mut outcome, &mut alone].into_iter().flatten() {
                outcome.seconds = 0.0;
            }
            assert_eq!(outcome, alone, "{:?} {}", share.position, share.count);
        }
    }
    assert!(
        view.averages(size, &[] as &[Share<Independent>], NonFinite::Fail)
            .is_empty()
    );
}

/// The back wall of the Cornell box is cut off: five columns of nine see nothing else, above the blocks.
#[test]
fn nothing_is_seen_beyond_a_far_plane() {
    let View {
        scene,
        sensor,
        filter,
        paths,
    } = scenes::cornell_box();
    let from_the_ground = Projection::default();
    let far = FarPlane::new(&from_the_ground, 555.0).unwrap();
    let mut view = View {
        scene,
        sensor: Clipped::new(sensor, Some(far)),
        filter,
        paths,
    };
    let size = [9, 9];
    let row: Vec<_> = (0..9)
        .map(|x| Share {
            position: [x, 2],
            points: Rescrambled::new(4, x.into()).unwrap(),
            count: 256,
        })
        .collect();
    for reused_by in [1, 4] {
        view.paths = view.paths.reused_by(reused_by).unwrap();
        #[cfg(feature = "simd")]
        assert!(view.pixel([0; 2], size).packet().is_some());
        let means = view.averages(size, &row, NonFinite::Fail);
        for (share, mean) in row.iter().zip(means) {
            let (x, mean) = (share.position[0], mean.unwrap().mean);
            let alone = view.alone(size, &share.given(), NonFinite::Fail);
            assert!(reused_by > 1 || mean == alone.unwrap().mean);
            assert_eq!(mean == DVec3::ZERO, (2..7).contains(&x), "{x}: {mean}");
        }
    }
}

#[test]
fn finite_sets_are_taken_whole_where_paths_are_reused() {
    let mut view = scenes::cornell_box();
    view.paths = view.paths.reused_by(2).unwrap();
    let means = [5, 16].map(|count| {
        let share = |x| Share {
            position: [x, 3],
            points: Hammersley::new(16, 5).unwrap(),
            count,
        };
        let outcomes = view.averages([9, 5], &[share(3), share(4)], NonFinite::Fail);
        let means = outcomes.into_iter().map(Result::unwrap);
        means.map(|it| (it.mean, it.used)).collect::<Vec<_>>()
    });
    assert_eq!(means[0], means[1]);
    assert_eq!(means[0][0].1, 16);
}

#[test]
fn two_parts_are_as_they_are_alone() {
    let (view, size) = (scenes::cornell_box(), [9, 1]);
    let mut lit = scenes::cornell_box();
    // Such paths are followed one by one.
    lit.paths = lit.paths.hiding_lights();
    let shares: Vec<_> = (0..9_u32)
        .map(|x| Share {
            position: [x, 0],
            points: Rescrambled::new(4, x.into()).unwrap(),
            count: COUNTS[x as usize],
        })
        .collect();
    for view in [view, lit] {
        for share in &shares {
            for cut in [0, share.count / 2, share.count / 3, share.count] {
                let two = view.averages_in_two(size, &[*share], |_| cut, NonFinite::Fail);
                let parts = [(0, cut), (cut, share.count - cut)];
                for (mut outcome, (skip, count)) in two.into_iter().flatten().zip(parts) {
                    let points = Skipped::new(share.points, skip);
                    let part = Share {
                        position: share.position,
                        points,
                        count,
                    };
                    let mut alone = view.alone(size, &part.given(), NonFinite::Fail);
                    assert_eq!(alone.is_err(), count == 0);
                    for outcome in [&mut outcome, &mut alone].into_iter().flatten() {
                        outcome.seconds = 0.0;
                    }
                    assert_eq!(outcome, alone, "{} {cut}", share.count);
                }
            }
        }
        // Several are as one.
        let cut = |share: &Share<_>| share.count / 2;
        let means = |shares: &[_]| -> Vec<_> {
            let outcomes = view.averages_in_two(size, shares, cut, NonFinite::Fail);
            let means = outcomes.into_iter().flatten();
            means
                .map(|outcome| outcome.ok().map(|estimate| estimate.mean))
                .collect()
        };
        let singly: Vec<_> = shares.iter().flat_map(|&share| means(&[share])).collect();
        assert_eq!((means(&shares), singly.len()), (singly, 18));
    }
}

#[test]
fn blue_noise_in_parts_is_that_of_the_whole() {
    let (view, size) = (scenes::cornell_box(), [4, 1]);
    for count in [64, 512] {
        let image = BlueNoise::new(count, 3).unwrap();
        let share = |x| Share {
            position: [x, 0],
            points: image.pixel([x, 0]),
            count,
        };
        let shares = [0, 1, 2, 3].map(share);
        let whole = view.averages(size, &shares, NonFinite::Fail);
        let halves = view.averages_in_two(size, &shares, |_| count / 2, NonFinite::Fail);
        for ((share, whole), halves) in shares.iter().zip(whole).zip(halves) {
            let halves = halves.map(|half| half.unwrap().mean);
            let mean = (halves[0] + halves[1]) / 2.0;
            assert!((mean - whole.unwrap().mean).length() < 1e-12);
            // One after the other, as passes take them.
            for (skip, half) in [0, count / 2].into_iter().zip(halves) {
                let part = Share {
                    position: share.position,
                    points: Skipped::new(&share.points, skip),
                    count: count / 2,
                };
                let alone = view.averages(size, &[part], NonFinite::Fail).remove(0);
                assert!((alone.unwrap().mean - half).length() < 1e-12);
            }
        }
    }
}

/// Sees nothing of the column 2, and cannot say so; in the column 4 it is too bright for squares.
struct Faulty;

impl Filter for Faulty {
    fn sample(&self, position: [u32; 2], size: [u32; 2], u: [f64; 2]) -> Filtered {
        let weight = match position[0] {
            2 if u[0] < 0.25 => f32::NAN,
            4 => 1e38,
            _ => 1.0,
        };
        Filtered {
            weight,
            ..BoxFilter.sample(position, size, u)
        }
    }
}

#[test]
fn what_plain_arithmetic_does_not_do_is_as_it_is_alone() {
    let size = [6, 1];
    let View {
        scene,
        sensor,
        paths,
        ..
    } = scenes::cornell_box();
    let mut view = View {
        scene,
        sensor,
        filter: Faulty,
        paths,
    };
    let shares: Vec<_> = (0..6)
        .map(|x| Share {
            position: [x, 0],
            points: Rescrambled::new(4, u64::from(x)).unwrap(),
            count: 64,
        })
        .collect();
    for hides in [false, true] {
        if hides {
            // Such paths are followed one by one.
            view.paths = view.paths.hiding_lights();
        }
        for rule in [NonFinite::Reject, NonFinite::Fail] {
            for (share, outcome) in shares.iter().zip(view.averages(size, &shares, rule)) {
                let alone = view.alone(size, &share.given(), rule);
                match (outcome, alone) {
                    (Ok(outcome), Ok(alone)) => {
                        let expected = if share.position[0] == 2 { 16 } else { 0 };
                        assert_eq!(outcome.rejected, expected);
                        assert_eq!(outcome.mean, alone.mean);
                    }
                    (outcome, alone) => {
                        assert_eq!(share.position[0], 2);
                        let reasons =
                            [outcome, alone].map(|it| format!("{:?}", it.unwrap_err().reason));
                        assert_eq!(reasons[0], reasons[1]);
                    }
                }
            }
        }
    }
}
