//! Pictures: radiance per pixel, and how sure it is.

mod difference;
mod exr;
mod png;
mod rows;

use core::fmt;
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::Error;

pub(in crate::path) use rows::Row;

/// Linear red, green and blue per pixel, row by row from the upper left corner, with or without their standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    mean: Vec<DVec3>,
    std_error: Option<Vec<DVec3>>,
    evaluations: Evaluations,
}

/// How many evaluations a picture took, over all pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Evaluations {
    requested: u64,
    used: u64,
    rejected: u64,
}

impl Image {
    /// The image with the given pixels, row by row, without standard errors.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the pixels are no whole number of rows of `width` pixels, at least one.
    pub fn new(width: usize, pixels: Vec<DVec3>) -> Result<Self, Error> {
        if width == 0 || pixels.is_empty() || !pixels.len().is_multiple_of(width) {
            return Err(Error::refused(
                "number of pixels",
                "a positive multiple of the width",
                format_args!("{} at a width of {width}", pixels.len()),
            ));
        }
        Ok(Self {
            width,
            mean: pixels,
            std_error: None,
            evaluations: Evaluations::default(),
        })
    }

    /// The same with the given standard errors.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if it is of another size.
    pub fn with_std_error(mut self, std_error: Self) -> Result<Self, Error> {
        self.same_size(&std_error)?;
        self.std_error = Some(std_error.mean);
        Ok(self)
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.mean.len() / self.width
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> &[DVec3] {
        &self.mean
    }

    /// The standard errors of the pixels, as an image of its own; infinite where nothing was rendered, never NaN
    /// there. `None` if any pixel that was rendered has none, as is the case for [`Average`](crate::Average).
    pub fn std_error(&self) -> Option<Self> {
        self.std_error.clone().map(|mean| Self {
            width: self.width,
            mean,
            std_error: None,
            evaluations: Evaluations::default(),
        })
    }

    /// How many evaluations of the integrand were asked for, over all pixels that were rendered; 0 for an image that was
    /// not rendered here.
    pub fn requested(&self) -> u64 {
        self.evaluations.requested
    }

    /// How many evaluations were made, over all pixels: see [`Estimate::used`](crate::Estimate::used).
    pub fn used(&self) -> u64 {
        self.evaluations.used
    }

    /// How many of the values were not finite and left out, over all pixels. Where it is not 0, the picture is too dark
    /// or too bright by what they stood for.
    pub fn rejected(&self) -> u64 {
        self.evaluations.rejected
    }

    /// The mean over all pixels.
    pub fn mean(&self) -> DVec3 {
        self.mean.iter().sum::<DVec3>() / self.mean.len() as f64
    }

    /// The image with squares of `factor` by `factor` pixels averaged into one: what the same scene gives at the
    /// smaller size. Standard errors are those of independent pixels.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a factor that does not divide width and height.
    pub fn downsampled(&self, factor: usize) -> Result<Self, Error> {
        if factor == 0
            || !self.width.is_multiple_of(factor)
            || !self.height().is_multiple_of(factor)
        {
            return Err(Error::refused(
                "factor",
                "a divisor of width and height",
                factor,
            ));
        }
        let count = (factor * factor) as f64;
        Ok(Self {
            width: self.width / factor,
            mean: self.squares(&self.mean, factor, |sum, pixel| sum + pixel / count),
            std_error: self.std_error.as_ref().map(|errors| {
                self.squares(errors, factor, |sum, error| {
                    (sum * sum + error * error / (count * count)).map(f64::sqrt)
                })
            }),
            evaluations: self.evaluations,
        })
    }

    /// Folds the pixels of every square of `factor` by `factor`.
    fn squares(
        &self,
        pixels: &[DVec3],
        factor: usize,
        fold: impl Fn(DVec3, DVec3) -> DVec3,
    ) -> Vec<DVec3> {
        let (width, height) = (self.width / factor, self.height() / factor);
        let mut squares = vec![DVec3::ZERO; width * height];
        for (y, row) in pixels.chunks_exact(self.width).enumerate() {
            for (x, &pixel) in row.iter().enumerate() {
                let square = &mut squares[y / factor * width + x / factor];
                *square = fold(*square, pixel);
            }
        }
        squares
    }

    /// The mean of this picture and one of other samples, as large, with the weights of both in each pixel. If both have standard errors, so
    /// has it.
    pub(in crate::path) fn joined(self, other: &Self, weights: impl Fn(usize) -> [f64; 2]) -> Self {
        let parts = |pixel: usize| {
            let [a, b] = weights(pixel);
            [a / (a + b), b / (a + b)]
        };
        let pixels = self.mean.iter().zip(&other.mean).enumerate();
        let mean = pixels.map(|(pixel, (here, there))| {
            let [a, b] = parts(pixel);
            *here * a + *there * b
        });
        let errors = self.std_error.as_ref().zip(other.std_error.as_ref());
        let std_error = errors.map(|(here, there)| {
            let pixels = here.iter().zip(there).enumerate();
            let joined = pixels.map(|(pixel, (here, there))| {
                let [a, b] = parts(pixel);
                let (here, there) = (*here * a, *there * b);
                (here * here + there * there).map(f64::sqrt)
            });
            joined.collect()
        });
        let (these, those) = (self.evaluations, other.evaluations);
        Self {
            width: self.width,
            mean: mean.collect(),
            std_error,
            evaluations: Evaluations {
                requested: these.requested + those.requested,
                used: these.used + those.used,
                rejected: these.rejected + those.rejected,
            },
        }
    }

    fn same_size(&self, other: &Self) -> Result<(), Error> {
        if self.width == other.width && self.mean.len() == other.mean.len() {
            return Ok(());
        }
        Err(Error::refused(
            "other image",
            "of the same size",
            format_args!(
                "{} x {} to {} x {}",
                other.width,
                other.height(),
                self.width,
                self.height()
            ),
        ))
    }
}

/// A file that could not be read or written.
#[derive(Debug)]
pub struct FileError {
    path: PathBuf,
    reason: Box<dyn core::error::Error + Send + Sync>,
}

impl FileError {
    pub(in crate::path) fn new(
        path: &Path,
        reason: impl Into<Box<dyn core::error::Error + Send + Sync>>,
    ) -> Self {
        Self {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    /// Which file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.reason)
    }
}

impl core::error::Error for FileError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        Some(&*self.reason)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: usize, height: usize) -> Image {
        let pixels = (0..width * height)
            .map(|i| DVec3::new(i as f64, 0.5, 1.0 / (i + 1) as f64))
            .collect();
        Image::new(width, pixels).unwrap()
    }

    #[test]
    fn downsampling_averages_squares_and_their_errors() {
        let image = ramp(4, 2).with_std_error(ramp(4, 2)).unwrap();
        let small = image.downsampled(2).unwrap();
        assert_eq!((small.width(), small.height()), (2, 1));
        assert_eq!(small.pixels()[0].x, (0.0 + 1.0 + 4.0 + 5.0) / 4.0);
        let expected = f64::sqrt(4.0 + 9.0 + 36.0 + 49.0) / 4.0;
        assert!((small.std_error().unwrap().pixels()[1].x - expected).abs() < 1e-15);
        assert!((small.mean() - image.mean()).length() < 1e-15);
        assert!(image.downsampled(0).is_err());
        assert!(image.downsampled(3).is_err());
    }

    #[test]
    fn sizes_must_fit() {
        assert!(Image::new(0, Vec::new()).is_err());
        assert!(Image::new(3, vec![DVec3::ZERO; 4]).is_err());
        assert!(ramp(4, 2).with_std_error(ramp(2, 4)).is_err());
        assert!(ramp(4, 2).rmse(&ramp(2, 4)).is_err());
    }

    #[test]
    fn files_come_back() {
        let directory = std::env::temp_dir().join(format!("estimand-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let (exr, png) = (directory.join("ramp.exr"), directory.join("ramp.png"));
        // Powers of two and fractions that f32 holds.
        let image = Image::new(2, vec![DVec3::new(0.25, 1024.0, 0.0); 6]).unwrap();
        image.write_exr(&exr).unwrap();
        assert_eq!(Image::read_exr(&exr).unwrap(), image);
        image.write_png(&png).unwrap();
        let bytes = ::image::open(&png).unwrap().into_rgb8();
        // 0.25 in sRGB is 1.055 * 0.25^(1/2.4) - 0.055 = 0.5371, times 255 is 136.96.
        assert_eq!(bytes.get_pixel(1, 2).0, [137, 255, 0]);
        std::fs::remove_dir_all(&directory).unwrap();
        let missing = Image::read_exr(&exr).unwrap_err();
        assert!(missing.to_string().contains("ramp.exr"));
        assert!(image.write_png(&png).is_err());
    }
}
