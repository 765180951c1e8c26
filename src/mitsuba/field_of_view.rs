//! How wide a camera sees, or a projector throws.

use super::error::SceneError;
use super::query::Query;

/// How wide a camera sees, or a projector throws: half of it at distance 1, along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldOfView {
    half: f64,
    axis: Axis,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

impl FieldOfView {
    /// That of `fov` along `fov_axis`, or of a focal length for a film of 36 mm by 24 mm.
    pub(super) fn ask(q: &mut Query<'_>) -> Result<Self, SceneError> {
        let axis = q.choice(
            "fov_axis",
            &[
                ("x", Axis::X),
                ("y", Axis::Y),
                ("diagonal", Axis::Diagonal),
                ("smaller", Axis::Smaller),
                ("larger", Axis::Larger),
            ],
        )?;
        let focal_length = q.text("focal_length")?;
        match (q.optional_number("fov")?, focal_length) {
            (Some(_), Some(_)) => Err(q.error("either `fov` or `focal_length`, not both")),
            (Some(fov), None) if fov > 0.0 && fov < 180.0 => {
                let half = (0.5 * fov).to_radians().tan();
                Ok(Self { half, axis })
            }
            (Some(fov), None) => Err(q.error(format_args!(
                "`fov` must be in (0, 180) degrees; it is {fov}"
            ))),
            (None, length) => {
                let text = length.unwrap_or("50mm");
                let length = super::number::number(text.trim_end_matches("mm"));
                let Some(length) = length.ok().filter(|&length| length > 0.0) else {
                    return Err(q.error(format_args!(
                        "`focal_length` must be a length such as 50mm; it is `{text}`"
                    )));
                };
                Ok(Self {
                    half: 36.0_f64.hypot(24.0) / (2.0 * length),
                    axis: Axis::Diagonal,
                })
            }
        }
    }

    /// Half the width of a picture whose width is `aspect` times its height, at distance 1.
    pub fn half_width(&self, aspect: f64) -> f64 {
        let Self { half, axis } = *self;
        match axis {
            Axis::X => half,
            Axis::Y => half * aspect,
            Axis::Diagonal => half / (1.0 + 1.0 / (aspect * aspect)).sqrt(),
            Axis::Smaller => half * aspect.max(1.0),
            Axis::Larger => half * aspect.min(1.0),
        }
    }
}
