//! Whether a tree chooses among lights so well that it pays.

use super::Surfaces;
use crate::path::bsdf::Bsdf;
use crate::path::frame::{Frame, cosine_hemisphere, singles};
use crate::path::light::{AreaLights, Emitter, Illumination, Light, LightTree};
use crate::path::{Ray, Surface};
use crate::points::{Independent, PointSet};
use crate::{Error, Sampler};

/// How much smaller the second moment of light drawn by a tree must be, for the time that it takes to be worth it: a tree has 0.45 to 0.7
/// of the rate, and a picture gains less than a sample of its light, having other noise. What it gained is in `benches/README.md`.
const GAIN: f64 = 2.5;

/// The same where lights drawn by power go in lanes: a tree takes them out, and has 0.3 of the rate.
const GAIN_IN_LANES: f64 = 8.0;

/// Rays that are followed.
const RAYS: usize = 256;

/// Points of the lights drawn by each of both for every surface that is met.
const DRAWN: u32 = 16;

/// Of the coordinates of those points; another than that of the rays.
const SEED: u64 = 1;

/// The same lights, chosen in two ways.
struct Both {
    by_power: AreaLights,
    by_tree: LightTree,
}

impl Both {
    fn of(mut emitters: Vec<Emitter>) -> Result<Self, Error> {
        emitters.iter_mut().for_each(Emitter::by_solid_angle);
        Ok(Self {
            by_power: AreaLights::new(emitters.clone())?,
            by_tree: LightTree::new(emitters)?,
        })
    }
}

impl<B: Bsdf> Surfaces<B> {
    /// Whether a [tree](LightTree) is to choose among the lights, rather than their power. On the surfaces that the first of some
    /// rays meet, and those that light meets once it is scattered there, points of the lights are drawn in both ways, and the second
    /// moments of what arrives are compared. Where nothing arrives, by power.
    pub(crate) fn want_light_tree(&self, rays: impl Iterator<Item = Ray>) -> bool {
        if self.emitters.len() < 2 {
            return false;
        }
        let Ok(both) = Both::of(self.emitters.clone()) else {
            return false;
        };
        let points = Independent::new(SEED);
        let (mut by_power, mut by_tree) = (0.0, 0.0);
        for (index, mut ray) in (0..).zip(rays.take(RAYS)) {
            let mut u = points.point(index);
            for _ in 0..2 {
                let Some(hit) = self.geometry.nearest(&ray) else {
                    break;
                };
                let mut surface = hit.surface;
                if surface.normal.dot(ray.direction) > 0.0 {
                    surface.normal = -surface.normal;
                }
                for _ in 0..DRAWN {
                    let drawn = [
                        both.by_power.sample(&surface, &mut u),
                        both.by_tree.sample(&surface, &mut u),
                    ];
                    for light in drawn.iter().flatten() {
                        let [power, tree] = self.moments(light, &both, &surface);
                        by_power += power;
                        by_tree += tree;
                    }
                }
                let inside = cosine_hemisphere(singles(u.next_2d()));
                let direction = Frame::around(surface.normal).out(inside);
                ray = Ray {
                    origin: surface.leave(direction),
                    direction,
                };
            }
        }
        // Alike without `simd`, for the same picture.
        let gain = if self.lights_in_lanes {
            GAIN_IN_LANES
        } else {
            GAIN
        };
        by_power > gain * by_tree
    }

    /// What light drawn in both ways, half and half, adds to the second moments of light drawn by power alone and by the tree alone.
    fn moments(&self, light: &Illumination, both: &Both, surface: &Surface) -> [f64; 2] {
        const NOTHING: [f64; 2] = [0.0; 2];
        let (ray, length) = (light.way.ray, light.way.length);
        let Some(hit) = self.geometry.nearest(&ray) else {
            return NOTHING;
        };
        let there = hit.surface;
        // Another light is at another distance.
        let is_drawn = ((there.point - ray.origin).length() - length).abs() < 1e-3 * length;
        let Some(emitter) = self.owners[hit.part].emitter(hit.triangle) else {
            return NOTHING;
        };
        let by_power = both.by_power.emitted(emitter, surface.point, &there);
        let by_tree = both.by_tree.emitted(emitter, surface.point, &there);
        let cosine = ray.direction.dot(surface.normal).max(0.0);
        let arriving = f64::from(by_power.radiance.element_sum() * cosine);
        if !(is_drawn && arriving > 0.0) {
            return NOTHING;
        }
        let densities = [by_power, by_tree].map(|emission| f64::from(emission.density));
        let density = 0.5 * (densities[0] + densities[1]);
        densities.map(|one| arriving * arriving / (one * density))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;
    use crate::path::Object;
    use crate::path::bsdf::Lambertian;
    use crate::path::shape::{Flat, Primitive, Sphere, cuboid};

    /// Lamps above a floor, one as bright as the other, at the given distances.
    fn wanted<P: Into<Primitive>>(places: &[f32], lamp: impl Fn(f32) -> P) -> bool {
        let white = Lambertian::new([0.5; 3]).unwrap();
        let floor = cuboid(
            [0.0, -2.0, 0.0],
            [[100.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 5.0]],
        )
        .unwrap();
        let lamps = places.iter().map(|&x| lamp(x));
        let lamps = Object::<Lambertian>::new(lamps, white)
            .emitting([1.0; 3])
            .unwrap();
        let surfaces = Surfaces::new(vec![Object::new(floor, white), lamps], Vec::new()).unwrap();
        surfaces.want_light_tree((0_u8..100).map(|k| Ray {
            origin: Vec3A::new(2.0 * f32::from(k) - 100.0, 3.0, 1.0),
            direction: Vec3A::NEG_Y,
        }))
    }

    fn apart(count: u8) -> Vec<f32> {
        let step = 200.0 / f32::from(count);
        let place = |k: u8| step * (f32::from(k) + 0.5) - 100.0;
        (0..count).map(place).collect()
    }

    fn ball(x: f32) -> Sphere {
        Sphere::new([x, 0.0, 0.0], 0.1).unwrap()
    }

    /// One that goes in lanes.
    fn square(x: f32) -> Flat {
        Flat::parallelogram([x, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]).unwrap()
    }

    #[test]
    fn a_tree_is_wanted_for_lamps_far_from_one_another() {
        assert!(wanted(&apart(20), ball));
        let together: Vec<f32> = apart(20).iter().map(|x| 0.01 * x).collect();
        assert!(!wanted(&together, ball));
        assert!(!wanted(&apart(1), ball));
        assert!(!wanted(&[], ball));
    }

    #[test]
    fn lamps_stay_in_lanes_unless_a_tree_gains_much() {
        assert!(wanted(&apart(5), ball) && !wanted(&apart(5), square));
        assert!(wanted(&apart(20), square));
    }
}
