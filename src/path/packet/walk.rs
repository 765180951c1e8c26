//! The radiance loop, a path a lane.

mod choices;
mod state;

use core::f32::consts::FRAC_1_PI;

use glam::{Vec3, Vec3A};
use pulp::{Simd, WithSimd};

use super::drawn::{Draws, Hits, Illuminated, Scatters, Weights};
use super::lamp::Lamp;
use super::math::{around, cosine_hemisphere, power};
use super::optics::{DELTA, OTHER, VARYING};
use super::reuse::{AtPoints, Keeper};
use super::solids::Rays;
use super::sweep::Shapes;
use super::{Packet, Single, Start};
use crate::Sampler;
use crate::path::Paths;
use crate::path::geometry;
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::light::{Sky, Surroundings};
use crate::path::segment::End;
use state::{Path, State};

/// The paths of some points.
///
/// `PLAIN` ones are in a scene of flat shapes that scatter light ideally diffusely, with flat lights and the same radiance all around: the
/// code for all else is left out.
pub(super) struct Walk<'a, U, const PLAIN: bool> {
    pub(super) packet: &'a Packet,
    pub(super) paths: Paths,
    pub(super) single: &'a dyn Single,
    pub(super) sky: Option<&'a Sky>,
    pub(super) sources: Option<&'a Surroundings>,
    pub(super) starts: &'a [Start],
    pub(super) points: &'a mut [U],
    pub(super) values: &'a mut [Vec3],
    pub(super) keeper: Option<Keeper<'a>>,
}

/// So many states are taken on in turn. With twice as many no difference was seen.
const GROUPS: usize = 16;

impl<U: Sampler, const PLAIN: bool> WithSimd for Walk<'_, U, PLAIN> {
    type Output = ();

    /// Follows some paths at a time, all of them segment by segment, so that those that begin go together.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let lanes = S::F32_LANES;
        let mut states = [State::IDLE; GROUPS];
        let mut begun = 0;
        while begun < self.starts.len() {
            let mut running = (self.starts.len() - begun).min(GROUPS * lanes);
            for (place, start) in self.starts[begun..][..running].iter().enumerate() {
                let path = Path::begin(begun + place, start);
                states[place / lanes].set(place % lanes, path);
            }
            begun += running;
            while running > 0 {
                // What was in the lanes behind the last path.
                for place in running..running.next_multiple_of(lanes) {
                    states[place / lanes].segment.0[place % lanes] = 0.0;
                }
                for state in &mut states[..running.div_ceil(lanes)] {
                    self.step(simd, state);
                }
                running = self.close_ranks(&mut states, running, lanes);
            }
        }
    }
}

/// What is known of the laws where the paths are.
pub(super) struct Laws<'a, S: Simd> {
    /// The normal that light is scattered by.
    pub(super) shading: Vector<S>,
    /// The cosine between it and the way that the path came.
    pub(super) facing: Real<S>,
    /// Of the ideally diffuse law.
    pub(super) albedo: Vector<S>,
    /// Where the law is another, which is asked by the points.
    other: Mask<S>,
    hits: Option<&'a Hits<'a>>,
    /// Whether these are the first points of all paths.
    alike: bool,
}

impl<U: Sampler, const PLAIN: bool> Walk<'_, U, PLAIN> {
    /// Ends the paths that go no further, of the first `running`, and moves the others up. How many these are.
    #[inline(always)]
    fn close_ranks(&mut self, states: &mut [State], running: usize, lanes: usize) -> usize {
        let mut left = 0;
        for place in 0..running {
            let (state, lane) = (&states[place / lanes], place % lanes);
            if state.segment.0[lane] > 0.0 {
                if left < place {
                    let path = state.path(lane);
                    states[left / lanes].set(left % lanes, path);
                }
                left += 1;
                continue;
            }
            let (point, radiance) = (state.point[lane], Row::vector(&state.radiance, lane));
            let weight = state.weight.0[lane];
            match &mut self.keeper {
                Some(keeper) => keeper.end(point, radiance, weight),
                None => self.values[point] = Vec3::from(radiance) * weight,
            }
        }
        left
    }

    /// Takes the paths of a state one segment on, as an iteration of [`Paths::radiance`] does.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, state: &mut State) {
        let packet = self.packet;
        let others = !PLAIN && packet.others;
        let (asks_lights, asks_around) =
            (!PLAIN && packet.asks_lights, !PLAIN && packet.asks_around);
        let some_asked = !PLAIN && packet.asked.is_some();
        let sky = self.sky.filter(|_| !PLAIN);
        let sources = self.sources.filter(|_| !PLAIN);
        let (zero, one) = (Real::splat(simd, 0.0), Real::splat(simd, 1.0));
        let origin = Vector::load(simd, &state.origin);
        let direction = Vector::load(simd, &state.direction);
        let mut throughput = Vector::load(simd, &state.throughput);
        let mut radiance = Vector::load(simd, &state.radiance);
        let density = Real::load(simd, &state.density);
        let segment = Real::load(simd, &state.segment);

        let walking = segment.gt(zero);
        // At first segments, of one pixel or its neighbours, rays run side by side.
        let alike = !segment.gt(one).any();
        let hit = packet.shapes.nearest(simd, origin, direction);
        let mut met = walking & hit.distance.lt(Real::splat(simd, f32::INFINITY));
        let solids = packet.solids.as_ref().filter(|_| !PLAIN);
        let solids = solids.and_then(|solids| {
            let near = walking & packet.boxes.entered(origin, direction, hit.distance);
            let round = met & hit.shape.ge(simd, solids.first);
            if !(near | round).any() {
                return None;
            }
            let rays = Rays {
                origin: &state.origin,
                direction: &state.direction,
                limit: &hit.distance.row(),
                active: &(near | round).row(simd),
            };
            let geometry = self.single.geometry();
            let soup = geometry.soup().filter(|soup| alike && soup.is_small());
            let triangles = soup.filter(|_| near.any()).map(|soup| {
                soup.nearest_together(geometry::Rays {
                    origin,
                    direction,
                    limit: hit.distance,
                    active: near,
                })
            });
            let near = near.row(simd);
            Some(solids.nearest(geometry, &rays, &near, triangles, &hit.shapes()))
        });
        if let Some(solids) = &solids {
            met = met | solids.met(simd);
        }
        let missed = walking & !met;
        if sky.is_some() || asks_around {
            if missed.any() {
                let (directions, lanes) = (&state.direction, &missed.row(simd));
                let (emitted, other) = match sky {
                    Some(sky) => {
                        let seen = sky.emitted_in_lanes(packet.arch, directions, lanes);
                        (
                            Vector::load(simd, &seen.radiance),
                            Real::load(simd, &seen.density),
                        )
                    }
                    None => {
                        let light = Weights::background(self.single, directions, lanes);
                        (light.weight(simd), light.density(simd))
                    }
                };
                let sum = radiance + throughput * emitted * power(density, other);
                radiance = missed.choose(sum, radiance);
            }
        } else if others {
            // As the loop over single paths has it, whatever the densities of a law are.
            let constant = Vector::splat(simd, packet.around);
            let sum = radiance + throughput * constant * power(density, zero);
            radiance = missed.choose(sum, radiance);
        } else if packet.around != Vec3A::ZERO {
            let sum = radiance + throughput * Vector::splat(simd, packet.around);
            radiance = missed.choose(sum, radiance);
        }

        let here = packet.here(simd, &hit, solids.as_ref());
        // What the view is asked about these points.
        let asks = others || asks_lights || some_asked || asks_around;
        let varying = !PLAIN && packet.varying;
        let hits = (asks || varying).then(|| here.hits(&packet.table, &state.direction));
        // Emitted light, met by a direction that was drawn at the surface before.
        let shines = met & here.shines();
        let to_be_asked = (asks_lights || some_asked).then(|| shines & here.is_asked());
        let faces = here.faces(origin);
        let (known, lit) = match to_be_asked {
            Some(asked) => (shines & !asked & faces, shines & (asked | faces)),
            None => (shines & faces, shines & faces),
        };
        if lit.any() {
            let (mut emitted, mut other) = if asks_lights {
                (Vector::splat(simd, Vec3A::ZERO), zero)
            } else {
                packet.emitted(simd, &here, origin, known)
            };
            if let (Some(asked), Some(hits)) = (to_be_asked, &hits)
                && asked.any()
            {
                let light = hits.emitted(self.single, &state.origin, &asked.row(simd));
                emitted = asked.choose(light.weight(simd), emitted);
                other = asked.select(light.density(simd), other);
            }
            let sum = radiance + throughput * emitted * power(density, other);
            radiance = lit.choose(sum, radiance);
        }
        let facing = here.shading.dot(-direction);
        let mut walking = met & segment.lt(Real::splat(simd, self.paths.longest as f32));
        let kind = if others || varying {
            here.kind(simd, &packet.table)
        } else {
            zero
        };
        let mut albedo = here.albedo(simd, &packet.table);
        let mut inner = if packet.one_sided {
            here.inner(simd, &packet.table)
        } else {
            one
        };
        let asked = walking & kind.eq(Real::splat(simd, VARYING));
        if let Some(hits) = hits.as_ref().filter(|_| varying && asked.any()) {
            let laws = hits.lambertian(self.single, &asked.row(simd));
            albedo = asked.choose(laws.weight(simd), albedo);
            inner = asked.select(laws.density(simd), inner);
        }
        if packet.one_sided {
            walking = walking & (inner.gt(zero) | facing.gt(zero));
        }
        if !walking.any() {
            radiance.store(&mut state.radiance);
            zero.store(&mut state.segment);
            return;
        }
        let at = Laws {
            shading: here.shading,
            facing,
            albedo,
            other: kind.ge(Real::splat(simd, OTHER)),
            hits: hits.as_ref(),
            alike,
        };

        if let Some(keeper) = &mut self.keeper {
            let at_points = AtPoints {
                segment: &state.segment,
                point: &state.point,
                diffuse: walking & !at.other,
            };
            let second = keeper.keep(simd, &at_points, &here, &at, radiance);
            // The colour of the first point is another for each pixel; the path is no less likely to go on than it was.
            radiance = second.choose(Vector::splat(simd, Vec3A::ZERO), radiance);
            let grey = throughput.max_element();
            let grey = Vector {
                x: grey,
                y: grey,
                z: grey,
            };
            throughput = second.choose(grey, throughput);
        }

        let mut draws = Draws {
            chosen: packet.first_light(),
            lamp: (asks_lights || some_asked).then_some(Illuminated::NONE),
            around: asks_around.then_some(Illuminated::NONE),
            sky: None,
            choices: [0.0; WIDEST],
            scattered: others.then_some(Scatters::NONE),
        };
        let [a, b, c, d] = if asks || sky.is_some() || sources.is_some() {
            self.draw(simd, state, (walking, &kind.row()), at.hits, &mut draws)
        } else {
            self.draw_diffuse(simd, state, walking, &mut draws.chosen)
        };

        // Next-event estimation: light met by drawing a point of the lights, and one of what is around.
        let mut seeing = walking;
        if others {
            seeing = seeing & kind.lt(Real::splat(simd, DELTA));
        }
        if !packet.emitters.is_empty() {
            let lamp = packet.lamp(simd, &here, &draws.chosen, [a, b], seeing);
            radiance = self.lit(simd, &at, &lamp, &packet.dividing, (throughput, radiance));
        }
        for light in [&draws.lamp, &draws.around].into_iter().flatten() {
            let ends = [
                (End::Surface, &packet.dividing),
                (End::Open, &packet.shapes),
            ];
            for (end, between) in ends {
                let lamp = light.lamp(simd, end, seeing);
                if lamp.active.any() {
                    radiance = self.lit(simd, &at, &lamp, between, (throughput, radiance));
                }
            }
        }
        if let Some(sources) = sources {
            let (points, active) = (here.point.rows(), seeing.row(simd));
            let chosen = sources.chosen_in_lanes(packet.arch, &points, &active, &draws.choices);
            let lamp = chosen.lamp(simd, &here, seeing);
            radiance = self.lit(simd, &at, &lamp, &packet.shapes, (throughput, radiance));
        }
        if let Some(sky) = &draws.sky {
            let lamp = sky.lamp(simd, &here, seeing);
            radiance = self.lit(simd, &at, &lamp, &packet.shapes, (throughput, radiance));
        }

        // All other light, by drawing a direction.
        let local = cosine_hemisphere(c, d);
        let mut goes_on = local.z.gt(zero);
        let mut weight = at.albedo;
        let mut drawn = FRAC_1_PI * local.z;
        let mut next = around(at.shading * one.copysign(facing), local);
        let mut eta = if others {
            Real::load(simd, &state.eta)
        } else {
            one
        };
        if let Some(scattered) = &draws.scattered {
            let other = at.other;
            goes_on = (other & scattered.goes_on(simd)) | (!other & goes_on);
            weight = other.choose(scattered.drawn.weight(simd), weight);
            drawn = other.select(scattered.drawn.density(simd), drawn);
            next = other.choose(scattered.drawn.direction(simd), next);
            eta = eta * other.select(scattered.eta(simd), one);
        }
        walking = walking & goes_on;
        throughput *= weight;
        let playing = walking & segment.ge(Real::splat(simd, self.paths.roulette.from as f32));
        if playing.any() {
            let carried = throughput.max_element() * (eta * eta);
            let weight = self.play(simd, state, playing, carried);
            walking = walking & (!playing | weight.gt(zero));
            throughput = playing.choose(throughput * weight, throughput);
        }
        here.place.leave(here.point, next).store(&mut state.origin);
        next.store(&mut state.direction);
        throughput.store(&mut state.throughput);
        radiance.store(&mut state.radiance);
        drawn.store(&mut state.density);
        if others {
            eta.store(&mut state.eta);
        }
        walking
            .select(segment + 1.0, zero)
            .store(&mut state.segment);
    }

    /// The radiance with the light that a lamp adds.
    #[inline(always)]
    fn lit<S: Simd>(
        &self,
        simd: S,
        at: &Laws<'_, S>,
        lamp: &Lamp<S>,
        between: &Shapes,
        (throughput, radiance): (Vector<S>, Vector<S>),
    ) -> Vector<S> {
        let zero = Real::splat(simd, 0.0);
        let cosine = at.shading.dot(lamp.into);
        let size = cosine.abs();
        let mut other = FRAC_1_PI * size;
        let mut value = at.albedo * (FRAC_1_PI * size);
        let mut seen = (cosine * at.facing).gt(zero) & other.gt(zero);
        if at.hits.is_some() {
            seen = seen | at.other;
        }
        let active = lamp.active & seen;
        if !active.any() {
            return radiance;
        }
        let (geometry, ways) = (
            || self.single.geometry(),
            (lamp.start, lamp.into, lamp.limit),
        );
        let mut visible = (self.packet).sees::<S, PLAIN>(between, geometry, at.alike, active, ways);
        // Other laws take their time, and are asked for light that arrives alone.
        if let Some(hits) = at.hits {
            let asked = visible & at.other;
            if asked.any() {
                let into = lamp.into.rows();
                let scatterings = hits.evaluate(self.single, &into, &asked.row(simd));
                value = at.other.choose(scatterings.weight(simd), value);
                other = at.other.select(scatterings.density(simd), other);
                visible = visible & other.gt(zero);
            }
        }
        let sum = throughput * value * lamp.weight * power(lamp.density, other);
        visible.choose(radiance + sum, radiance)
    }
}
