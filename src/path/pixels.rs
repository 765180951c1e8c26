//! The means of several pixels at once.

mod ahead;

use super::View;
use super::bsdf::Bsdf;
use super::filter::Filter;
use super::light::{Environment, Light};
use super::reuse::{Group, Part, Pixels, Run, Tracer, Traces};
use super::sensor::Sensor;
use crate::points::{PointSet, Skipped};
use crate::recorder::Recorder;
use crate::{Average, Cursor, Estimator, Integrand, NonFinite, Outcome};
use glam::Vec3;

pub(in crate::path) use ahead::Ahead;

#[cfg(feature = "simd")]
use {
    super::packet::{Keeper, Packet},
    super::reuse::TOGETHER,
    crate::block::Block,
    crate::estimators::whole,
    crate::evaluate::BLOCK,
    crate::room::with_room,
    crate::tallied::Tallied,
    crate::tally::Tally,
    crate::{Estimate, Value},
    glam::DVec3,
};

/// A pixel, and the points that its mean is to be over.
#[derive(Clone, Copy, Debug)]
pub struct Share<P> {
    /// The column and the row, from the upper left corner of the picture.
    pub position: [u32; 2],
    /// The points, of which a finite set is taken whole.
    pub points: P,
    /// How many of them, from the first one on.
    pub count: u64,
}

/// The same of points of any kind: what takes these is compiled for a view, not for each kind of points.
pub(in crate::path) type Given<'a> = Share<&'a dyn PointSet>;

impl<P: PointSet> Share<P> {
    pub(in crate::path) fn given(&self) -> Given<'_> {
        Share {
            position: self.position,
            points: &self.points,
            count: self.count,
        }
    }

    /// The first points, and the others.
    fn cut(&self, first: u64) -> [Share<Skipped<&P>>; 2] {
        let part = |skipped, count| Share {
            position: self.position,
            points: Skipped::new(&self.points, skipped),
            count,
        };
        [part(0, first), part(first, self.count - first)]
    }

    fn average(&self, rule: NonFinite) -> Average<&P> {
        Average::new(&self.points, self.count).non_finite(rule)
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// The mean of each of some pixels of a picture of `size`: unless paths are reused, what [`Average`] gives for the [`pixel`](Self::pixel) alone, to the bit,
    /// but for the [time](crate::Estimate::seconds), which may be 0: that of pixels together is not told apart.
    ///
    /// Where many paths are followed at once, those of several pixels go together, which is several times as fast for a few points a
    /// pixel, and somewhat faster for some hundreds. A few thousand points in all are enough for that.
    ///
    /// If paths are [reused](super::Paths::reused_by), they are by pixels that follow one another here: ask for all of a run of
    /// [columns](super::Paths::columns_together) at once, or the means are others.
    ///
    /// ```
    /// use estimand::path::{Share, scenes};
    /// use estimand::points::{Rescrambled, pixel};
    /// use estimand::{Average, Estimator, NonFinite};
    ///
    /// let (view, size) = (scenes::cornell_box(), [16, 16]);
    /// let row: Vec<_> = (0..16)
    ///     .map(|x| {
    ///         let points = Rescrambled::new(4, pixel::seed([x, 9], 1))?;
    ///         Ok(Share { position: [x, 9], points, count: 4 })
    ///     })
    ///     .collect::<Result<_, estimand::Error>>()?;
    /// let means = view.averages(size, &row, NonFinite::Fail);
    /// let alone = Average::new(row[3].points, 4).estimate(&view.pixel([3, 9], size))?;
    /// assert_eq!(means[3].as_ref().unwrap().mean, alone.mean);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Each pixel has its own: that of [`Average`]. Where paths are reused, light that is not finite is met by all pixels that use it: each of them fails, or
    /// counts it, and names the point of its own path of the same number.
    pub fn averages<P: PointSet>(
        &self,
        size: [u32; 2],
        shares: &[Share<P>],
        rule: NonFinite,
    ) -> Vec<Outcome<Vec3>> {
        let shares: Vec<_> = shares.iter().map(Share::given).collect();
        self.means(size, &shares, rule)
    }

    fn means(&self, size: [u32; 2], shares: &[Given<'_>], rule: NonFinite) -> Vec<Outcome<Vec3>> {
        if let Some(parts) = self.reused(size, shares, shares.iter().map(|_| 0), rule) {
            let shares = shares.iter().zip(parts);
            let mean =
                |(share, [_, all]): (&Given<'_>, [Part; 2])| all.outcome(&share.average(rule));
            return shares.map(mean).collect();
        }
        self.each(size, shares, |_, share, values| {
            self.mean(size, share, values, rule)
        })
    }

    /// The means over the first points of each share, `cut` of them, and over the others apart: two [`averages`](Self::averages) in the time
    /// of one, for what they differ by.
    ///
    /// ```
    /// use estimand::NonFinite;
    /// use estimand::path::{Share, scenes};
    /// use estimand::points::Rescrambled;
    ///
    /// let (view, size) = (scenes::cornell_box(), [16, 16]);
    /// let share = Share { position: [3, 9], points: Rescrambled::new(4, 1)?, count: 12 };
    /// let means = view.averages_in_two(size, &[share], |_| 8, NonFinite::Fail);
    /// let [Ok(first), Ok(others)] = &means[0] else {
    ///     panic!("both parts have values");
    /// };
    /// let all = view.averages(size, &[share], NonFinite::Fail).remove(0).unwrap();
    /// assert!(((first.mean * 8.0 + others.mean * 4.0) / 12.0 - all.mean).length() < 1e-15);
    /// # Ok::<(), estimand::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Each part has its own: that of [`Average`], also for no points. Neither says where its number of points is no power of the radix of its set.
    ///
    /// # Panics
    ///
    /// If a cut is above the count, or a finite set is not asked for whole.
    pub fn averages_in_two<P: PointSet>(
        &self,
        size: [u32; 2],
        shares: &[Share<P>],
        cut: impl Fn(&Share<P>) -> u64,
        rule: NonFinite,
    ) -> Vec<[Outcome<Vec3>; 2]> {
        let cuts: Vec<_> = shares.iter().map(cut).collect();
        let shares: Vec<_> = shares.iter().map(Share::given).collect();
        self.means_in_two(size, &shares, &cuts, rule)
    }

    fn means_in_two(
        &self,
        size: [u32; 2],
        shares: &[Given<'_>],
        cuts: &[u64],
        rule: NonFinite,
    ) -> Vec<[Outcome<Vec3>; 2]> {
        for (share, &cut) in shares.iter().zip(cuts) {
            let count = share.count;
            let whole = share
                .points
                .size()
                .is_none_or(|size| size == count || count == 0);
            assert!(cut <= count && whole, "{count} points cut at {cut}");
        }
        if let Some(parts) = self.reused(size, shares, cuts.iter().copied(), rule) {
            let shares = shares.iter().zip(cuts).zip(parts);
            let means = |((share, &cut), [a, b]): ((&Given<'_>, &u64), [Part; 2])| {
                let [first, others] = share.cut(cut);
                [
                    a.outcome(&first.average(rule)),
                    b.outcome(&others.average(rule)),
                ]
            };
            return shares.map(means).collect();
        }
        self.each(size, shares, |number, share, values| {
            let cut = cuts[number];
            let parts = share.cut(cut);
            let values = values.map(|values| {
                let (first, others) = values.split_at(usize::try_from(cut).unwrap_or(usize::MAX));
                [first, others]
            });
            core::array::from_fn(|part| {
                let values = values.map(|values| values[part]);
                self.mean(size, &parts[part].given(), values, rule)
            })
        })
    }

    /// What both parts of each share give where paths are reused.
    fn reused(
        &self,
        size: [u32; 2],
        shares: &[Given<'_>],
        cuts: impl Iterator<Item = u64>,
        rule: NonFinite,
    ) -> Option<Vec<[Part; 2]>> {
        let ahead = self.ahead(size);
        let pixels = Pixels {
            reused_by: self.paths.reused_by,
            rule,
            follow: &|runs: &[Run<'_>], groups, traces| {
                self.trace(size, runs, groups, traces, &ahead);
            },
            coordinates: &|share, index| {
                let mut coordinates = Vec::new();
                let mut recorder = Recorder {
                    inner: Cursor::new(share.points, index),
                    coordinates: &mut coordinates,
                };
                self.pixel(share.position, size).evaluate(&mut recorder);
                coordinates
            },
        };
        (self.paths.reused_by > 1).then(|| pixels.parts(shares, cuts))
    }

    /// Before any path is followed.
    pub(in crate::path) fn ahead(&self, size: [u32; 2]) -> Ahead {
        Ahead::new(self.pixel([0; 2], size).dimensions())
    }

    /// Follows the paths of some runs, and shares the light of some groups.
    pub(in crate::path) fn trace(
        &self,
        size: [u32; 2],
        runs: &[Run<'_>],
        groups: &[Group],
        traces: &mut Traces,
        ahead: &Ahead,
    ) {
        #[cfg(feature = "simd")]
        if let Some(packet) = self.pixel([0; 2], size).packet() {
            let slots = |run: &Run<'_>| run.slot..run.slot + run.length();
            let of: Vec<_> = runs.iter().flat_map(slots).collect();
            let keeper = Keeper {
                traces,
                roulette: &self.paths.roulette,
                of: &of,
            };
            self.follow(packet, size, runs, ahead, &mut Vec::new(), Some(keeper));
            return packet.share(self.scene.geometry(), groups, traces);
        }
        let _ = ahead;
        self.trace_singly(size, runs, groups, traces);
    }

    /// The same, one path after the other.
    pub(in crate::path) fn trace_singly(
        &self,
        size: [u32; 2],
        runs: &[Run<'_>],
        groups: &[Group],
        traces: &mut Traces,
    ) {
        for run in runs {
            let pixel = self.pixel(run.share.position, size);
            for (slot, index) in (run.slot..).zip(run.indices.clone()) {
                let mut tracer = Tracer {
                    traces,
                    roulette: &self.paths.roulette,
                    slot,
                };
                let u = &mut Cursor::new(run.share.points, index);
                let (radiance, weight) = pixel.follow(u, &mut tracer);
                tracer.end(radiance, weight);
            }
        }
        for group in groups {
            traces.share(group, &|way| self.scene.occluded(way));
        }
    }

    /// What `tell` makes of each share, its number and the values at its points, if it has few.
    fn each<T>(
        &self,
        size: [u32; 2],
        shares: &[Given<'_>],
        tell: impl Fn(usize, &Given<'_>, Option<&[Vec3]>) -> T,
    ) -> Vec<T> {
        #[cfg(feature = "simd")]
        if let Some(packet) = self.pixel([0; 2], size).packet() {
            return self.together(packet, size, shares, tell);
        }
        #[cfg(not(feature = "simd"))]
        let _ = size;
        let shares = shares.iter().enumerate();
        shares
            .map(|(number, share)| tell(number, share, None))
            .collect()
    }

    /// The mean over a share, of which the values may be there.
    fn mean(
        &self,
        size: [u32; 2],
        share: &Given<'_>,
        values: Option<&[Vec3]>,
        rule: NonFinite,
    ) -> Outcome<Vec3> {
        #[cfg(feature = "simd")]
        // What plain arithmetic does not do is left to the estimator.
        if let Some(estimate) = values.and_then(|values| share.of_values(values, rule)) {
            return Ok(estimate);
        }
        #[cfg(not(feature = "simd"))]
        let _ = values;
        self.alone(size, share, rule)
    }

    fn alone(&self, size: [u32; 2], share: &Given<'_>, rule: NonFinite) -> Outcome<Vec3> {
        share
            .average(rule)
            .estimate(&self.pixel(share.position, size))
    }
}

#[cfg(feature = "simd")]
impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// [`each`](Self::each) in lanes.
    fn together<T>(
        &self,
        packet: &Packet,
        size: [u32; 2],
        mut shares: &[Given<'_>],
        tell: impl Fn(usize, &Given<'_>, Option<&[Vec3]>) -> T,
    ) -> Vec<T> {
        let mut outcomes = Vec::with_capacity(shares.len());
        let mut values = Vec::new();
        let ahead = self.ahead(size);
        while !shares.is_empty() {
            let mut points = 0;
            let mut more = |share: &Given<'_>| {
                let enough = points >= TOGETHER;
                points += few(share);
                !enough
            };
            let end = shares.iter().take_while(|share| more(share)).count();
            let (batch, rest) = shares.split_at(end);
            let runs: Vec<_> = batch
                .iter()
                .map(|share| Run::of(share, few(share)))
                .collect();
            self.follow(packet, size, &runs, &ahead, &mut values, None);
            let mut given = &values[..];
            for share in batch {
                let (own, others) = given.split_at(few(share));
                given = others;
                let own = (!own.is_empty()).then_some(own);
                outcomes.push(tell(outcomes.len(), share, own));
            }
            shares = rest;
        }
        outcomes
    }

    /// The values at some points of shares, or what is to be kept of their paths.
    fn follow(
        &self,
        packet: &Packet,
        size: [u32; 2],
        runs: &[Run<'_>],
        ahead: &Ahead,
        values: &mut Vec<Vec3>,
        keeper: Option<Keeper<'_>>,
    ) {
        // Any pixel will do for all that is asked but where paths begin.
        let any = self.pixel([0; 2], size);
        let width = |run: &Run<'_>| ahead.width().min(run.share.points.dimensions());
        let rows = |run: &Run<'_>| run.length() * width(run) as usize;
        let length = runs.iter().map(rows).sum();
        with_room(length, |room| {
            let mut free = &mut *room;
            for run in runs {
                let (own, others) = free.split_at_mut(rows(run));
                run.share.points.fill(run.indices.start, 0..width(run), own);
                free = others;
            }
            let points = runs.iter().map(Run::length).sum();
            let (mut samplers, mut starts) =
                (Vec::with_capacity(points), Vec::with_capacity(points));
            let mut left = &*room;
            for run in runs {
                let width = width(run) as usize;
                let pixel = self.pixel(run.share.position, size);
                for index in run.indices.clone() {
                    let (row, others) = left.split_at(width);
                    left = others;
                    let mut sampler = Cursor::with_prefix(run.share.points, index, row);
                    starts.push(pixel.start(&mut sampler));
                    samplers.push(sampler);
                }
            }
            values.clear();
            values.resize(samplers.len(), Vec3::ZERO);
            packet.radiance(self.paths, &any, &starts, &mut samplers, values, keeper);
            ahead.learn(samplers.iter().map(Cursor::dimension));
        });
    }
}

#[cfg(feature = "simd")]
impl Given<'_> {
    /// The estimate from the values at its points; `None` without any, and if plain arithmetic does not do.
    fn of_values(&self, values: &[Vec3], rule: NonFinite) -> Option<Estimate<DVec3>> {
        let mut block = Block::EMPTY;
        block.extend(values, Value::widen);
        let mut tally = Tally::EMPTY;
        tally.close(block.piece()?);
        self.average(rule).summary(&[tally])
    }
}

/// How many points the share has, if they are to be followed with those of others; 0 if not.
#[cfg(feature = "simd")]
fn few(share: &Given<'_>) -> usize {
    let count = whole(&share.points, share.count);
    usize::try_from(count)
        .ok()
        .filter(|_| count <= BLOCK)
        .unwrap_or(0)
}

#[cfg(test)]
mod tests;
