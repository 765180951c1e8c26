//! Sources without size, as many points see them at once, one a lane, with the bits of single ones.

use core::f32::consts::TAU;

use glam::Vec3A;
use pulp::{Arch, Simd, WithSimd};

use super::{Background, Place, Source, Surroundings, choose, worth};
use crate::path::frame::lanes::turns;
use crate::path::lanes::{Mask, Row, Vector, WIDEST};
use crate::path::light::{Environment, SpotLight};

/// The most sources that are seen at once.
const MOST: usize = 16;

/// What arrives from the sources that some lanes have chosen.
pub(in crate::path) struct Chosen {
    /// The irradiance on a surface that faces it, over the probability of the choice; black where nothing arrives.
    pub(in crate::path) weight: [Row<f32>; 3],
    /// Where it comes from: the direction to it if it is far away, the place otherwise.
    pub(in crate::path) from: [Row<f32>; 3],
    /// 1 where it is far away, 0 elsewhere.
    pub(in crate::path) far: Row<f32>,
}

impl Surroundings {
    /// The radiance all around, if all sources are seen in lanes and nothing else is asked for.
    pub(in crate::path) fn around_in_lanes(&self) -> Option<Vec3A> {
        let known = |source: &Source| match source {
            Source::Point(_) | Source::Directional(_) => true,
            Source::Spot(spot) => spot.slide.is_none(),
            Source::Projector(_) => false,
        };
        let few = (1..=MOST).contains(&self.sources.len());
        match &self.background {
            _ if !(few && self.sources.iter().all(known)) => None,
            Background::None => Some(Vec3A::ZERO),
            Background::Constant(constant) => constant.constant(),
            Background::Sky(_) => None,
        }
    }

    /// Whether there are several sources, among which a coordinate chooses.
    pub(in crate::path) fn are_several(&self) -> bool {
        self.sources.len() > 1
    }

    /// The sources that coordinates choose in the active lanes, for surfaces at some points. No more than [`MOST`].
    #[inline(never)]
    pub(in crate::path) fn chosen_in_lanes(
        &self,
        arch: Arch,
        points: &[Row<f32>; 3],
        active: &Row<f32>,
        u: &[f64; WIDEST],
    ) -> Chosen {
        let mut arriving = [Arriving::NOTHING; MOST];
        arch.dispatch(Look {
            sources: &self.sources,
            points,
            arriving: &mut arriving,
        });
        let mut chosen = Chosen {
            weight: [Row::<f32>::ZERO; 3],
            from: [Row::<f32>::ZERO; 3],
            far: Row::<f32>::ZERO,
        };
        let arriving = &arriving[..self.sources.len().min(MOST)];
        for lane in (0..WIDEST).filter(|&lane| active.0[lane] > 0.0) {
            let worths = arriving.iter().map(|one| one.worth.0[lane]);
            let Some((source, factor)) = choose(worths, u[lane]) else {
                continue;
            };
            let weight = Row::vector(&arriving[source].weight, lane) * factor;
            Row::set_vector(&mut chosen.weight, lane, weight);
            let (from, far) = match self.sources[source].place() {
                Place::Near(position) => (position, 0.0),
                Place::Far(direction) => (direction, 1.0),
            };
            Row::set_vector(&mut chosen.from, lane, from);
            chosen.far.0[lane] = far;
        }
        chosen
    }
}

/// What arrives from one source, and what it is worth.
#[derive(Clone, Copy)]
struct Arriving {
    weight: [Row<f32>; 3],
    worth: Row<f32>,
}

impl Arriving {
    const NOTHING: Self = Self {
        weight: [Row::<f32>::ZERO; 3],
        worth: Row::<f32>::ZERO,
    };
}

struct Look<'a> {
    sources: &'a [Source],
    points: &'a [Row<f32>; 3],
    arriving: &'a mut [Arriving; MOST],
}

impl WithSimd for Look<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let point = Vector::load(simd, self.points);
        for (source, arriving) in self.sources.iter().zip(self.arriving) {
            let weight = match source {
                Source::Point(light) => {
                    let intensity = Vector::splat(simd, light.intensity);
                    from_point(point, Vector::splat(simd, light.position), intensity)
                }
                Source::Spot(light) => light.arriving_in_lanes(point),
                Source::Directional(light) => Vector::splat(simd, light.arriving()),
                // Of these nothing is told.
                Source::Projector(_) => Vector::splat(simd, Vec3A::ZERO),
            };
            weight.store(&mut arriving.weight);
            worth(weight.x, weight.y, weight.z).store(&mut arriving.worth);
        }
    }
}

/// As [`from_point`](super::super::point::from_point).
#[inline(always)]
fn from_point<S: Simd>(point: Vector<S>, position: Vector<S>, intensity: Vector<S>) -> Vector<S> {
    let toward = position - point;
    let squared = toward.dot(toward);
    let weight = intensity / squared;
    let lit = squared.gt(squared.all(0.0)) & is_finite(weight);
    lit.choose(weight, Vector::splat(squared.simd(), Vec3A::ZERO))
}

#[inline(always)]
fn is_finite<S: Simd>(vector: Vector<S>) -> Mask<S> {
    let most = vector.x.all(f32::MAX);
    vector.x.abs().le(most) & vector.y.abs().le(most) & vector.z.abs().le(most)
}

impl SpotLight {
    /// As [`arriving`](Self::arriving).
    #[inline(always)]
    fn arriving_in_lanes<S: Simd>(&self, point: Vector<S>) -> Vector<S> {
        let simd = point.x.simd();
        let (zero, one) = (point.x.all(0.0), point.x.all(1.0));
        let position = Vector::splat(simd, self.position);
        let toward = point - position;
        let inverse = 1.0 / toward.length();
        let apart = inverse.le(zero.all(f32::MAX)) & inverse.gt(zero);
        let toward = toward * apart.select(inverse, zero);
        let cosine = Vector::splat(simd, self.axis).dot(toward);
        let sine = ((1.0 - cosine) * (1.0 + cosine)).max(zero).sqrt();
        let angle = TAU * turns(sine, cosine);
        let falloff = ((self.cutoff - angle) * self.per_radian).max(zero).min(one);
        let falloff = cosine.ge(zero.all(self.full_cosine)).select(one, falloff);
        let inside = cosine.gt(zero.all(self.cutoff_cosine));
        let weight = from_point(
            point,
            position,
            Vector::splat(simd, self.intensity) * falloff,
        );
        inside.choose(weight, Vector::splat(simd, Vec3A::ZERO))
    }
}
