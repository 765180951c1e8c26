//! The kernels of the L2 discrepancies, in one dimension.

use core::f64::consts::PI;

/// A kernel `K(x, y)` on `[0, 1]^2`, of which two coordinates make the integrals below.
pub(super) trait Kernel {
    /// The integral of the kernel over both coordinates, as a fraction.
    const MEAN: (f64, f64);

    /// Whether the kernel is 1 plus the kernel of one dimension alone, so that products over the dimensions contain all
    /// projections.
    const PROJECTIONS: bool;

    /// `K` is this times [`pair`](Self::pair): a power of two, which costs nothing here and one product
    /// a dimension there.
    const SCALE: f64;

    /// The integral of the kernel over its other coordinate.
    fn single(x: f64) -> f64;

    /// What [`pair`](Self::pair) wants to know of a coordinate.
    fn features(x: f64) -> [f64; 2];

    /// The kernel divided by [`SCALE`](Self::SCALE), for two coordinates in terms of their features.
    fn pair(x: [f64; 2], y: [f64; 2]) -> f64;
}

pub(super) struct Star;

impl Kernel for Star {
    const MEAN: (f64, f64) = (1.0, 3.0);
    const PROJECTIONS: bool = false;
    const SCALE: f64 = 1.0;

    fn single(x: f64) -> f64 {
        0.5 * (1.0 - x) * (1.0 + x)
    }

    fn features(x: f64) -> [f64; 2] {
        [1.0 - x, 0.0]
    }

    #[inline(always)]
    fn pair([x, _]: [f64; 2], [y, _]: [f64; 2]) -> f64 {
        if x < y { x } else { y }
    }
}

pub(super) struct Centred;

impl Kernel for Centred {
    const MEAN: (f64, f64) = (13.0, 12.0);
    const PROJECTIONS: bool = true;
    const SCALE: f64 = 1.0;

    fn single(x: f64) -> f64 {
        let a = (x - 0.5).abs();
        1.0 + 0.5 * a * (1.0 - a)
    }

    fn features(x: f64) -> [f64; 2] {
        [0.5 * x, 0.5 + 0.5 * (x - 0.5).abs()]
    }

    #[inline(always)]
    fn pair([x, a]: [f64; 2], [y, b]: [f64; 2]) -> f64 {
        (a + b) - (x - y).abs()
    }
}

pub(super) struct WrapAround;

impl Kernel for WrapAround {
    const MEAN: (f64, f64) = (4.0, 3.0);
    const PROJECTIONS: bool = true;
    const SCALE: f64 = 1.0;

    fn single(_: f64) -> f64 {
        4.0 / 3.0
    }

    fn features(x: f64) -> [f64; 2] {
        [x, 0.0]
    }

    #[inline(always)]
    fn pair([x, _]: [f64; 2], [y, _]: [f64; 2]) -> f64 {
        // 3/2 - t (1 - t) = 5/4 + (t - 1/2)^2
        let centred = (x - y).abs() - 0.5;
        1.25 + centred * centred
    }
}

pub(super) struct Mixture;

impl Kernel for Mixture {
    const MEAN: (f64, f64) = (19.0, 12.0);
    const PROJECTIONS: bool = true;
    const SCALE: f64 = 0.5;

    fn single(x: f64) -> f64 {
        let a = (x - 0.5).abs();
        5.0 / 3.0 - 0.25 * a * (1.0 + a)
    }

    fn features(x: f64) -> [f64; 2] {
        // Half of 2 (15/8 - 9/32), so that two of them make up the constant below.
        [x, 51.0 / 32.0 - 0.5 * (x - 0.5).abs()]
    }

    #[inline(always)]
    fn pair([x, a]: [f64; 2], [y, b]: [f64; 2]) -> f64 {
        // t^2 / 2 - 3 t / 4 = (t - 3/4)^2 / 2 - 9/32
        let shifted = (x - y).abs() - 0.75;
        (a + b) + shifted * shifted
    }
}

pub(super) struct Symmetric;

impl Kernel for Symmetric {
    const MEAN: (f64, f64) = (4.0, 3.0);
    const PROJECTIONS: bool = true;
    const SCALE: f64 = 2.0;

    fn single(x: f64) -> f64 {
        1.0 + 2.0 * x * (1.0 - x)
    }

    fn features(x: f64) -> [f64; 2] {
        [x, 0.0]
    }

    #[inline(always)]
    fn pair([x, _]: [f64; 2], [y, _]: [f64; 2]) -> f64 {
        1.0 - (x - y).abs()
    }
}

pub(super) struct Extreme;

impl Kernel for Extreme {
    const MEAN: (f64, f64) = (1.0, 12.0);
    const PROJECTIONS: bool = false;
    const SCALE: f64 = 1.0;

    fn single(x: f64) -> f64 {
        0.5 * x * (1.0 - x)
    }

    fn features(x: f64) -> [f64; 2] {
        [x, 1.0 - x]
    }

    #[inline(always)]
    fn pair([x, above_x]: [f64; 2], [y, above_y]: [f64; 2]) -> f64 {
        // min(x, y) - x y = min(x, y) (1 - max(x, y))
        let least = if x < y { x } else { y };
        let above = if above_x < above_y { above_x } else { above_y };
        least * above
    }
}

pub(super) struct Diaphony;

impl Kernel for Diaphony {
    const MEAN: (f64, f64) = (1.0, 1.0);
    const PROJECTIONS: bool = true;
    const SCALE: f64 = 1.0;

    fn single(_: f64) -> f64 {
        1.0
    }

    fn features(x: f64) -> [f64; 2] {
        [x, 0.0]
    }

    #[inline(always)]
    fn pair([x, _]: [f64; 2], [y, _]: [f64; 2]) -> f64 {
        // 1 + 2 pi^2 (t^2 - t + 1/6) = 1 - pi^2 / 6 + 2 pi^2 (t - 1/2)^2
        const SQUARE: f64 = 2.0 * PI * PI;
        const LEAST: f64 = 1.0 - PI * PI / 6.0;
        let centred = (x - y).abs() - 0.5;
        LEAST + SQUARE * (centred * centred)
    }
}
