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
use crate::{Average, Estimator, Integrand, NonFinite, Outcome};
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
    crate::{Cursor, Estimate, Value},
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

impl<P: PointSet> Share<P> {
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
    /// Where many paths are followed at once, those of the next pixel begin where those of one run out, which is several times as
    /// fast for a few points a pixel, and somewhat faster for some hundreds. A few thousand points in all are enough for that.
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
        if let Some(parts) = self.reused(size, shares, &|_| 0, rule) {
            let shares = shares.iter().zip(parts);
            let mean =
                |(share, [_, all]): (&Share<P>, [Part; 2])| all.outcome(&share.average(rule));
            return shares.map(mean).collect();
        }
        self.each(size, shares, |share, values| {
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
        for share in shares {
            let (cut, count) = (cut(share), share.count);
            let whole = share
                .points
                .size()
                .is_none_or(|size| size == count || count == 0);
            assert!(cut <= count && whole, "{count} points cut at {cut}");
        }
        if let Some(parts) = self.reused(size, shares, &cut, rule) {
            let shares = shares.iter().zip(parts);
            let means = |(share, [a, b]): (&Share<P>, [Part; 2])| {
                let [first, others] = share.cut(cut(share));
                [
                    a.outcome(&first.average(rule)),
                    b.outcome(&others.average(rule)),
                ]
            };
            return shares.map(means).collect();
        }
        self.each(size, shares, |share, values| {
            let cut = cut(share);
            let parts = share.cut(cut);
            let values = values.map(|values| {
                let (first, others) = values.split_at(usize::try_from(cut).unwrap_or(usize::MAX));
                [first, others]
            });
            core::array::from_fn(|part| {
                let values = values.map(|values| values[part]);
                self.mean(size, &parts[part], values, rule)
            })
        })
    }

    /// What both parts of each share give where paths are reused.
    fn reused<P: PointSet>(
        &self,
        size: [u32; 2],
        shares: &[Share<P>],
        cut: &dyn Fn(&Share<P>) -> u64,
        rule: NonFinite,
    ) -> Option<Vec<[Part; 2]>> {
        let ahead = self.ahead(size);
        let pixels = Pixels {
            reused_by: self.paths.reused_by,
            rule,
            follow: &|runs: &[Run<'_, P>], groups, traces| {
                self.trace(size, runs, groups, traces, &ahead);
            },
            coordinates: &|share, index| {
                let mut coordinates = Vec::new();
                let mut recorder = Recorder {
                    inner: share.points.point(index),
                    coordinates: &mut coordinates,
                };
                self.pixel(share.position, size).evaluate(&mut recorder);
                coordinates
            },
        };
        (self.paths.reused_by > 1).then(|| pixels.parts(shares, cut))
    }

    /// Before any path is followed.
    pub(in crate::path) fn ahead(&self, size: [u32; 2]) -> Ahead {
        Ahead::new(self.pixel([0; 2], size).dimensions())
    }

    /// Follows the paths of some runs, and shares the light of some groups.
    pub(in crate::path) fn trace<P: PointSet>(
        &self,
        size: [u32; 2],
        runs: &[Run<'_, P>],
        groups: &[Group],
        traces: &mut Traces,
        ahead: &Ahead,
    ) {
        #[cfg(feature = "simd")]
        if let Some(packet) = self.pixel([0; 2], size).packet() {
            let slots = |run: &Run<'_, P>| run.slot..run.slot + run.length();
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
    pub(in crate::path) fn trace_singly<P: PointSet>(
        &self,
        size: [u32; 2],
        runs: &[Run<'_, P>],
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
                let u = &mut run.share.points.point(index);
                let (radiance, weight) = pixel.follow(u, &mut tracer);
                tracer.end(radiance, weight);
            }
        }
        for group in groups {
            traces.share(group, &|way| self.scene.occluded(way));
        }
    }

    /// What `tell` makes of each share and the values at its points, if it has few.
    fn each<P: PointSet, T>(
        &self,
        size: [u32; 2],
        shares: &[Share<P>],
        tell: impl Fn(&Share<P>, Option<&[Vec3]>) -> T,
    ) -> Vec<T> {
        #[cfg(feature = "simd")]
        if let Some(packet) = self.pixel([0; 2], size).packet() {
            return self.together(packet, size, shares, tell);
        }
        #[cfg(not(feature = "simd"))]
        let _ = size;
        shares.iter().map(|share| tell(share, None)).collect()
    }

    /// The mean over a share, of which the values may be there.
    fn mean<P: PointSet>(
        &self,
        size: [u32; 2],
        share: &Share<P>,
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

    fn alone<P: PointSet>(
        &self,
        size: [u32; 2],
        share: &Share<P>,
        rule: NonFinite,
    ) -> Outcome<Vec3> {
        share
            .average(rule)
            .estimate(&self.pixel(share.position, size))
    }
}

#[cfg(feature = "simd")]
impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// [`each`](Self::each) in lanes.
    fn together<P: PointSet, T>(
        &self,
        packet: &Packet,
        size: [u32; 2],
        mut shares: &[Share<P>],
        tell: impl Fn(&Share<P>, Option<&[Vec3]>) -> T,
    ) -> Vec<T> {
        let mut outcomes = Vec::with_capacity(shares.len());
        let mut values = Vec::new();
        let ahead = self.ahead(size);
        while !shares.is_empty() {
            let mut points = 0;
            let mut more = |share: &Share<P>| {
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
            outcomes.extend(batch.iter().map(|share| {
                let (own, others) = given.split_at(few(share));
                given = others;
                tell(share, (!own.is_empty()).then_some(own))
            }));
            shares = rest;
        }
        outcomes
    }

    /// The values at some points of shares, or what is to be kept of their paths.
    fn follow<P: PointSet>(
        &self,
        packet: &Packet,
        size: [u32; 2],
        runs: &[Run<'_, P>],
        ahead: &Ahead,
        values: &mut Vec<Vec3>,
        keeper: Option<Keeper<'_>>,
    ) {
        // Any pixel will do for all that is asked but where paths begin.
        let any = self.pixel([0; 2], size);
        let width = |run: &Run<'_, P>| ahead.width().min(run.share.points.dimensions());
        let rows = |run: &Run<'_, P>| run.length() * width(run) as usize;
        let length = runs.iter().map(rows).sum();
        with_room(length, |room| {
            let mut free = &mut *room;
            for run in runs {
                let (own, others) = free.split_at_mut(rows(run));
                run.share.points.fill(run.indices.start, 0..width(run), own);
                free = others;
            }
            let (mut samplers, mut pixels) = (Vec::new(), Vec::new());
            let mut left = &*room;
            for run in runs {
                let width = width(run) as usize;
                for index in run.indices.clone() {
                    let (row, others) = left.split_at(width);
                    left = others;
                    samplers.push(Cursor::with_prefix(&run.share.points, index, row));
                    pixels.push(run.share.position);
                }
            }
            values.clear();
            values.resize(samplers.len(), Vec3::ZERO);
            let start = |point: usize, u: &mut _| self.pixel(pixels[point], size).start(u);
            packet.radiance(self.paths, &any, &start, &mut samplers, values, keeper);
            ahead.learn(samplers.iter().map(Cursor::dimension));
        });
    }
}

#[cfg(feature = "simd")]
impl<P: PointSet> Share<P> {
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
fn few<P: PointSet>(share: &Share<P>) -> usize {
    let count = whole(&share.points, share.count);
    usize::try_from(count)
        .ok()
        .filter(|_| count <= BLOCK)
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::filter::{BoxFilter, Filtered};
    use crate::path::scenes;
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
        let rescrambled =
            |seed, _| Box::new(Rescrambled::new(4, seed).unwrap()) as Box<dyn PointSet>;
        let independent = |seed, _| Box::new(Independent::new(seed)) as Box<dyn PointSet>;
        // In fewer dimensions than paths read, and of a size of its own.
        let finite = |_, count: u64| {
            Box::new(Hammersley::new(count.max(1), 5).unwrap()) as Box<dyn PointSet>
        };
        for points in [rescrambled, independent, finite] {
            let shares = shares(points);
            let together = view.averages(size, &shares, NonFinite::Fail);
            assert_eq!(together.len(), shares.len());
            for (share, mut outcome) in shares.iter().zip(together) {
                let mut alone = view.alone(size, share, NonFinite::Fail);
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
                        let mut alone = view.alone(size, &part, NonFinite::Fail);
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
                    let alone = view.alone(size, share, rule);
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
}
