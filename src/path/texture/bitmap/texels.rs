//! The texels of an image in memory: four bytes a component, or one.

use glam::Vec3A;

use crate::Error;
use crate::path::color;

/// What the bytes of an image stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Fractions of 255.
    Linear,
    /// Fractions of 255, encoded by the curve of sRGB.[^srgb]
    ///
    /// [^srgb]: IEC 61966-2-1:1999. *Default RGB colour space, sRGB*. <https://webstore.iec.ch/publication/6169>
    Srgb,
}

impl Encoding {
    /// The linear value of an encoded fraction.
    pub fn decode(self, fraction: f64) -> f64 {
        match self {
            Self::Linear => fraction,
            Self::Srgb if fraction <= 0.04045 => fraction / 12.92,
            Self::Srgb => ((fraction + 0.055) / 1.055).powf(2.4),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Texels {
    width: usize,
    height: usize,
    components: usize,
    values: Values,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    Floats(Vec<f32>),
    /// With what each byte stands for.
    Bytes(Vec<u8>, Box<[f32; 256]>),
}

impl Texels {
    pub(super) fn floats(width: usize, components: usize, values: Vec<f32>) -> Result<Self, Error> {
        let height = rows(width, components, values.len())?;
        Ok(Self {
            width,
            height,
            components,
            values: Values::Floats(values),
        })
    }

    pub(super) fn bytes(
        width: usize,
        components: usize,
        values: Vec<u8>,
        encoding: Encoding,
    ) -> Result<Self, Error> {
        let height = rows(width, components, values.len())?;
        let mut meaning = Box::new([0.0; 256]);
        for (byte, value) in (0_u8..=255).zip(meaning.iter_mut()) {
            #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
            let decoded = encoding.decode(f64::from(byte) / 255.0) as f32;
            *value = decoded;
        }
        Ok(Self {
            width,
            height,
            components,
            values: Values::Bytes(values, meaning),
        })
    }

    pub(super) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    pub(super) fn components(&self) -> usize {
        self.components
    }

    #[inline]
    fn value(&self, index: usize) -> f32 {
        match &self.values {
            Values::Floats(values) => values[index],
            Values::Bytes(values, meaning) => meaning[usize::from(values[index])],
        }
    }

    #[inline]
    pub(super) fn color(&self, column: usize, row: usize) -> Vec3A {
        let first = (row * self.width + column) * self.components;
        if self.components == 1 {
            return Vec3A::splat(self.value(first));
        }
        Vec3A::new(
            self.value(first),
            self.value(first + 1),
            self.value(first + 2),
        )
    }

    #[inline]
    pub(super) fn number(&self, column: usize, row: usize) -> f32 {
        if self.components == 1 {
            return self.value(row * self.width + column);
        }
        self.color(column, row).dot(color::LUMINANCE)
    }

    pub(super) fn mean(&self) -> f32 {
        let texels = (0..self.height).flat_map(|row| (0..self.width).map(move |x| (x, row)));
        let sum: f64 = texels.map(|(x, row)| f64::from(self.number(x, row))).sum();
        #[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
        let mean = (sum / (self.width * self.height) as f64) as f32;
        mean
    }

    pub(super) fn range(&self) -> [f32; 2] {
        let count = self.width * self.height * self.components;
        (0..count)
            .map(|index| self.value(index))
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            })
    }
}

/// How many rows there are.
fn rows(width: usize, components: usize, count: usize) -> Result<usize, Error> {
    if components != 1 && components != 3 {
        let domain = "one or three";
        return Err(Error::refused("number of components", domain, components));
    }
    let row = width.saturating_mul(components);
    if row == 0 || count == 0 || !count.is_multiple_of(row) {
        return Err(Error::refused(
            "number of values",
            "a positive multiple of width and components",
            format_args!("{count} at {width} texels of {components}"),
        ));
    }
    Ok(count / row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_is_decoded_as_its_standard_says() {
        // 188 of 255 is the byte nearest to one half in linear light; 10 lies on the straight part.
        let texels = Texels::bytes(1, 3, vec![188, 10, 255], Encoding::Srgb).unwrap();
        let [a, b, c] = texels.color(0, 0).to_array();
        assert!((a - 0.5029).abs() < 1e-4, "{a}");
        assert!((b - 10.0 / 255.0 / 12.92).abs() < 1e-8, "{b}");
        assert_eq!(c, 1.0);
        let linear = Texels::bytes(1, 1, vec![51], Encoding::Linear).unwrap();
        assert_eq!(linear.number(0, 0), 0.2);
    }

    #[test]
    fn the_luminance_of_white_is_one() {
        let white = Texels::floats(1, 3, vec![1.0; 3]).unwrap();
        assert!((white.mean() - 1.0).abs() < 1e-6);
        assert_eq!(white.range(), [1.0; 2]);
    }
}
