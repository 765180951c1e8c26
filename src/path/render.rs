//! Pixels as integrands, images as many estimates.

use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3, Vec3A};

use super::bsdf::Bsdf;
#[cfg(feature = "simd")]
use super::bsdf::{Lambertian, Scattered, Scattering};
use super::filter::{BoxFilter, Filter};
#[cfg(feature = "simd")]
use super::geometry::{Geometry, Hit};
use super::image::{Image, Row};
#[cfg(feature = "simd")]
use super::light::{Emission, Illumination, Sky, Surroundings};
use super::light::{Environment, Light};
#[cfg(feature = "simd")]
use super::packet::{Packet, Single};
use super::roulette::Witness;
use super::sensor::Sensor;
use super::{Paths, Ray, Scene, Share};
use crate::points::{PointSet, pixel};
use crate::{Error, Estimate, Estimator, Incomplete, Integrand, NonFinite, Outcome, Sampler, each};

/// The mean radiance around a pixel, as an integral over the unit cube: two coordinates for the point of the
/// [film](Filter::sample), those of the [sensor](Sensor::ray), those of the [path](Paths::radiance).
#[derive(Debug)]
pub struct Pixel<'a, B, L, E, C, F = BoxFilter> {
    /// What is seen.
    pub scene: &'a Scene<B, L, E>,
    /// The camera.
    pub sensor: &'a C,
    /// What the pixel sees of the film.
    pub filter: &'a F,
    /// Which paths of light are followed.
    pub paths: Paths,
    /// The column and the row, from the upper left corner of the picture.
    pub position: [u32; 2],
    /// The width and the height of the picture, in pixels.
    pub size: [u32; 2],
}

/// Coordinates computed ahead of paths that the surroundings soon end: those of the film and of two surfaces without lamps.
const AHEAD: u32 = 10;

/// Coordinates computed ahead where nothing is around the scene.
const FAR_AHEAD: u32 = 34;

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> Pixel<'_, B, L, E, C, F> {
    /// The ray of a path, and what its radiance counts.
    #[inline]
    pub(in crate::path) fn start<S: Sampler>(&self, u: &mut S) -> Start {
        let seen = self.filter.sample(self.position, self.size, u.next_2d());
        let film = core::array::from_fn(|axis| seen.point[axis] / f64::from(self.size[axis]));
        let mut ray = self.sensor.ray(film, u);
        if let Some(far) = self.sensor.far_plane() {
            ray = self.scene.past_far(ray, far);
        }
        Start {
            ray,
            weight: seen.weight,
        }
    }

    /// The radiance of a path that somebody looks at, and what it counts.
    #[inline(never)]
    pub(crate) fn follow(&self, mut u: &mut dyn Sampler, witness: &mut dyn Witness) -> (Vec3, f32) {
        let Start { ray, weight } = self.start(&mut u);
        let radiance = self.paths.witnessed(self.scene, ray, &mut u, witness);
        (radiance, weight)
    }
}

#[cfg(feature = "simd")]
impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> Single for Pixel<'_, B, L, E, C, F> {
    fn evaluate(&self, at: &Hit, out: Vec3A, into: Vec3A) -> Scattering {
        let vertex = self.scene.vertex(*at);
        vertex.bsdf.evaluate(&vertex.surface, out, into)
    }

    fn lambertian(&self, at: &Hit) -> Option<Lambertian> {
        let vertex = self.scene.vertex(*at);
        vertex.bsdf.lambertian_at(&vertex.surface)
    }

    fn sample(&self, at: &Hit, out: Vec3A, mut u: &mut dyn Sampler) -> Option<Scattered> {
        let vertex = self.scene.vertex(*at);
        vertex.bsdf.sample(&vertex.surface, out, &mut u)
    }

    fn lamp(&self, at: &Hit, mut u: &mut dyn Sampler) -> Option<Illumination> {
        self.scene.lights().sample(&at.surface, &mut u)
    }

    fn around(&self, at: &Hit, mut u: &mut dyn Sampler) -> Option<Illumination> {
        self.scene.environment().sample(&at.surface, &mut u)
    }

    fn emitted(&self, at: &Hit, from: Vec3A) -> Emission {
        self.scene.emitted(at, from)
    }

    fn background(&self, direction: Vec3A) -> Emission {
        self.scene.environment().emitted(direction)
    }

    fn geometry(&self) -> &Geometry {
        self.scene.geometry()
    }

    fn sky(&self) -> Option<&Sky> {
        self.scene.environment().as_sky()
    }

    fn sources(&self) -> Option<&Surroundings> {
        let surroundings = self.scene.environment().as_surroundings()?;
        surroundings.around_in_lanes().map(|_| surroundings)
    }
}

#[cfg(feature = "simd")]
impl<B, L, E, C, F> Pixel<'_, B, L, E, C, F> {
    /// The scene for many paths at once, if it is one of those and the paths are too.
    #[inline]
    pub(in crate::path) fn packet(&self) -> Option<&Packet> {
        if self.paths.hides_lights {
            return None;
        }
        self.scene.packet()
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> Integrand
    for Pixel<'_, B, L, E, C, F>
{
    type Value = Vec3;

    const AT_ONCE: usize = 256;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> Vec3 {
        let Start { ray, weight } = self.start(u);
        self.paths.radiance(self.scene, ray, u) * weight
    }

    #[inline]
    fn evaluate_many<S: Sampler>(&self, samplers: &mut [S], values: &mut [Vec3]) {
        #[cfg(feature = "simd")]
        if let Some(packet) = self.packet() {
            let starts: Vec<_> = samplers.iter_mut().map(|u| self.start(u)).collect();
            let mut points: Vec<_> = (samplers.iter_mut())
                .map(|sampler| sampler as &mut dyn Sampler)
                .collect();
            return packet.radiance_of_any(self.paths, self, &starts, &mut points, values);
        }
        for (u, value) in samplers.iter_mut().zip(values) {
            *value = Integrand::evaluate(self, u);
        }
    }

    fn dimensions(&self) -> u32 {
        if self.scene.environment().constant() == Some(Vec3A::ZERO) {
            FAR_AHEAD
        } else {
            AHEAD
        }
    }
}

/// Where a path begins, and what it counts.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Start {
    pub(in crate::path) ray: Ray,
    pub(in crate::path) weight: f32,
}

/// What to render, and from where.
#[derive(Debug)]
pub struct View<B, L, E, C, F = BoxFilter> {
    /// What is seen.
    pub scene: Scene<B, L, E>,
    /// The camera.
    pub sensor: C,
    /// What a pixel sees of the film.
    pub filter: F,
    /// Which paths of light are followed.
    pub paths: Paths,
}

/// A picture that had to stop, with what there is of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfinished {
    /// Why it stopped.
    pub reason: Error,
    /// The column and the row of the pixel whose estimate stopped; `None` if it was none of them.
    pub position: Option<[u32; 2]>,
    /// The estimate of that pixel, from all evaluations before the one that stopped it; `None` if there were none.
    pub so_far: Option<Box<Estimate<DVec3>>>,
    /// The picture with all pixels before that one, row by row. The others, itself included, are black, with infinite
    /// standard errors. `None` if rendering did not begin.
    pub image: Option<Box<Image>>,
}

impl From<Error> for Unfinished {
    fn from(reason: Error) -> Self {
        Self {
            reason,
            position: None,
            so_far: None,
            image: None,
        }
    }
}

impl fmt::Display for Unfinished {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some([x, y]) = self.position {
            write!(f, "pixel ({x}, {y}): ")?;
        }
        write!(f, "{}", self.reason)
    }
}

impl core::error::Error for Unfinished {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        Some(&self.reason)
    }
}

/// Why a row was cut short.
struct Stopped {
    position: [u32; 2],
    incomplete: Incomplete<DVec3>,
}

impl Row {
    /// Adds the pixel at `position`, the next one, if there is an estimate of it.
    fn take(&mut self, position: [u32; 2], outcome: Outcome<Vec3>) -> Result<(), Stopped> {
        let estimate = outcome.map_err(|incomplete| Stopped {
            position,
            incomplete,
        })?;
        self.push(&estimate);
        Ok(())
    }
}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor, F: Filter> View<B, L, E, C, F> {
    /// The picture, of `size[0]` by `size[1]` pixels: for every pixel the estimate of the estimator that `estimator`
    /// makes from the pixel's seed, which is [`pixel::seed`]`([x, y], seed)`. So neighbours are independent of
    /// one another, and anybody can compute a pixel again, or go on with it:
    ///
    /// ```
    /// use estimand::path::scenes;
    /// use estimand::points::pixel;
    /// use estimand::{Estimator, MonteCarlo};
    ///
    /// let view = scenes::cornell_box();
    /// let (size, [x, y], seed) = ([8, 8], [3, 5], 1);
    /// let picture = view.render(size, seed, |key| MonteCarlo::new(16, key))?;
    ///
    /// let again = MonteCarlo::new(16, pixel::seed([x, y], seed));
    /// let again = again.estimate(&view.pixel([x, y], size))?;
    /// assert_eq!(again.mean, picture.pixels()[(y * size[0] + x) as usize]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// The film of the sensor is stretched over the picture, whatever its size: for square pixels the camera's
    /// aspect must be `size[0] / size[1]`.
    ///
    /// Pixels are independent of one another, whatever the filter. The bits are the same for any number of threads.
    ///
    /// # Errors
    ///
    /// [`Unfinished`] if an estimate is an error: for the first such pixel of the picture, row by row, whatever the
    /// number of threads. Rows after it are not begun any more; those before it are finished, and are
    /// [there](Unfinished::image). Also for a picture without pixels.
    pub fn render<T: Estimator>(
        &self,
        size: [u32; 2],
        seed: u64,
        estimator: impl Fn(u64) -> T + Sync,
    ) -> Result<Image, Unfinished> {
        self.render_while(size, seed, estimator, |_| true)
    }

    /// The same, row by row: `proceed` is called with the number of a row, from any thread, before the row is
    /// rendered. Rows for which it returns `false` stay black, with infinite
    /// [standard errors](Image::std_error): nothing is known of them.
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render).
    pub fn render_while<T: Estimator>(
        &self,
        size: [u32; 2],
        seed: u64,
        estimator: impl Fn(u64) -> T + Sync,
        proceed: impl Fn(u32) -> bool + Sync,
    ) -> Result<Image, Unfinished> {
        let estimate = |position, key| estimator(key).estimate(&self.pixel(position, size));
        Image::of_pixels_while(size, seed, &estimate, &proceed)
    }

    /// The picture whose pixels are means over the first `count` points, or all of a finite set, that `points` makes of their seeds: what
    /// [`render`](Self::render) gives with [`Average`](crate::Average), to the bit, and faster, since many paths are followed
    /// at once; see [`averages`](Self::averages). Unless paths are [reused](Paths::reused_by): then it has less noise, and pixels are no longer
    /// independent of one another.
    ///
    /// ```
    /// use estimand::Average;
    /// use estimand::path::scenes;
    /// use estimand::points::Rescrambled;
    ///
    /// let (view, size) = (scenes::cornell_box(), [16, 16]);
    /// let points = |seed| Rescrambled::new(4, seed);
    /// let picture = view.render_points(size, 1, 8, points, |_| true)?;
    /// let singly = view.render(size, 1, |seed| Average::new(points(seed).unwrap(), 8))?;
    /// assert_eq!(picture, singly);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// `proceed` is that of [`render_while`](Self::render_while).
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render), and where `points` has an error.
    pub fn render_points<P: PointSet>(
        &self,
        size: [u32; 2],
        seed: u64,
        count: u64,
        points: impl Fn(u64) -> Result<P, Error> + Sync,
        proceed: impl Fn(u32) -> bool + Sync,
    ) -> Result<Image, Unfinished> {
        let share = |position| -> Result<Share<P>, Stopped> {
            let points = points(pixel::seed(position, seed)).map_err(|reason| Stopped {
                position,
                incomplete: reason.into(),
            })?;
            Ok(Share {
                position,
                points,
                count,
            })
        };
        Image::of_rows_while(size, &proceed, &|y| {
            let (mut row, mut refused) = (Row::new(), None);
            let mut shares = Vec::with_capacity(size[0] as usize);
            for x in 0..size[0] {
                match share([x, y]) {
                    Ok(share) => shares.push(share),
                    Err(stopped) => {
                        refused = Some(stopped);
                        break;
                    }
                }
            }
            let outcomes = self.averages(size, &shares, NonFinite::Fail);
            for (share, outcome) in shares.iter().zip(outcomes) {
                if let Err(stopped) = row.take(share.position, outcome) {
                    return (row, Some(stopped));
                }
            }
            (row, refused)
        })
    }

    /// The pixel in column and row `position` of a picture of `size`.
    pub fn pixel(&self, position: [u32; 2], size: [u32; 2]) -> Pixel<'_, B, L, E, C, F> {
        Pixel {
            scene: &self.scene,
            sensor: &self.sensor,
            filter: &self.filter,
            paths: self.paths,
            position,
            size,
        }
    }
}

impl Image {
    /// The picture with whatever `estimate` gives for each pixel, told its column and row and its seed, as
    /// [`View::render`] has it.
    ///
    /// ```
    /// use estimand::path::{Image, scenes};
    /// use estimand::{Estimator, MonteCarlo};
    ///
    /// // More samples in the middle.
    /// let (view, size) = (scenes::cornell_box(), [16, 16]);
    /// let picture = Image::of_pixels(size, 1, |[x, y], key| {
    ///     let count = if (4..12).contains(&x) && (4..12).contains(&y) { 64 } else { 8 };
    ///     MonteCarlo::new(count, key).estimate(&view.pixel([x, y], size))
    /// })?;
    /// assert_eq!(picture.used(), 64 * 64 + 192 * 8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`View::render`].
    pub fn of_pixels(
        size: [u32; 2],
        seed: u64,
        estimate: impl Fn([u32; 2], u64) -> Outcome<Vec3> + Sync,
    ) -> Result<Self, Unfinished> {
        Self::of_pixels_while(size, seed, &estimate, &|_| true)
    }

    pub(in crate::path) fn of_pixels_while(
        size: [u32; 2],
        seed: u64,
        estimate: &(dyn Fn([u32; 2], u64) -> Outcome<Vec3> + Sync),
        proceed: &(dyn Fn(u32) -> bool + Sync),
    ) -> Result<Self, Unfinished> {
        Self::of_rows_while(size, proceed, &|y| {
            let mut row = Row::new();
            for x in 0..size[0] {
                let position = [x, y];
                let outcome = estimate(position, pixel::seed(position, seed));
                if let Err(stopped) = row.take(position, outcome) {
                    return (row, Some(stopped));
                }
            }
            (row, None)
        })
    }

    /// The picture of whatever rows `row` gives, up to the first that stops.
    fn of_rows_while(
        size: [u32; 2],
        proceed: &(dyn Fn(u32) -> bool + Sync),
        row: &(dyn Fn(u32) -> (Row, Option<Stopped>) + Sync),
    ) -> Result<Self, Unfinished> {
        let [_, height] = size;
        check_size(size)?;
        // The first row that is known to stop. Rows before it go on: one of them may stop too, and is to be reported then.
        let first_stopped = AtomicU32::new(u32::MAX);
        let row = |y| {
            if y > first_stopped.load(Ordering::Relaxed) || !proceed(y) {
                return (Row::new(), None);
            }
            let (row, stopped) = row(y);
            if stopped.is_some() {
                first_stopped.fetch_min(y, Ordering::Relaxed);
            }
            (row, stopped)
        };
        let rows = each(u64::from(height), |y| {
            row(u32::try_from(y).expect("the height is a u32"))
        });
        let mut finished = Vec::with_capacity(rows.len());
        for (row, stopped) in rows {
            finished.push(row);
            if let Some(Stopped {
                position,
                incomplete,
            }) = stopped
            {
                return Err(Unfinished {
                    reason: incomplete.reason,
                    position: Some(position),
                    so_far: incomplete.so_far,
                    image: Some(Box::new(Self::of_rows(size, &finished))),
                });
            }
        }
        Ok(Self::of_rows(size, &finished))
    }
}

/// That a picture has pixels.
pub(in crate::path) fn check_size([width, height]: [u32; 2]) -> Result<(), Error> {
    if width > 0 && height > 0 {
        return Ok(());
    }
    let given = format_args!("{width} x {height}");
    Err(Error::refused(
        "size of the picture",
        "at least 1 x 1 pixels",
        given,
    ))
}
