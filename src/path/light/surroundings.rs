//! Several sources of light that are no shapes.

#[cfg(feature = "simd")]
mod lanes;

use core::ops::{Add, Mul};

use glam::Vec3A;

use super::{
    Constant, DirectionalLight, Emission, Environment, Illumination, PointLight, ProjectorLight,
    Sky, SpotLight,
};
use crate::path::color::LUMINANCE;
use crate::path::{Segment, Surface};
use crate::{Error, Sampler};

#[cfg(feature = "simd")]
pub(in crate::path) use lanes::Chosen;

/// A source of light without size.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A point that shines everywhere.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(Box<SpotLight>),
    /// Parallel light.
    Directional(DirectionalLight),
    /// A point that throws a picture.
    Projector(Box<ProjectorLight>),
}

impl Source {
    /// The light that arrives at the surface `from` if nothing is in the way; `None` if none does.
    #[inline]
    pub fn illuminate<D>(&self, from: &Surface<D>) -> Option<Illumination> {
        Illumination::without_size(self.arriving(from.point), || self.place().way(from))
    }

    /// The irradiance that a surface at `point` would have that faces it.
    #[inline]
    fn arriving(&self, point: Vec3A) -> Vec3A {
        match self {
            Self::Point(light) => light.arriving(point),
            Self::Spot(light) => light.arriving(point),
            Self::Directional(light) => light.arriving(),
            Self::Projector(light) => light.arriving(point),
        }
    }

    /// Where it is.
    #[inline]
    fn place(&self) -> Place {
        match self {
            Self::Point(light) => Place::Near(light.position),
            Self::Spot(light) => Place::Near(light.position),
            Self::Directional(light) => Place::Far(light.toward),
            Self::Projector(light) => Place::Near(light.position),
        }
    }
}

/// Where a source is.
enum Place {
    /// At a point.
    Near(Vec3A),
    /// In a direction.
    Far(Vec3A),
}

impl Place {
    /// The way to it.
    #[inline]
    fn way<D>(&self, from: &Surface<D>) -> Option<Segment> {
        match *self {
            Self::Near(position) => Segment::to_point(from, position),
            Self::Far(direction) => Some(Segment::along(from, direction)),
        }
    }
}

/// What is seen where a ray leaves the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Background {
    /// Nothing.
    None,
    /// The same everywhere.
    Constant(Constant),
    /// A picture.
    Sky(Box<Sky>),
}

/// Any number of sources without size, and a background.
///
/// At every surface one sample is drawn. A background that is a [`Sky`] takes half of them where there are sources too; among
/// the sources one is chosen in proportion to the luminance that it would have on the surface if nothing were in
/// the way. That takes time in proportion to their number.
///
/// One coordinate is drawn to choose, unless there is nothing to be chosen; then those of the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    sources: Vec<Source>,
    background: Background,
}

impl Surroundings {
    /// The given sources before the background.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for 2^32 sources or more.
    pub fn new(sources: Vec<Source>, background: Background) -> Result<Self, Error> {
        if u32::try_from(sources.len()).is_err() {
            let count = sources.len();
            return Err(Error::refused("number of sources", "below 2^32", count));
        }
        Ok(Self {
            sources,
            background,
        })
    }

    /// The probability with which a sample is one of the sky.
    #[inline]
    fn share_of_sky(&self) -> f64 {
        match (&self.background, self.sources.is_empty()) {
            (Background::Sky(_), true) => 1.0,
            (Background::Sky(_), false) => 0.5,
            _ => 0.0,
        }
    }

    /// One of the sources, chosen by the coordinate `u`, with its weight over the probability of the choice.
    #[inline]
    fn choose_for<D>(&self, from: &Surface<D>, u: f64) -> Option<Illumination> {
        let arriving = |source: &Source| source.arriving(from.point);
        let worths = self.sources.iter().map(|source| {
            let weight = arriving(source);
            worth(weight.x, weight.y, weight.z)
        });
        let (chosen, factor) = choose(worths, u)?;
        let source = &self.sources[chosen];
        Illumination::without_size(arriving(source) * factor, || source.place().way(from))
    }
}

/// What an irradiance is worth when a source is chosen: half its luminance, which is finite.
#[inline(always)]
fn worth<T: Mul<f32, Output = T> + Add<Output = T>>(red: T, green: T, blue: T) -> T {
    red * (0.5 * LUMINANCE.x) + green * (0.5 * LUMINANCE.y) + blue * (0.5 * LUMINANCE.z)
}

/// The place of one that the coordinate `u` chooses in proportion to what they are `worth`, and one over the probability of it.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn choose(worths: impl Iterator<Item = f32> + Clone, u: f64) -> Option<(usize, f32)> {
    let sum: f64 = worths.clone().map(f64::from).sum();
    let target = u * sum;
    let (mut before, mut chosen) = (0.0, None);
    for (place, worth) in worths.enumerate() {
        let worth = f64::from(worth);
        if worth > 0.0 && before <= target {
            chosen = Some((place, worth));
        }
        before += worth;
    }
    chosen.map(|(place, worth)| (place, (sum / worth) as f32))
}

impl Environment for Surroundings {
    fn constant(&self) -> Option<Vec3A> {
        match &self.background {
            Background::None if self.sources.is_empty() => Some(Vec3A::ZERO),
            Background::Constant(constant) if self.sources.is_empty() => constant.constant(),
            _ => None,
        }
    }

    fn as_surroundings(&self) -> Option<&Surroundings> {
        Some(self)
    }

    fn as_sky(&self) -> Option<&Sky> {
        match &self.background {
            Background::Sky(sky) if self.sources.is_empty() => Some(sky),
            _ => None,
        }
    }

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "a half or one")]
    fn emitted(&self, direction: Vec3A) -> Emission {
        match &self.background {
            Background::None => Emission::NONE,
            Background::Constant(constant) => constant.emitted(direction),
            Background::Sky(sky) => {
                let emission = sky.emitted(direction);
                Emission {
                    density: emission.density * self.share_of_sky() as f32,
                    ..emission
                }
            }
        }
    }

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "a half or one")]
    fn sample<D, S: Sampler>(&self, from: &Surface<D>, u: &mut S) -> Option<Illumination> {
        let share = self.share_of_sky();
        let choice = if share == 1.0 || (share == 0.0 && self.sources.len() < 2) {
            0.0
        } else {
            u.next_1d()
        };
        if choice < share
            && let Background::Sky(sky) = &self.background
        {
            let light = sky.sample(from, u)?;
            let share = share as f32;
            return Some(Illumination {
                weight: light.weight / share,
                density: light.density * share,
                ..light
            });
        }
        let light = self.choose_for(from, (choice - share) / (1.0 - share))?;
        Some(Illumination {
            weight: light.weight / (1.0 - share) as f32,
            ..light
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Independent, PointSet};
    use glam::DMat3;

    /// The mean weight of samples above a plane is the sum of what all sources give.
    #[test]
    fn choosing_sources_keeps_their_sum() {
        let from = Surface {
            point: Vec3A::new(0.1, 0.2, 0.3),
            normal: Vec3A::Y,
            margin: 0.0,
            detail: (),
        };
        let sources = vec![
            Source::Point(PointLight::new([0.0, 2.0, 0.0], [4.0, 2.0, 1.0]).unwrap()),
            Source::Directional(DirectionalLight::new([0.5, -1.0, 0.2], [0.3, 0.5, 0.9]).unwrap()),
            Source::Point(PointLight::new([3.0, 1.0, 0.0], [0.0; 3]).unwrap()),
            Source::Spot(Box::new(
                SpotLight::new([0.0, 3.0, 1.0], [0.0, -1.0, -0.2], [9.0; 3], 10.0, 40.0).unwrap(),
            )),
        ];
        let all: Vec3A = sources
            .iter()
            .filter_map(|source| source.illuminate(&from))
            .map(|light| light.weight)
            .sum();
        let sky = Sky::new(2, &[[0.5, 1.0, 2.0]; 6], DMat3::IDENTITY).unwrap();
        let four_pi = 4.0 * core::f32::consts::PI;
        let points = Independent::new(1);
        for (background, more) in [
            (Background::None, Vec3A::ZERO),
            (
                Background::Constant(Constant::new([1.0; 3]).unwrap()),
                Vec3A::ZERO,
            ),
            (
                Background::Sky(Box::new(sky)),
                Vec3A::new(0.5, 1.0, 2.0) * four_pi,
            ),
        ] {
            let lights = Surroundings::new(sources.clone(), background).unwrap();
            let count: u32 = 1 << 16;
            let (mut sum, mut squares) = (Vec3A::ZERO, Vec3A::ZERO);
            for index in 0..count {
                let mut u = points.point(index.into());
                let Some(light) = lights.sample(&from, &mut u) else {
                    continue;
                };
                let weight = light.weight / count as f32;
                sum += weight;
                squares += light.weight * weight;
            }
            let error = ((squares - sum * sum) / count as f32).map(|v| v.max(0.0).sqrt());
            let off = (sum - (all + more)).abs();
            // Five standard errors, and the rounding of the sum: exceeded with a probability of 6e-7 in each of 9 cases.
            let bound = error * 5.0 + (all + more) * 1e-4;
            assert!(off.cmple(bound).all(), "{sum} {}", all + more);
        }
    }

    #[test]
    fn a_coordinate_chooses_by_worth() {
        let last = 1.0 - 0.5 * f64::EPSILON;
        let of = |worths: &[f32], u| choose(worths.iter().copied(), u);
        for (u, chosen) in [
            (0.0, (1, 4.0)),
            (0.249, (1, 4.0)),
            (0.25, (3, 4.0 / 3.0)),
            (last, (3, 4.0 / 3.0)),
        ] {
            assert_eq!(of(&[0.0, 1.0, 0.0, 3.0, 0.0], u), Some(chosen), "{u}");
        }
        for u in [0.0, last] {
            assert_eq!(
                (of(&[2.0], u), of(&[0.0; 2], u), of(&[], u)),
                (Some((0, 1.0)), None, None)
            );
        }
        let most = worth(f32::MAX, f32::MAX, f32::MAX);
        assert!(most.is_finite());
        assert_eq!(of(&[most, most], 0.5), Some((1, 2.0)));
    }

    #[test]
    fn a_spot_ends_at_its_angle() {
        let spot = SpotLight::new([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [2.0; 3], 30.0, 60.0).unwrap();
        let at = |degrees: f32| {
            let point = Vec3A::new(degrees.to_radians().tan(), 0.0, 0.0);
            let surface = Surface {
                point,
                normal: Vec3A::Y,
                margin: 0.0,
                detail: (),
            };
            let light = spot.illuminate(&surface);
            light.map_or(0.0, |light| light.weight.x * (1.0 + point.x * point.x))
        };
        assert!((at(0.0) - 2.0).abs() < 1e-5);
        assert!((at(29.0) - 2.0).abs() < 1e-5);
        assert!((at(45.0) - 1.0).abs() < 1e-5);
        assert_eq!(at(61.0), 0.0);
        for (full, cutoff) in [(40.0, 30.0), (-1.0, 30.0), (0.0, 181.0), (f32::NAN, 30.0)] {
            assert!(SpotLight::new([0.0; 3], [1.0, 0.0, 0.0], [1.0; 3], full, cutoff).is_err());
        }
        assert!(SpotLight::new([0.0; 3], [0.0; 3], [1.0; 3], 1.0, 2.0).is_err());
        assert!(PointLight::new([f32::INFINITY; 3], [1.0; 3]).is_err());
        assert!(DirectionalLight::new([0.0; 3], [1.0; 3]).is_err());
    }
}
