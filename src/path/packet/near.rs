//! Lights that are drawn by solid angle where they are near: rectangles in lanes, triangles one lane after the other.

use pulp::{Simd, WithSimd};

use super::Packet;
use super::place::{Column, NOTHING, Table};
use crate::path::lanes::{Real, Row, Vector, WIDEST};
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
pub(super) struct Drawn {
    pub(super) point: [Row<f32>; 3],
    pub(super) density: Row<f32>,
}

/// A light a lane, and the point that sees it.
pub(super) struct Lights<'a> {
    pub(super) shapes: &'a Row<u32>,
    /// 1 in the lanes with a light, 0 in the others.
    pub(super) active: Row<f32>,
    pub(super) from: [Row<f32>; 3],
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
            let (Primitive::Flat(flat), true) = (shape, number != asked) else {
                continue;
            };
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
}

impl Packet {
    /// Where lights are near, changes what is drawn from their areas: the density, and with `u` the points.
    ///
    /// A function of its own, since most scenes have no such lights, and their loop gets shorter.
    #[inline(never)]
    pub(super) fn draw_near(
        &self,
        near: &Near,
        lights: &Lights<'_>,
        u: Option<&[Row<f32>; 2]>,
        drawn: &mut Drawn,
    ) {
        self.arch.dispatch(Look {
            near,
            table: &self.table,
            lights,
            u,
            drawn,
        });
    }
}

/// A look at the lights of all lanes.
struct Look<'a> {
    near: &'a Near,
    table: &'a Table,
    lights: &'a Lights<'a>,
    u: Option<&'a [Row<f32>; 2]>,
    drawn: &'a mut Drawn,
}

impl WithSimd for Look<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (near, shapes) = (self.near, self.lights.shapes);
        let from = Vector::load(simd, &self.lights.from);
        let active = Real::load(simd, &self.lights.active).gt(Real::splat(simd, 0.0));
        let place = self.table.places(simd, shapes);
        let area = self.table.area(simd, shapes);
        let outline = Table::number(simd, &near.outline, shapes);
        let longest = Table::number(simd, &near.longest, shapes);
        let triangle = outline.eq(area.all(TRIANGLE));
        let corner = place.corner - from;
        let height = -corner.dot(place.normal);
        let middle = triangle.select(area.all(1.0 / 3.0), area.all(0.5));
        let to_middle = corner + (place.first_edge + place.second_edge) * middle;
        let active = active & are_near(to_middle, area, height, longest);
        let rectangles = active & outline.eq(area.all(RECTANGLE));
        let drawn = self.drawn;
        if rectangles.any() {
            let [width, depth] = &near.lengths;
            let rectangle = Rectangle::new(
                corner,
                [place.first_edge, place.second_edge],
                [
                    Table::number(simd, width, shapes),
                    Table::number(simd, depth, shapes),
                ],
                height,
            );
            let far = Real::load(simd, &drawn.density);
            let density = rectangles.select(rectangle.density(), far);
            density.store(&mut drawn.density);
            if let Some([a, b]) = self.u {
                let [s, t] = rectangle.sample([Real::load(simd, a), Real::load(simd, b)]);
                let far = Vector::load(simd, &drawn.point);
                let point = rectangles.choose(place.at(s, t), far);
                point.store(&mut drawn.point);
            }
        }
        let triangles = active & triangle;
        if triangles.any() {
            near.draw_triangles(self.lights, &triangles.row(simd), self.u, drawn);
        }
    }
}

impl Near {
    #[inline(never)]
    fn draw_triangles(
        &self,
        lights: &Lights<'_>,
        active: &Row<f32>,
        u: Option<&[Row<f32>; 2]>,
        drawn: &mut Drawn,
    ) {
        for lane in (0..WIDEST).filter(|&lane| active.0[lane] > 0.0) {
            let Some(flat) = &self.triangles[lights.shapes.0[lane] as usize] else {
                continue;
            };
            let from = Row::vector(&lights.from, lane);
            if let Some([a, b]) = u {
                if let Some((point, density)) = flat.sample_near(from, [a.0[lane], b.0[lane]]) {
                    Row::set_vector(&mut drawn.point, lane, point);
                    drawn.density.0[lane] = density;
                }
            } else if let Some(density) = flat.density_near(from) {
                drawn.density.0[lane] = density;
            }
        }
    }
}
