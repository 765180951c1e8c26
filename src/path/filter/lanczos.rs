//! The filter of Lanczos.

use core::f64::consts::PI;

use super::Profile;
use crate::Error;

/// The sine over its argument, windowed by its own central lobe:[^lanczos] sharp, with much ringing.
///
/// [^lanczos]: Lanczos, Cornelius (1956). *Applied Analysis*, section 4.11. Prentice Hall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanczos {
    lobes: u32,
}

impl Lanczos {
    /// The filter with `lobes` lobes on each side, which are as many pixels. Two or three are usual.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a number outside `[1, 64]`.
    pub fn new(lobes: u32) -> Result<Self, Error> {
        if (1..=64).contains(&lobes) {
            Ok(Self { lobes })
        } else {
            Err(Error::refused(
                "number of lobes of a Lanczos filter",
                "in [1, 64]",
                lobes,
            ))
        }
    }
}

impl Profile for Lanczos {
    fn radius(&self) -> f64 {
        self.lobes.into()
    }

    fn value(&self, x: f64) -> f64 {
        if x == 0.0 {
            return 1.0;
        }
        let (phase, window) = (PI * x, PI * x / f64::from(self.lobes));
        phase.sin() * window.sin() / (phase * window)
    }
}
