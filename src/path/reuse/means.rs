//! The means of pixels whose paths are reused.

use core::ops::Range;

use glam::{DVec3, Vec3};

use super::{SPREAD, Traces, WIDTH};
use crate::block::Block;
use crate::estimators::whole;
use crate::hash::hash;
use crate::path::pixels::Given;
use crate::points::PointSet;
use crate::tallied::{Tallied, Tallies, finish};
use crate::tally::{Open, Tally};
use crate::{Average, Error, NonFinite, Outcome, Value};

/// Some points of a share, whose paths are kept in slots from `slot` on.
pub(in crate::path) struct Run<'a> {
    pub(in crate::path) share: &'a Given<'a>,
    pub(in crate::path) indices: Range<u64>,
    pub(in crate::path) slot: usize,
    /// Which of all shares.
    number: usize,
}

#[cfg(feature = "simd")]
impl<'a> Run<'a> {
    /// The first points of a share, of which nothing is kept.
    pub(in crate::path) fn of(share: &'a Given<'a>, count: usize) -> Self {
        Self {
            share,
            indices: 0..count as u64,
            slot: 0,
            number: 0,
        }
    }

    pub(in crate::path) fn length(&self) -> usize {
        length(&self.indices)
    }
}

fn length(indices: &Range<u64>) -> usize {
    usize::try_from(indices.end - indices.start).expect("a run is short")
}

/// Pixels that go together, and the slots of their paths: a pixel after the other, each with room for as many rounds.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Group {
    pub(in crate::path) pixels: usize,
    pub(in crate::path) rounds: usize,
    pub(in crate::path) slot: usize,
}

impl Group {
    /// Where the path of a pixel in a round is kept.
    pub(in crate::path) fn slot(&self, pixel: usize, round: usize) -> usize {
        self.slot + pixel * self.rounds + round
    }
}

/// From how many paths on those at hand are followed: enough for few lanes to be idle when they run out, few enough for their
/// coordinates to stay in a cache.
pub(in crate::path) const TOGETHER: usize = 512;

/// A share among those that may go together.
struct Member<'a> {
    share: &'a Given<'a>,
    number: usize,
    count: u64,
    /// Where it is in a random order of the pixels.
    place: u64,
}

impl<'a> Member<'a> {
    fn new((number, share): (usize, &'a Given<'a>)) -> Self {
        let [x, y] = share.position;
        Self {
            share,
            number,
            count: whole(&share.points, share.count),
            place: hash(y.into(), x.into()),
        }
    }
}

/// Paths to be followed together.
struct Batch<'a> {
    runs: Vec<Run<'a>>,
    groups: Vec<Group>,
    slots: usize,
    paths: usize,
}

impl<'a> Batch<'a> {
    const EMPTY: Self = Self {
        runs: Vec::new(),
        groups: Vec::new(),
        slots: 0,
        paths: 0,
    };

    /// Adds the rounds of a group of shares.
    fn add(&mut self, members: &[Member<'a>], rounds: Range<u64>) {
        let room = length(&rounds).next_multiple_of(WIDTH);
        let group = Group {
            pixels: members.len(),
            rounds: room,
            slot: self.slots,
        };
        for (pixel, member) in members.iter().enumerate() {
            let indices = rounds.start.min(member.count)..rounds.end.min(member.count);
            self.paths += length(&indices);
            self.runs.push(Run {
                share: member.share,
                indices,
                slot: group.slot(pixel, 0),
                number: member.number,
            });
        }
        self.slots += members.len() * room;
        self.groups.push(group);
    }
}

/// Follows the paths of some runs and shares the light of some groups.
type Follow<'a> = &'a dyn Fn(&[Run<'_>], &[Group], &mut Traces);

/// What the path of a pixel at a point reads.
type Coordinates<'a> = &'a dyn Fn(&Given<'_>, u64) -> Vec<f64>;

/// How the pixels of a picture are followed.
pub(in crate::path) struct Pixels<'a> {
    /// How many use a path.
    pub(in crate::path) reused_by: u32,
    pub(in crate::path) rule: NonFinite,
    pub(in crate::path) follow: Follow<'a>,
    pub(in crate::path) coordinates: Coordinates<'a>,
}

impl Pixels<'_> {
    /// What the first points of each share give, as many as its cut says, and the others. Those go together that follow one another, in one row and its
    /// columns, and have the most points in common, drawn at random: pixels beside one another that err alike would be seen as stripes.
    pub(in crate::path) fn parts(
        &self,
        shares: &[Given<'_>],
        cuts: impl Iterator<Item = u64>,
    ) -> Vec<[Part; 2]> {
        let mut parts: Vec<_> = cuts.map(|cut| [0, cut].map(Part::new)).collect();
        let mut traces = Traces::default();
        let mut batch = Batch::EMPTY;
        let mut number = 0;
        let pixels = self.reused_by as usize;
        let columns = self.reused_by * SPREAD;
        // As many at once as keep the lanes busy.
        let at_once = TOGETHER.div_ceil(pixels).next_multiple_of(WIDTH) as u64;
        let cell = |share: &Given<'_>| [share.position[0] / columns, share.position[1]];
        for cell in shares.chunk_by(|a, b| cell(a) == cell(b)) {
            let mut members: Vec<_> = (number..).zip(cell).map(Member::new).collect();
            number += cell.len();
            members.sort_by_key(|member| (member.count, member.place));
            for group in members.chunks(pixels) {
                let most = group.last().map_or(0, |member| member.count);
                let mut done = 0;
                while done < most {
                    let rounds = done..most.min(done + at_once);
                    done = rounds.end;
                    batch.add(group, rounds);
                    if batch.paths >= TOGETHER {
                        self.run(&mut batch, &mut traces, &mut parts);
                    }
                }
            }
        }
        self.run(&mut batch, &mut traces, &mut parts);
        parts
    }

    fn run(&self, batch: &mut Batch<'_>, traces: &mut Traces, parts: &mut [[Part; 2]]) {
        traces.clear(batch.slots);
        (self.follow)(&batch.runs, &batch.groups, traces);
        let mut values = Vec::new();
        for run in &batch.runs {
            let Range { start, end } = run.indices;
            let [first, others] = &mut parts[run.number];
            let cut = others.from.clamp(start, end);
            for (part, indices) in [(first, start..cut), (others, cut..end)] {
                let slots =
                    [indices.start, indices.end].map(|end| run.slot + length(&(start..end)));
                values.clear();
                values.extend(traces.values(slots[0]..slots[1]));
                let coordinates = |index| (self.coordinates)(run.share, index);
                part.add(indices.start, &values, self.rule, coordinates);
            }
        }
        *batch = Batch::EMPTY;
    }
}

/// What some points of a share have given.
#[derive(Debug, PartialEq)]
pub(in crate::path) struct Part {
    /// The first of them.
    from: u64,
    tally: Tally<DVec3>,
    stopped: Result<(), Error>,
}

impl Part {
    fn new(from: u64) -> Self {
        Self {
            from,
            tally: Tally::EMPTY,
            stopped: Ok(()),
        }
    }

    /// Adds the values at the points from `index` on, those after all others.
    fn add(
        &mut self,
        index: u64,
        values: &[Vec3],
        rule: NonFinite,
        coordinates: impl Fn(u64) -> Vec<f64>,
    ) {
        if values.is_empty() || self.stopped.is_err() {
            return;
        }
        let mut block = Block::EMPTY;
        block.extend(values, Value::widen);
        if let Some(piece) = block.piece() {
            return self.tally.close(piece);
        }
        let mut open = Open::EMPTY;
        for (index, value) in (index..).zip(values) {
            if rule == NonFinite::Fail && !value.is_finite() {
                self.stopped = Err(Error::NonFinite {
                    index: index - self.from,
                    replicate: 0,
                    coordinates: coordinates(index),
                    value: value.to_array().map(f64::from).to_vec(),
                });
                break;
            }
            open.push(value.widen(), 0);
        }
        self.tally.close(open.piece());
    }

    /// What `average` gives, of which the points are.
    pub(in crate::path) fn outcome<P: PointSet>(self, average: &Average<P>) -> Outcome<Vec3> {
        average.sources()?;
        finish(average, &Tallies::of(self.tally), self.stopped, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;
    use crate::Stop;
    use crate::hash::unit_f32;
    use crate::points::Independent;

    fn share([x, y]: [u32; 2], count: u64) -> Given<'static> {
        Given {
            position: [x, y],
            points: const { &Independent::new(0) },
            count,
        }
    }

    /// Paths whose values are those of their pixel and index.
    fn parts(
        shares: &[Given<'_>],
        rule: NonFinite,
        cut: &dyn Fn(&Given<'_>) -> u64,
        value: impl Fn(u32, u64) -> Vec3,
    ) -> Vec<[Part; 2]> {
        let follow: Follow<'_> = &|runs, groups, traces| {
            let ends = |&group: &Group| (0..group.pixels).map(move |pixel| group.slot(pixel, 0));
            let expected: Vec<_> = groups.iter().flat_map(ends).collect();
            let slots: Vec<_> = runs.iter().map(|run| run.slot).collect();
            assert_eq!(slots, expected);
            for run in runs {
                for (slot, index) in (run.slot..).zip(run.indices.clone()) {
                    let value = value(run.share.position[0], index);
                    traces.end(slot, value.into(), 1.0);
                }
            }
            let mut sum = traces.slots.len() * WIDTH;
            for group in groups {
                assert!(group.rounds.is_multiple_of(WIDTH));
                sum -= group.pixels * group.rounds;
                traces.share(group, &|_| panic!("nothing is known of any point"));
            }
            assert_eq!(sum, 0, "slots of no group");
        };
        let pixels = Pixels {
            reused_by: 4,
            rule,
            follow,
            coordinates: &|share, index| vec![share.position[0].into(), index as f64],
        };
        pixels.parts(shares, shares.iter().map(cut))
    }

    fn random(x: u32, index: u64) -> Vec3 {
        Vec3::splat(unit_f32(hash(x.into(), index)))
    }

    #[test]
    fn each_pixel_has_its_values() {
        let counts = [0, 1, 16, 17, 127, 128, 129, 1000, 5];
        let shares: Vec<_> = (2..).zip(counts).map(|(x, n)| share([x, 3], n)).collect();
        for cut in [0, 1, 16, 130, 2000] {
            let cut = |share: &Given<'_>| share.count.min(cut);
            let found = parts(&shares, NonFinite::Fail, &cut, random);
            for (share, parts) in shares.iter().zip(found) {
                let ranges = [0..cut(share), cut(share)..share.count];
                for (part, range) in parts.into_iter().zip(ranges) {
                    let average = Average::new(share.points, range.end - range.start);
                    let outcome = part.outcome(&average);
                    if range.is_empty() {
                        assert!(matches!(outcome.unwrap_err().reason, Error::Refused { .. }));
                        continue;
                    }
                    let estimate = outcome.unwrap();
                    let sum: f64 = (range.clone())
                        .map(|index| f64::from(random(share.position[0], index).x))
                        .sum();
                    let count = range.end - range.start;
                    assert_eq!((estimate.used, estimate.requested), (count, count));
                    assert!((estimate.mean.x - sum / count as f64).abs() < 1e-14);
                }
            }
        }
    }

    /// The columns of the pixels of each group.
    fn groups(shares: &[Given<'_>]) -> Vec<Vec<u32>> {
        let found = RefCell::new(Vec::new());
        let pixels = Pixels {
            reused_by: 8,
            rule: NonFinite::Fail,
            follow: &|mut runs, groups, _| {
                for group in groups {
                    let (own, others) = runs.split_at(group.pixels);
                    runs = others;
                    let columns = own.iter().map(|run| run.share.position[0]);
                    found.borrow_mut().push(columns.collect());
                }
            },
            coordinates: &|_, _| Vec::new(),
        };
        let _ = pixels.parts(shares, shares.iter().map(|_| 0));
        found.into_inner()
    }

    #[test]
    fn pixels_of_some_columns_go_together() {
        let row = (5..70).map(|x| [x, 3]).chain((66..68).map(|x| [x, 4]));
        // More than there are, in one place.
        let shares: Vec<_> = (row.chain([[0, 0]; 20]))
            .map(|position| share(position, 2))
            .collect();
        let groups = groups(&shares);
        let sizes: Vec<_> = groups.iter().map(Vec::len).collect();
        // 27 columns below 32, 32 of them, and 6.
        assert_eq!(sizes, [8, 8, 8, 3, 8, 8, 8, 8, 6, 2, 8, 8, 4]);
        for (cell, columns) in [(0, 5..32), (1, 32..64), (2, 64..70)] {
            let mut found = [&groups[..4], &groups[4..8], &groups[8..9]][cell].concat();
            let beside = found
                .windows(2)
                .filter(|pair| pair[1] == pair[0] + 1)
                .count();
            assert!(found.len() < 8 || beside < found.len() / 4, "{found:?}");
            found.sort_unstable();
            assert_eq!(found, columns.collect::<Vec<_>>());
        }
    }

    #[test]
    fn pixels_of_as_many_points_go_together() {
        let counts = [4, 64].into_iter().cycle();
        let shares: Vec<_> = (0..32).zip(counts).map(|(x, n)| share([x, 0], n)).collect();
        let groups = groups(&shares);
        assert_eq!(groups.len(), 4);
        for (number, group) in groups.iter().enumerate() {
            assert!(
                group.iter().all(|x| x % 2 == u32::from(number > 1)),
                "{group:?}"
            );
        }
    }

    #[test]
    fn values_that_are_not_finite_are_named_or_counted() {
        let shares = [share([0, 0], 200), share([1, 0], 200)];
        let value = |x, index| match (x, index) {
            (1, 130) => Vec3::new(1.0, f32::NAN, 2.0),
            _ => random(x, index),
        };
        for (cut, relative) in [(0, 130), (100, 30)] {
            let found = parts(&shares, NonFinite::Fail, &|_| cut, value);
            let [[_, good], [first, bad]] = <[_; 2]>::try_from(found).unwrap();
            assert_eq!(good.stopped, Ok(()));
            assert_eq!(first.stopped, Ok(()));
            let average = Average::new(shares[1].points, 200 - cut);
            let incomplete = bad.outcome(&average).unwrap_err();
            let Error::NonFinite {
                index,
                replicate,
                coordinates,
                value,
            } = incomplete.reason
            else {
                panic!("{}", incomplete.reason);
            };
            assert_eq!((index, replicate), (relative, 0));
            assert_eq!(coordinates, [1.0, 130.0]);
            assert!(value[0] == 1.0 && value[1].is_nan() && value[2] == 2.0);
            let so_far = incomplete.so_far.unwrap();
            assert_eq!((so_far.used, so_far.stop), (relative, Stop::Unfinished));
        }
        let found = parts(&shares, NonFinite::Reject, &|_| 0, value);
        let [_, [_, bad]] = <[_; 2]>::try_from(found).unwrap();
        let estimate = bad.outcome(&Average::new(shares[1].points, 200)).unwrap();
        assert_eq!((estimate.used, estimate.rejected), (200, 1));
        let sum: f64 = (0..200)
            .filter(|&k| k != 130)
            .map(|k| f64::from(random(1, k).x))
            .sum();
        assert!((estimate.mean.x - sum / 199.0).abs() < 1e-14);
        let nothing = parts(&shares, NonFinite::Reject, &|_| 0, |_, _| Vec3::NAN);
        for ([_, all], share) in nothing.into_iter().zip(&shares) {
            let reason = all
                .outcome(&Average::new(share.points, 200))
                .unwrap_err()
                .reason;
            assert_eq!(reason, Error::NothingLeft { rejected: 200 });
        }
    }
}
