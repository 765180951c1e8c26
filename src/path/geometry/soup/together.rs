//! The rays of all lanes, through the triangles of all meshes together.
//!
//! Rays that run side by side enter the same boxes: each is asked for all of them at once, as the triangles in it are. A ray that enters one by itself goes on
//! alone.

use pulp::{NullaryFnOnce, Simd};

use super::{Block, Blocks, Soup};
use crate::path::geometry::flats::{LANES, Lanes};
use crate::path::geometry::node::{Child, Node};
use crate::path::geometry::probe::{Inverted, WIDER};
use crate::path::geometry::tree::InLeaf;
use crate::path::lanes::{Index, Mask, Real, Row, Vector, WIDEST};
use crate::path::ray::Ray;

/// Rays, one a lane, and how far they go, in the lanes that have one.
#[derive(Clone, Copy)]
pub(in crate::path) struct Rays<S: Simd> {
    pub(in crate::path) origin: Vector<S>,
    pub(in crate::path) direction: Vector<S>,
    pub(in crate::path) limit: Real<S>,
    pub(in crate::path) active: Mask<S>,
}

/// The first triangle that each ray meets, if any.
pub(in crate::path) type Triangles = [Option<InLeaf>; WIDEST];

/// Boxes that are still to be visited, at most. Rays of which more are left go on alone.
const ROOM: usize = 32;

impl Soup {
    /// Whether rays that run side by side gain by going together: paths take a seventh less time among some hundred triangles, a twentieth
    /// among 8000, and none among 25 000, where such rays part soon.
    #[inline]
    pub(in crate::path) fn is_small(&self) -> bool {
        const SMALL: usize = 3000;
        self.blocks.as_slice().len() < SMALL
    }

    /// The first triangle in each lane, as [`nearest`](Self::nearest) has it.
    #[inline(always)]
    pub(in crate::path) fn nearest_together<S: Simd>(&self, rays: Rays<S>) -> Triangles {
        rays.limit.simd().vectorize(ToNearest { soup: self, rays })
    }

    /// Where any triangle is met, as [`occluded`](Self::occluded) has it.
    #[inline(always)]
    pub(in crate::path) fn occluded_together<S: Simd>(&self, rays: Rays<S>) -> Mask<S> {
        rays.limit.simd().vectorize(ToAny { soup: self, rays })
    }

    /// Visits what rays enter, with what `search` has found so far.
    #[inline(always)]
    fn walk<S: Simd>(&self, rays: &Rays<S>, search: &mut impl Search<S>) {
        let (nodes, blocks) = (self.tree.nodes(), self.blocks.as_slice());
        let inverted = Inverted::new(rays.origin, rays.direction);
        let mut stack = Stack::of(rays.active);
        while let Some(visit) = stack.pop() {
            let mask = search.left(&visit);
            if !mask.any() {
                continue;
            }
            if mask.is_one() || stack.is_full() {
                let lanes = mask.row(mask.simd());
                let (origins, directions) = (rays.origin.rows(), rays.direction.rows());
                for lane in (0..S::F32_LANES).filter(|&lane| lanes.0[lane] > 0.0) {
                    let ray = Ray {
                        origin: Row::vector(&origins, lane),
                        direction: Row::vector(&directions, lane),
                    };
                    search.alone(self, visit.child, &ray, lane);
                }
            } else if visit.child.is_leaf() {
                let leaf = visit.child.index();
                search.leaf(&blocks[leaf], leaf, mask);
            } else {
                let node = &nodes[visit.child.index()];
                stack.push(node, &inverted, search.limit(), mask);
            }
        }
    }
}

/// What is looked for among the triangles.
trait Search<S: Simd> {
    /// How far the rays go.
    fn limit(&self) -> Real<S>;

    /// The rays for which there may be something in a box.
    fn left(&self, visit: &Visit<S>) -> Mask<S>;

    /// Looks at the triangles of a leaf.
    fn leaf(&mut self, block: &Block, number: usize, mask: Mask<S>);

    /// Looks at what is in a box and below for a single ray.
    fn alone(&mut self, soup: &Soup, child: Child, ray: &Ray, lane: usize);
}

/// A box that some rays enter.
#[derive(Clone, Copy)]
struct Visit<S: Simd> {
    child: Child,
    /// The rays.
    mask: Mask<S>,
    /// Where each of them enters.
    start: Real<S>,
    /// Where the first of them does.
    first: f32,
}

struct Stack<S: Simd> {
    visits: [Visit<S>; ROOM],
    count: usize,
}

impl<S: Simd> Stack<S> {
    /// All boxes.
    #[inline(always)]
    fn of(mask: Mask<S>) -> Self {
        let root = Visit {
            child: Child::ROOT,
            mask,
            start: Real::splat(mask.simd(), 0.0),
            first: 0.0,
        };
        Self {
            visits: [root; ROOM],
            count: 1,
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Visit<S>> {
        self.count = self.count.checked_sub(1)?;
        Some(self.visits[self.count % ROOM])
    }

    #[inline(always)]
    fn is_full(&self) -> bool {
        self.count + LANES > ROOM
    }

    /// Adds the boxes of a node that any of the rays enters, the nearest last.
    #[inline(always)]
    fn push(&mut self, node: &Node, rays: &Inverted<S>, limit: Real<S>, mask: Mask<S>) {
        let begin = self.count;
        for lane in 0..LANES {
            if node.is_empty(lane) {
                break;
            }
            let (start, enters) = rays.enter(node.corners(lane), limit);
            let mask = mask & enters;
            if !mask.any() {
                continue;
            }
            let first = mask.select(start, limit.all(f32::INFINITY)).least();
            let mut place = self.count;
            while place > begin && self.visits[(place - 1) % ROOM].first < first {
                self.visits[place % ROOM] = self.visits[(place - 1) % ROOM];
                place -= 1;
            }
            self.visits[place % ROOM] = Visit {
                child: node.child(lane),
                mask,
                start,
                first,
            };
            self.count += 1;
        }
    }
}

impl Block {
    /// Where rays meet the plane of a triangle, and whether that is in front of them and within it: the arithmetic of single rays.
    #[inline(always)]
    fn meet<S: Simd>(&self, place: usize, rays: &Rays<S>) -> (Real<S>, Mask<S>) {
        let Rays {
            origin, direction, ..
        } = *rays;
        let flats = &self.flats;
        let zero = origin.x.all(0.0);
        let offset = vector(zero, &flats.corner, place) - origin;
        let normal = vector(zero, &flats.normal, place);
        let distance = offset.dot(normal) * (1.0 / direction.dot(normal));
        let inside = direction * distance - offset;
        let s = inside.dot(vector(zero, &flats.first_dual, place));
        let t = inside.dot(vector(zero, &flats.second_dual, place));
        let (slack_s, slack_t) = (flats.slack[0][place], flats.slack[1][place]);
        let slant = flats.slant[place];
        let inside = distance.gt(zero)
            & s.ge(zero.all(-slack_s))
            & t.ge(zero.all(-slack_t))
            & (s + slant * t).le(zero.all(1.0 + slack_s))
            & (t + slant * s).le(zero.all(1.0 + slack_t));
        (distance, inside)
    }

    /// How many triangles there are: where there is none the normal is zero.
    #[inline(always)]
    fn count(&self) -> usize {
        let [x, y, z] = &self.flats.normal;
        let mut count = 0;
        while count < LANES && (x[count] != 0.0 || y[count] != 0.0 || z[count] != 0.0) {
            count += 1;
        }
        count
    }
}

/// The vector at a place, in all lanes. No closure: compilers do not always make one part of the function that is compiled for a machine.
#[inline(always)]
fn vector<S: Simd>(zero: Real<S>, [x, y, z]: &[Lanes; 3], place: usize) -> Vector<S> {
    Vector {
        x: zero.all(x[place]),
        y: zero.all(y[place]),
        z: zero.all(z[place]),
    }
}

struct ToNearest<'a, S: Simd> {
    soup: &'a Soup,
    rays: Rays<S>,
}

impl<S: Simd> NullaryFnOnce for ToNearest<'_, S> {
    type Output = Triangles;

    #[inline(always)]
    fn call(self) -> Triangles {
        let rays = &self.rays;
        let simd = rays.limit.simd();
        let mut nearest = Nearest {
            rays,
            distance: rays.limit,
            leaf: Index::splat(simd, 0),
            place: Index::splat(simd, 0),
            met: rays.limit.lt(rays.limit),
        };
        self.soup.walk(rays, &mut nearest);
        let (met, distance) = (nearest.met.row(simd), nearest.distance.row());
        let (leaf, place) = (nearest.leaf.row(), nearest.place.row());
        let mut triangles = [None; WIDEST];
        for (lane, triangle) in triangles.iter_mut().enumerate() {
            if met.0[lane] > 0.0 {
                *triangle = Some(InLeaf {
                    leaf: leaf.0[lane] as usize,
                    lane: place.0[lane] as usize,
                    distance: distance.0[lane],
                });
            }
        }
        triangles
    }
}

/// The nearest triangles so far.
struct Nearest<'a, S: Simd> {
    rays: &'a Rays<S>,
    /// The limit where none is met.
    distance: Real<S>,
    /// Zero where none is met, as the place is.
    leaf: Index<S>,
    place: Index<S>,
    met: Mask<S>,
}

impl<S: Simd> Search<S> for Nearest<'_, S> {
    #[inline(always)]
    fn limit(&self) -> Real<S> {
        self.distance
    }

    #[inline(always)]
    fn left(&self, visit: &Visit<S>) -> Mask<S> {
        visit.mask & visit.start.le(self.distance * WIDER)
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "trees have less than 2^31 leaves"
    )]
    fn leaf(&mut self, block: &Block, number: usize, mask: Mask<S>) {
        let simd = self.distance.simd();
        let number = number as u32;
        for place in 0..block.count() {
            let (distance, inside) = block.meet(place, self.rays);
            // Of two at the same distance that in the leaf of the lower number is the first.
            let lower = self.leaf.ge(simd, number + 1);
            let nearer = distance.lt(self.distance) | (lower & distance.eq(self.distance));
            let nearer = mask & inside & nearer;
            self.distance = nearer.select(distance, self.distance);
            self.leaf = nearer.index(Index::splat(simd, number), self.leaf);
            self.place = nearer.index(Index::splat(simd, place as u32), self.place);
            self.met = self.met | nearer;
        }
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "trees have less than 2^31 leaves"
    )]
    fn alone(&mut self, soup: &Soup, child: Child, ray: &Ray, lane: usize) {
        let simd = self.distance.simd();
        let (mut distance, mut met) = (self.distance.row(), self.met.row(simd));
        let (mut leaf, mut place) = (self.leaf.row(), self.place.row());
        let mut blocks = Blocks {
            blocks: soup.blocks.as_slice(),
            nearest: leaf.0[lane] as usize,
        };
        let limit = distance.0[lane];
        if let Some(nearer) = (soup.tree).nearest_in_leaves(child, ray, limit, &mut blocks) {
            distance.0[lane] = nearer.distance;
            leaf.0[lane] = nearer.leaf as u32;
            place.0[lane] = nearer.lane as u32;
            met.0[lane] = 1.0;
            self.distance = Real::load(simd, &distance);
            self.leaf = Index::load(simd, &leaf);
            self.place = Index::load(simd, &place);
            self.met = Real::load(simd, &met).gt(Real::splat(simd, 0.0));
        }
    }
}

struct ToAny<'a, S: Simd> {
    soup: &'a Soup,
    rays: Rays<S>,
}

impl<S: Simd> NullaryFnOnce for ToAny<'_, S> {
    type Output = Mask<S>;

    #[inline(always)]
    fn call(self) -> Mask<S> {
        let rays = &self.rays;
        let mut any = Any {
            rays,
            met: rays.limit.lt(rays.limit),
        };
        self.soup.walk(rays, &mut any);
        any.met
    }
}

/// Where a triangle was met.
struct Any<'a, S: Simd> {
    rays: &'a Rays<S>,
    met: Mask<S>,
}

impl<S: Simd> Search<S> for Any<'_, S> {
    #[inline(always)]
    fn limit(&self) -> Real<S> {
        self.rays.limit
    }

    #[inline(always)]
    fn left(&self, visit: &Visit<S>) -> Mask<S> {
        visit.mask & !self.met
    }

    #[inline(always)]
    fn leaf(&mut self, block: &Block, _: usize, mask: Mask<S>) {
        for place in 0..block.count() {
            let (distance, inside) = block.meet(place, self.rays);
            self.met = self.met | (mask & inside & distance.lt(self.rays.limit));
        }
    }

    #[inline(always)]
    fn alone(&mut self, soup: &Soup, child: Child, ray: &Ray, lane: usize) {
        let simd = self.rays.limit.simd();
        let mut blocks = Blocks::new(soup.blocks.as_slice());
        let limit = self.rays.limit.row().0[lane];
        if (soup.tree).any_in_leaves(child, ray, limit, &mut blocks) {
            let mut met = self.met.row(simd);
            met.0[lane] = 1.0;
            self.met = Real::load(simd, &met).gt(Real::splat(simd, 0.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use pulp::{Arch, WithSimd};

    use super::*;
    use crate::hash::{hash, unit_f32};
    use crate::path::shape::Mesh;

    /// Rays, asked for together and one by one.
    struct Asked<'a> {
        soup: &'a Soup,
        rays: &'a [Ray; WIDEST],
        limits: [f32; WIDEST],
        /// Zero in the lanes that have none.
        active: Row<f32>,
    }

    impl WithSimd for Asked<'_> {
        type Output = usize;

        /// How many of the rays meet a triangle.
        fn with_simd<S: Simd>(self, simd: S) -> usize {
            let (mut origin, mut direction) = ([Row::<f32>::ZERO; 3], [Row::<f32>::ZERO; 3]);
            for (lane, ray) in self.rays.iter().enumerate() {
                Row::set_vector(&mut origin, lane, ray.origin);
                Row::set_vector(&mut direction, lane, ray.direction);
            }
            let rays = Rays {
                origin: Vector::load(simd, &origin),
                direction: Vector::load(simd, &direction),
                limit: Real::load(simd, &Row(self.limits)),
                active: Real::load(simd, &self.active).gt(Real::splat(simd, 0.0)),
            };
            let found = self.soup.nearest_together(rays);
            let occluded = self.soup.occluded_together(rays).row(simd);
            let mut met = 0;
            for (lane, found) in found.iter().enumerate().take(S::F32_LANES) {
                let (ray, limit) = (&self.rays[lane], self.limits[lane]);
                assert!(alone_before(self.soup, ray, limit));
                let bits = |met: InLeaf| (met.leaf, met.lane, met.distance.to_bits());
                let alone = self.soup.nearest(ray, limit).map(bits);
                let alone = alone.filter(|_| self.active.0[lane] > 0.0);
                assert_eq!(found.map(bits), alone, "{ray:?} {limit}");
                assert_eq!(occluded.0[lane] > 0.0, alone.is_some(), "{ray:?} {limit}");
                met += usize::from(alone.is_some());
            }
            assert!(found[S::F32_LANES..].iter().all(Option::is_none));
            met
        }
    }

    /// Whether what a ray meets alone is nearer than `limit`, if it meets anything.
    fn alone_before(soup: &Soup, ray: &Ray, limit: f32) -> bool {
        soup.nearest(ray, limit)
            .is_none_or(|met| met.distance < limit)
    }

    fn vector(seed: u64, k: u64, size: f32) -> [f32; 3] {
        core::array::from_fn(|axis| size * (unit_f32(hash(seed, 3 * k + axis as u64)) - 0.5))
    }

    /// Squares along each side of the sheet.
    const SQUARES: u16 = 24;

    /// Triangles anywhere, and a sheet of others that meet in their edges.
    fn soup(count: u32, size: f32) -> Soup {
        let mut corners = Vec::new();
        for k in 0..u64::from(count) {
            let corner = vector(7, k, 1.0);
            corners.push(corner);
            for other in [1, 2] {
                let edge = vector(8 + other, k, size);
                corners.push(core::array::from_fn(|axis| corner[axis] + edge[axis]));
            }
        }
        let mut triangles: Vec<_> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        for x in 0..=SQUARES {
            corners.extend(
                (0..=SQUARES)
                    .map(|y| [x, y].map(line))
                    .map(|[x, y]| [x, y, 0.0]),
            );
        }
        for (x, y) in (0..SQUARES).flat_map(|x| (0..SQUARES).map(move |y| (x, y))) {
            let corner = |x, y| 3 * count + u32::from(x * (SQUARES + 1) + y);
            let [a, b] = [corner(x, y), corner(x + 1, y)];
            triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
        Soup::new(vec![Mesh::new(corners, triangles).unwrap()]).unwrap()
    }

    /// Where the squares of the sheet meet.
    fn line(number: u16) -> f32 {
        f32::from(number) / f32::from(SQUARES) - 0.5
    }

    #[test]
    fn rays_that_go_together_meet_what_each_meets_alone() {
        let (mut met, mut lanes) = (0, 0);
        for (count, size) in [(2, 0.5), (100, 0.3), (4000, 0.05), (5000, 3.0)] {
            let soup = soup(count, size);
            for seed in 0..400_u32 {
                let (spread, seed) = ([1e-3, 0.1, 1.0][(seed % 3) as usize], u64::from(seed));
                let random = |k| Vec3A::from(vector(1000 + seed, k, 1.0));
                let origin = Vec3A::from(vector(100 + seed, 0, 2.0));
                // Side by side, or anywhere; one along an axis, some to edges of the sheet, and some that go nowhere.
                let rays = core::array::from_fn(|lane| {
                    let k = 2 * lane as u64;
                    let origin = origin + random(k + 1) * (0.1 * spread);
                    let direction = random(k) * spread - origin;
                    let direction = match lane {
                        3 => Vec3A::NEG_Y,
                        4..8 => {
                            let edge = line(u16::try_from(hash(seed, k) % 25).unwrap());
                            (random(k) * spread).with_z(0.0).with_x(edge) - origin
                        }
                        8 if seed % 5 == 0 => Vec3A::ZERO,
                        9 if seed % 5 == 1 => Vec3A::NAN,
                        _ => direction,
                    };
                    Ray {
                        origin,
                        direction: direction / direction.length().max(1e-3),
                    }
                });
                let limit = |lane: usize| {
                    let random = hash(seed, 100 + lane as u64) % 8;
                    // That of the first triangle too, which is not met then, and the next number.
                    let distance = || {
                        let met = soup.nearest(&rays[lane], f32::INFINITY);
                        met.map_or(0.3, |met| met.distance)
                    };
                    match random {
                        0 => unit_f32(hash(seed, lane as u64)),
                        1 => distance(),
                        2 => distance().next_up(),
                        _ => f32::INFINITY,
                    }
                };
                let asked = || Asked {
                    soup: &soup,
                    rays: &rays,
                    limits: core::array::from_fn(limit),
                    active: Row(core::array::from_fn(|lane| {
                        f32::from(u8::from(hash(seed, 200 + lane as u64) & 7 > 0))
                    })),
                };
                met += Arch::new().dispatch(asked());
                asked().with_simd(pulp::Scalar);
                #[cfg(target_arch = "x86_64")]
                if let Some(simd) = pulp::x86::V3::try_new() {
                    asked().with_simd(simd);
                }
                lanes += WIDEST;
            }
        }
        assert!(met > lanes / 20, "{met} of {lanes}");
    }
}
