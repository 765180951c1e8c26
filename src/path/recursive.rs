//! The rendering equation by recursion, as it is taught: to be compared with, not to be fast.

use glam::{Vec3, Vec3A};

use super::bsdf::Bsdf;
use super::filter::Filter;
use super::light::{Environment, Light};
use super::radiance::power;
use super::render::Start;
use super::roulette::Rule;
use super::sensor::Sensor;
use super::{Pixel, Ray, Scene};
use crate::{Error, Integrand, Sampler};

/// Stochastic ray tracing: at every surface several rays go on, and their mean is the light that arrives.
///
/// With one ray it is path tracing, slower than [`Paths::radiance`](super::Paths::radiance) and with the same mean. With
/// more the number of rays grows as a power of the depth: that is what path tracing avoids. Where recursion
/// [ends](Ending) and how light is [found](Direct) can be chosen, without bias and with.
///
/// ```
/// use estimand::path::{Direct, Ending, Image, Recursive, scenes};
/// use estimand::{Estimator, MonteCarlo};
///
/// // Everything emits and reflects one half: three segments see 1/2 + 1/4 + 1/8.
/// let (view, size) = (scenes::furnace(), [8, 8]);
/// let tree = Recursive::new(4, Ending::Depth(3), Direct::NextEvent)?;
/// let picture = Image::of_pixels(size, 1, |position, key| {
///     MonteCarlo::new(64, key).estimate(&tree.pixel(view.pixel(position, size)))
/// })?;
/// assert!((picture.mean().x - 0.875).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recursive {
    rays: u32,
    ending: Ending,
    direct: Direct,
}

/// Where recursion ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// Biased: after so many segments, at least 1. What longer paths would add is missing.
    Depth(u32),
    /// Biased: where a ray carries less than this share, in `(0, 1]`, of what began at the camera; after
    /// 1000 segments at the latest. What the rays left out would add is missing.
    Threshold(f32),
    /// Unbiased: by Russian roulette after every segment from this one on, by what a ray carries, as
    /// [`Paths::roulette_from`](super::Paths::roulette_from) has it.
    Roulette(u32),
}

/// How light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direct {
    /// By a point of the lights at every surface, weighted against directions that happen to hit them.
    NextEvent,
    /// By directions that happen to hit lights, alone. Lights without size are never hit.
    Chance,
}

/// The longest path that a threshold ends: two mirrors that face one another never carry less.
const LONGEST: u32 = 1000;

/// A ray under way.
struct Branch {
    ray: Ray,
    /// What a unit of radiance along the ray adds to the pixel.
    throughput: Vec3A,
    /// The density with which its direction was drawn.
    density: f32,
    eta: f32,
    segment: u32,
}

impl Recursive {
    /// `rays` rays at every surface, at least one.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no rays, a depth of 0 and a threshold outside `(0, 1]`.
    pub fn new(rays: u32, ending: Ending, direct: Direct) -> Result<Self, Error> {
        if rays == 0 {
            return Err(Error::refused("number of rays", "at least 1", rays));
        }
        match ending {
            Ending::Depth(0) => Err(Error::refused("number of segments", "at least 1", 0)),
            Ending::Threshold(share) if !(share > 0.0 && share <= 1.0) => {
                Err(Error::refused("threshold", "in (0, 1]", share))
            }
            _ => Ok(Self {
                rays,
                ending,
                direct,
            }),
        }
    }

    /// `pixel`, its light found by this recursion instead of by its own paths.
    pub fn pixel<B, L, E, C, F>(
        self,
        pixel: Pixel<'_, B, L, E, C, F>,
    ) -> RecursivePixel<'_, B, L, E, C, F> {
        RecursivePixel {
            recursion: self,
            pixel,
        }
    }

    /// The radiance that arrives at the origin of `ray` from its direction: an estimate.
    ///
    /// At every surface the coordinates are read in this order: those of a point of the lights, where such are drawn;
    /// then ray by ray those of its direction, one for Russian roulette where it is played, and those of all that
    /// follows.
    pub fn radiance<B: Bsdf, L: Light, E: Environment, S: Sampler>(
        &self,
        scene: &Scene<B, L, E>,
        ray: Ray,
        u: &mut S,
    ) -> Vec3 {
        let branch = Branch {
            ray,
            throughput: Vec3A::ONE,
            density: f32::INFINITY,
            eta: 1.0,
            segment: 1,
        };
        self.follow(scene, &branch, u).into()
    }

    /// What a ray and all that grows from it add to the pixel.
    fn follow<B: Bsdf, L: Light, E: Environment, S: Sampler>(
        &self,
        scene: &Scene<B, L, E>,
        branch: &Branch,
        u: &mut S,
    ) -> Vec3A {
        let ray = &branch.ray;
        let met = |density: f32| match self.direct {
            Direct::NextEvent => power(branch.density, density),
            Direct::Chance => 1.0,
        };
        let Some(vertex) = scene.meet(ray) else {
            let emission = scene.environment().emitted(ray.direction);
            return branch.throughput * emission.radiance * met(emission.density);
        };
        let mut radiance = Vec3A::ZERO;
        if let Some(emitter) = vertex.emitter {
            let lights = scene.lights();
            let emission = lights.emitted(emitter, ray.origin, vertex.place());
            radiance += emission.radiance * met(emission.density);
        }
        let mut sum = branch.throughput * radiance;
        if self.ending == Ending::Depth(branch.segment) {
            return sum;
        }
        let (surface, bsdf, out) = (&vertex.surface, vertex.bsdf, -ray.direction);
        if self.direct == Direct::NextEvent && !bsdf.is_delta() {
            let area = scene.lights().sample(surface, u);
            let around = scene.environment().sample(surface, u);
            for light in [area, around].into_iter().flatten() {
                let scattering = bsdf.evaluate(surface, out, light.way.ray.direction);
                if scattering.density > 0.0 && !scene.occluded(&light.way) {
                    let weight = power(light.density, scattering.density);
                    sum += branch.throughput * scattering.value * light.weight * weight;
                }
            }
        }
        for _ in 0..self.rays {
            let Some(next) = bsdf.sample(surface, out, u) else {
                continue;
            };
            let mut grown = Branch {
                ray: Ray {
                    origin: surface.leave(next.direction),
                    direction: next.direction,
                },
                throughput: branch.throughput * next.weight / self.rays as f32,
                density: next.density,
                eta: branch.eta * next.eta,
                segment: branch.segment + 1,
            };
            if let Some(weight) = self.survives(&grown, u) {
                grown.throughput *= weight;
                sum += self.follow(scene, &grown, u);
            }
        }
        sum
    }

    /// The weight of a ray that goes on; `None` for one that ends before its first surface.
    fn survives<S: Sampler>(&self, grown: &Branch, u: &mut S) -> Option<f32> {
        let carried = grown.throughput.max_element() * (grown.eta * grown.eta);
        match self.ending {
            Ending::Depth(_) => Some(1.0),
            Ending::Threshold(share) => {
                (!(carried < share) && grown.segment <= LONGEST).then_some(1.0)
            }
            Ending::Roulette(from) if grown.segment <= from => Some(1.0),
            Ending::Roulette(from) => Rule::of_throughput(from).play(grown.segment - 1, carried, u),
        }
    }
}

/// A [`Pixel`] whose light is found by recursion, made by [`Recursive::pixel`].
#[derive(Debug)]
pub struct RecursivePixel<'a, B, L, E, C, F> {
    recursion: Recursive,
    pixel: Pixel<'a, B, L, E, C, F>,
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> Integrand
    for RecursivePixel<'_, B, L, E, C, F>
{
    type Value = Vec3;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> Vec3 {
        let Start { ray, weight } = self.pixel.start(u);
        self.recursion.radiance(self.pixel.scene, ray, u) * weight
    }

    fn dimensions(&self) -> u32 {
        self.pixel.dimensions()
    }
}
