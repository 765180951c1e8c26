//! Images from files.

use std::path::Path;

use image::DynamicImage;

use super::{Bitmap, Encoding};
use crate::path::image::FileError;

impl Bitmap {
    /// Reads a file in any format that is enabled: PNG, JPEG, OpenEXR, Radiance HDR, TGA and BMP. Whole numbers are fractions
    /// encoded as sRGB has it, floating-point ones are linear; opacity is left out.
    ///
    /// # Errors
    ///
    /// [`FileError`] if the file cannot be read, and for values that are not finite.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FileError> {
        read(path.as_ref(), Encoding::Srgb)
    }

    /// Reads a file whose numbers are no colours, as those of a normal map are: they are taken as they are.
    ///
    /// # Errors
    ///
    /// [`FileError`] if the file cannot be read, and for values that are not finite.
    pub fn read_raw(path: impl AsRef<Path>) -> Result<Self, FileError> {
        read(path.as_ref(), Encoding::Linear)
    }
}

fn read(path: &Path, encoding: Encoding) -> Result<Bitmap, FileError> {
    let fail = |reason: Box<dyn core::error::Error + Send + Sync>| FileError::new(path, reason);
    let picture = image::ImageReader::open(path)
        .map_err(|error| fail(error.into()))?
        .with_guessed_format()
        .map_err(|error| fail(error.into()))?
        .decode()
        .map_err(|error| fail(error.into()))?;
    let width = picture.width() as usize;
    let grey = !picture.color().has_color();
    let components = if grey { 1 } else { 3 };
    let decode = |value: u16| {
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let decoded = encoding.decode(f64::from(value) / 65535.0) as f32;
        decoded
    };
    let bitmap = match picture {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Bitmap::new(width, components, picture.into_rgb32f().into_raw())
        }
        DynamicImage::ImageLuma16(_) | DynamicImage::ImageLumaA16(_) => {
            let values = picture.into_luma16().into_raw();
            Bitmap::new(width, components, values.into_iter().map(decode).collect())
        }
        DynamicImage::ImageRgb16(_) | DynamicImage::ImageRgba16(_) => {
            let values = picture.into_rgb16().into_raw();
            Bitmap::new(width, components, values.into_iter().map(decode).collect())
        }
        _ if grey => Bitmap::of_bytes(width, components, picture.into_luma8().into_raw(), encoding),
        _ => Bitmap::of_bytes(width, components, picture.into_rgb8().into_raw(), encoding),
    };
    bitmap.map_err(|error| fail(error.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floating_point_files_are_linear() {
        let path = std::env::temp_dir().join(format!("estimand-{}.exr", std::process::id()));
        let pixels = vec![glam::DVec3::new(0.25, 4.0, 0.0), glam::DVec3::splat(0.5)];
        let image = crate::path::Image::new(2, pixels).unwrap();
        image.write_exr(&path).unwrap();
        let bitmap = Bitmap::read(&path);
        std::fs::remove_file(&path).unwrap();
        let left = bitmap.unwrap().color_at(glam::Vec2::new(0.25, 0.5));
        assert_eq!(left.to_array(), [0.25, 4.0, 0.0]);
    }

    #[test]
    fn files_are_read_with_and_without_the_curve() {
        let path = std::env::temp_dir().join(format!("estimand-{}.png", std::process::id()));
        let image = image::RgbaImage::from_raw(1, 2, vec![255, 51, 0, 9, 0, 51, 255, 200]);
        image.unwrap().save(&path).unwrap();
        let (colors, raw) = (Bitmap::read(&path), Bitmap::read_raw(&path));
        std::fs::remove_file(&path).unwrap();
        let (colors, raw) = (colors.unwrap(), raw.unwrap());
        assert_eq!((raw.size(), raw.components()), ([1, 2], 3));
        assert_eq!(raw.range(), [0.0, 1.0]);
        let upper = glam::Vec2::new(0.5, 0.25);
        assert_eq!(raw.color_at(upper).to_array(), [1.0, 0.2, 0.0]);
        // ((0.2 + 0.055) / 1.055)^2.4.
        assert!((colors.color_at(upper).y - 0.033_105).abs() < 1e-6);
        let missing = Bitmap::read(&path).unwrap_err();
        assert!(missing.to_string().contains(path.to_str().unwrap()));
    }
}
