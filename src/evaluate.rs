//! The loop over points: one block at a time, fast if its values are ordinary, carefully if not.

use core::ops::{ControlFlow, Range};

use crate::block::Block;
use crate::points::PointSet;
use crate::recorder::Recorder;
use crate::room::with_room;
use crate::tally::{Open, Piece, Tally};
use crate::{Cursor, Error, Integrand, NonFinite, Sampler, Value, reduce};

/// Points per block. A block is the unit of parallel work and of seeding; its length is a constant, so
/// that the sums do not depend on the machine.
pub(crate) const BLOCK: u64 = 1024;

/// Where the points of an estimate come from.
pub(crate) trait Source: Sync {
    /// Hands the points of `indices`, which lie in one block, to `visit` in order.
    ///
    /// About `dimensions` coordinates of each will be read; `drawn` were read by the points of the block
    /// before these.
    fn points(&self, indices: Range<u64>, drawn: u64, dimensions: u32, visit: &mut impl Visit);
}

/// What is done at each point.
pub(crate) trait Visit {
    /// At the points `indices`, each of which begins in the stream `u` where the one before it ended; `begin` is told when.
    fn stream<S: Sampler>(&mut self, indices: Range<u64>, u: &mut S, begin: impl Fn(&mut S));

    /// At the points `indices`, of which `at` gives any part in order. Breaks off if no others are wanted.
    fn points<S: Sampler, P: Iterator<Item = S>>(
        &mut self,
        indices: Range<u64>,
        at: impl Fn(Range<u64>) -> P,
    ) -> ControlFlow<()>;
}

/// Coordinates computed ahead per call of `fill`: 32 KiB, which the first-level cache holds.
const AHEAD: usize = 4096;

impl<P: PointSet> Source for P {
    fn points(&self, indices: Range<u64>, _: u64, dimensions: u32, visit: &mut impl Visit) {
        let dimensions = dimensions.min(self.dimensions());
        let width = dimensions as usize;
        if width == 0 || width > AHEAD {
            let _ = visit.points(indices, |part| part.map(|index| self.point(index)));
            return;
        }
        // A power of two: nets fill such blocks fastest.
        let most = 1 << (AHEAD / width).ilog2();
        with_room(most * width, |room| {
            let (mut index, end) = (indices.start, indices.end);
            while index < end {
                let rows = usize::try_from(end - index).map_or(most, |left| left.min(most));
                let ahead = &mut room[..rows * width];
                self.fill(index, 0..dimensions, ahead);
                let (first, ahead) = (index, &*ahead);
                let at = move |part: Range<u64>| {
                    #[expect(clippy::cast_possible_truncation, reason = "below the number of rows")]
                    let row = (part.start - first) as usize;
                    let rows = ahead[row * width..].chunks_exact(width).zip(part);
                    rows.map(move |(row, index)| Cursor::with_row(self, index, row, dimensions))
                };
                if visit.points(first..first + rows as u64, at).is_break() {
                    break;
                }
                index += rows as u64;
            }
        });
    }
}

/// What becomes of a last block that is not complete.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tail {
    /// It stays open, to be gone on with.
    Open,
    /// It is closed: nothing will follow.
    Closed,
}

/// Takes every source from where its tally is to the number of points in `counts`.
///
/// Points that were evaluated before are not evaluated again, and the tallies are to the bit those of an
/// evaluation at once. A value that is not finite stops it, unless such values are to be rejected; the
/// tallies then hold some of the points, all before the offending one of its source among them.
pub(crate) fn evaluate<I: Integrand, S: Source>(
    sources: &[S],
    tallies: &mut [Tally<Wide<I>>],
    counts: &[u64],
    tail: Tail,
    integrand: &I,
    policy: NonFinite,
) -> Result<(), Error> {
    spread(tallies, counts, &|source, indices, open| {
        block(&sources[source], indices, open, tail, integrand, policy)
    })
}

/// Evaluates one block, or a part of it, of a source: its points `indices`, after those of the open block.
type Evaluate<'a, V> = dyn Fn(usize, Range<u64>, Option<Open<V>>) -> Part<V> + Sync + 'a;

/// Spreads the blocks over the threads and takes their results in order. It is compiled once for a type of values, not for
/// every integrand.
fn spread<V: Value>(
    tallies: &mut [Tally<V>],
    counts: &[u64],
    block: &Evaluate<'_, V>,
) -> Result<(), Error> {
    // The jobs of a source follow one another; `ends` are the numbers of jobs up to and with it.
    let mut ends = Vec::with_capacity(tallies.len());
    let mut jobs = 0;
    for (tally, &count) in tallies.iter().zip(counts) {
        let used = tally.used();
        if count > used {
            jobs += count.div_ceil(BLOCK) - used / BLOCK;
        }
        ends.push(jobs);
    }
    let begun: Vec<_> = tallies
        .iter()
        .map(|tally| (tally.used(), tally.open))
        .collect();
    let mut taken = 0;
    let mut source = 0;
    reduce::in_order(
        jobs,
        |job| {
            let source = ends.partition_point(|&end| end <= job);
            let before = if source == 0 { 0 } else { ends[source - 1] };
            let (used, open) = begun[source];
            let first = (used / BLOCK + job - before) * BLOCK;
            let indices = first.max(used)..counts[source].min(first + BLOCK);
            let open = open.filter(|_| job == before);
            block(source, indices, open)
        },
        |part| {
            while ends[source] <= taken {
                source += 1;
            }
            taken += 1;
            match part {
                Part::Closed(piece) => tallies[source].close(piece),
                Part::Open(open) => tallies[source].open = Some(open),
                Part::Stopped(open, offender) => {
                    tallies[source].open = (open.used() > 0).then_some(open);
                    return Err(Error::NonFinite {
                        index: offender.index,
                        replicate: source as u64,
                        coordinates: offender.coordinates,
                        value: offender.value,
                    });
                }
            }
            Ok(())
        },
    )
}

pub(crate) type Wide<I> = <<I as Integrand>::Value as Value>::Wide;

/// What the evaluation of a block, or of a part of it, has given.
enum Part<V> {
    Closed(Piece<V>),
    Open(Open<V>),
    Stopped(Open<V>, Box<Offender>),
}

/// A point where the integrand was not finite.
struct Offender {
    index: u64,
    coordinates: Vec<f64>,
    value: Vec<f64>,
}

fn block<I: Integrand, S: Source>(
    source: &S,
    indices: Range<u64>,
    open: Option<Open<Wide<I>>>,
    tail: Tail,
    integrand: &I,
    policy: NonFinite,
) -> Part<Wide<I>> {
    let complete = tail == Tail::Closed || indices.end.is_multiple_of(BLOCK);
    if complete && open.is_none() {
        let mut fast = Fast::new(integrand);
        source.points(indices.clone(), 0, integrand.dimensions(), &mut fast);
        if let Some(piece) = fast.block.piece() {
            return Part::Closed(piece);
        }
    }
    match careful(source, indices, open, integrand, policy) {
        (open, Some(offender)) => Part::Stopped(open, offender),
        (open, None) if complete => Part::Closed(open.piece()),
        (open, None) => Part::Open(open),
    }
}

/// Evaluates a block value by value: names what is not finite, sums what has no ordinary squares, and
/// keeps what it takes to go on.
#[cold]
fn careful<I: Integrand, S: Source>(
    source: &S,
    indices: Range<u64>,
    open: Option<Open<Wide<I>>>,
    integrand: &I,
    policy: NonFinite,
) -> (Open<Wide<I>>, Option<Box<Offender>>) {
    let mut careful = Careful {
        integrand,
        policy,
        open: open.unwrap_or(Open::EMPTY),
        coordinates: Vec::new(),
        offender: None,
    };
    let drawn = careful.open.drawn;
    source.points(indices, drawn, integrand.dimensions(), &mut careful);
    (careful.open, careful.offender)
}

struct Fast<'a, I: Integrand> {
    integrand: &'a I,
    block: Block<Wide<I>>,
    /// Room for values that are added to the block together: its sums are then kept in registers.
    values: Vec<I::Value>,
}

impl<'a, I: Integrand> Fast<'a, I> {
    /// As many values as are worth while, fewer large ones: their room is to stay in the first-level cache.
    const GROUP: usize = {
        let most = match size_of::<I::Value>() {
            0 => 64,
            size => 512_usize.div_ceil(size).next_multiple_of(2),
        };
        if most > I::AT_ONCE { most } else { I::AT_ONCE }
    };

    fn new(integrand: &'a I) -> Self {
        Self {
            integrand,
            block: Block::EMPTY,
            values: vec![I::Value::ZERO; Self::GROUP],
        }
    }

    /// Adds the first values of the room to the block. A function of its own, in which the lanes of the sums stay together.
    #[inline(never)]
    fn add(&mut self, count: usize) {
        self.block.extend(&self.values[..count], Value::widen);
    }
}

impl<I: Integrand> Visit for Fast<'_, I> {
    fn stream<S: Sampler>(&mut self, indices: Range<u64>, u: &mut S, begin: impl Fn(&mut S)) {
        let mut left = indices.end - indices.start;
        while left > 0 {
            let count = usize::try_from(left).map_or(Self::GROUP, |left| left.min(Self::GROUP));
            for value in &mut self.values[..count] {
                begin(u);
                *value = self.integrand.evaluate(u);
            }
            self.add(count);
            left -= count as u64;
        }
    }

    fn points<S: Sampler, P: Iterator<Item = S>>(
        &mut self,
        indices: Range<u64>,
        at: impl Fn(Range<u64>) -> P,
    ) -> ControlFlow<()> {
        let most = if I::AT_ONCE > 1 {
            I::AT_ONCE
        } else {
            Self::GROUP
        };
        let mut samplers = Vec::new();
        let mut first = indices.start;
        while first < indices.end {
            let count = usize::try_from(indices.end - first).map_or(most, |left| left.min(most));
            let group = first..first + count as u64;
            let values = &mut self.values[..count];
            if I::AT_ONCE > 1 {
                samplers.clear();
                samplers.extend(at(group.clone()));
                self.integrand.evaluate_many(&mut samplers, values);
            } else {
                for (value, mut u) in values.iter_mut().zip(at(group.clone())) {
                    *value = self.integrand.evaluate(&mut u);
                }
            }
            self.add(count);
            first = group.end;
        }
        ControlFlow::Continue(())
    }
}

struct Careful<'a, I: Integrand> {
    integrand: &'a I,
    policy: NonFinite,
    open: Open<Wide<I>>,
    coordinates: Vec<f64>,
    offender: Option<Box<Offender>>,
}

impl<I: Integrand> Careful<'_, I> {
    /// Behind a pointer: the integrand is compiled for it once, not once more for every point set.
    fn point(&mut self, index: u64, u: &mut dyn Sampler) -> ControlFlow<()> {
        self.coordinates.clear();
        let mut u = Recorder {
            inner: u,
            coordinates: &mut self.coordinates,
        };
        let value = self.integrand.evaluate(&mut u).widen();
        if !value.is_finite() && self.policy == NonFinite::Fail {
            let mut components = Vec::new();
            value.for_each(|component| components.push(component));
            self.offender = Some(Box::new(Offender {
                index,
                coordinates: core::mem::take(&mut self.coordinates),
                value: components,
            }));
            return ControlFlow::Break(());
        }
        self.open.push(value, self.coordinates.len() as u64);
        ControlFlow::Continue(())
    }
}

impl<I: Integrand> Visit for Careful<'_, I> {
    fn stream<S: Sampler>(&mut self, mut indices: Range<u64>, u: &mut S, begin: impl Fn(&mut S)) {
        let _ = indices.try_for_each(|index| {
            begin(u);
            self.point(index, u)
        });
    }

    fn points<S: Sampler, P: Iterator<Item = S>>(
        &mut self,
        indices: Range<u64>,
        at: impl Fn(Range<u64>) -> P,
    ) -> ControlFlow<()> {
        let mut points = indices.clone().zip(at(indices));
        points.try_for_each(|(index, mut u)| self.point(index, &mut u))
    }
}
