//! What is known of the shapes, and the shapes that paths are at.

use glam::Vec3A;
use pulp::Simd;

use super::optics::{DARK, Emitted, Optics};
use crate::path::geometry::FEW;
use crate::path::lanes::{Real, Row, Vector, WIDEST};
use crate::path::shape::Flat;

/// Room for as many shapes as are swept over: a power of two.
pub(super) const MOST: usize = FEW.next_power_of_two();

pub(super) type Column = [f32; MOST];

/// What is known of each flat shape.
#[derive(Debug)]
pub(super) struct Table {
    corner: [Column; 3],
    first_edge: [Column; 3],
    second_edge: [Column; 3],
    normal: [Column; 3],
    inset: [Column; 2],
    slant: Column,
    margin: Column,
    pub(super) area: Column,
    albedo: [Column; 3],
    radiance: [Column; 3],
    chance: Column,
    kind: Column,
    inner: Column,
    part: [u32; MOST],
}

pub(super) const NOTHING: Column = [0.0; MOST];

impl Table {
    pub(super) const EMPTY: Self = Self {
        corner: [NOTHING; 3],
        first_edge: [NOTHING; 3],
        second_edge: [NOTHING; 3],
        normal: [NOTHING; 3],
        inset: [NOTHING; 2],
        slant: NOTHING,
        margin: NOTHING,
        area: NOTHING,
        albedo: [NOTHING; 3],
        radiance: [NOTHING; 3],
        chance: [DARK; MOST],
        kind: NOTHING,
        inner: NOTHING,
        part: [0; MOST],
    };

    /// A flat shape, which is the part `part` of the scene.
    pub(super) fn set(&mut self, shape: usize, part: u32, flat: &Flat, optics: &Optics) {
        let radiance = match optics.emitted {
            Emitted::Flat(light) => light.radiance,
            Emitted::Nothing | Emitted::Asked => Vec3A::ZERO,
        };
        for axis in 0..3 {
            self.corner[axis][shape] = flat.corner[axis];
            self.first_edge[axis][shape] = flat.first_edge[axis];
            self.second_edge[axis][shape] = flat.second_edge[axis];
            self.normal[axis][shape] = flat.normal[axis];
            self.albedo[axis][shape] = optics.law.albedo[axis];
            self.radiance[axis][shape] = radiance[axis];
        }
        self.inset[0][shape] = flat.inset[0];
        self.inset[1][shape] = flat.inset[1];
        self.slant[shape] = flat.slant;
        self.margin[shape] = flat.margin;
        self.area[shape] = flat.area;
        self.chance[shape] = optics.emitted.chance();
        self.kind[shape] = optics.law.kind();
        self.inner[shape] = optics.law.inner();
        self.part[shape] = part;
    }

    /// The shapes of all lanes.
    #[inline(always)]
    pub(super) fn places<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Place<S> {
        let mut rows = Rows::EMPTY;
        for lane in 0..WIDEST {
            let shape = shapes.0[lane] as usize % MOST;
            for axis in 0..3 {
                rows.corner[axis].0[lane] = self.corner[axis][shape];
                rows.first_edge[axis].0[lane] = self.first_edge[axis][shape];
                rows.second_edge[axis].0[lane] = self.second_edge[axis][shape];
                rows.normal[axis].0[lane] = self.normal[axis][shape];
            }
            rows.margin.0[lane] = self.margin[shape];
            rows.chance.0[lane] = self.chance[shape];
        }
        Place {
            corner: Vector::load(simd, &rows.corner),
            first_edge: Vector::load(simd, &rows.first_edge),
            second_edge: Vector::load(simd, &rows.second_edge),
            normal: Vector::load(simd, &rows.normal),
            margin: Real::load(simd, &rows.margin),
            chance: Real::load(simd, &rows.chance),
        }
    }

    /// The same shape in all lanes.
    #[inline(always)]
    pub(super) fn place<S: Simd>(&self, simd: S, shape: u32) -> Place<S> {
        let shape = shape as usize % MOST;
        let vector = |columns: &[Column; 3]| {
            let [x, y, z] = columns;
            Vector::splat(simd, Vec3A::new(x[shape], y[shape], z[shape]))
        };
        Place {
            corner: vector(&self.corner),
            first_edge: vector(&self.first_edge),
            second_edge: vector(&self.second_edge),
            normal: vector(&self.normal),
            margin: Real::splat(simd, self.margin[shape]),
            chance: Real::splat(simd, self.chance[shape]),
        }
    }

    #[inline(always)]
    pub(super) fn number<S: Simd>(simd: S, column: &Column, shapes: &Row<u32>) -> Real<S> {
        let mut row = Row::<f32>::ZERO;
        for (number, &shape) in row.0.iter_mut().zip(&shapes.0) {
            *number = column[shape as usize % MOST];
        }
        Real::load(simd, &row)
    }

    #[inline(always)]
    fn vector<S: Simd>(simd: S, [x, y, z]: &[Column; 3], shapes: &Row<u32>) -> Vector<S> {
        Vector {
            x: Self::number(simd, x, shapes),
            y: Self::number(simd, y, shapes),
            z: Self::number(simd, z, shapes),
        }
    }

    /// What the one light emits, in all lanes.
    #[inline(always)]
    pub(super) fn light<S: Simd>(&self, simd: S, shape: usize) -> Vector<S> {
        let [r, g, b] = &self.radiance;
        Vector::splat(simd, Vec3A::new(r[shape], g[shape], b[shape]))
    }

    #[inline(always)]
    pub(super) fn albedo<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Vector<S> {
        Self::vector(simd, &self.albedo, shapes)
    }

    #[inline(always)]
    pub(super) fn radiance<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Vector<S> {
        Self::vector(simd, &self.radiance, shapes)
    }

    #[inline(always)]
    pub(super) fn area<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Real<S> {
        Self::number(simd, &self.area, shapes)
    }

    #[inline(always)]
    pub(super) fn slant<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Real<S> {
        Self::number(simd, &self.slant, shapes)
    }

    #[inline(always)]
    pub(super) fn kind<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Real<S> {
        Self::number(simd, &self.kind, shapes)
    }

    /// Which part of the scene the shapes are.
    #[inline(always)]
    pub(super) fn parts(&self, shapes: &Row<u32>) -> Row<u32> {
        Row(shapes.0.map(|shape| self.part[shape as usize % MOST]))
    }

    #[inline(always)]
    pub(super) fn inner<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> Real<S> {
        Self::number(simd, &self.inner, shapes)
    }

    #[inline(always)]
    pub(super) fn inset<S: Simd>(&self, simd: S, shapes: &Row<u32>) -> [Real<S>; 2] {
        let [first, second] = &self.inset;
        [
            Self::number(simd, first, shapes),
            Self::number(simd, second, shapes),
        ]
    }
}

/// A [`Place`] lane by lane.
struct Rows {
    corner: [Row<f32>; 3],
    first_edge: [Row<f32>; 3],
    second_edge: [Row<f32>; 3],
    normal: [Row<f32>; 3],
    margin: Row<f32>,
    chance: Row<f32>,
}

impl Rows {
    const EMPTY: Self = Self {
        corner: [Row::<f32>::ZERO; 3],
        first_edge: [Row::<f32>::ZERO; 3],
        second_edge: [Row::<f32>::ZERO; 3],
        normal: [Row::<f32>::ZERO; 3],
        margin: Row::<f32>::ZERO,
        chance: Row::<f32>::ZERO,
    };
}

/// A shape a lane.
#[derive(Clone, Copy)]
pub(super) struct Place<S: Simd> {
    pub(super) corner: Vector<S>,
    pub(super) first_edge: Vector<S>,
    pub(super) second_edge: Vector<S>,
    pub(super) normal: Vector<S>,
    pub(super) margin: Real<S>,
    /// The probability of the shape among the lights, 0 if the view is asked for its light; negative if it emits none.
    pub(super) chance: Real<S>,
}

impl<S: Simd> Place<S> {
    /// The point with the coordinates `s` and `t` along the edges.
    #[inline(always)]
    pub(super) fn at(&self, s: Real<S>, t: Real<S>) -> Vector<S> {
        self.corner + (self.first_edge * s + self.second_edge * t)
    }

    /// Where a ray that leaves `point` in `direction` must start.
    #[inline(always)]
    pub(super) fn leave(&self, point: Vector<S>, direction: Vector<S>) -> Vector<S> {
        point + self.normal * self.margin.copysign(self.normal.dot(direction))
    }

    /// The density per solid angle, seen from `from`, of a point drawn uniformly from the area.
    #[inline(always)]
    pub(super) fn density_of_area(
        &self,
        from: Vector<S>,
        point: Vector<S>,
        area: Real<S>,
    ) -> Real<S> {
        let offset = point - from;
        let squared = offset.dot(offset);
        let density = squared * squared.sqrt() / (self.normal.dot(offset).abs() * area);
        density.min(squared.all(f32::MAX))
    }
}
