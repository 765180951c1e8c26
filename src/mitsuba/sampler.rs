//! Samplers: which points a pixel is estimated with.

use super::error::SceneError;
use super::query::{Child, Query};

/// Which points a pixel is estimated with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    /// Their kind.
    pub points: Points,
    /// How many a pixel.
    pub sample_count: u32,
    /// The seed.
    pub seed: u32,
}

/// The kinds of points that Mitsuba has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// `independent`.
    Independent,
    /// `stratified`.
    Stratified,
    /// `multijitter`: correlated multi-jittered.
    MultiJitter,
    /// `orthogonal`: an orthogonal array.
    Orthogonal,
    /// `ldsampler`: a (0, 2)-sequence.
    LowDiscrepancy,
}

/// The sampler of a sensor.
pub(super) fn child(query: &Query<'_>, child: Option<Child<'_>>) -> Result<Sampler, SceneError> {
    match child {
        Some(child) => describe(query.enter(child)?),
        None => Ok(Sampler {
            points: Points::Independent,
            sample_count: 4,
            seed: 0,
        }),
    }
}

fn describe(mut query: Query<'_>) -> Result<Sampler, SceneError> {
    let points = match query.plugin() {
        "independent" => Points::Independent,
        "stratified" => Points::Stratified,
        "multijitter" => Points::MultiJitter,
        "orthogonal" => Points::Orthogonal,
        "ldsampler" => Points::LowDiscrepancy,
        _ => {
            return Err(query.unsupported(
                "there are independent, stratified, multijitter, orthogonal and ldsampler",
            ));
        }
    };
    // They change the noise alone.
    query.ignore(&["jitter", "strength"]);
    let sample_count = query.count("sample_count", 4)?;
    let seed = query.count("seed", 0)?;
    if sample_count == 0 {
        return Err(query.error("`sample_count` must be at least 1; it is 0"));
    }
    query.finish()?;
    Ok(Sampler {
        points,
        sample_count,
        seed,
    })
}
