//! What an integrand may return: a fixed number of real components.

/// A value that can be averaged: a fixed number of real components.
///
/// Averages are always formed in `f64`: an `f32` integrand is widened before it is added to
/// anything, because a running mean in `f32` stops moving after some 10^7 samples.
///
/// Implemented for `f64`, `f32`, arrays `[V; N]`, pairs `(A, B)` and, with the feature `glam`, for
/// glam's vectors.
///
/// # Writing your own
///
/// ```
/// use estimand::{Average, Estimator, Value, cube, points::Independent};
///
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// struct Rgb { r: f64, g: f64, b: f64 }
///
/// impl Value for Rgb {
///     type Wide = Self;
///     const ZERO: Self = Self { r: 0.0, g: 0.0, b: 0.0 };
///     fn zip(self, rhs: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
///         Self { r: f(self.r, rhs.r), g: f(self.g, rhs.g), b: f(self.b, rhs.b) }
///     }
///     fn widen(self) -> Self { self }
/// }
///
/// let red = cube(|[x]| Rgb { r: x, g: 0.0, b: 1.0 });
/// let estimate = Average::new(Independent::new(7), 10_000).estimate(&red)?;
/// assert!((estimate.mean.r - 0.5).abs() < 0.02);
/// # Ok::<(), estimand::Error>(())
/// ```
pub trait Value: Copy + Send + Sync {
    /// The same components in `f64`: what averages and errors of this value are made of.
    type Wide: Value<Wide = Self::Wide> + core::fmt::Debug + 'static;

    /// The value with every component zero.
    const ZERO: Self;

    /// Applies `f` to every pair of components, in a fixed order.
    #[must_use]
    fn zip(self, rhs: Self, f: impl FnMut(f64, f64) -> f64) -> Self;

    /// The same components in `f64`.
    fn widen(self) -> Self::Wide;

    /// Applies `f` to every component, in the order of [`zip`](Self::zip).
    #[must_use]
    fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        self.zip(self, |a, _| f(a))
    }

    /// Calls `f` with every component, in the order of [`zip`](Self::zip).
    fn for_each(self, mut f: impl FnMut(f64)) {
        let _ = self.map(|a| {
            f(a);
            a
        });
    }

    /// Whether no component is NaN or infinite.
    fn is_finite(self) -> bool {
        let mut finite = true;
        self.for_each(|a| finite &= a.is_finite());
        finite
    }
}

#[expect(clippy::use_self, reason = "components are f64 whatever the value is")]
impl Value for f64 {
    type Wide = Self;
    const ZERO: Self = 0.0;

    #[inline]
    fn zip(self, rhs: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        f(self, rhs)
    }

    #[inline]
    fn widen(self) -> Self {
        self
    }
}

impl Value for f32 {
    type Wide = f64;
    const ZERO: Self = 0.0;

    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "an f32 value rounds to its own precision"
    )]
    fn zip(self, rhs: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        f(f64::from(self), f64::from(rhs)) as Self
    }

    #[inline]
    fn widen(self) -> f64 {
        f64::from(self)
    }
}

impl<V: Value, const N: usize> Value for [V; N] {
    type Wide = [V::Wide; N];
    const ZERO: Self = [V::ZERO; N];

    #[inline]
    fn zip(self, rhs: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        core::array::from_fn(|i| self[i].zip(rhs[i], &mut f))
    }

    #[inline]
    fn widen(self) -> Self::Wide {
        core::array::from_fn(|i| self[i].widen())
    }
}

impl<A: Value, B: Value> Value for (A, B) {
    type Wide = (A::Wide, B::Wide);
    const ZERO: Self = (A::ZERO, B::ZERO);

    #[inline]
    fn zip(self, rhs: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        (self.0.zip(rhs.0, &mut f), self.1.zip(rhs.1, &mut f))
    }

    #[inline]
    fn widen(self) -> Self::Wide {
        (self.0.widen(), self.1.widen())
    }
}

#[cfg(feature = "glam")]
macro_rules! glam_value {
    ($($vector:ty: [$scalar:ty; $n:literal] => $wide:ty),+ $(,)?) => {$(
        impl Value for $vector {
            type Wide = $wide;
            const ZERO: Self = <$vector>::ZERO;

            #[inline]
            fn zip(self, rhs: Self, f: impl FnMut(f64, f64) -> f64) -> Self {
                <$vector>::from_array(<[$scalar; $n]>::zip(self.to_array(), rhs.to_array(), f))
            }

            #[inline]
            fn widen(self) -> $wide {
                <$wide>::from_array(Value::widen(self.to_array()))
            }
        }
    )+};
}

#[cfg(feature = "glam")]
glam_value! {
    glam::Vec2: [f32; 2] => glam::DVec2,
    glam::Vec3: [f32; 3] => glam::DVec3,
    glam::Vec3A: [f32; 3] => glam::DVec3,
    glam::Vec4: [f32; 4] => glam::DVec4,
    glam::DVec2: [f64; 2] => glam::DVec2,
    glam::DVec3: [f64; 3] => glam::DVec3,
    glam::DVec4: [f64; 4] => glam::DVec4,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_values_visit_every_component_once_in_order() {
        let value = ([1.0_f32, 2.0], [(3.0_f64, 4.0_f64)]);
        let mut seen = Vec::new();
        value.for_each(|component| seen.push(component));
        assert_eq!(seen, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(
            value.zip(value, |a, b| a * b).widen(),
            ([1.0, 4.0], [(9.0, 16.0)])
        );
    }

    #[test]
    fn one_bad_component_makes_a_value_not_finite() {
        assert!([1.0_f64, -2.0].is_finite());
        assert!(!(1.0_f64, [0.0_f32, f32::NAN]).is_finite());
        assert!(![f64::NEG_INFINITY; 1].is_finite());
    }
}
