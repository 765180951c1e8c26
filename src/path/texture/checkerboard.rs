//! Two textures in turn.

use glam::{Affine2, Vec2, Vec3A};

use super::{Parameter, Texture};
use crate::path::Spot;
use crate::path::frame::floor;

/// Two textures in turn: in each unit square of the transformed texture coordinates the first one in the quarters
/// where both coordinates are in the lower half, or both in the upper one, and the second one elsewhere.
///
/// As a number, the two change places. So Mitsuba has it, whose pictures are to be met.
///
/// ```
/// use estimand::path::Spot;
/// use estimand::path::texture::{Checkerboard, Uniform};
/// use glam::{Affine2, Vec2};
///
/// let colors = [Uniform::from(0.4).into(), Uniform::from(0.2).into()];
/// let board = Checkerboard::new(colors, Affine2::from_scale(Vec2::splat(4.0)));
/// assert_eq!(board.color(&Spot::new(Vec2::new(0.05, 0.05))).x, 0.4);
/// assert_eq!(board.color(&Spot::new(Vec2::new(0.05, 0.2))).x, 0.2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Checkerboard {
    textures: [Texture; 2],
    to_uv: Affine2,
}

impl Checkerboard {
    /// The two textures in turn; `to_uv` transforms the texture coordinates of the board, not those of the
    /// two.
    pub fn new(textures: [Texture; 2], to_uv: Affine2) -> Self {
        Self { textures, to_uv }
    }

    /// Which of the two colours is at `uv`.
    #[inline]
    fn field(&self, uv: Vec2) -> usize {
        let uv = self.to_uv.transform_point2(uv);
        let upper = (uv - uv.map(floor)).cmpgt(Vec2::splat(0.5));
        usize::from(upper.test(0) != upper.test(1))
    }

    /// The value at a place as linear red, green and blue.
    #[inline]
    pub fn color(&self, place: &Spot) -> Vec3A {
        self.textures[self.field(place.uv)].color(place)
    }

    /// The value at a place as a number.
    #[inline]
    pub fn number(&self, place: &Spot) -> f32 {
        self.textures[1 - self.field(place.uv)].number(place)
    }

    /// The derivatives of the number by `u` and `v` within a field.
    #[inline]
    pub fn slope(&self, place: &Spot) -> Vec2 {
        self.textures[1 - self.field(place.uv)].slope(place)
    }

    /// The mean number.
    pub fn mean(&self) -> f32 {
        let [first, second] = &self.textures;
        0.5 * (first.mean() + second.mean())
    }

    /// The least and the greatest component of both.
    pub fn range(&self) -> [f32; 2] {
        let [first, second] = &self.textures;
        let ([a, b], [c, d]) = (first.range(), second.range());
        // Minimum and maximum would lose NaN.
        if (a + b + c + d).is_nan() {
            return [f32::NAN; 2];
        }
        [a.min(c), b.max(d)]
    }
}
