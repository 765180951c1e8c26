//! Studies of pictures: error against run time, measured against a reference image.

use core::fmt;

use glam::DVec3;

use super::{Image, Unfinished};
use crate::Error;
use crate::convergence::{Convergence, Study, Trial};

/// A [`Study`] of pictures, made by [`Study::pictures`].
#[must_use]
pub struct Pictures<'a> {
    study: Study<'a>,
    reference: &'a Image,
}

impl<'a> Study<'a> {
    /// Goes on with pictures, whose error is that against `reference`: over all pixels and components. If it has standard
    /// errors, they are its noise. Errors are relative to its mean.
    ///
    /// ```
    /// use estimand::convergence::Study;
    /// use estimand::{MonteCarlo, path::scenes};
    ///
    /// let view = scenes::furnace();
    /// let picture = |spp, seed| view.render([4, 4], seed, |key| MonteCarlo::new(spp, key));
    /// let reference = picture(1000, 0)?;
    /// let study = Study::new([4, 16, 64], 4)?.pictures(&reference);
    /// let convergence = study.method("plain", picture).run()?;
    /// let samples = &convergence.curves[0].samples;
    /// assert!(samples[2].rmse < samples[0].rmse);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pictures(self, reference: &'a Image) -> Pictures<'a> {
        let mean = reference.mean().element_sum() / 3.0;
        let study = self.noise(reference.noise()).scale(mean);
        Pictures { study, reference }
    }
}

impl<'a> Pictures<'a> {
    /// Adds a method: `picture` renders with a number of samples a pixel and a seed.
    pub fn method(
        mut self,
        name: impl Into<String>,
        picture: impl Fn(u64, u64) -> Result<Image, Unfinished> + 'a,
    ) -> Self {
        let reference = self.reference;
        self.study = self.study.trials(name, move |count, seed| {
            let picture = picture(count, seed).map_err(|unfinished| unfinished.reason)?;
            picture.trial(reference)
        });
        self
    }

    /// Runs everything: see [`Study::run`].
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for a reference that is not finite or of another size than a picture; see also [`Study::run`].
    pub fn run(&self) -> Result<Convergence, Error> {
        if let Some(pixel) = self
            .reference
            .pixels()
            .iter()
            .find(|pixel| !pixel.is_finite())
        {
            return Err(Error::refused("reference of a study", "finite", pixel));
        }
        self.study.run()
    }
}

impl fmt::Debug for Pictures<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pictures")
            .field("study", &self.study)
            .finish_non_exhaustive()
    }
}

impl Image {
    /// The root-mean-square of the standard errors over all pixels and components; 0 if it has none.
    pub fn noise(&self) -> f64 {
        self.std_error()
            .map_or(0.0, |errors| mean_square(&errors).sqrt())
    }

    /// How far this picture is from `reference`, and from what it claims: for a [`Study`].
    ///
    /// A component is covered if the two differ by at most 1.96 of their standard errors, taken together.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if the reference is of another size.
    pub fn trial(&self, reference: &Self) -> Result<Trial, Error> {
        let rmse = self.rmse(reference)?;
        let covered = self.std_error().map(|errors| {
            let nothing = vec![DVec3::ZERO; errors.pixels().len()];
            let theirs = reference.std_error();
            let theirs = theirs
                .as_ref()
                .map_or(&nothing[..], |theirs| theirs.pixels());
            let pixels = self.pixels().iter().zip(reference.pixels());
            let errors = errors.pixels().iter().zip(theirs);
            let mut inside = 0.0;
            for ((mean, truth), (here, there)) in pixels.zip(errors) {
                let reach = 1.96 * (here * here + there * there).map(f64::sqrt);
                let within = (mean - truth).abs().cmple(reach);
                inside += f64::from(within.bitmask().count_ones());
            }
            inside / (3 * nothing.len()) as f64
        });
        Ok(Trial {
            evaluations: self.used(),
            squared_error: rmse * rmse,
            squared_claim: self.std_error().map(|errors| mean_square(&errors)),
            covered,
        })
    }
}

/// Over all pixels and components.
fn mean_square(image: &Image) -> f64 {
    let pixels = image.pixels();
    let squares: f64 = pixels.iter().map(|pixel| pixel.length_squared()).sum();
    squares / (3 * pixels.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[[f64; 3]]) -> Image {
        Image::new(1, pixels.iter().map(|&pixel| pixel.into()).collect()).unwrap()
    }

    #[test]
    fn a_trial_by_hand() {
        let reference = image(&[[1.0, 2.0, 3.0], [0.0; 3]])
            .with_std_error(image(&[[3.0, 0.0, 0.0], [0.0; 3]]))
            .unwrap();
        assert!((reference.noise() - 1.5_f64.sqrt()).abs() < 1e-15);
        let picture = image(&[[10.0, 2.0, 3.5], [0.0; 3]]);
        let bare = picture.trial(&reference).unwrap();
        assert!((bare.squared_error - (81.0 + 0.25) / 6.0).abs() < 1e-12);
        assert_eq!((bare.squared_claim, bare.covered), (None, None));
        // 9 is within 1.96 times 5, the hypotenuse of 3 and 4; 0.5 is not within 0.392.
        let errors = image(&[[4.0, 0.0, 0.2], [0.0; 3]]);
        let picture = picture.with_std_error(errors).unwrap();
        let trial = picture.trial(&reference).unwrap();
        assert!((trial.squared_claim.unwrap() - 16.04 / 6.0).abs() < 1e-12);
        assert_eq!(trial.covered, Some(5.0 / 6.0));
    }

    #[test]
    fn references_must_fit() {
        let study = || Study::new([1, 2], 2).unwrap().shortest(0.0);
        let picture = |_, _| Ok(image(&[[1.0; 3]]));
        let nan = image(&[[f64::NAN; 3]]);
        let error = study().pictures(&nan).method("plain", picture).run();
        assert_eq!(
            error.unwrap_err().to_string(),
            "the reference of a study must be finite; it was [NaN, NaN, NaN]"
        );
        let larger = image(&[[1.0; 3]; 2]);
        let error = study().pictures(&larger).method("plain", picture).run();
        assert!(error.unwrap_err().to_string().contains("of the same size"));
    }
}
