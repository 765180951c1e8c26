//! A sampler that remembers what was read.

use crate::Sampler;

/// Remembers the coordinates that were read.
pub(crate) struct Recorder<'a, S> {
    pub(crate) inner: S,
    pub(crate) coordinates: &'a mut Vec<f64>,
}

impl<S: Sampler> Sampler for Recorder<'_, S> {
    fn next_1d(&mut self) -> f64 {
        let coordinate = self.inner.next_1d();
        self.coordinates.push(coordinate);
        coordinate
    }
}
