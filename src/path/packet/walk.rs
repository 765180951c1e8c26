//! The radiance loop, a path a lane.

use core::f32::consts::{FRAC_1_PI, FRAC_PI_4};

use glam::{Vec3, Vec3A};
use pulp::{Simd, WithSimd};

use super::meshes::{Meshes, Rays};
use super::near::Drawn;
use super::place::DARK;
use super::{Packet, Start};
use crate::Sampler;
use crate::path::frame::single;
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::{Paths, gamma};

/// The paths of some points.
pub(super) struct Walk<'a, U> {
    pub(super) packet: &'a Packet,
    pub(super) paths: Paths,
    pub(super) start: &'a dyn Fn(&mut U) -> Start,
    pub(super) points: &'a mut [U],
    pub(super) values: &'a mut [Vec3],
}

/// What the loop over single paths keeps in its variables, of each lane's path.
struct State {
    origin: [Row<f32>; 3],
    direction: [Row<f32>; 3],
    throughput: [Row<f32>; 3],
    radiance: [Row<f32>; 3],
    density: Row<f32>,
    /// Zero in a lane without a path.
    segment: Row<f32>,
    weight: Row<f32>,
    /// Which point the path belongs to, if any.
    point: [usize; WIDEST],
}

impl State {
    const IDLE: Self = Self {
        origin: [Row::<f32>::ZERO; 3],
        direction: [Row::<f32>::ZERO; 3],
        throughput: [Row::<f32>::ZERO; 3],
        radiance: [Row::<f32>::ZERO; 3],
        density: Row::<f32>::ZERO,
        segment: Row::<f32>::ZERO,
        weight: Row::<f32>::ZERO,
        point: [usize::MAX; WIDEST],
    };

    #[inline(always)]
    fn begin(&mut self, lane: usize, point: usize, Start { ray, weight }: Start) {
        for axis in 0..3 {
            self.origin[axis].0[lane] = ray.origin[axis];
            self.direction[axis].0[lane] = ray.direction[axis];
            self.throughput[axis].0[lane] = 1.0;
            self.radiance[axis].0[lane] = 0.0;
        }
        // The density of the camera's direction, which is no choice.
        self.density.0[lane] = f32::INFINITY;
        self.segment.0[lane] = 1.0;
        self.weight.0[lane] = weight;
        self.point[lane] = point;
    }

    #[inline(always)]
    fn value(&self, lane: usize) -> Vec3 {
        let [r, g, b] = &self.radiance;
        Vec3::new(r.0[lane], g.0[lane], b.0[lane]) * self.weight.0[lane]
    }
}

impl<U: Sampler> WithSimd for Walk<'_, U> {
    type Output = ();

    /// Follows a path in each lane; where one ends the next one begins.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let mut state = State::IDLE;
        let mut begun = 0;
        let mut running = 0;
        loop {
            for lane in 0..S::F32_LANES {
                if state.segment.0[lane] > 0.0 {
                    continue;
                }
                if let Some(value) = self.values.get_mut(state.point[lane]) {
                    *value = state.value(lane);
                    state.point[lane] = usize::MAX;
                    running -= 1;
                }
                if begun < self.points.len() {
                    let start = (self.start)(&mut self.points[begun]);
                    state.begin(lane, begun, start);
                    begun += 1;
                    running += 1;
                }
            }
            if running == 0 {
                break;
            }
            self.step(simd, &mut state);
        }
    }
}

impl<U: Sampler> Walk<'_, U> {
    /// Takes every path one segment on, as an iteration of [`Paths::radiance`] does.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, state: &mut State) {
        let Packet {
            table,
            shapes,
            dividing,
            meshes,
            ..
        } = self.packet;
        let (zero, one) = (Real::splat(simd, 0.0), Real::splat(simd, 1.0));
        let origin = Vector::load(simd, &state.origin);
        let direction = Vector::load(simd, &state.direction);
        let mut throughput = Vector::load(simd, &state.throughput);
        let mut radiance = Vector::load(simd, &state.radiance);
        let density = Real::load(simd, &state.density);
        let segment = Real::load(simd, &state.segment);

        let hit = shapes.nearest(simd, origin, direction);
        let walking = segment.gt(zero);
        let mut met = walking & hit.distance.lt(Real::splat(simd, f32::INFINITY));
        let triangles = meshes.as_ref().map(|meshes| {
            meshes.nearest(&Rays {
                origin: &state.origin,
                direction: &state.direction,
                limit: &hit.distance.row(),
                active: &walking.row(simd),
            })
        });
        if let Some(triangles) = &triangles {
            met = met | triangles.met(simd);
        }
        if self.packet.sky != Vec3A::ZERO {
            let sum = radiance + throughput * Vector::splat(simd, self.packet.sky);
            radiance = (walking & !met).choose(sum, radiance);
        }
        let mut shape = Row::<u32>::ZERO;
        hit.shape.store(&mut shape);
        let mut here = table.places(simd, &shape);
        let mut point = {
            let [low_s, low_t] = table.inset(simd, &shape);
            let s = hit.s.max(low_s).min(one - low_s);
            let t = hit.t.max(low_t).min(one - low_t);
            if self.packet.triangles {
                let beyond = (table.slant(simd, &shape) * (s + t) + low_s.max(low_t)).max(one);
                here.at(s / beyond, t / beyond)
            } else {
                here.at(s, t)
            }
        };

        // The normal that light is scattered by.
        let mut shading = here.normal;
        if let Some(triangles) = &triangles {
            let met = triangles.met(simd);
            point = met.choose(triangles.point(simd), point);
            here.normal = met.choose(triangles.normal(simd), here.normal);
            here.margin = met.select(triangles.margin(simd), here.margin);
            here.chance = met.select(Real::splat(simd, DARK), here.chance);
            shading = met.choose(triangles.shading(simd), here.normal);
        }

        // Emitted light, met by a direction that was drawn at the surface before.
        let lit = met & here.chance.ge(zero) & here.normal.dot(origin - point).gt(zero);
        if lit.any() {
            let area = table.area(simd, &shape);
            let mut drawn = here.density_of_area(origin, point, area);
            if let Some(near) = &self.packet.near {
                drawn = near.density(&shape, lit, origin, drawn);
            }
            let other = here.chance * drawn;
            let emission = throughput * table.radiance(simd, &shape);
            radiance = lit.choose(radiance + emission * power(density, other), radiance);
        }
        let facing = shading.dot(-direction);
        let mut walking = met & segment.lt(Real::splat(simd, self.paths.longest as f32));
        if self.packet.one_sided {
            let mut inner = table.inner(simd, &shape);
            if let Some(triangles) = &triangles {
                inner = (triangles.met(simd)).select(triangles.inner(simd), inner);
            }
            walking = walking & (inner.gt(zero) | facing.gt(zero));
        }
        if !walking.any() {
            radiance.store(&mut state.radiance);
            zero.store(&mut state.segment);
            return;
        }
        let mut albedo = table.albedo(simd, &shape);
        if let Some(triangles) = &triangles {
            albedo = (triangles.met(simd)).choose(triangles.albedo(simd), albedo);
        }

        let mut chosen = match self.packet.emitters[..] {
            [one] => Row::<u32>::splat(one),
            _ => Row::<u32>::ZERO,
        };
        let [a, b, c, d] = self.draw(simd, state, walking, &mut chosen);

        // Next-event estimation: light met by drawing a point of the lights.
        if let [first, rest @ ..] = &self.packet.emitters[..] {
            let (there, area, light) = if rest.is_empty() {
                let shape = *first as usize;
                (
                    table.place(simd, *first),
                    Real::splat(simd, table.area[shape]),
                    table.light(simd, shape),
                )
            } else {
                (
                    table.places(simd, &chosen),
                    table.area(simd, &chosen),
                    table.radiance(simd, &chosen),
                )
            };
            let (s, t) = if self.packet.slanted_lights {
                let slanted = table.slant(simd, &chosen).gt(zero);
                let above = b.gt(a);
                let (half_a, half_b) = (0.5 * a, 0.5 * b);
                let s = above.select(half_a, a - half_b);
                let t = above.select(b - half_a, half_b);
                (slanted.select(s, a), slanted.select(t, b))
            } else {
                (a, b)
            };
            let target = there.at(s, t);
            let mut drawn = Drawn {
                point: target,
                density: there.density_of_area(point, target, area),
            };
            if let Some(near) = &self.packet.near {
                drawn = near.sample(&chosen, walking, point, [a, b], drawn);
            }
            let target = drawn.point;
            let own = there.chance * drawn.density;
            let toward = target - point;
            let start = here.leave(point, toward);
            let way = there.leave(target, -toward) - start;
            let length = way.length();
            let into = way * (1.0 / length);
            let cosine = shading.dot(into);
            let size = cosine.abs();
            let other = FRAC_1_PI * size;
            let active = walking
                & there.normal.dot(point - target).gt(zero)
                & own.gt(zero)
                & own.lt(Real::splat(simd, f32::MAX))
                & length.gt(zero)
                & (cosine * facing).gt(zero)
                & other.gt(zero);
            if active.any() {
                // Other lanes may have the largest of numbers, whose inverse is a slow one.
                let own = active.select(own, one);
                let limit = length * (1.0 - gamma(8));
                let mut visible = !dividing.occluded(start, into, limit, !active);
                if let Some(meshes) = meshes {
                    visible = self.passing(simd, meshes, visible, [start, into], limit);
                }
                let value = albedo * (FRAC_1_PI * size);
                let sum = throughput * value * (light * (1.0 / own)) * power(own, other);
                radiance = visible.choose(radiance + sum, radiance);
            }
        }

        // All other light, by drawing a direction.
        let local = cosine_hemisphere(c, d);
        walking = walking & local.z.gt(zero);
        throughput *= albedo;
        let playing = walking & segment.ge(Real::splat(simd, self.paths.roulette.from as f32));
        if playing.any() {
            let weight = self.play(simd, state, playing, throughput.max_element());
            walking = walking & (!playing | weight.gt(zero));
            throughput = playing.choose(throughput * weight, throughput);
        }
        let normal = shading * one.copysign(facing);
        let next = around(normal, local);
        here.leave(point, next).store(&mut state.origin);
        next.store(&mut state.direction);
        throughput.store(&mut state.throughput);
        radiance.store(&mut state.radiance);
        (FRAC_1_PI * local.z).store(&mut state.density);
        walking
            .select(segment + 1.0, zero)
            .store(&mut state.segment);
    }

    /// Where no mesh is in the way, among the lanes of `visible`, from a point in a direction.
    #[inline(always)]
    fn passing<S: Simd>(
        &self,
        simd: S,
        meshes: &Meshes,
        visible: Mask<S>,
        [start, into]: [Vector<S>; 2],
        limit: Real<S>,
    ) -> Mask<S> {
        let passes = meshes.passes(&Rays {
            origin: &start.rows(),
            direction: &into.rows(),
            limit: &limit.row(),
            active: &visible.row(simd),
        });
        Real::load(simd, &passes).gt(Real::splat(simd, 0.0))
    }

    /// Two coordinates for a point of the lights, which choose one first, and two for the next direction.
    #[inline(always)]
    fn draw<S: Simd>(
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
    fn play<S: Simd>(
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

/// The vector with the given coordinates in the [frame](crate::path::frame::Frame) around a normal.
#[inline(always)]
fn around<S: Simd>(normal: Vector<S>, local: Vector<S>) -> Vector<S> {
    let one = normal.z.all(1.0);
    let sign = one.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vector {
        x: 1.0 + sign * normal.x * normal.x * a,
        y: sign * b,
        z: -sign * normal.x,
    };
    let bitangent = Vector {
        x: b,
        y: sign + normal.y * normal.y * a,
        z: -normal.y,
    };
    tangent * local.x + bitangent * local.y + normal * local.z
}

/// As [`cosine_hemisphere`](crate::path::frame::cosine_hemisphere).
#[inline(always)]
fn cosine_hemisphere<S: Simd>(u: Real<S>, v: Real<S>) -> Vector<S> {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (zero, one) = (u.all(0.0), u.all(1.0));
    let wide = a.abs().gt(b.abs());
    let (radius, other) = (wide.select(a, b), wide.select(b, a));
    let angle = FRAC_PI_4 * other / radius.eq(zero).select(one, radius);
    let x = angle * angle;
    let cosine = 1.0 + x * (-0.5 + x * (1.0 / 24.0 + x * (-1.0 / 720.0 + x * (1.0 / 40320.0))));
    let sine = angle * (1.0 + x * (-1.0 / 6.0 + x * (1.0 / 120.0 + x * (-1.0 / 5040.0))));
    Vector {
        x: radius * wide.select(cosine, sine),
        y: radius * wide.select(sine, cosine),
        z: (1.0 - radius * radius).max(zero).sqrt(),
    }
}

/// As the `power` of the loop over single paths.
#[inline(always)]
fn power<S: Simd>(own: Real<S>, other: Real<S>) -> Real<S> {
    let (zero, one) = (own.all(0.0), own.all(1.0));
    let ratio = own.eq(other).select(one, other / own);
    own.gt(zero).select(1.0 / (1.0 + ratio * ratio), zero)
}
