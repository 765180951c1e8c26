//! Lights that are drawn by solid angle where they are near: rectangles in lanes, triangles one lane after the other.

use pulp::Simd;

use super::place::{Column, NOTHING, Place, Table};
use crate::path::lanes::{Mask, Real, Row, Vector, WIDEST};
use crate::path::light::AreaLights;
use crate::path::shape::{Flat, Primitive, Rectangle, are_near};

/// The lights, by the number of their shape.
#[derive(Debug)]
pub(super) struct Near {
    /// 0 for what is drawn from the area, wherever it is.
    outline: Column,
    /// The lengths of the edges, of rectangles.
    lengths: [Column; 2],
    longest: Column,
    triangles: Vec<Option<Flat>>,
}

const RECTANGLE: f32 = 1.0;
const TRIANGLE: f32 = 2.0;

/// A point of a light a lane, and its density per solid angle given the light.
pub(super) struct Drawn<S: Simd> {
    pub(super) point: Vector<S>,
    pub(super) density: Real<S>,
}

/// The lights of some lanes, as their points see them.
struct Seen<S: Simd> {
    /// Which are rectangles that are near, and which triangles.
    rectangles: Mask<S>,
    triangles: Mask<S>,
    corner: Vector<S>,
    height: Real<S>,
}

impl Near {
    /// `None` if all lights are drawn from the area, wherever they are. `numbers` are those of the shapes of the lights, `asked` that of
    /// lights that are none of them.
    pub(super) fn new(numbers: &[u32], asked: u32, lights: &AreaLights) -> Option<Self> {
        let mut near = Self {
            outline: NOTHING,
            lengths: [NOTHING; 2],
            longest: NOTHING,
            triangles: Vec::new(),
        };
        let mut any = false;
        for (&number, shape) in numbers.iter().zip(lights.shapes()) {
            let Primitive::Flat(flat) = shape else {
                continue;
            };
            if number == asked {
                continue;
            }
            let Some(longest) = flat.longest_by_solid_angle() else {
                continue;
            };
            any = true;
            let number = number as usize;
            near.longest[number] = longest;
            if flat.slant > 0.0 {
                near.outline[number] = TRIANGLE;
                let room = near.triangles.len().max(number + 1);
                near.triangles.resize(room, None);
                near.triangles[number] = Some(*flat);
            } else {
                near.outline[number] = RECTANGLE;
                near.lengths[0][number] = flat.first_edge.length();
                near.lengths[1][number] = flat.second_edge.length();
            }
        }
        any.then_some(near)
    }

    /// The lights `shapes`, which are at `places`, as `from` sees them.
    #[inline(always)]
    fn seen<S: Simd>(
        &self,
        shapes: &Row<u32>,
        (place, area): (&Place<S>, Real<S>),
        active: Mask<S>,
        from: Vector<S>,
    ) -> Seen<S> {
        let simd = area.simd();
        let outline = Table::number(simd, &self.outline, shapes);
        let longest = Table::number(simd, &self.longest, shapes);
        let triangle = outline.eq(area.all(TRIANGLE));
        let corner = place.corner - from;
        let height = -corner.dot(place.normal);
        let middle = triangle.select(area.all(1.0 / 3.0), area.all(0.5));
        let to_middle = corner + (place.first_edge + place.second_edge) * middle;
        let near = active & are_near(to_middle, area, height, longest);
        Seen {
            rectangles: near & outline.eq(area.all(RECTANGLE)),
            triangles: near & triangle,
            corner,
            height,
        }
    }

    #[inline(always)]
    fn rectangles<S: Simd>(
        &self,
        shapes: &Row<u32>,
        place: &Place<S>,
        seen: &Seen<S>,
    ) -> Rectangle<S> {
        let simd = seen.height.simd();
        let lengths = [0, 1].map(|edge| Table::number(simd, &self.lengths[edge], shapes));
        let edges = [place.first_edge, place.second_edge];
        Rectangle::new(seen.corner, edges, lengths, seen.height)
    }

    /// The triangles of the lanes that have one.
    #[inline(always)]
    fn triangles<S: Simd>(
        &self,
        shapes: &Row<u32>,
        seen: &Seen<S>,
    ) -> impl Iterator<Item = (usize, &Flat)> {
        let lanes = seen.triangles.row(seen.height.simd());
        let lanes = (0..WIDEST).filter(move |&lane| lanes.0[lane] > 0.0);
        lanes.filter_map(|lane| Some((lane, self.triangles[shapes.0[lane] as usize].as_ref()?)))
    }

    /// The points that `u` draws from the lights `shapes`, which are at `places`, as `from` sees them: `far` but where they are near.
    #[inline(always)]
    pub(super) fn sample<S: Simd>(
        &self,
        shapes: &Row<u32>,
        places: (&Place<S>, Real<S>),
        active: Mask<S>,
        from: Vector<S>,
        u: [Real<S>; 2],
        far: Drawn<S>,
    ) -> Drawn<S> {
        let seen = self.seen(shapes, places, active, from);
        let (place, mut drawn) = (places.0, far);
        if seen.rectangles.any() {
            let rectangle = self.rectangles(shapes, place, &seen);
            let [s, t] = rectangle.sample(u);
            drawn = Drawn {
                point: seen.rectangles.choose(place.at(s, t), drawn.point),
                density: (seen.rectangles).select(rectangle.density(), drawn.density),
            };
        }
        if seen.triangles.any() {
            let simd = drawn.density.simd();
            let (from, [a, b]) = (from.rows(), u.map(Real::row));
            let (mut point, mut density) = (drawn.point.rows(), drawn.density.row());
            for (lane, flat) in self.triangles(shapes, &seen) {
                let u = [a.0[lane], b.0[lane]];
                if let Some((there, own)) = flat.sample_near(Row::vector(&from, lane), u) {
                    Row::set_vector(&mut point, lane, there);
                    density.0[lane] = own;
                }
            }
            drawn = Drawn {
                point: Vector::load(simd, &point),
                density: Real::load(simd, &density),
            };
        }
        drawn
    }

    /// The densities with which points of the lights `shapes` are drawn, as `from` sees them: `far` but where they are near.
    #[inline(always)]
    pub(super) fn density<S: Simd>(
        &self,
        shapes: &Row<u32>,
        places: (&Place<S>, Real<S>),
        active: Mask<S>,
        from: Vector<S>,
        far: Real<S>,
    ) -> Real<S> {
        let seen = self.seen(shapes, places, active, from);
        let mut density = far;
        if seen.rectangles.any() {
            let rectangle = self.rectangles(shapes, places.0, &seen);
            density = seen.rectangles.select(rectangle.density(), density);
        }
        if seen.triangles.any() {
            let (from, mut row) = (from.rows(), density.row());
            for (lane, flat) in self.triangles(shapes, &seen) {
                if let Some(own) = flat.density_near(Row::vector(&from, lane)) {
                    row.0[lane] = own;
                }
            }
            density = Real::load(far.simd(), &row);
        }
        density
    }
}
