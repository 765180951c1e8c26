//! Values that are the same everywhere.

use glam::{Vec2, Vec3A};

use super::Parameter;

/// The same value everywhere: linear red, green and blue, or a number.
///
/// As a number, three components are their mean.
///
/// ```
/// use estimand::path::texture::{Parameter, Uniform};
///
/// let red = Uniform::from([0.5, 0.25, 0.0]);
/// assert_eq!(red.number(&()), 0.25);
/// assert_eq!(Uniform::from(0.5).color(&()).to_array(), [0.5; 3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform(Vec3A);

impl Uniform {
    /// One in every component.
    pub const ONE: Self = Self(Vec3A::ONE);
}

impl From<f32> for Uniform {
    fn from(number: f32) -> Self {
        Self(Vec3A::splat(number))
    }
}

impl From<[f32; 3]> for Uniform {
    fn from(rgb: [f32; 3]) -> Self {
        Self(Vec3A::from(rgb))
    }
}

impl Parameter for Uniform {
    type Place = ();

    #[inline]
    fn color(&self, (): &()) -> Vec3A {
        self.0
    }

    #[inline]
    fn number(&self, (): &()) -> f32 {
        self.mean()
    }

    #[inline]
    fn slope(&self, (): &()) -> Vec2 {
        Vec2::ZERO
    }

    #[inline]
    fn mean(&self) -> f32 {
        // A number comes back as it is.
        if self.0.x == self.0.y && self.0.y == self.0.z {
            return self.0.x;
        }
        self.0.element_sum() / 3.0
    }

    fn range(&self) -> [f32; 2] {
        // Minimum and maximum of vectors may lose NaN.
        if self.0.is_nan() {
            return [f32::NAN; 2];
        }
        [self.0.min_element(), self.0.max_element()]
    }
}
