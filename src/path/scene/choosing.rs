//! Whether a tree chooses among lights so well that it pays.

use super::Surfaces;
use crate::Sampler;
use crate::path::bsdf::Bsdf;
use crate::path::frame::{Frame, cosine_hemisphere, singles};
use crate::path::light::{AreaLights, Emitter, Illumination, Light, LightTree};
use crate::path::{Ray, Surface};
use crate::points::{Independent, PointSet};

/// How much smaller the second moment of light drawn by a tree must be, for the time that it takes to be worth it. Less of the noise of a
/// picture goes: there is other noise, and good points choose evenly among few lights by themselves. Lamps in halls and cubes with ratios
/// of 2.7 to 13 had 1.03 to 4.5 times the efficiency by a tree, scenes with ratios below 1 had 0.7 times: see `benches/README.md`.
const GAIN: f64 = 2.0;

/// Points of the lights drawn by each of both for every surface that is looked at.
const DRAWN: u32 = 16;

impl<B: Bsdf> Surfaces<B> {
    /// Whether a [tree](LightTree) is to choose among the lights rather than their power. For what some rays meet, and what light meets
    /// once it is scattered there, both draw points of the lights that shine there; second moments of what arrives are compared.
    pub(crate) fn want_light_tree(&self, rays: impl Iterator<Item = Ray>) -> bool {
        // By a tree each path would ask for itself, which takes three times as long.
        if self.emitters.len() < 2 || self.lights_in_lanes {
            return false;
        }
        let mut emitters = self.emitters.clone();
        emitters.iter_mut().for_each(Emitter::by_solid_angle);
        let (Ok(by_power), Ok(tree)) =
            (AreaLights::new(emitters.clone()), LightTree::new(emitters))
        else {
            return false;
        };
        let both = (by_power, tree);
        let points = Independent::new(0);
        let mut moments = [0.0; 2];
        for (index, mut ray) in (0..).zip(rays) {
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
                    for drawn in [
                        both.0.sample(&surface, &mut u),
                        both.1.sample(&surface, &mut u),
                    ] {
                        let found = drawn.and_then(|light| self.moments(&light, &both, &surface));
                        let [a, b] = found.unwrap_or_default();
                        moments = [moments[0] + a, moments[1] + b];
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
        moments[0] > GAIN * moments[1]
    }

    /// What light drawn by either, half and half, adds to the second moments of light drawn by the one and by the other.
    fn moments(
        &self,
        light: &Illumination,
        both: &(AreaLights, LightTree),
        surface: &Surface,
    ) -> Option<[f64; 2]> {
        let ray = light.way.ray;
        let hit = self.geometry.nearest(&ray)?;
        let emitter = self.owners[hit.part].emitter(hit.triangle)?;
        let there = hit.surface;
        if (there.point - ray.origin).length() < 0.999 * light.way.length {
            return None;
        }
        let by_power = both.0.emitted(emitter, surface.point, &there);
        let by_tree = both.1.emitted(emitter, surface.point, &there);
        let cosine = ray.direction.dot(surface.normal).max(0.0);
        let arriving = f64::from(by_power.radiance.element_sum() * cosine);
        let densities = [by_power, by_tree].map(|emission| f64::from(emission.density));
        let density = 0.5 * (densities[0] + densities[1]);
        let moments = densities.map(|one| arriving * arriving / (one * density));
        moments
            .iter()
            .all(|moment| moment.is_finite())
            .then_some(moments)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;
    use crate::path::Object;
    use crate::path::bsdf::Lambertian;
    use crate::path::shape::{Sphere, cuboid};

    /// Lamps above a floor, one as bright as the other, at the given distances.
    fn wanted(places: &[f32]) -> bool {
        let white = Lambertian::new([0.5; 3]).unwrap();
        let floor = cuboid(
            [0.0, -2.0, 0.0],
            [[100.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 5.0]],
        )
        .unwrap();
        let lamps = places
            .iter()
            .map(|&x| Sphere::new([x, 0.0, 0.0], 0.1).unwrap());
        let lamps = Object::<Lambertian>::new(lamps, white)
            .emitting([1.0; 3])
            .unwrap();
        let surfaces = Surfaces::new(vec![Object::new(floor, white), lamps], Vec::new()).unwrap();
        surfaces.want_light_tree((0_u8..100).map(|k| Ray {
            origin: Vec3A::new(2.0 * f32::from(k) - 100.0, 3.0, 1.0),
            direction: Vec3A::NEG_Y,
        }))
    }

    #[test]
    fn a_tree_is_wanted_for_lamps_far_from_one_another() {
        let apart: Vec<f32> = (0_u8..20).map(|k| 10.0 * f32::from(k) - 95.0).collect();
        assert!(wanted(&apart));
        let together: Vec<f32> = apart.iter().map(|x| 0.01 * x).collect();
        assert!(!wanted(&together));
        assert!(!wanted(&apart[..1]));
        assert!(!wanted(&[]));
    }
}
