//! Lights that are drawn by solid angle where they are near, one lane after the other.

use pulp::Simd;

use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::light::AreaLights;
use crate::path::shape::{Flat, Primitive};

/// The lights, by the number of their shape.
#[derive(Debug)]
pub(super) struct Near {
    flats: Vec<Option<Flat>>,
}

/// A point of a light a lane, and its density per solid angle given the light.
pub(super) struct Drawn<S: Simd> {
    pub(super) point: Vector<S>,
    pub(super) density: Real<S>,
}

impl Near {
    /// `None` if all lights are drawn from the area, wherever they are. `numbers` are those of the shapes of the lights.
    pub(super) fn new(numbers: &[u32], lights: &AreaLights) -> Option<Self> {
        let mut flats = Vec::new();
        for (&number, shape) in numbers.iter().zip(lights.shapes()) {
            if let Primitive::Flat(flat) = shape
                && flat.is_by_solid_angle()
            {
                let number = number as usize;
                flats.resize(flats.len().max(number + 1), None);
                flats[number] = Some(*flat);
            }
        }
        (!flats.is_empty()).then_some(Self { flats })
    }

    #[inline(always)]
    fn flat(&self, shapes: &Row<u32>, lane: usize) -> Option<&Flat> {
        self.flats.get(shapes.0[lane] as usize)?.as_ref()
    }

    /// The points that `u` draws from the lights `shapes`, as `from` sees them: `far` but where they are near.
    #[inline(always)]
    pub(super) fn sample<S: Simd>(
        &self,
        shapes: &Row<u32>,
        active: Mask<S>,
        from: Vector<S>,
        [a, b]: [Real<S>; 2],
        far: Drawn<S>,
    ) -> Drawn<S> {
        let simd = a.simd();
        let active = active.row(simd);
        let (from, mut point) = (from.rows(), far.point.rows());
        let (a, b, mut density) = (a.row(), b.row(), far.density.row());
        for lane in (0..WIDEST).filter(|&lane| active.0[lane] > 0.0) {
            let near = self.flat(shapes, lane).and_then(|flat| {
                flat.sample_near(Row::vector(&from, lane), [a.0[lane], b.0[lane]])
            });
            if let Some((there, drawn)) = near {
                Row::set_vector(&mut point, lane, there);
                density.0[lane] = drawn;
            }
        }
        Drawn {
            point: Vector::load(simd, &point),
            density: Real::load(simd, &density),
        }
    }

    /// The densities with which points of the lights `shapes` are drawn, as `from` sees them: `far` but where they are near.
    #[inline(always)]
    pub(super) fn density<S: Simd>(
        &self,
        shapes: &Row<u32>,
        active: Mask<S>,
        from: Vector<S>,
        far: Real<S>,
    ) -> Real<S> {
        let simd = far.simd();
        let active = active.row(simd);
        let (from, mut density) = (from.rows(), far.row());
        for lane in (0..WIDEST).filter(|&lane| active.0[lane] > 0.0) {
            let near = self
                .flat(shapes, lane)
                .and_then(|flat| flat.density_near(Row::vector(&from, lane)));
            if let Some(drawn) = near {
                density.0[lane] = drawn;
            }
        }
        Real::load(simd, &density)
    }
}
