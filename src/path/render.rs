//! Pixels as integrands, images as many estimates.

use core::fmt;

use glam::{DVec3, Vec3};

use super::bsdf::Bsdf;
use super::image::Image;
use super::light::{Environment, Light};
use super::sensor::Sensor;
use super::{Paths, Scene};
use crate::hash::hash;
use crate::{Error, Estimate, Estimator, Integrand, Sampler, each};

/// The mean radiance over a pixel, as an integral over the unit cube: two coordinates for the point of the pixel,
/// those of the [sensor](Sensor::ray), those of the [path](Paths::radiance).
#[derive(Debug)]
pub struct Pixel<'a, B, L, E, C> {
    /// What is seen.
    pub scene: &'a Scene<B, L, E>,
    /// The camera.
    pub sensor: &'a C,
    /// Which paths of light are followed.
    pub paths: Paths,
    /// The column and the row, from the upper left corner of the picture.
    pub position: [u32; 2],
    /// The width and the height of the picture, in pixels.
    pub size: [u32; 2],
}

/// Coordinates computed ahead: those of the film and of two surfaces. Few paths end before.
const AHEAD: u32 = 10;

impl<B: Bsdf, L: Light, E: Environment, C: Sensor> Integrand for Pixel<'_, B, L, E, C>
where
    B: Sync,
{
    type Value = Vec3;

    #[inline]
    fn evaluate<S: Sampler>(&self, u: &mut S) -> Vec3 {
        let [x, y] = u.next_2d();
        let film = [
            (f64::from(self.position[0]) + x) / f64::from(self.size[0]),
            (f64::from(self.position[1]) + y) / f64::from(self.size[1]),
        ];
        let ray = self.sensor.ray(film, u);
        self.paths.radiance(self.scene, ray, u)
    }

    fn dimensions(&self) -> u32 {
        AHEAD
    }
}

/// What to render, and from where.
#[derive(Debug)]
pub struct View<B, L, E, C> {
    /// What is seen.
    pub scene: Scene<B, L, E>,
    /// The camera.
    pub sensor: C,
    /// Which paths of light are followed.
    pub paths: Paths,
}

/// A pixel whose estimate had to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfinished {
    /// The column and the row of the pixel.
    pub position: [u32; 2],
    /// Why it stopped.
    pub reason: Error,
}

impl fmt::Display for Unfinished {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.position;
        write!(f, "pixel ({x}, {y}): {}", self.reason)
    }
}

impl core::error::Error for Unfinished {}

impl<B: Bsdf, L: Light, E: Environment, C: Sensor> View<B, L, E, C> {
    /// The picture, of `size[0]` by `size[1]` pixels: for every pixel the estimate of the estimator that `estimator`
    /// makes from the pixel's seed, a hash of `seed` and of the pixel. So neighbours are independent of one
    /// another.
    ///
    /// The box filter of one pixel: nothing of a pixel is seen in its neighbours. The bits are the same
    /// for any number of threads.
    ///
    /// # Errors
    ///
    /// [`Unfinished`] for the first pixel whose estimate is an error.
    pub fn render<T: Estimator>(
        &self,
        size: [u32; 2],
        seed: u64,
        estimator: impl Fn(u64) -> T + Sync,
    ) -> Result<Image, Unfinished> {
        self.render_while(size, seed, estimator, |_| true)
    }

    /// The same, row by row: `proceed` is called with the number of a row, from any thread, before the row is
    /// rendered. Rows for which it returns `false` stay black.
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
        let [width, height] = size;
        let pixel = |x, y| {
            let position = [x, y];
            let key = hash(hash(seed, u64::from(y)), u64::from(x));
            let pixel = Pixel {
                scene: &self.scene,
                sensor: &self.sensor,
                paths: self.paths,
                position,
                size,
            };
            estimator(key)
                .estimate(&pixel)
                .map_err(|stopped| Unfinished {
                    position,
                    reason: stopped.reason,
                })
        };
        let row = |y| -> Result<Vec<Estimate<DVec3>>, Unfinished> {
            let y = u32::try_from(y).unwrap_or(u32::MAX);
            if proceed(y) {
                (0..width).map(|x| pixel(x, y)).collect()
            } else {
                Ok(vec![Estimate::new(DVec3::ZERO, 0); width as usize])
            }
        };
        let mut estimates = Vec::with_capacity(width as usize * height as usize);
        for row in each(u64::from(height), row) {
            estimates.extend(row?);
        }
        Ok(Image::of_estimates(size, &estimates))
    }
}
