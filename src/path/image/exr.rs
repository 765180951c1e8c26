//! OpenEXR files.

use std::path::Path;

use ::exr::prelude::{SpecificChannels, Vec2, WritableImage};
use glam::DVec3;

use super::{FileError, Image};

impl Image {
    /// Reads red, green and blue of the first layer of an OpenEXR file.
    ///
    /// # Errors
    ///
    /// [`FileError`] if there is no such file, or no such layer in it.
    pub fn read_exr(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let read = ::exr::prelude::read_first_rgba_layer_from_file(
            path,
            |size, _| {
                let pixels = vec![DVec3::ZERO; size.area()];
                (size.width(), pixels)
            },
            |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = DVec3::new(r.into(), g.into(), b.into());
            },
        )
        .map_err(|reason| FileError::new(path, reason))?;
        let (width, pixels) = read.layer_data.channel_data.pixels;
        Self::new(width, pixels).map_err(|reason| FileError::new(path, reason))
    }

    /// Writes red, green and blue to an OpenEXR file, in 32-bit floats; the same picture is the same file to the byte. The
    /// standard errors are an [image of their own](Self::std_error).
    ///
    /// # Errors
    ///
    /// [`FileError`] if the file cannot be written.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let channels = SpecificChannels::rgb(|Vec2(x, y): Vec2<usize>| {
            let [r, g, b] = self.mean[y * self.width + x].as_vec3().to_array();
            (r, g, b)
        });
        let size = (self.width, self.height());
        // Several threads would write the tiles in the order in which they are done with them.
        ::exr::prelude::Image::from_channels(size, channels)
            .write()
            .non_parallel()
            .to_file(path)
            .map_err(|reason| FileError::new(path, reason))
    }
}
