//! From the estimates of the pixels to a picture.

use glam::DVec3;

use super::{Evaluations, Image};
use crate::Estimate;

/// What a picture keeps of the estimates of a row, from the left; fewer than its width where it was cut short.
pub(in crate::path) struct Row {
    mean: Vec<DVec3>,
    /// `None` as soon as one estimate has none.
    std_error: Option<Vec<DVec3>>,
    evaluations: Evaluations,
}

impl Row {
    /// No pixels yet.
    pub(in crate::path) fn new() -> Self {
        Self {
            mean: Vec::new(),
            std_error: Some(Vec::new()),
            evaluations: Evaluations::default(),
        }
    }

    /// Adds the next pixel.
    pub(in crate::path) fn push(&mut self, estimate: &Estimate<DVec3>) {
        self.mean.push(estimate.mean);
        self.std_error =
            self.std_error
                .take()
                .zip(estimate.std_error)
                .map(|(mut errors, error)| {
                    errors.push(error);
                    errors
                });
        self.evaluations.requested += estimate.requested;
        self.evaluations.used += estimate.used;
        self.evaluations.rejected += estimate.rejected;
    }
}

impl Image {
    /// The image of the given rows, at most `height` of them, of at most `width` pixels, both at least 1. Pixels that are
    /// missing are black, with an infinite standard error if the others have one.
    pub(in crate::path) fn of_rows([width, height]: [u32; 2], rows: &[Row]) -> Self {
        let (width, pixels) = (width as usize, width as usize * height as usize);
        let (mut mean, mut evaluations) = (Vec::with_capacity(pixels), Evaluations::default());
        let mut std_error = Some(Vec::with_capacity(pixels));
        for (end, row) in (1..).map(|row| row * width).zip(rows) {
            mean.extend_from_slice(&row.mean);
            mean.resize(end, DVec3::ZERO);
            std_error = std_error.zip(row.std_error.as_ref()).map(|(mut all, row)| {
                all.extend_from_slice(row);
                all.resize(end, DVec3::INFINITY);
                all
            });
            evaluations.requested += row.evaluations.requested;
            evaluations.used += row.evaluations.used;
            evaluations.rejected += row.evaluations.rejected;
        }
        mean.resize(pixels, DVec3::ZERO);
        let anything = rows.iter().any(|row| !row.mean.is_empty());
        let std_error = std_error.filter(|_| anything).map(|mut all| {
            all.resize(pixels, DVec3::INFINITY);
            all
        });
        Self {
            width,
            mean,
            std_error,
            evaluations,
        }
    }
}
