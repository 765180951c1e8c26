//! Many paths at once, one in each lane of the vectors that the machine has.
//!
//! For scenes of few shapes, and meshes and copies. Rays look for shapes and boxes around meshes and copies, and paths are lit by flat lights, skies and
//! sources without size and scattered ideally diffusely, in lanes; all else goes lane by lane. Some vectors of paths go segment by segment, those that end make
//! room. Every lane has the bits of [`Paths::radiance`]: the same
//! arithmetic in the same order, the coordinates read in the same order.

mod boxes;
mod drawn;
mod here;
mod lamp;
mod math;
mod near;
mod optics;
mod place;
mod reuse;
mod solids;
mod sweep;
mod walk;

use glam::{Vec3, Vec3A};

use super::Paths;
use super::bsdf::{Lambertian, Scattered, Scattering};
use super::geometry::{Geometry, Hit};
use super::light::{AreaLights, Emission, Illumination, Sky, Surroundings};
use super::render::Start;
use super::reuse::{Group, Traces};
use super::shape::Primitive;
use crate::points::PointSet;
use crate::{Cursor, Sampler};

pub(in crate::path) use optics::{Emitted, FlatLight, Law, Optics};
pub(in crate::path) use reuse::Keeper;

use boxes::Boxes;
use near::Near;
use place::{MOST, Table};
use reuse::Sharing;
use solids::Solids;
use sweep::Shapes;
use walk::Walk;

/// A scene that many paths are followed in at once.
#[derive(Debug)]
pub(in crate::path) struct Packet {
    table: Table,
    shapes: Shapes,
    /// Those of them that can be between two points of the scene.
    dividing: Shapes,
    solids: Option<Solids>,
    /// Around all triangles and copies.
    boxes: Boxes,
    lights: AreaLights,
    near: Option<Near>,
    /// The shape of each emitter; of one that is drawn one lane after the other a number that no flat shape has.
    emitters: Vec<u32>,
    around: Vec3A,
    triangles: bool,
    slanted_lights: bool,
    /// Whether any law may be black on the inner side.
    one_sided: bool,
    /// Whether any ideally diffuse law may be another from point to point: its albedo is asked for lane by lane.
    varying: bool,
    /// Whether any law is another than the ideally diffuse one.
    others: bool,
    /// Whether the view is asked for all light of shapes, lane by lane.
    asks_lights: bool,
    /// That number, if there are such emitters beside flat lights. The [`Table`] knows nothing of it.
    asked: Option<u32>,
    /// Whether it is asked for what is around.
    asks_around: bool,
    arch: pulp::Arch,
}

/// What packets ask of a view, most of it one lane at a time.
pub(in crate::path) trait Single {
    /// What the law at a point does for a pair of directions.
    fn evaluate(&self, at: &Hit, out: Vec3A, into: Vec3A) -> Scattering;

    /// The ideally diffuse law at a point where it is one.
    fn lambertian(&self, at: &Hit) -> Option<Lambertian>;

    /// A direction that the law at a point draws.
    fn sample(&self, at: &Hit, out: Vec3A, u: &mut dyn Sampler) -> Option<Scattered>;

    /// Light that a point may get from the lights of the scene.
    fn lamp(&self, at: &Hit, u: &mut dyn Sampler) -> Option<Illumination>;

    /// Light that it may get from what is around.
    fn around(&self, at: &Hit, u: &mut dyn Sampler) -> Option<Illumination>;

    /// What a point of a light emits towards another point.
    fn emitted(&self, at: &Hit, from: Vec3A) -> Emission;

    /// What comes from all around against a direction.
    fn background(&self, direction: Vec3A) -> Emission;

    /// The shapes of the scene.
    fn geometry(&self) -> &Geometry;

    /// The picture around the scene, if that is what is around it.
    fn sky(&self) -> Option<&Sky>;

    /// Sources without size, if they are seen in lanes.
    fn sources(&self) -> Option<&Surroundings>;
}

impl Packet {
    /// The scene of the given shapes, if it is one of those. `optics` tells what each of the `parts` does to light, as [`Hit`] numbers them;
    /// `smooth`, whether laws heed interpolated normals. Without `lights`, or if none of them is flat, or if some are not
    /// and as many shapes are flat as there is room for, the view is asked for all light of shapes; without
    /// `around`, the same radiance from everywhere, for what is around, unless that is a sky.
    pub(in crate::path) fn new(
        geometry: &Geometry,
        parts: usize,
        optics: impl Fn(usize) -> Optics,
        lights: Option<&AreaLights>,
        around: Option<Vec3A>,
        smooth: bool,
    ) -> Option<Self> {
        let (primitives, sweep) = (geometry.shapes(), geometry.sweep()?);
        let flats = &sweep.flat_shapes;
        // Which part a lane is at is kept in 32 bits, as the trees keep triangles and copies.
        u32::try_from(parts).ok()?;
        let mut known: Vec<_> = (0..parts).map(optics).collect();
        let lights = lights.and_then(|lights| lights_or_ask(lights, &mut known, flats.len()));
        let first = u32::try_from(flats.len()).ok()?;
        let laws = || known.iter().map(|optics| &optics.law);
        let mut packet = Self {
            table: Table::EMPTY,
            shapes: Shapes::default(),
            dividing: Shapes::default(),
            solids: None,
            boxes: Boxes(geometry.boxes_beside()),
            lights: lights.cloned().unwrap_or(AreaLights::NONE),
            near: None,
            emitters: Vec::new(),
            around: around.unwrap_or(Vec3A::ZERO),
            triangles: false,
            slanted_lights: false,
            one_sided: laws().any(|law| law.inner() == 0.0 || law.varies()),
            varying: laws().any(Law::varies),
            others: laws().any(|law| !law.is_diffuse()),
            asks_lights: lights.is_none(),
            asked: None,
            asks_around: around.is_none(),
            arch: pulp::Arch::new(),
        };
        packet.emitters = vec![first; packet.lights.shapes().count()];
        for ((number, &shape), &divides) in (0_u32..).zip(flats).zip(&sweep.divides) {
            let Primitive::Flat(flat) = &primitives[shape] else {
                return None;
            };
            let optics = &known[shape];
            let part = u32::try_from(shape).ok()?;
            packet.table.set(number as usize, part, flat, optics);
            packet.shapes.push(number, flat);
            if divides {
                packet.dividing.push(number, flat);
            }
            packet.triangles |= flat.slant != 0.0;
            if let Emitted::Flat(light) = optics.emitted {
                packet.slanted_lights |= flat.slant != 0.0;
                packet.emitters[light.emitter as usize] = number;
            }
        }
        let others = sweep.round.iter().map(|&(shape, _)| shape);
        let round: Vec<_> = (sweep.ball_shapes.iter().copied().chain(others))
            .map(|shape| (primitives[shape], shape))
            .collect();
        for (number, (shape, _)) in (first..).zip(&round) {
            packet.shapes.push_round(number, shape);
            packet.dividing.push_round(number, shape);
        }
        if !round.is_empty() || !packet.boxes.0.is_empty() {
            packet.solids = Some(Solids {
                round,
                first,
                optics: known,
                smooth,
            });
        }
        packet.asked = packet.emitters.contains(&first).then_some(first);
        packet.near = Near::new(&packet.emitters, first, &packet.lights);
        Some(packet)
    }

    /// What [`Paths::radiance`] gives for each of the points, times the weight that its start has; `starts` tells where their paths
    /// begin. Paths that are to be reused are kept by `keeper`, and have no values yet.
    ///
    /// View and points are behind pointers, and it is not inlined, so that the loop is compiled with this crate, for no view and no kind of points.
    #[inline(never)]
    pub(in crate::path) fn radiance(
        &self,
        paths: Paths,
        single: &dyn Single,
        starts: &[Start],
        points: &mut [Cursor<'_, dyn PointSet + '_>],
        values: &mut [Vec3],
        keeper: Option<Keeper<'_>>,
    ) {
        self.follow(paths, single, starts, points, values, keeper);
    }

    /// The same for points of any kind, each coordinate of which is asked for through a pointer.
    #[inline(never)]
    pub(in crate::path) fn radiance_of_any(
        &self,
        paths: Paths,
        single: &dyn Single,
        starts: &[Start],
        points: &mut [&mut dyn Sampler],
        values: &mut [Vec3],
    ) {
        self.follow(paths, single, starts, points, values, None);
    }

    #[inline(always)]
    fn follow<U: Sampler>(
        &self,
        paths: Paths,
        single: &dyn Single,
        starts: &[Start],
        points: &mut [U],
        values: &mut [Vec3],
        keeper: Option<Keeper<'_>>,
    ) {
        debug_assert_eq!(starts.len(), points.len(), "a start for each point");
        let asks = self.asks_lights || self.asked.is_some() || self.asks_around;
        let constant = !self.others && !self.varying;
        let plain = self.solids.is_none()
            && constant
            && !asks
            && single.sky().is_none()
            && single.sources().is_none();
        if plain {
            self.walk::<U, true>(paths, single, starts, points, values, keeper);
        } else {
            self.walk::<U, false>(paths, single, starts, points, values, keeper);
        }
    }

    #[inline]
    fn walk<U: Sampler, const PLAIN: bool>(
        &self,
        paths: Paths,
        single: &dyn Single,
        starts: &[Start],
        points: &mut [U],
        values: &mut [Vec3],
        keeper: Option<Keeper<'_>>,
    ) {
        self.arch.dispatch(Walk::<_, PLAIN> {
            packet: self,
            paths,
            single,
            sky: single.sky(),
            sources: single.sources(),
            starts,
            points,
            values,
            keeper,
        });
    }

    /// Shares the light of some groups of paths.
    #[inline(never)]
    pub(in crate::path) fn share(
        &self,
        geometry: &Geometry,
        groups: &[Group],
        traces: &mut Traces,
    ) {
        self.arch.dispatch(Sharing {
            packet: self,
            geometry,
            groups,
            traces,
        });
    }
}

/// The lights, if any are drawn in lanes or there are none; otherwise it is told of all of them that they are to be asked for. `flats` is
/// how many shapes are flat.
fn lights_or_ask<'a>(
    lights: &'a AreaLights,
    known: &mut [Optics],
    flats: usize,
) -> Option<&'a AreaLights> {
    let all = lights.shapes().count();
    let flat = known.iter().filter(|optics| optics.emitted.is_flat());
    let flat = flat.count();
    if flat == all || flat > 0 && flats < MOST {
        return Some(lights);
    }
    for optics in known.iter_mut().filter(|optics| optics.emitted.is_flat()) {
        optics.emitted = Emitted::Asked;
    }
    None
}

#[cfg(test)]
mod tests;
