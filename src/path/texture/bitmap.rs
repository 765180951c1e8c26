//! Images as textures.

mod read;
mod texels;

use glam::{Affine2, Vec2, Vec3A};

use crate::Error;
use crate::path::frame::floor;

pub use texels::Encoding;
use texels::Texels;

/// How values between the centres of texels are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// From the four texels around, each with a weight that falls linearly in both coordinates.
    #[default]
    Bilinear,
    /// From the texel that the point is in.
    Nearest,
}

/// What lies outside the unit square of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The same image again.
    #[default]
    Repeat,
    /// The image, every other time mirrored.
    Mirror,
    /// The texels of the edge.
    Clamp,
}

impl Wrap {
    /// Which of `count` texels is at `index`.
    #[inline]
    fn texel(self, index: i64, count: usize) -> usize {
        // An image has far less than 2^62 texels in a row.
        let length = count.cast_signed() as i64;
        if (0..length).contains(&index) {
            // The usual case, without a division.
            return usize::try_from(index).unwrap_or(0);
        }
        let index = match self {
            Self::Repeat => index.rem_euclid(length),
            Self::Mirror => {
                let index = index.rem_euclid(2 * length);
                index.min(2 * length - 1 - index)
            }
            Self::Clamp => index.clamp(0, length - 1),
        };
        usize::try_from(index).unwrap_or(0)
    }
}

/// An image that covers the unit square of the texture coordinates: its upper left corner is at `(0, 0)`, its lower right one
/// at `(1, 1)`.
///
/// One component a texel or three. As a number, three components are their luminance.
///
/// ```
/// use estimand::path::texture::{Bitmap, Filter};
/// use glam::Vec2;
///
/// let image = Bitmap::new(2, 1, vec![0.0, 1.0])?;
/// assert_eq!(image.number_at(Vec2::new(0.5, 0.5)), 0.5);
/// let image = image.filtered(Filter::Nearest);
/// assert_eq!(image.number_at(Vec2::new(0.49, 0.5)), 0.0);
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    texels: Texels,
    filter: Filter,
    wrap: Wrap,
    to_uv: Affine2,
    mean: f32,
    range: [f32; 2],
}

/// The texels around a point and where it lies between them.
struct Around {
    columns: [usize; 2],
    rows: [usize; 2],
    between: Vec2,
}

impl Bitmap {
    /// The image with the given components, row by row from the upper left corner, `components` of them a texel:
    /// linear values of any size.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for another number of components than one or three, for values that are no whole number of
    /// rows of `width` texels, at least one, and for one that is not finite.
    pub fn new(width: usize, components: usize, values: Vec<f32>) -> Result<Self, Error> {
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(Error::refused("texel", "finite", value));
        }
        Texels::floats(width, components, values).map(Self::of)
    }

    /// The image with components of eight bits, which stand for fractions, linear or encoded as sRGB has it.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] as for [`Self::new`].
    pub fn of_bytes(
        width: usize,
        components: usize,
        values: Vec<u8>,
        encoding: Encoding,
    ) -> Result<Self, Error> {
        Texels::bytes(width, components, values, encoding).map(Self::of)
    }

    fn of(texels: Texels) -> Self {
        Self {
            mean: texels.mean(),
            range: texels.range(),
            texels,
            filter: Filter::default(),
            wrap: Wrap::default(),
            to_uv: Affine2::IDENTITY,
        }
    }

    /// The same, with another rule between texels.
    pub fn filtered(mut self, filter: Filter) -> Self {
        self.filter = filter;
        self
    }

    /// The same, with another rule outside of the image.
    pub fn wrapped(mut self, wrap: Wrap) -> Self {
        self.wrap = wrap;
        self
    }

    /// The same, with texture coordinates that are transformed first.
    pub fn transformed(mut self, to_uv: Affine2) -> Self {
        self.to_uv = to_uv;
        self
    }

    /// Texels in a row and rows.
    pub fn size(&self) -> [usize; 2] {
        self.texels.size()
    }

    /// How many components a texel has: one or three.
    pub fn components(&self) -> usize {
        self.texels.components()
    }

    /// The mean over all texels, of three components that of the luminance.
    pub fn mean(&self) -> f32 {
        self.mean
    }

    /// The least and the greatest component of all texels.
    pub fn range(&self) -> [f32; 2] {
        self.range
    }

    /// The value at `uv` as linear red, green and blue.
    #[inline]
    pub fn color_at(&self, uv: Vec2) -> Vec3A {
        self.at(uv, |column, row| self.texels.color(column, row))
    }

    /// The value at `uv` as a number.
    #[inline]
    pub fn number_at(&self, uv: Vec2) -> f32 {
        self.at(uv, |column, row| self.texels.number(column, row))
    }

    /// The derivatives of the number at `uv` by `u` and `v`; zero without interpolation.
    pub fn slope_at(&self, uv: Vec2) -> Vec2 {
        if self.filter == Filter::Nearest {
            return Vec2::ZERO;
        }
        let Around {
            columns: [left, right],
            rows: [upper, lower],
            between,
        } = self.around(self.texel_coordinates(uv) - 0.5);
        let number = |column, row| self.texels.number(column, row);
        let (a, b) = (number(left, upper), number(right, upper));
        let (c, d) = (number(left, lower), number(right, lower));
        let slope = Vec2::new(mix(b - a, d - c, between.y), mix(c - a, d - b, between.x));
        self.to_uv.matrix2.transpose() * (slope * self.resolution())
    }

    #[inline]
    fn at<V>(&self, uv: Vec2, texel: impl Fn(usize, usize) -> V) -> V
    where
        V: Copy + core::ops::Add<Output = V> + core::ops::Mul<f32, Output = V>,
    {
        let point = self.texel_coordinates(uv);
        if self.filter == Filter::Nearest {
            let around = self.around(point);
            return texel(around.columns[0], around.rows[0]);
        }
        let Around {
            columns: [left, right],
            rows: [upper, lower],
            between,
        } = self.around(point - 0.5);
        let above = mix(texel(left, upper), texel(right, upper), between.x);
        let below = mix(texel(left, lower), texel(right, lower), between.x);
        mix(above, below, between.y)
    }

    #[inline]
    fn resolution(&self) -> Vec2 {
        let [width, height] = self.texels.size();
        Vec2::new(width as f32, height as f32)
    }

    #[inline]
    fn texel_coordinates(&self, uv: Vec2) -> Vec2 {
        self.to_uv.transform_point2(uv) * self.resolution()
    }

    #[inline]
    fn around(&self, point: Vec2) -> Around {
        let corner = point.map(floor);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a whole number or saturated"
        )]
        let [column, row] = [corner.x as i64, corner.y as i64];
        let [width, height] = self.texels.size();
        Around {
            columns: [column, column.saturating_add(1)].map(|i| self.wrap.texel(i, width)),
            rows: [row, row.saturating_add(1)].map(|i| self.wrap.texel(i, height)),
            between: point - corner,
        }
    }
}

#[inline]
fn mix<V>(a: V, b: V, t: f32) -> V
where
    V: core::ops::Add<Output = V> + core::ops::Mul<f32, Output = V>,
{
    a * (1.0 - t) + b * t
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(wrap: Wrap) -> Bitmap {
        let values = vec![0.0, 1.0, 2.0, 3.0];
        Bitmap::new(4, 1, values).unwrap().wrapped(wrap)
    }

    #[test]
    fn outside_the_image_it_is_repeated_mirrored_or_continued() {
        let at = |wrap, x: f32| {
            let image = row(wrap).filtered(Filter::Nearest);
            image.number_at(Vec2::new(x, 7.3))
        };
        for (x, repeat, mirror, clamp) in [
            (0.1, 0.0, 0.0, 0.0),
            (0.9, 3.0, 3.0, 3.0),
            (1.1, 0.0, 3.0, 3.0),
            (1.9, 3.0, 0.0, 3.0),
            (2.1, 0.0, 0.0, 3.0),
            (-0.1, 3.0, 0.0, 0.0),
            (-0.9, 0.0, 3.0, 0.0),
        ] {
            assert_eq!(at(Wrap::Repeat, x), repeat, "{x}");
            assert_eq!(at(Wrap::Mirror, x), mirror, "{x}");
            assert_eq!(at(Wrap::Clamp, x), clamp, "{x}");
        }
    }

    #[test]
    fn interpolation_is_linear_between_centres_and_wraps() {
        let image = row(Wrap::Repeat);
        assert_eq!(image.number_at(Vec2::new(0.125, 0.0)), 0.0);
        assert_eq!(image.number_at(Vec2::new(0.5, 0.4)), 1.5);
        assert_eq!(image.number_at(Vec2::new(0.0, 0.9)), 1.5);
        assert_eq!(row(Wrap::Clamp).number_at(Vec2::new(0.0, 0.9)), 0.0);
    }

    #[test]
    fn slopes_are_those_of_the_values() {
        let values = (0_u8..12).map(|i| f32::from(i * i % 7)).collect();
        let turn = Affine2::from_scale_angle_translation(Vec2::new(1.5, 0.5), 0.4, Vec2::X);
        let image = Bitmap::new(4, 1, values).unwrap().transformed(turn);
        let uv = Vec2::new(0.31, 0.57);
        let slope = image.slope_at(uv);
        let step = 1e-3;
        for (axis, expected) in [(Vec2::X, slope.x), (Vec2::Y, slope.y)] {
            let high = image.number_at(uv + axis * step);
            let low = image.number_at(uv - axis * step);
            let difference = (high - low) / (2.0 * step);
            assert!((difference - expected).abs() < 0.02 * slope.length());
        }
    }

    #[test]
    fn coordinates_far_away_are_no_panic() {
        for x in [f32::MAX, -f32::MAX, 1e10, f32::INFINITY, f32::NAN] {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                row(wrap).number_at(Vec2::new(x, -x));
            }
        }
    }

    #[test]
    fn what_is_no_image_is_refused() {
        assert!(Bitmap::new(4, 1, vec![0.0; 6]).is_err());
        assert!(Bitmap::new(0, 1, Vec::new()).is_err());
        assert!(Bitmap::new(1, 2, vec![0.0; 2]).is_err());
        assert!(Bitmap::new(1, 1, vec![f32::NAN]).is_err());
    }
}
