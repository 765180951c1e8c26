//! The loop over points: one block at a time, fast if its values are ordinary, carefully if not.

use core::ops::{ControlFlow, Range};

use crate::moments::Block;
use crate::points::PointSet;
use crate::{
    Cursor, Error, Estimate, Incomplete, Integrand, Moments, NonFinite, Sampler, Value, reduce,
};

/// Points per block. A block is the unit of parallel work and of seeding; its length is a constant, so
/// that the sums do not depend on the machine.
const BLOCK: u64 = 1024;

/// Where the points of an estimate come from.
pub(crate) trait Source: Sync {
    /// Hands the points of `indices`, which lie in one block, to `visit` in order.
    ///
    /// About `dimensions` coordinates of each will be read.
    fn points(&self, indices: Range<u64>, dimensions: u32, visit: &mut impl Visit);
}

/// What is done at each point.
pub(crate) trait Visit {
    fn point<S: Sampler>(&mut self, index: u64, u: S) -> ControlFlow<()>;
}

/// Coordinates computed ahead per call of `fill`: 32 KiB, which the first-level cache holds.
const AHEAD: usize = 4096;

impl<P: PointSet> Source for P {
    fn points(&self, indices: Range<u64>, dimensions: u32, visit: &mut impl Visit) {
        let dimensions = dimensions.min(self.dimensions());
        let width = dimensions as usize;
        let (mut index, end) = (indices.start, indices.end);
        if width == 0 || width > AHEAD {
            while index < end {
                if visit.point(index, self.point(index)).is_break() {
                    return;
                }
                index += 1;
            }
            return;
        }
        let rows = (AHEAD / width).min(usize::try_from(end - index).unwrap_or(AHEAD));
        let mut ahead = vec![0.0; rows * width];
        while index < end {
            let rows = rows.min(usize::try_from(end - index).unwrap_or(rows));
            let ahead = &mut ahead[..rows * width];
            self.fill(index, 0..dimensions, ahead);
            for prefix in ahead.chunks_exact(width) {
                if visit
                    .point(index, Cursor::with_prefix(self, index, prefix))
                    .is_break()
                {
                    return;
                }
                index += 1;
            }
        }
    }
}

/// What the points of one source have given.
#[derive(Clone, Copy)]
pub(crate) struct Tally<V> {
    pub(crate) moments: Moments<V>,
    pub(crate) rejected: u64,
}

impl<V: Value> Tally<V> {
    const EMPTY: Self = Self {
        moments: Moments::new(),
        rejected: 0,
    };

    /// How many evaluations were made.
    pub(crate) fn used(&self) -> u64 {
        self.moments.count() + self.rejected
    }
}

/// An evaluation that stopped: why, and the tallies of all points before.
pub(crate) struct Stopped<V> {
    pub(crate) reason: Error,
    pub(crate) tallies: Vec<Tally<V>>,
}

/// The result of an estimator: `estimate` of the tallies, or of those there were before the stop. It
/// returns `None` if the tallies hold no value.
pub(crate) fn conclude<V: Value>(
    outcome: Result<Vec<Tally<V>>, Stopped<V>>,
    estimate: impl Fn(&[Tally<V>]) -> Option<Estimate<V>>,
) -> Result<Estimate<V>, Incomplete<V>> {
    match outcome {
        Ok(tallies) => estimate(&tallies).ok_or_else(|| {
            Error::NothingLeft {
                rejected: tallies.iter().map(|tally| tally.rejected).sum(),
            }
            .into()
        }),
        Err(Stopped { reason, tallies }) => Err(Incomplete {
            reason,
            so_far: estimate(&tallies).map(Box::new),
        }),
    }
}

/// Evaluates `integrand` at the points `0..count` of every source; one tally a source.
pub(crate) fn evaluate<I: Integrand, S: Source>(
    sources: &[S],
    count: u64,
    integrand: &I,
    policy: NonFinite,
) -> Result<Vec<Tally<Wide<I>>>, Stopped<Wide<I>>> {
    let blocks = count.div_ceil(BLOCK);
    let mut tallies = vec![Tally::EMPTY; sources.len()];
    let mut taken = 0;
    let place = |job: u64| usize::try_from(job / blocks).expect("a source is in memory");
    let outcome = reduce::in_order(
        blocks * sources.len() as u64,
        |job| {
            let first = job % blocks * BLOCK;
            let indices = first..count.min(first + BLOCK);
            block(&sources[place(job)], indices, integrand, policy)
        },
        |(tally, offender): (Tally<_>, Option<Offender>)| {
            let source = place(taken);
            taken += 1;
            tallies[source].moments.merge(tally.moments);
            tallies[source].rejected += tally.rejected;
            offender.map_or(Ok(()), |offender| Err((source, offender)))
        },
    );
    match outcome {
        Ok(()) => Ok(tallies),
        Err((
            source,
            Offender {
                index,
                coordinates,
                value,
            },
        )) => {
            tallies.truncate(source + 1);
            let reason = Error::NonFinite {
                index,
                replicate: source as u64,
                coordinates,
                value,
            };
            Err(Stopped { reason, tallies })
        }
    }
}

pub(crate) type Wide<I> = <<I as Integrand>::Value as Value>::Wide;

/// A point where the integrand was not finite.
struct Offender {
    index: u64,
    coordinates: Vec<f64>,
    value: Vec<f64>,
}

fn block<I: Integrand, S: Source>(
    source: &S,
    indices: Range<u64>,
    integrand: &I,
    policy: NonFinite,
) -> (Tally<Wide<I>>, Option<Offender>) {
    let mut fast = Fast {
        integrand,
        block: Block::EMPTY,
    };
    source.points(indices.clone(), integrand.dimensions(), &mut fast);
    match fast.block.moments() {
        Some(moments) => (
            Tally {
                moments,
                rejected: 0,
            },
            None,
        ),
        None => careful(source, indices, integrand, policy),
    }
}

/// Evaluates a block again, value by value: names what is not finite, and sums what has no ordinary
/// squares.
#[cold]
fn careful<I: Integrand, S: Source>(
    source: &S,
    indices: Range<u64>,
    integrand: &I,
    policy: NonFinite,
) -> (Tally<Wide<I>>, Option<Offender>) {
    let mut careful = Careful {
        integrand,
        policy,
        tally: Tally::EMPTY,
        offender: None,
    };
    source.points(indices, integrand.dimensions(), &mut careful);
    (careful.tally, careful.offender)
}

struct Fast<'a, I: Integrand> {
    integrand: &'a I,
    block: Block<Wide<I>>,
}

impl<I: Integrand> Visit for Fast<'_, I> {
    #[inline]
    fn point<S: Sampler>(&mut self, _: u64, mut u: S) -> ControlFlow<()> {
        self.block.push(self.integrand.evaluate(&mut u).widen());
        ControlFlow::Continue(())
    }
}

struct Careful<'a, I: Integrand> {
    integrand: &'a I,
    policy: NonFinite,
    tally: Tally<Wide<I>>,
    offender: Option<Offender>,
}

impl<I: Integrand> Visit for Careful<'_, I> {
    fn point<S: Sampler>(&mut self, index: u64, u: S) -> ControlFlow<()> {
        let mut u = Recorder {
            inner: u,
            coordinates: Vec::new(),
        };
        let value = self.integrand.evaluate(&mut u).widen();
        if value.is_finite() {
            self.tally.moments.push(value);
        } else if self.policy == NonFinite::Reject {
            self.tally.rejected += 1;
        } else {
            let mut components = Vec::new();
            value.for_each(|component| components.push(component));
            let coordinates = u.coordinates;
            self.offender = Some(Offender {
                index,
                coordinates,
                value: components,
            });
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// Remembers the coordinates that were read.
struct Recorder<S> {
    inner: S,
    coordinates: Vec<f64>,
}

impl<S: Sampler> Sampler for Recorder<S> {
    fn next_1d(&mut self) -> f64 {
        let coordinate = self.inner.next_1d();
        self.coordinates.push(coordinate);
        coordinate
    }
}
