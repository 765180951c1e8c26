//! The radiance loop.

use glam::{Vec3, Vec3A};

use super::Ray;
use super::bsdf::Bsdf;
use super::light::{Environment, Light};
use super::reuse::{Diffuse, MOST, SPREAD};
use super::roulette::{Rule, Witness};
use super::scene::Scene;
use crate::{Error, Sampler};

/// Which paths of light are followed.
///
/// By default all: paths end by Russian roulette, without bias, from their fifth segment on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paths {
    pub(in crate::path) longest: u32,
    pub(in crate::path) roulette: Rule,
    pub(in crate::path) hides_lights: bool,
    /// Whether, of what is around, only that is hidden which nothing is in front of: not what is seen through holes and thin glass.
    pub(in crate::path) hides_in_front_alone: bool,
    pub(in crate::path) reused_by: u32,
}

impl Default for Paths {
    fn default() -> Self {
        Self {
            longest: u32::MAX,
            roulette: Rule::of_throughput(5),
            hides_lights: false,
            hides_in_front_alone: false,
            reused_by: 1,
        }
    }
}

impl Paths {
    /// Leaves out the light of paths of more than `segments` segments: 1 is what is seen directly, 2 adds what is lit
    /// directly. The picture is darker then; that is the price of a fixed length, and not to be seen in
    /// any error bar.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for 0.
    pub fn longest(mut self, segments: u32) -> Result<Self, Error> {
        if segments == 0 {
            return Err(Error::refused("number of segments", "at least 1", segments));
        }
        self.longest = segments;
        Ok(self)
    }

    /// Plays Russian roulette after every segment from this one on. The probability of survival is the largest
    /// component of what the path still carries, and 0.95 at most; what refraction takes from it or
    /// adds to it does not count, since the way out of the glass gives it back.
    pub fn roulette_from(mut self, segment: u32) -> Self {
        self.roulette = Rule::of_throughput(segment);
        self
    }

    /// Leaves out of the picture what emits light, but not its light: the camera looks through shapes that shine, where it sees them directly, and
    /// sees nothing where it would see what is around the scene, be it through holes and thin glass. Shapes that shine are seen through these.
    pub fn hiding_lights(mut self) -> Self {
        self.hides_lights = true;
        self
    }

    /// The same, but for what is around the scene where it is seen through holes and thin glass, as Mitsuba's `direct` has it.
    #[cfg(feature = "mitsuba")]
    pub(crate) fn hiding_lights_in_front(mut self) -> Self {
        self.hides_lights = true;
        self.hides_in_front_alone = true;
        self
    }

    /// Reuses each path for `pixels` of a picture, 1 to 16, where means of many are computed at once: in
    /// [`View::averages`](super::View::averages), [`averages_in_two`](super::View::averages_in_two) and
    /// [`render_points`](super::View::render_points). All else, a pixel as an integrand among it, has paths of its own, as with 1.[^bekaert]
    ///
    /// The light that leaves the second point of a path goes to the first points of all paths of the same number of the pixels that go together,
    /// as far as they see it: without bias, since a path from there might have come to it. Pixels that go together are drawn, always the same ones, from a run of
    /// [columns](Self::columns_together) of one row, among those with as many points. What is gained is the variance of light that is scattered at least
    /// twice, ideally diffusely where it is reused; the price is a ray for each other pixel. Nothing is gained where light from lamps and from the sky is all that
    /// there is, or where nothing is ideally diffuse.
    ///
    /// The error of a pixel is told as before, but pixels that go together are no longer independent of one another: they err alike. So the error of a
    /// mean over a run of them is larger than those of the pixels say.
    ///
    /// ```
    /// use estimand::path::{Image, scenes};
    /// use estimand::points::Rescrambled;
    ///
    /// // The radiance is 1 everywhere.
    /// let (mut view, size) = (scenes::furnace(), [32, 32]);
    /// let truth = Image::new(32, vec![[1.0; 3].into(); 32 * 32])?;
    /// let alone = view.render_points(size, 1, 16, |key| Rescrambled::new(4, key), |_| true)?;
    /// view.paths = view.paths.reused_by(8)?;
    /// let together = view.render_points(size, 1, 16, |key| Rescrambled::new(4, key), |_| true)?;
    /// assert!(together.rmse(&truth)? < 0.8 * alone.rmse(&truth)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for none, and for more than 16.
    ///
    /// [^bekaert]: Bekaert, Philippe; Sbert, Mateu; Halton, John (2002). *Accelerating Path Tracing by Re-Using Paths*.
    ///     <https://doi.org/10.2312/EGWR/EGWR02/125-134>
    pub fn reused_by(mut self, pixels: u32) -> Result<Self, Error> {
        if pixels == 0 || pixels as usize > MOST {
            let what = "number of pixels that reuse a path";
            return Err(Error::refused(what, "from 1 to 16", pixels));
        }
        self.reused_by = pixels;
        Ok(self)
    }

    /// How many columns the pixels that go together are drawn from, from a multiple of this on; 1 if paths are not [reused](Self::reused_by).
    pub fn columns_together(&self) -> u32 {
        match self.reused_by {
            1 => 1,
            pixels => pixels * SPREAD,
        }
    }

    /// The radiance that arrives at the origin of `ray` from its direction: an estimate, whose mean over the
    /// coordinates of `u` is the solution of the rendering equation.[^kajiya]
    ///
    /// The coordinates are read in this order. At every surface: those of the [lights](Light) and those of the
    /// [environment](Environment), unless the surface scatters to single directions only; for the next direction as
    /// many as the law of scattering draws; by default from the fifth segment on one for Russian roulette.
    ///
    /// [^kajiya]: Kajiya, James (1986). *The Rendering Equation*. <https://doi.org/10.1145/15886.15902>
    #[inline]
    pub fn radiance<B: Bsdf, L: Light, E: Environment, S: Sampler>(
        &self,
        scene: &Scene<B, L, E>,
        ray: Ray,
        u: &mut S,
    ) -> Vec3 {
        self.witnessed(scene, ray, u, &mut ())
    }

    /// The same, with somebody who looks on.
    #[inline]
    pub(in crate::path) fn witnessed<B: Bsdf, L: Light, E: Environment, S: Sampler>(
        &self,
        scene: &Scene<B, L, E>,
        mut ray: Ray,
        u: &mut S,
        witness: &mut (impl Witness + ?Sized),
    ) -> Vec3 {
        let mut radiance = Vec3A::ZERO;
        if self.hides_lights {
            ray = scene.past_lights(ray);
        }
        // What a unit of radiance at the end of the path adds to the pixel.
        let mut throughput = Vec3A::ONE;
        // The density with which the direction of the ray was drawn. The camera's is no choice.
        let mut density = f32::INFINITY;
        let mut eta = 1.0;
        // Whether what is around would be seen directly, and is not to be.
        let mut hidden = self.hides_lights;
        for segment in 1.. {
            let Some(vertex) = scene.meet(&ray) else {
                let emission = scene.environment().emitted(ray.direction);
                if !hidden {
                    radiance += throughput * emission.radiance * power(density, emission.density);
                }
                break;
            };
            // Emitted light, met by a direction that was drawn at the surface before.
            if let Some(emitter) = vertex.emitter {
                let lights = scene.lights();
                let emission = lights.emitted(emitter, ray.origin, vertex.place());
                radiance += throughput * emission.radiance * power(density, emission.density);
            }
            if segment >= self.longest {
                break;
            }
            let (surface, bsdf) = (&vertex.surface, vertex.bsdf);
            let out = -ray.direction;
            let diffuse = || Diffuse::of(&vertex, out);
            witness.scatters(segment, &diffuse, &mut throughput, &mut radiance);
            // Next-event estimation: light met by drawing a point of the lights, and one of what is around.
            if !bsdf.is_delta() {
                let area = scene.lights().sample(surface, u);
                let around = scene.environment().sample(surface, u);
                for light in [area, around].into_iter().flatten() {
                    let scattering = bsdf.evaluate(surface, out, light.way.ray.direction);
                    if scattering.density > 0.0 && !scene.occluded(&light.way) {
                        let weight = power(light.density, scattering.density);
                        radiance += throughput * scattering.value * light.weight * weight;
                    }
                }
            }
            // All other light, by drawing a direction.
            let Some(next) = bsdf.sample(surface, out, u) else {
                break;
            };
            hidden = hidden && !self.hides_in_front_alone && next.passes(surface.normal, out);
            throughput *= next.weight;
            eta *= next.eta;
            let carried = throughput.max_element() * (eta * eta);
            let mut weight = 1.0;
            if segment >= self.roulette.from {
                let Some(survivor) = self.roulette.play(segment, carried, u) else {
                    break;
                };
                weight = survivor;
                throughput *= weight;
            }
            witness.goes_on(segment, carried, weight, radiance);
            density = next.density;
            ray = Ray {
                origin: surface.leave(next.direction),
                direction: next.direction,
            };
        }
        radiance.into()
    }
}

/// The weight of a sample that was drawn with density `own`, where another technique has the density `other`: the
/// power heuristic, as [`Heuristic::Power`](crate::integrands::Heuristic::Power) has it, in `f32`. The density of a direction
/// without alternative is infinite, its weight 1.
#[inline]
pub(super) fn power(own: f32, other: f32) -> f32 {
    if !(own > 0.0) {
        return 0.0;
    }
    let ratio = if own == other { 1.0 } else { other / own };
    1.0 / (1.0 + ratio * ratio)
}
