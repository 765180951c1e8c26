//! From stratum to stratum, and what is evaluated on the way.

use core::ops::Range;
use std::borrow::Cow;

use super::{Stratum, Visited};
use crate::points::{Independent, PointSet, permuted};
use crate::room::with_room;
use crate::{Cursor, Error, NonFinite, Value, reduce};

/// So many points in each stratum, one stratum after the other, in parts that can be evaluated side by side.
pub(crate) struct Walk<'a> {
    order: Order,
    /// The numbers of points up to and with each visit.
    ends: Cow<'a, [u64]>,
    /// Points in a part at most, a power of two.
    longest: u64,
}

/// Which strata are visited, in their order.
enum Order {
    /// The first part is short, and the next ones are longer, so that what is quick is done in few parts and what is slow can be
    /// stopped.
    Shuffled(Vec<u32>),
    /// All by their numbers. The last part is short, and those before are longer, so that nobody waits long for who has the last one.
    InTurn,
}

/// Points in the shortest part.
const SHORTEST: u64 = 256;

impl<'a> Walk<'a> {
    /// `count(k)` points in each of so many `strata`; no part is longer than `longest`, rounded up to a power of two.
    ///
    /// The order of the strata is random, one that `key` selects. So those that were visited first are a random sample of all,
    /// and a walk that has to stop early has an estimate to give.
    pub(crate) fn shuffled(
        strata: usize,
        count: impl Fn(usize) -> u64 + Sync,
        key: u64,
        longest: u64,
    ) -> Self {
        let blocks = permuted(strata as u64, key, |order| {
            let counts = order.iter().map(|&stratum| count(stratum as usize));
            let mut sums = Vec::with_capacity(order.len());
            sums.extend(counts.scan(0, |sum, count| {
                *sum += count;
                Some(*sum)
            }));
            sums
        });
        let (mut order, mut ends) = (Vec::with_capacity(strata), Vec::with_capacity(strata));
        for (part, sums) in blocks {
            let before = ends.last().copied().unwrap_or(0);
            order.extend(part);
            ends.extend(sums.into_iter().map(|sum| before + sum));
        }
        Self::new(ends.into(), Order::Shuffled(order), longest)
    }

    /// The same with strata in the order of their numbers: less to do where nothing is said before the walk is complete. `ends` are the
    /// numbers of points up to and with each stratum.
    pub(crate) fn in_turn(ends: &'a [u64], longest: u64) -> Self {
        Self::new(ends.into(), Order::InTurn, longest)
    }

    fn new(ends: Cow<'a, [u64]>, order: Order, longest: u64) -> Self {
        Self {
            order,
            ends,
            longest: longest.next_power_of_two().max(SHORTEST),
        }
    }

    /// The stratum of a visit.
    #[inline]
    fn stratum(&self, visit: usize) -> usize {
        match &self.order {
            Order::Shuffled(order) => order[visit] as usize,
            Order::InTurn => visit,
        }
    }

    /// How many points there are.
    pub(crate) fn points(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// The first point of a part, or the end of the last.
    fn first_of(&self, part: u64) -> u64 {
        match self.order {
            Order::Shuffled(_) => self.growing(part),
            Order::InTurn => {
                let left = self.number().saturating_sub(part);
                self.points() - self.growing(left)
            }
        }
    }

    /// The first point of a part, if parts become longer.
    fn growing(&self, part: u64) -> u64 {
        let first = match part {
            0 => 0,
            part if part <= self.doublings() => SHORTEST << (part - 1),
            part => self.longest.saturating_mul(part - self.doublings()),
        };
        first.min(self.points())
    }

    fn doublings(&self) -> u64 {
        (self.longest / SHORTEST).ilog2().into()
    }

    /// How many parts there are.
    fn number(&self) -> u64 {
        let count = self.points();
        if count > self.longest {
            self.doublings() + count.div_ceil(self.longest)
        } else {
            u64::from(count > 0)
                + u64::from(count.div_ceil(SHORTEST).max(1).next_power_of_two().ilog2())
        }
    }

    /// How many parts are needed for `count` points.
    fn parts(&self, count: u64) -> u64 {
        let count = count.min(self.points());
        let (mut enough, mut low) = (self.number(), 0);
        while low < enough {
            let middle = low.midpoint(enough);
            if self.first_of(middle) >= count {
                enough = middle;
            } else {
                low = middle + 1;
            }
        }
        enough
    }

    /// Whether all points are in `visited`.
    pub(crate) fn is_complete<V>(&self, visited: &Visited<V>) -> bool {
        visited.parts >= self.parts(u64::MAX)
    }

    /// Goes on until `count` points of this walk, or a few more, are in `visited`, or all. `job` evaluates a range of them;
    /// what it gives besides goes to `take`.
    pub(crate) fn go_on<V: Value, T: Send>(
        &self,
        visited: &mut Visited<V>,
        count: u64,
        job: impl Fn(Range<u64>) -> (Part<V>, T) + Sync,
        mut take: impl FnMut(T) + Send,
    ) -> Result<(), Error> {
        if matches!(self.order, Order::Shuffled(_)) {
            visited.strata.resize(self.ends.len(), Stratum::EMPTY);
        } else {
            let more = self.ends.len().saturating_sub(visited.strata.len());
            visited.strata.reserve_exact(more);
        }
        let begun = visited.parts;
        let jobs = self.parts(count).saturating_sub(begun);
        reduce::in_order(
            jobs,
            |part| job(self.first_of(begun + part)..self.first_of(begun + part + 1)),
            |(part, more)| {
                if let Some(offender) = part.offender {
                    if visited.before.is_none() {
                        visited.before = Some(Box::new(visited.clone()));
                        self.merge(visited, part.given);
                    }
                    return Err(*offender);
                }
                if let Some(before) = visited.before.take() {
                    *visited = *before;
                }
                self.merge(visited, part.given);
                take(more);
                visited.parts += 1;
                Ok(())
            },
        )?;
        if self.is_complete(visited) {
            // The last ones may have had no value.
            visited.strata.resize(self.ends.len(), Stratum::EMPTY);
        }
        Ok(())
    }

    fn merge<V: Value>(&self, visited: &mut Visited<V>, given: Given<V>) {
        for (visit, stratum) in (given.first..).zip(&given.strata) {
            let place = self.stratum(visit);
            if let Some(before) = visited.strata.get_mut(place) {
                before.merge(stratum);
            } else {
                // Of those that are visited in turn, the ones before that had no value may be missing.
                visited.strata.resize(place, Stratum::EMPTY);
                visited.strata.push(*stratum);
            }
        }
        for (visit, weight) in given.left_out {
            let stratum = self.stratum(visit);
            let least = visited.strata.len().max(stratum + 1);
            visited.strata.resize(least, Stratum::EMPTY);
            visited.left_out.entry(stratum).or_default().push(weight);
        }
    }

    /// Evaluates the points `range`.
    pub(crate) fn evaluate<T: Visitor>(
        &self,
        range: Range<u64>,
        rows: &Rows,
        policy: NonFinite,
        visitor: &mut T,
    ) -> Part<T::Value> {
        let first = self.ends.partition_point(|&end| end <= range.start);
        let last = self.ends.partition_point(|&end| end < range.end);
        let mut part = Part {
            given: Given {
                first,
                strata: Vec::with_capacity((last + 1).saturating_sub(first)),
                left_out: Vec::new(),
            },
            offender: None,
        };
        let mut values = vec![T::Value::ZERO; rows.number];
        let mut runs = Vec::with_capacity(rows.number);
        with_room(rows.number * rows.stride(), |room| {
            let (mut index, mut visit) = (range.start, first);
            while index < range.end && part.offender.is_none() {
                // Batch by batch: coordinates, then values, then what they give in each stratum.
                let left = range.end - index;
                let number =
                    usize::try_from(left).map_or(rows.number, |left| left.min(rows.number));
                let room = &mut room[..number * rows.stride()];
                let values = &mut values[..number];
                rows.fill(index, room);
                visit = self.runs(visit, index, number, &mut runs);
                visitor.place(&runs, room);
                rows.evaluate(index, room, values, visitor);
                visitor.leave(values);
                for run in &runs {
                    let values = &mut values[run.points.clone()];
                    if let Some(given) = Stratum::sums(values) {
                        part.given.add(run.visit, &given);
                        continue;
                    }
                    let first = index + run.points.start as u64;
                    let kept = part.sort_out(first, run.visit, values, policy, |place| {
                        let at = first + place as u64;
                        let place = run.points.start + place;
                        let row = rows.row(room, place);
                        visitor.look(place, Cursor::with_prefix(&rows.points, at, row))
                    });
                    if kept > 0 {
                        part.given.add(run.visit, &Stratum::of(&values[..kept]));
                    }
                    if part.offender.is_some() {
                        break;
                    }
                }
                index += number as u64;
            }
        });
        part
    }

    /// Finds the runs of the `number` points from `index` on, with their visits from `visit` on. Which visit the point after them
    /// is in, or was the last.
    fn runs(&self, mut visit: usize, index: u64, number: usize, runs: &mut Vec<Run>) -> usize {
        runs.clear();
        let mut start = 0;
        while start < number {
            while self.ends[visit] <= index + start as u64 {
                visit += 1;
            }
            let end = self.ends[visit] - index;
            let end = usize::try_from(end).map_or(number, |end| end.min(number));
            runs.push(Run {
                visit,
                stratum: self.stratum(visit),
                points: start..end,
            });
            start = end;
        }
        visit
    }
}

/// Points of a batch that are in one stratum, one after the other.
pub(crate) struct Run {
    pub(crate) visit: usize,
    pub(crate) stratum: usize,
    pub(crate) points: Range<usize>,
}

/// How coordinates are computed ahead.
pub(crate) struct Rows {
    pub(crate) points: Independent,
    /// The first coordinates of each point.
    pub(crate) width: u32,
    /// Of so many points at once.
    pub(crate) number: usize,
}

impl Rows {
    /// How many numbers a row takes: points without coordinates have rows all the same, if of no meaning.
    #[inline]
    fn stride(&self) -> usize {
        (self.width as usize).max(1)
    }

    /// The coordinates of one point.
    fn row<'a>(&self, room: &'a [f64], place: usize) -> &'a [f64] {
        &room[place * self.stride()..][..self.width as usize]
    }

    /// Writes the coordinates of the points from `first` on.
    fn fill(&self, first: u64, room: &mut [f64]) {
        if self.width > 0 {
            self.points.fill(first, 0..self.width, room);
        }
    }

    /// The values at the points from `first` on, whose coordinates are in `room`. A function of its own, so that the machine's
    /// registers are for this loop.
    #[inline(never)]
    fn evaluate<T: Visitor>(
        &self,
        first: u64,
        room: &[f64],
        values: &mut [T::Value],
        visitor: &mut T,
    ) {
        let rows = room.chunks_exact(self.stride());
        for (place, (value, row)) in values.iter_mut().zip(rows).enumerate() {
            let row = &row[..self.width as usize];
            let u = Cursor::with_row(&self.points, first + place as u64, row, self.width);
            *value = visitor.value(place, u);
        }
    }
}

/// Evaluates an integrand in one stratum after the other.
pub(crate) trait Visitor {
    type Value: Value;

    /// Moves points, a row of coordinates each, from the unit cube into the strata of `runs`.
    fn place(&mut self, runs: &[Run], rows: &mut [f64]);

    /// The value at the point `place`.
    fn value(&mut self, place: usize, u: Cursor<'_, Independent>) -> Self::Value;

    /// The values of all of them are known: multiplies each by what its point weighs.
    fn leave(&mut self, _values: &mut [Self::Value]) {}

    /// The same point once more.
    fn look(&mut self, place: usize, u: Cursor<'_, Independent>) -> Look<Self::Value>;
}

/// A point, looked at closely.
pub(crate) struct Look<V> {
    /// The coordinates of its image.
    pub(crate) coordinates: Vec<f64>,
    /// The value there.
    pub(crate) value: V,
    pub(crate) weight: f64,
}

/// What a part of a walk has given, and the value that ended it if one did.
pub(crate) struct Part<V> {
    given: Given<V>,
    offender: Option<Box<Error>>,
}

/// What a part of a walk has given.
struct Given<V> {
    /// The visit to the first of its strata.
    first: usize,
    strata: Vec<Stratum<V>>,
    /// Visits and weights of the points whose values were left out.
    left_out: Vec<(usize, f64)>,
}

impl<V: Value> Given<V> {
    /// Adds to what the stratum of `visit`, the last one or a later one, has given.
    #[inline]
    fn add(&mut self, visit: usize, more: &Stratum<V>) {
        let place = visit - self.first;
        if place >= self.strata.len() {
            self.strata.resize(place, Stratum::EMPTY);
            self.strata.push(*more);
        } else {
            self.strata[place].merge(more);
        }
    }
}

impl<V: Value> Part<V> {
    /// Moves those of the `values` of one stratum, from the point `first` on, that are finite to the front. How many they are.
    #[cold]
    fn sort_out(
        &mut self,
        first: u64,
        visit: usize,
        values: &mut [V],
        policy: NonFinite,
        mut look: impl FnMut(usize) -> Look<V>,
    ) -> usize {
        let mut kept = 0;
        for (place, index) in (0..values.len()).zip(first..) {
            if values[place].is_finite() {
                values[kept] = values[place];
                kept += 1;
                continue;
            }
            let look = look(place);
            if policy == NonFinite::Fail {
                let Look {
                    coordinates, value, ..
                } = look;
                self.offender = Some(Box::new(Error::of_value(index, coordinates, value)));
                break;
            }
            self.given.left_out.push((visit, look.weight));
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_one_another_and_end_where_they_are_asked_to() {
        let counts = [70_000, 2, 3];
        for longest in [256, 1024, 16_384] {
            let walks = [
                Walk::shuffled(3, |stratum| counts[stratum], 7, longest),
                Walk::in_turn(&[70_000, 70_002, 70_005], longest),
            ];
            let [growing, shrinking] = walks.each_ref().map(|walk| {
                let parts = walk.number();
                assert_eq!((walk.first_of(0), walk.first_of(parts)), (0, 70_005));
                assert_eq!((walk.parts(0), walk.parts(u64::MAX)), (0, parts));
                let lengths = (0..parts).map(|part| {
                    let (first, end) = (walk.first_of(part), walk.first_of(part + 1));
                    assert!(first < end && end - first <= longest, "{first} to {end}");
                    assert_eq!(walk.parts(first), part);
                    assert_eq!(walk.parts(first + 1), part + 1);
                    end - first
                });
                lengths.collect::<Vec<_>>()
            });
            assert!(growing.iter().eq(shrinking.iter().rev()));
            assert_eq!(growing[0], 256);
        }
        assert_eq!(Walk::shuffled(0, |_| 0, 0, 1).parts(u64::MAX), 0);
        assert_eq!(Walk::in_turn(&[3], 1).parts(1), 1);
    }

    #[test]
    fn every_stratum_is_visited_once_with_its_points() {
        // In several blocks.
        let counts: Vec<u64> = (2..3000).collect();
        let walk = Walk::shuffled(counts.len(), |stratum| counts[stratum], 3, 256);
        let mut seen: Vec<_> = (0..counts.len()).map(|visit| walk.stratum(visit)).collect();
        for (visit, &stratum) in seen.iter().enumerate() {
            let before = visit.checked_sub(1).map_or(0, |visit| walk.ends[visit]);
            assert_eq!(walk.ends[visit] - before, counts[stratum]);
        }
        assert!(!seen.is_sorted());
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..counts.len()));
    }
}
