//! Scenes ready to be rendered, of whatever types they are made.

use core::cell::Cell;
use core::fmt;

use glam::DVec3;

use crate::path::bsdf::Bsdf;
use crate::path::filter::Filter;
use crate::path::light::{Environment, Light};
use crate::path::sensor::Sensor;
use crate::path::{Share, View};
use crate::points::PointSet;
use crate::{Average, Error, Estimate, Estimator, Incomplete, NonFinite, Sampler};

/// A [`View`] of any types, behind a pointer.
pub trait Picture: Sync + fmt::Debug {
    /// The mean radiance of a pixel over the first `count` of some points, or over all of a finite set. Values that are not
    /// finite are left out and counted.
    ///
    /// # Errors
    ///
    /// [`Incomplete`] if the points are none, or no value is finite.
    fn average(
        &self,
        position: [u32; 2],
        size: [u32; 2],
        points: &dyn PointSet,
        count: u64,
    ) -> Result<Estimate<DVec3>, Incomplete<DVec3>>;

    /// The same for several pixels at once, which is faster: see [`View::averages`].
    ///
    /// # Errors
    ///
    /// As there.
    fn averages(
        &self,
        size: [u32; 2],
        shares: &[Share<&dyn PointSet>],
    ) -> Vec<Result<Estimate<DVec3>, Incomplete<DVec3>>>;

    /// The same for the first points of each share, as many as `cut` says, and the others apart: see [`View::averages_in_two`].
    ///
    /// # Errors
    ///
    /// As there.
    ///
    /// # Panics
    ///
    /// As there.
    fn averages_in_two(
        &self,
        size: [u32; 2],
        shares: &[Share<&dyn PointSet>],
        cut: &dyn Fn(&Share<&dyn PointSet>) -> u64,
    ) -> Vec<[Result<Estimate<DVec3>, Incomplete<DVec3>>; 2]>;

    /// Reuses each path for `pixels` that are asked for at once, by [`averages`](Self::averages) and [`averages_in_two`](Self::averages_in_two): see
    /// [`Paths::reused_by`](crate::path::Paths::reused_by).
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as there.
    fn reuse_paths(&mut self, pixels: u32) -> Result<(), Error>;

    /// Ends paths by Russian roulette as it pays in this picture: see [`View::learn_roulette`].
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as there.
    fn learn_roulette(&mut self, size: [u32; 2], count: u64, seed: u64) -> Result<(), Error>;

    /// How many coordinates the sample of a pixel at one of the points takes.
    fn coordinates(
        &self,
        position: [u32; 2],
        size: [u32; 2],
        points: &dyn PointSet,
        index: u64,
    ) -> u64;
}

impl<B, L, E, C, F> Picture for View<B, L, E, C, F>
where
    B: Bsdf + fmt::Debug,
    L: Light + fmt::Debug,
    E: Environment + fmt::Debug,
    C: Sensor + fmt::Debug,
    F: Filter + fmt::Debug,
{
    fn average(
        &self,
        position: [u32; 2],
        size: [u32; 2],
        points: &dyn PointSet,
        count: u64,
    ) -> Result<Estimate<DVec3>, Incomplete<DVec3>> {
        Average::new(points, count)
            .non_finite(NonFinite::Reject)
            .estimate(&self.pixel(position, size))
    }

    fn averages(
        &self,
        size: [u32; 2],
        shares: &[Share<&dyn PointSet>],
    ) -> Vec<Result<Estimate<DVec3>, Incomplete<DVec3>>> {
        self.averages(size, shares, NonFinite::Reject)
    }

    fn averages_in_two(
        &self,
        size: [u32; 2],
        shares: &[Share<&dyn PointSet>],
        cut: &dyn Fn(&Share<&dyn PointSet>) -> u64,
    ) -> Vec<[Result<Estimate<DVec3>, Incomplete<DVec3>>; 2]> {
        self.averages_in_two(size, shares, cut, NonFinite::Reject)
    }

    fn reuse_paths(&mut self, pixels: u32) -> Result<(), Error> {
        self.paths = self.paths.reused_by(pixels)?;
        Ok(())
    }

    fn learn_roulette(&mut self, size: [u32; 2], count: u64, seed: u64) -> Result<(), Error> {
        self.paths = Self::learn_roulette(self, size, count, seed)?;
        Ok(())
    }

    fn coordinates(
        &self,
        position: [u32; 2],
        size: [u32; 2],
        points: &dyn PointSet,
        index: u64,
    ) -> u64 {
        let drawn = Cell::new(0);
        let mut counting = Counting {
            points,
            index,
            drawn: &drawn,
        };
        self.pixel(position, size).follow(&mut counting, &mut ());
        u64::from(drawn.get())
    }
}

/// The coordinates of one point, and how many have been asked for.
struct Counting<'a> {
    points: &'a dyn PointSet,
    index: u64,
    drawn: &'a Cell<u32>,
}

impl Sampler for Counting<'_> {
    fn next_1d(&mut self) -> f64 {
        let dimension = self.drawn.get();
        self.drawn.set(dimension + 1);
        // Past the last dimension any number is as good: paths as long as that are rare.
        if dimension < self.points.dimensions() {
            self.points.coordinate(self.index, dimension)
        } else {
            crate::hash::unit(crate::hash::hash(self.index, dimension.into()))
        }
    }
}
