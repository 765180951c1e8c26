//! What the paths draw, one lane after the other, in the order in which single paths read their coordinates.

use pulp::Simd;

use super::{State, Walk};
use crate::Sampler;
use crate::path::frame::{single, singles};
use crate::path::lanes::{Mask, Real, Row, WIDEST};
use crate::path::light::Surroundings;
use crate::path::packet::drawn::{Draws, Hits};
use crate::path::packet::optics::{DELTA, OTHER};

impl<U: Sampler, const PLAIN: bool> Walk<'_, U, PLAIN> {
    /// What the paths draw at their points, where the view is asked or the sky is a picture: two coordinates for a point of flat
    /// lights, which choose one first, or what others draw; two for the sky, one for sources without size, or what other surroundings draw; and two for the
    /// next direction of the ideally diffuse law, or what others draw.
    #[inline(always)]
    pub(super) fn draw<S: Simd>(
        &mut self,
        simd: S,
        state: &State,
        (walking, kinds): (Mask<S>, &Row<f32>),
        hits: Option<&Hits<'_>>,
        draws: &mut Draws,
    ) -> [Real<S>; 4] {
        let lit = !self.packet.emitters.is_empty();
        let walks = walking.row(simd);
        let mut u = [Row::<f32>::ZERO; 4];
        let (mut lanes, mut coordinates, mut count) = ([0; WIDEST], [[0.0; 2]; WIDEST], 0);
        for lane in (0..S::F32_LANES).filter(|&lane| walks.0[lane] > 0.0) {
            let sampler = &mut self.points[state.point[lane]];
            let kind = kinds.0[lane];
            if kind != DELTA {
                if lit {
                    let [a, b] = sampler.next_2d();
                    let (light, a) = self.packet.lights.choose(a);
                    let (shape, u_of_light) = (self.packet.emitters[light], singles([a, b]));
                    draws.chosen.0[lane] = shape;
                    [u[0].0[lane], u[1].0[lane]] = u_of_light;
                    if let (Some(hits), Some(lamp)) = (hits, &mut draws.lamp)
                        && self.packet.asked == Some(shape)
                    {
                        let from = hits.hit(lane).surface;
                        lamp.set(lane, self.packet.lights.drawn(light, &from, u_of_light));
                    }
                } else if let (Some(hits), Some(lamp)) = (hits, &mut draws.lamp) {
                    lamp.set(lane, self.single.lamp(&hits.hit(lane), sampler));
                }
                if let (Some(hits), Some(around)) = (hits, &mut draws.around) {
                    around.set(lane, self.single.around(&hits.hit(lane), sampler));
                }
                if self.sources.is_some_and(Surroundings::are_several) {
                    draws.choices[lane] = sampler.next_1d();
                }
                if self.sky.is_some() {
                    (lanes[count], coordinates[count]) = (lane, sampler.next_2d());
                    count += 1;
                }
            }
            if kind < OTHER {
                let [c, d] = sampler.next_2d();
                (u[2].0[lane], u[3].0[lane]) = (single(c), single(d));
            } else if let (Some(hits), Some(scattered)) = (hits, &mut draws.scattered) {
                let (hit, out) = (hits.hit(lane), hits.out(lane));
                scattered.set(lane, self.single.sample(&hit, out, sampler));
            }
        }
        if let Some(sky) = self.sky {
            draws.sky = Some(sky.drawn_in_lanes(self.packet.arch, &lanes[..count], &coordinates));
        }
        u.map(|row| Real::load(simd, &row))
    }

    /// The same where all laws are ideally diffuse, the view is asked for no light, and neither a picture nor sources are around.
    #[inline(always)]
    pub(super) fn draw_diffuse<S: Simd>(
        &mut self,
        simd: S,
        state: &State,
        walking: Mask<S>,
        chosen: &mut Row<u32>,
    ) -> [Real<S>; 4] {
        let lit = !self.packet.emitters.is_empty();
        let walks = walking.row(simd);
        let mut u = [Row::<f32>::ZERO; 4];
        for lane in 0..S::F32_LANES {
            if walks.0[lane] == 0.0 {
                continue;
            }
            let sampler = &mut self.points[state.point[lane]];
            let mut point = [0.0; 4];
            if lit {
                sampler.next_nd(&mut point);
                (chosen.0[lane], point[0]) = self.packet.choose(point[0]);
            } else {
                sampler.next_nd(&mut point[2..]);
            }
            for (row, number) in u.iter_mut().zip(point) {
                row.0[lane] = single(number);
            }
        }
        let [a, b, c, d] = &u;
        [
            Real::load(simd, a),
            Real::load(simd, b),
            Real::load(simd, c),
            Real::load(simd, d),
        ]
    }

    /// Russian roulette: the weights of the paths that go on, zero for those that end.
    #[inline(always)]
    pub(super) fn play<S: Simd>(
        &mut self,
        simd: S,
        state: &State,
        playing: Mask<S>,
        carried: Real<S>,
    ) -> Real<S> {
        let plays = playing.row(simd);
        let mut weights = Row::<f32>::ZERO;
        carried.store(&mut weights);
        for lane in 0..S::F32_LANES {
            if plays.0[lane] > 0.0 {
                let u = &mut self.points[state.point[lane]];
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a count"
                )]
                let segment = state.segment.0[lane] as u32;
                let survivor = self.paths.roulette.play(segment, weights.0[lane], u);
                weights.0[lane] = survivor.unwrap_or(0.0);
            }
        }
        Real::load(simd, &weights)
    }
}
