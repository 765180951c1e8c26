//! Shapes that emit light.

use glam::Vec3A;

use super::{Emission, Emitter, Illumination, Light};
use crate::path::frame::singles;
#[cfg(feature = "simd")]
use crate::path::shape::Primitive;
use crate::path::shape::Shape;
use crate::path::{Segment, Surface};
use crate::{Error, Sampler};

/// Shapes that emit light from their outer sides; none at all is a number too.
///
/// Two coordinates draw a point, however many shapes there are: the first also chooses the shape, in
/// proportion to its power, and what is left of it is a coordinate again. How a shape draws its points is
/// [its own affair](Shape::sample).
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLights {
    emitters: Vec<Emitter>,
    choices: Vec<Choice>,
}

/// The probability of an emitter, and the sum of those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    probability: f64,
    before: f64,
}

impl Choice {
    /// A density given the choice, times the probability of the choice.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
    fn times(self, density: f32) -> f32 {
        self.probability as f32 * density
    }
}

impl AreaLights {
    /// No lights.
    pub(in crate::path) const NONE: Self = Self {
        emitters: Vec::new(),
        choices: Vec::new(),
    };

    /// Whether an emitter is [plain](Emitter::is_plain).
    #[cfg(feature = "simd")]
    pub(in crate::path) fn is_plain(&self, emitter: u32) -> bool {
        self.emitters[emitter as usize].is_plain()
    }

    /// The probability with which an emitter is chosen.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn probability(&self, emitter: u32) -> f32 {
        self.choices[emitter as usize].times(1.0)
    }

    /// What an emitter emits; of a picture the mean.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn radiance(&self, emitter: u32) -> Vec3A {
        self.emitters[emitter as usize].radiance
    }

    /// The shapes of the emitters.
    #[cfg(feature = "simd")]
    pub(in crate::path) fn shapes(&self) -> impl Iterator<Item = &Primitive> {
        self.emitters.iter().map(|emitter| &emitter.shape)
    }

    /// Which emitter the coordinate chooses, and what is left of the coordinate.
    #[inline]
    pub(in crate::path) fn choose(&self, u: f64) -> (usize, f64) {
        let [_, rest @ ..] = &self.choices[..] else {
            return (0, u);
        };
        if rest.is_empty() {
            return (0, u);
        }
        let chosen = rest.partition_point(|choice| choice.before <= u);
        let Choice {
            probability,
            before,
        } = self.choices[chosen];
        (chosen, ((u - before) / probability).clamp(0.0, 1.0))
    }

    /// The way to the point that coordinates draw of an emitter.
    #[inline]
    pub(in crate::path) fn drawn<D>(
        &self,
        chosen: usize,
        from: &Surface<D>,
        u: [f32; 2],
    ) -> Option<Illumination> {
        let emitter = self.emitters.get(chosen)?;
        let drawn = emitter.shape.sample_with_density(from.point, u);
        let (there, density) = (drawn.0, self.choices[chosen].times(drawn.1));
        let lit = there.normal.dot(from.point - there.point) > 0.0;
        if !(lit && density > 0.0 && density < f32::MAX) {
            return None;
        }
        Some(Illumination {
            way: Segment::between(from, &there)?,
            weight: emitter.radiance_at(&there) * density.recip(),
            density,
        })
    }
}

impl Light for AreaLights {
    fn new(emitters: Vec<Emitter>) -> Result<Self, Error> {
        let total: f64 = emitters.iter().map(Emitter::power).sum();
        if !(emitters.is_empty() || total > 0.0 && total.is_finite()) {
            return Err(Error::refused(
                "power of all lights together",
                "positive and finite",
                total,
            ));
        }
        let choices = emitters
            .iter()
            .scan(0.0, |sum, emitter| {
                let (before, probability) = (*sum, emitter.power() / total);
                *sum += probability;
                Some(Choice {
                    probability,
                    before,
                })
            })
            .collect();
        Ok(Self { emitters, choices })
    }

    /// Not without emitters: coordinates are drawn all the same then, which paths at once do only if they ask.
    fn as_area_lights(&self) -> Option<&Self> {
        (!self.emitters.is_empty()).then_some(self)
    }

    #[inline]
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination> {
        let [a, b] = u.next_2d();
        let (chosen, a) = self.choose(a);
        self.drawn(chosen, from, singles([a, b]))
    }

    #[inline]
    fn emitted(&self, emitter: u32, from: Vec3A, surface: &Surface) -> Emission {
        let choice = self.choices[emitter as usize];
        let emitter = &self.emitters[emitter as usize];
        if surface.normal.dot(from - surface.point) <= 0.0 {
            return Emission::NONE;
        }
        Emission {
            radiance: emitter.radiance_at(surface),
            density: choice.times(emitter.shape.density(from, surface)),
        }
    }
}
