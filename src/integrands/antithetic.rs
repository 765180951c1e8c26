//! Antithetic pairs.

use crate::{Integrand, Sampler, Value};

/// The mean of an integrand at a point and at its mirror image through the centre of the cube.[^hammersley]
///
/// It removes whatever is odd about the centre: all of a linear integrand, most of a monotonic one. Of what is even
/// it removes nothing, and then costs twice as much for nothing. One evaluation asks the integrand twice.
///
/// A coordinate `u` is mirrored to `1 - 2^-53 - u`, which is in `[0, 1)` too.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube, integrands::Antithetic};
///
/// let linear = cube(|[x, y]| 3.0 * x - y);
/// let estimate = MonteCarlo::new(100, 1).estimate(&Antithetic::new(linear))?;
/// assert!((estimate.mean - 1.0).abs() < 1e-14);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^hammersley]: Hammersley, John; Morton, Keith (1956). *A New Monte Carlo Technique: Antithetic Variates*.
///     <https://doi.org/10.1017/S0305004100031455>
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct Antithetic<I> {
    integrand: I,
}

impl<I: Integrand> Antithetic<I> {
    /// `integrand`, at a point and its mirror image.
    pub const fn new(integrand: I) -> Self {
        Self { integrand }
    }
}

impl<I: Integrand> Integrand for Antithetic<I> {
    type Value = I::Value;

    fn evaluate<S: Sampler>(&self, u: &mut S) -> I::Value {
        let mut memory = Memory::new(u);
        let here = self.integrand.evaluate(&mut memory);
        let there = self.integrand.evaluate(&mut memory.mirror());
        here.zip(there, |here, there| 0.5 * here + 0.5 * there)
    }

    fn dimensions(&self) -> u32 {
        self.integrand.dimensions()
    }
}

/// Coordinates that are remembered without an allocation.
const SHORT: usize = 32;

/// Remembers the coordinates that were read.
struct Memory<'a, S> {
    inner: &'a mut S,
    short: [f64; SHORT],
    long: Vec<f64>,
    count: usize,
}

impl<'a, S: Sampler> Memory<'a, S> {
    fn new(inner: &'a mut S) -> Self {
        Self {
            inner,
            short: [0.0; SHORT],
            long: Vec::new(),
            count: 0,
        }
    }

    fn mirror(self) -> Mirror<'a, S> {
        Mirror {
            memory: self,
            position: 0,
        }
    }
}

impl<S: Sampler> Sampler for Memory<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let u = self.inner.next_1d();
        match self.short.get_mut(self.count) {
            Some(place) => *place = u,
            None => self.long.push(u),
        }
        self.count += 1;
        u
    }
}

/// The mirror images of the coordinates remembered, then of new ones.
struct Mirror<'a, S> {
    memory: Memory<'a, S>,
    position: usize,
}

impl<S: Sampler> Sampler for Mirror<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;
        let position = self.position;
        self.position += 1;
        let u = if position >= self.memory.count {
            self.memory.inner.next_1d()
        } else if position < SHORT {
            self.memory.short[position]
        } else {
            self.memory.long[position - SHORT]
        };
        LARGEST - u
    }
}
