//! Mixtures of two laws.

use glam::Vec3A;

use super::{Law, Scattered, Scattering};
use crate::Sampler;
use crate::path::frame::single;
use crate::path::texture::{Parameter, Uniform};

/// A mixture of two laws.
///
/// One coordinate chooses one of them, then that one draws. Where a direction could have been drawn by either, its
/// density is that of both.[^veach] The weight of the second law is clamped to `[0, 1]`.
///
/// Mitsuba 3.9.1 adds the probability of a single direction, such as a mirror's, to the density of the other law. So what a
/// mirror reflects in a mixture with a darker law is too dark: of a white one with weight 0.3 over a diffuse 0.2, two thirds
/// remain from above. Ours is not.
///
/// [^veach]: Veach, Eric; Guibas, Leonidas (1995). *Optimally Combining Sampling Techniques for Monte Carlo Rendering*.
///     <https://doi.org/10.1145/218380.218498>
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend<L, P = Uniform> {
    weight: P,
    laws: [L; 2],
}

impl<L, P> Blend<L, P> {
    /// The fraction `1 - weight` of the first law and `weight` of the second.
    pub fn new(weight: P, laws: [L; 2]) -> Self {
        Self { weight, laws }
    }
}

impl<L: Law<Place = P::Place>, P: Parameter> Law for Blend<L, P> {
    type Place = P::Place;

    fn is_delta(&self) -> bool {
        self.laws.iter().all(Law::is_delta)
    }

    #[inline]
    fn evaluate(&self, place: &P::Place, out: Vec3A, into: Vec3A) -> Scattering {
        let weight = self.weight.number(place).clamp(0.0, 1.0);
        let [first, second] = &self.laws;
        let first = first.evaluate(place, out, into);
        let second = second.evaluate(place, out, into);
        Scattering {
            value: first.value * (1.0 - weight) + second.value * weight,
            density: first.density * (1.0 - weight) + second.density * weight,
        }
    }

    #[inline]
    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        let weight = self.weight.number(place).clamp(0.0, 1.0);
        let second = single(u.next_1d()) < weight;
        let (chosen, other) = if second { (1, 0) } else { (0, 1) };
        let fraction = if second { weight } else { 1.0 - weight };
        let scattered = self.laws[chosen].sample(place, out, u)?;
        if scattered.density == f32::INFINITY {
            return Some(scattered);
        }
        let other = self.laws[other].evaluate(place, out, scattered.direction);
        let own = fraction * scattered.density;
        let density = own + (1.0 - fraction) * other.density;
        let value = scattered.weight * own + other.value * (1.0 - fraction);
        (density > 0.0).then(|| Scattered {
            weight: value / density,
            density,
            ..scattered
        })
    }
}
