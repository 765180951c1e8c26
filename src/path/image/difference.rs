//! How far one image is from another.

use glam::DVec3;

use super::Image;
use crate::Error;

impl Image {
    /// The root of the mean squared difference to `reference`, over all pixels and components.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if it is of another size.
    pub fn rmse(&self, reference: &Self) -> Result<f64, Error> {
        let squares = self.mean_over(reference, |here, there| (here - there).length_squared())?;
        Ok((squares / 3.0).sqrt())
    }

    /// The mean, over all pixels and components, of the squared difference over the squared reference, to which
    /// 0.01 is added so that dark pixels do not rule.[^rousselle]
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if it is of another size.
    ///
    /// [^rousselle]: Rousselle, Fabrice; Knaus, Claude; Zwicker, Matthias (2011). *Adaptive Sampling and
    ///     Reconstruction using Greedy Error Minimization*. <https://doi.org/10.1145/2024156.2024193>
    pub fn relative_mse(&self, reference: &Self) -> Result<f64, Error> {
        let squares = self.mean_over(reference, |here, there| {
            let (difference, scale) = (here - there, there * there + DVec3::splat(1e-2));
            (difference * difference / scale).element_sum()
        })?;
        Ok(squares / 3.0)
    }

    fn mean_over(
        &self,
        reference: &Self,
        measure: impl Fn(DVec3, DVec3) -> f64,
    ) -> Result<f64, Error> {
        self.same_size(reference)?;
        let pixels = self.mean.iter().zip(&reference.mean);
        let sum: f64 = pixels.map(|(&here, &there)| measure(here, there)).sum();
        Ok(sum / self.mean.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_by_hand() {
        let one = Image::new(2, vec![DVec3::ONE, DVec3::ZERO]).unwrap();
        let other = Image::new(2, vec![DVec3::new(1.0, 1.0, 0.4), DVec3::ZERO]).unwrap();
        assert!((one.rmse(&other).unwrap() - (0.36_f64 / 6.0).sqrt()).abs() < 1e-15);
        assert!((one.relative_mse(&other).unwrap() - 0.36 / 0.17 / 6.0).abs() < 1e-15);
        assert_eq!(one.rmse(&one).unwrap(), 0.0);
    }
}
