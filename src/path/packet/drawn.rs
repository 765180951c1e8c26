//! What paths draw one lane after the other.

use glam::{Vec2, Vec3A};
use pulp::Simd;

use super::Single;
use super::here::Here;
use super::lamp::Lamp;
use super::solids::Names;
use crate::path::bsdf::Scattered;
use crate::path::geometry::Hit;
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::light::{Chosen, Emission, Illumination, Seen};
use crate::path::segment::End;
use crate::path::{Surface, gamma};

/// Weights and densities, and the directions they belong to where those were drawn.
pub(super) struct Weights {
    direction: [Row<f32>; 3],
    weight: [Row<f32>; 3],
    density: Row<f32>,
}

impl Weights {
    const NONE: Self = Self {
        direction: [Row::<f32>::ZERO; 3],
        weight: [Row::<f32>::ZERO; 3],
        density: Row::<f32>::ZERO,
    };

    #[inline(always)]
    fn set(&mut self, lane: usize, weight: Vec3A, density: f32) {
        Row::set_vector(&mut self.weight, lane, weight);
        self.density.0[lane] = density;
    }

    /// What comes from all around against the directions of the active lanes.
    #[inline(never)]
    pub(super) fn background(
        single: &dyn Single,
        directions: &[Row<f32>; 3],
        active: &Row<f32>,
    ) -> Self {
        Self::of(active, |lane| {
            let Emission { radiance, density } = single.background(Row::vector(directions, lane));
            (radiance, density)
        })
    }

    /// The weights and densities of the active lanes.
    #[inline(always)]
    fn of(active: &Row<f32>, one: impl Fn(usize) -> (Vec3A, f32)) -> Self {
        let mut weights = Self::NONE;
        for lane in (0..WIDEST).filter(|&lane| active.0[lane] > 0.0) {
            let (weight, density) = one(lane);
            weights.set(lane, weight, density);
        }
        weights
    }

    #[inline(always)]
    pub(super) fn direction<S: Simd>(&self, simd: S) -> Vector<S> {
        Vector::load(simd, &self.direction)
    }

    #[inline(always)]
    pub(super) fn weight<S: Simd>(&self, simd: S) -> Vector<S> {
        Vector::load(simd, &self.weight)
    }

    #[inline(always)]
    pub(super) fn density<S: Simd>(&self, simd: S) -> Real<S> {
        Real::load(simd, &self.density)
    }
}

impl Seen {
    /// The way to the light.
    #[inline(always)]
    pub(super) fn lamp<S: Simd>(&self, simd: S, here: &Here<'_, S>, active: Mask<S>) -> Lamp<S> {
        let density = Real::load(simd, &self.density);
        let active = active & density.gt(Real::splat(simd, 0.0));
        let into = Vector::load(simd, &self.direction);
        Lamp {
            start: here.place.leave(here.point, into),
            into,
            limit: Real::splat(simd, f32::INFINITY),
            weight: Vector::load(simd, &self.radiance) / density,
            density: active.select(density, Real::splat(simd, 1.0)),
            active,
        }
    }
}

impl Chosen {
    /// The way to the light.
    #[inline(always)]
    pub(super) fn lamp<S: Simd>(&self, simd: S, here: &Here<'_, S>, active: Mask<S>) -> Lamp<S> {
        let zero = Real::splat(simd, 0.0);
        let far = Real::load(simd, &self.far).gt(zero);
        let (from, weight) = (
            Vector::load(simd, &self.from),
            Vector::load(simd, &self.weight),
        );
        let toward = far.choose(from, from - here.point);
        let start = here.place.leave(here.point, toward);
        let way = from - start;
        let length = way.length();
        let any = weight.max_element().gt(zero);
        let active = active & any & (far | length.gt(zero));
        let endless = Real::splat(simd, f32::INFINITY);
        Lamp {
            start,
            into: far.choose(from, way * (1.0 / length)),
            limit: far.select(endless, length * (1.0 - gamma(8))),
            weight,
            density: endless,
            active,
        }
    }
}

/// Light that points may get, which the view was asked for.
pub(super) struct Illuminated {
    start: [Row<f32>; 3],
    limit: Row<f32>,
    /// 1 where the way to it ends at no surface.
    open: Row<f32>,
    /// The way to it.
    light: Weights,
}

impl Illuminated {
    pub(super) const NONE: Self = Self {
        start: [Row::<f32>::ZERO; 3],
        limit: Row::<f32>::ZERO,
        open: Row::<f32>::ZERO,
        light: Weights::NONE,
    };

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, light: Option<Illumination>) {
        if let Some(Illumination {
            way,
            weight,
            density,
        }) = light
        {
            Row::set_vector(&mut self.start, lane, way.ray.origin);
            self.limit.0[lane] = way.length;
            self.open.0[lane] = f32::from(u8::from(way.end() == End::Open));
            Row::set_vector(&mut self.light.direction, lane, way.ray.direction);
            self.light.set(lane, weight, density);
        }
    }

    /// That at the ends of such ways.
    #[inline(always)]
    pub(super) fn lamp<S: Simd>(&self, simd: S, end: End, active: Mask<S>) -> Lamp<S> {
        let zero = Real::splat(simd, 0.0);
        let density = self.light.density(simd);
        let open = Real::load(simd, &self.open).gt(zero);
        let here = match end {
            End::Open => open,
            End::Surface => !open,
        };
        let active = active & here & density.gt(zero);
        Lamp {
            start: Vector::load(simd, &self.start),
            into: self.light.direction(simd),
            limit: Real::load(simd, &self.limit),
            weight: self.light.weight(simd),
            density: active.select(density, Real::splat(simd, 1.0)),
            active,
        }
    }
}

/// What laws of scattering draw that are not ideally diffuse.
pub(super) struct Scatters {
    pub(super) drawn: Weights,
    eta: Row<f32>,
    goes_on: Row<f32>,
}

impl Scatters {
    pub(super) const NONE: Self = Self {
        drawn: Weights::NONE,
        eta: Row::<f32>::ZERO,
        goes_on: Row::<f32>::ZERO,
    };

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, scattered: Option<Scattered>) {
        if let Some(scattered) = scattered {
            Row::set_vector(&mut self.drawn.direction, lane, scattered.direction);
            self.drawn.set(lane, scattered.weight, scattered.density);
            self.eta.0[lane] = scattered.eta;
            self.goes_on.0[lane] = 1.0;
        }
    }

    #[inline(always)]
    pub(super) fn eta<S: Simd>(&self, simd: S) -> Real<S> {
        Real::load(simd, &self.eta)
    }

    #[inline(always)]
    pub(super) fn goes_on<S: Simd>(&self, simd: S) -> Mask<S> {
        Real::load(simd, &self.goes_on).gt(Real::splat(simd, 0.0))
    }
}

/// What paths draw at their points.
pub(super) struct Draws {
    /// The shapes that are chosen among flat lights.
    pub(super) chosen: Row<u32>,
    /// Light of shapes and of what is around that is drawn one lane after the other.
    pub(super) lamp: Option<Illuminated>,
    pub(super) around: Option<Illuminated>,
    pub(super) sky: Option<Seen>,
    /// What chooses among sources without size.
    pub(super) choices: [f64; WIDEST],
    /// Where laws are not ideally diffuse.
    pub(super) scattered: Option<Scatters>,
}

/// The points that paths are at, to be asked lane by lane.
pub(super) struct Hits<'a> {
    pub(super) point: [Row<f32>; 3],
    pub(super) normal: [Row<f32>; 3],
    pub(super) margin: Row<f32>,
    pub(super) names: Names,
    /// The ways that the paths came.
    pub(super) direction: &'a [Row<f32>; 3],
}

impl Hits<'_> {
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize) -> Hit {
        Hit {
            part: self.names.part.0[lane] as usize,
            surface: Surface {
                point: Row::vector(&self.point, lane),
                normal: Row::vector(&self.normal, lane),
                margin: self.margin.0[lane],
                detail: (),
            },
            triangle: self.names.triangle.0[lane] as usize,
            along: Vec2::new(self.names.along[0].0[lane], self.names.along[1].0[lane]),
            copy: (self.names.copy.0[lane] as usize).checked_sub(1),
        }
    }

    #[inline(always)]
    pub(super) fn out(&self, lane: usize) -> Vec3A {
        -Row::vector(self.direction, lane)
    }

    /// What the lights at the active lanes emit towards `origin`.
    #[inline(never)]
    pub(super) fn emitted(
        &self,
        single: &dyn Single,
        origin: &[Row<f32>; 3],
        active: &Row<f32>,
    ) -> Weights {
        Weights::of(active, |lane| {
            let origin = Row::vector(origin, lane);
            let Emission { radiance, density } = single.emitted(&self.hit(lane), origin);
            (radiance, density)
        })
    }

    /// The albedos of the ideally diffuse laws at the active lanes, and 1 where the inner side scatters as the outer one does, 0 where it is
    /// black.
    #[inline(never)]
    pub(super) fn lambertian(&self, single: &dyn Single, active: &Row<f32>) -> Weights {
        Weights::of(active, |lane| match single.lambertian(&self.hit(lane)) {
            Some(law) => (law.albedo, f32::from(u8::from(law.has_inside()))),
            None => {
                debug_assert!(
                    false,
                    "a law that is ideally diffuse tells how at every point"
                );
                (Vec3A::ZERO, 0.0)
            }
        })
    }

    /// What the laws of the active lanes do for light from some directions.
    #[inline(never)]
    pub(super) fn evaluate(
        &self,
        single: &dyn Single,
        into: &[Row<f32>; 3],
        active: &Row<f32>,
    ) -> Weights {
        Weights::of(active, |lane| {
            let into = Row::vector(into, lane);
            let scattering = single.evaluate(&self.hit(lane), self.out(lane), into);
            (scattering.value, scattering.density)
        })
    }
}
