//! PNG files.

use std::path::Path;

use ::image::RgbImage;

use super::{FileError, Image};

impl Image {
    /// Writes a PNG file with eight bits a component, encoded as sRGB.[^srgb]
    ///
    /// There is no tone mapping: a radiance of 1 is white, and what is brighter is cut off, component by component.
    ///
    /// # Errors
    ///
    /// [`FileError`] if the file cannot be written.
    ///
    /// [^srgb]: International Electrotechnical Commission (1999). *Colour management - Default RGB colour space -
    ///     sRGB*. IEC 61966-2-1. <https://webstore.iec.ch/en/publication/6169>
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let size = [self.width, self.height()].map(u32::try_from);
        let [Ok(width), Ok(height)] = size else {
            return Err(FileError::new(path, "more than 2^32 rows or columns"));
        };
        let pixels = self
            .mean
            .iter()
            .flat_map(|pixel| pixel.to_array().map(encoded));
        RgbImage::from_raw(width, height, pixels.collect())
            .ok_or_else(|| FileError::new(path, "too large a picture"))?
            .save_with_format(path, ::image::ImageFormat::Png)
            .map_err(|reason| FileError::new(path, reason))
    }
}

/// A linear component as a byte of sRGB; zero for NaN.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "in 0..=255, and a cast of NaN is zero"
)]
fn encoded(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}
