//! Which shapes the rays of all lanes meet.

mod rare;
mod round;

use glam::Vec3A;
use pulp::Simd;

use crate::path::geometry::{Kind, axis};
use crate::path::lanes::{Index, Mask, Real, Row, Vector};
use crate::path::shape::{Flat, Primitive};

use rare::{Nearest, Occluded, Rare};
use round::Ball;

/// The shapes, by how simple their equations are.
#[derive(Debug, Default)]
pub(super) struct Shapes {
    aligned: [Vec<Aligned>; 3],
    parallelograms: Vec<Numbered>,
    triangles: Vec<Numbered>,
    balls: Vec<(u32, Ball)>,
    rare: Rare,
}

/// A rectangle whose normal is the axis `k` and whose edges run along the axes `k + 1` and `k + 2`, modulo 3.
///
/// The same arithmetic as for any other, without what is multiplied by zero there.
#[derive(Clone, Copy, Debug)]
struct Aligned {
    shape: u32,
    corner: [f32; 3],
    /// The component of the dual vector along each edge's axis.
    dual: [f32; 2],
    range: Range,
    /// Whether the first edge runs along the axis `k + 2`.
    swapped: bool,
}

/// Any other shape.
#[derive(Clone, Copy, Debug)]
struct Numbered {
    shape: u32,
    corner: Vec3A,
    normal: Vec3A,
    dual: [Vec3A; 2],
    range: Range,
}

/// Where the coordinates along the edges are inside.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: [f32; 2],
    high: [f32; 2],
}

impl Range {
    fn of(flat: &Flat) -> Self {
        Self {
            low: flat.slack.map(|slack| -slack),
            high: flat.slack.map(|slack| 1.0 + slack),
        }
    }

    fn swapped(self) -> Self {
        let ([a, b], [c, d]) = (self.low, self.high);
        Self {
            low: [b, a],
            high: [d, c],
        }
    }
}

/// Where rays meet a shape.
#[derive(Clone, Copy)]
pub(super) struct Hit<S: Simd> {
    /// Infinite where none is met.
    pub(super) distance: Real<S>,
    /// The coordinates along the edges.
    pub(super) s: Real<S>,
    pub(super) t: Real<S>,
    pub(super) shape: Index<S>,
}

impl<S: Simd> Hit<S> {
    /// The numbers of the shapes, to be read lane by lane.
    #[inline(always)]
    pub(super) fn shapes(&self) -> Row<u32> {
        self.shape.row()
    }

    #[inline(always)]
    fn nearer(self, shape: u32, met: Meeting<S>) -> Self {
        let nearer = met.inside & met.distance.lt(self.distance);
        let number = Index::splat(met.distance.simd(), shape);
        Self {
            distance: nearer.select(met.distance, self.distance),
            s: nearer.select(met.s, self.s),
            t: nearer.select(met.t, self.t),
            shape: nearer.index(number, self.shape),
        }
    }
}

/// Where rays meet the plane of one shape.
#[derive(Clone, Copy)]
struct Meeting<S: Simd> {
    distance: Real<S>,
    s: Real<S>,
    t: Real<S>,
    /// Whether that is in front of the ray and within the shape.
    inside: Mask<S>,
}

impl Shapes {
    /// Adds a shape. Those of simpler [`Kind`] must have been added before.
    pub(super) fn push(&mut self, shape: u32, flat: &Flat) {
        match Kind::of(flat) {
            Kind::Aligned(normal) => {
                self.aligned[normal].push(Aligned::new(shape, flat, normal));
            }
            Kind::Parallelogram => self.parallelograms.push(Numbered::new(shape, flat)),
            Kind::Triangle => self.triangles.push(Numbered::new(shape, flat)),
        }
    }

    /// Adds a shape that is not flat. All flat ones must have been added before, spheres before disks, and those before cylinders.
    pub(super) fn push_round(&mut self, shape: u32, round: &Primitive) {
        match *round {
            Primitive::Flat(_) => unreachable!("flat shapes are others"),
            Primitive::Sphere(sphere) => self.balls.push((shape, Ball::new(&sphere))),
            Primitive::Disk(disk) => self.rare.disks.push((shape, disk)),
            Primitive::Cylinder(cylinder) => self.rare.cylinders.push((shape, cylinder)),
        }
    }

    /// The nearest shape in each lane.
    #[inline(always)]
    pub(super) fn nearest<S: Simd>(
        &self,
        simd: S,
        origin: Vector<S>,
        direction: Vector<S>,
    ) -> Hit<S> {
        let zero = Real::splat(simd, 0.0);
        let mut hit = Hit {
            distance: Real::splat(simd, f32::INFINITY),
            s: zero,
            t: zero,
            shape: Index::splat(simd, 0),
        };
        for (normal, aligned) in self.aligned.iter().enumerate() {
            if aligned.is_empty() {
                continue;
            }
            let (origin, direction) = (origin.turned(normal), direction.turned(normal));
            let inverse = 1.0 / direction.x;
            for rectangle in aligned {
                let met = rectangle.meet(simd, origin, direction, inverse);
                hit = hit.nearer(rectangle.shape, met);
            }
        }
        for flat in &self.parallelograms {
            hit = hit.nearer(flat.shape, flat.parallelogram(simd, origin, direction));
        }
        for flat in &self.triangles {
            hit = hit.nearer(flat.shape, flat.triangle(simd, origin, direction));
        }
        for (shape, ball) in &self.balls {
            hit = hit.nearer(*shape, ball.meet(simd, origin, direction));
        }
        if self.rare.is_empty() {
            return hit;
        }
        simd.vectorize(Nearest {
            rare: &self.rare,
            rays: [origin, direction],
            hit,
        })
    }

    /// Whether any shape is nearer than `limit`, or `blocked` holds already.
    #[inline(always)]
    pub(super) fn occluded<S: Simd>(
        &self,
        origin: Vector<S>,
        direction: Vector<S>,
        limit: Real<S>,
        mut blocked: Mask<S>,
    ) -> Mask<S> {
        let simd = limit.simd();
        for (normal, aligned) in self.aligned.iter().enumerate() {
            if aligned.is_empty() {
                continue;
            }
            let (origin, direction) = (origin.turned(normal), direction.turned(normal));
            let inverse = 1.0 / direction.x;
            for rectangle in aligned {
                let met = rectangle.meet(simd, origin, direction, inverse);
                blocked = blocked | (met.inside & met.distance.lt(limit));
            }
        }
        for flat in &self.parallelograms {
            let met = flat.parallelogram(simd, origin, direction);
            blocked = blocked | (met.inside & met.distance.lt(limit));
        }
        for flat in &self.triangles {
            let met = flat.triangle(simd, origin, direction);
            blocked = blocked | (met.inside & met.distance.lt(limit));
        }
        for (_, ball) in &self.balls {
            let met = ball.meet(simd, origin, direction);
            blocked = blocked | (met.inside & met.distance.lt(limit));
        }
        if self.rare.is_empty() {
            return blocked;
        }
        simd.vectorize(Occluded {
            rare: &self.rare,
            rays: [origin, direction],
            limit,
            blocked,
        })
    }
}

impl Aligned {
    fn new(shape: u32, flat: &Flat, normal: usize) -> Self {
        let turned = |k: usize| flat.corner[(normal + k) % 3];
        let swapped = axis(flat.first_dual) == Some((normal + 2) % 3);
        let (mut duals, mut range) = ([flat.first_dual, flat.second_dual], Range::of(flat));
        if swapped {
            duals.reverse();
            range = range.swapped();
        }
        Self {
            shape,
            corner: [turned(0), turned(1), turned(2)],
            dual: [duals[0][(normal + 1) % 3], duals[1][(normal + 2) % 3]],
            range,
            swapped,
        }
    }

    #[inline(always)]
    fn meet<S: Simd>(
        &self,
        simd: S,
        origin: Vector<S>,
        direction: Vector<S>,
        inverse: Real<S>,
    ) -> Meeting<S> {
        let distance = (self.corner[0] - origin.x) * inverse;
        let a = (direction.y * distance - (self.corner[1] - origin.y)) * self.dual[0];
        let b = (direction.z * distance - (self.corner[2] - origin.z)) * self.dual[1];
        let inside = distance.gt(Real::splat(simd, 0.0))
            & a.ge(a.all(self.range.low[0]))
            & b.ge(b.all(self.range.low[1]))
            & a.le(a.all(self.range.high[0]))
            & b.le(b.all(self.range.high[1]));
        let (s, t) = if self.swapped { (b, a) } else { (a, b) };
        Meeting {
            distance,
            s,
            t,
            inside,
        }
    }
}

impl Numbered {
    fn new(shape: u32, flat: &Flat) -> Self {
        Self {
            shape,
            corner: flat.corner,
            normal: flat.normal,
            dual: [flat.first_dual, flat.second_dual],
            range: Range::of(flat),
        }
    }

    #[inline(always)]
    fn parallelogram<S: Simd>(
        &self,
        simd: S,
        origin: Vector<S>,
        direction: Vector<S>,
    ) -> Meeting<S> {
        let met = self.plane(simd, origin, direction);
        let Meeting { s, t, inside, .. } = met;
        let [high_s, high_t] = self.range.high;
        let inside = inside & s.le(s.all(high_s)) & t.le(t.all(high_t));
        Meeting { inside, ..met }
    }

    #[inline(always)]
    fn triangle<S: Simd>(&self, simd: S, origin: Vector<S>, direction: Vector<S>) -> Meeting<S> {
        let met = self.plane(simd, origin, direction);
        let Meeting { s, t, inside, .. } = met;
        let [high_s, high_t] = self.range.high;
        let inside = inside & (s + t).le(s.all(high_s)) & (t + s).le(t.all(high_t));
        Meeting { inside, ..met }
    }

    /// Where rays meet the plane, and whether that is in front of the ray and inside of the two edges at the corner.
    #[inline(always)]
    fn plane<S: Simd>(&self, simd: S, origin: Vector<S>, direction: Vector<S>) -> Meeting<S> {
        let normal = Vector::splat(simd, self.normal);
        let offset = Vector::splat(simd, self.corner) - origin;
        let distance = offset.dot(normal) * (1.0 / direction.dot(normal));
        let inside = direction * distance - offset;
        let s = inside.dot(Vector::splat(simd, self.dual[0]));
        let t = inside.dot(Vector::splat(simd, self.dual[1]));
        let inside = distance.gt(Real::splat(simd, 0.0))
            & s.ge(s.all(self.range.low[0]))
            & t.ge(t.all(self.range.low[1]));
        Meeting {
            distance,
            s,
            t,
            inside,
        }
    }
}
