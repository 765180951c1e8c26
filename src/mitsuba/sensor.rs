//! Sensors: from where the picture is taken.

use glam::{DMat4, DVec2};

use super::document::Kind;
use super::error::SceneError;
use super::film::{self, Film};
use super::query::Query;
use super::sampler::{self, Sampler};

/// From where and how the picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// How points are projected.
    pub projection: Projection,
    /// From the camera's coordinates, which looks along +z with +x to the left and +y upwards, to the scene's.
    pub to_world: DMat4,
    /// What is nearer than this along the axis is not seen.
    pub near_clip: f64,
    /// What is farther than this along the axis is not seen.
    pub far_clip: f64,
    /// The pixels.
    pub film: Film,
    /// The points.
    pub sampler: Sampler,
}

/// How points are projected onto the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// `perspective`: a pinhole.
    Perspective {
        /// The angle that the whole film spans across, in degrees, in `(0, 180)`.
        fov: f64,
        /// How far the principal point is from the centre, in parts of the width and the height of the film.
        principal_point_offset: DVec2,
    },
    /// `thinlens`: a thin lens.
    ThinLens {
        /// The angle that the whole film spans across, in degrees, in `(0, 180)`.
        fov: f64,
        /// The radius of the lens.
        aperture_radius: f64,
        /// How far the plane is that is in focus, along the axis.
        focus_distance: f64,
    },
    /// `orthographic`: the film spans from -1 to 1 across, in the camera's coordinates.
    Orthographic,
}

pub(super) fn describe(mut query: Query<'_>) -> Result<Sensor, SceneError> {
    let q = &mut query;
    let (mut film, mut sampler) = (None, None);
    for child in q.children() {
        match child.kind {
            Kind::Film if film.is_none() => film = Some(child),
            Kind::Sampler if sampler.is_none() => sampler = Some(child),
            _ => return Err(q.stray(child)),
        }
    }
    let film = film::child(q, film)?;
    let sampler = sampler::child(q, sampler)?;
    let near_clip = q.positive("near_clip", 1e-2)?;
    let far_clip = q.positive("far_clip", 1e4)?;
    if !(near_clip < far_clip) {
        return Err(q.error(format_args!(
            "`near_clip` must be below `far_clip`; they are {near_clip} and {far_clip}"
        )));
    }
    let focus_distance = q.positive("focus_distance", far_clip)?;
    let to_world = q.transform("to_world")?.unwrap_or_default();
    // Nothing moves here.
    q.ignore(&["shutter_open", "shutter_close"]);
    let projection = match q.plugin() {
        "perspective" => Projection::Perspective {
            fov: field_of_view(q, &film)?,
            principal_point_offset: DVec2::new(
                q.number("principal_point_offset_x", 0.0)?,
                q.number("principal_point_offset_y", 0.0)?,
            ),
        },
        "thinlens" => Projection::ThinLens {
            fov: field_of_view(q, &film)?,
            aperture_radius: q.positive("aperture_radius", 0.0)?,
            focus_distance,
        },
        "orthographic" => Projection::Orthographic,
        _ => {
            return Err(q.unsupported("there are perspective, thinlens and orthographic"));
        }
    };
    if projection != Projection::Orthographic && scales(&to_world) {
        return Err(q.error("`to_world` of a camera must not scale; change the field of view"));
    }
    query.finish()?;
    Ok(Sensor {
        projection,
        to_world,
        near_clip,
        far_clip,
        film,
        sampler,
    })
}

/// Whether a transform changes lengths.
fn scales(transform: &DMat4) -> bool {
    [transform.x_axis, transform.y_axis, transform.z_axis]
        .iter()
        .any(|axis| !((axis.length_squared() - 1.0).abs() < 1e-3))
}

/// The angle across, of `fov` along `fov_axis` or of a focal length for a film of 36 mm by 24 mm.
fn field_of_view(q: &mut Query<'_>, film: &Film) -> Result<f64, SceneError> {
    let aspect = f64::from(film.width) / f64::from(film.height);
    let axis = q.choice(
        "fov_axis",
        &[
            ("x", Axis::X),
            ("y", Axis::Y),
            ("diagonal", Axis::Diagonal),
            ("smaller", if aspect > 1.0 { Axis::Y } else { Axis::X }),
            ("larger", if aspect > 1.0 { Axis::X } else { Axis::Y }),
        ],
    )?;
    let focal_length = q.text("focal_length")?;
    let (half_tangent, axis) = match (q.optional_number("fov")?, focal_length) {
        (Some(_), Some(_)) => return Err(q.error("either `fov` or `focal_length`, not both")),
        (Some(fov), None) if fov > 0.0 && fov < 180.0 => ((0.5 * fov).to_radians().tan(), axis),
        (Some(fov), None) => {
            return Err(q.error(format_args!(
                "`fov` must be in (0, 180) degrees; it is {fov}"
            )));
        }
        (None, length) => {
            let text = length.unwrap_or("50mm");
            let length = super::number::number(text.trim_end_matches("mm"));
            let Some(length) = length.ok().filter(|&length| length > 0.0) else {
                return Err(q.error(format_args!(
                    "`focal_length` must be a length such as 50mm; it is `{text}`"
                )));
            };
            (36.0_f64.hypot(24.0) / (2.0 * length), Axis::Diagonal)
        }
    };
    let across = match axis {
        Axis::X => half_tangent,
        Axis::Y => half_tangent * aspect,
        Axis::Diagonal => half_tangent / (1.0 + 1.0 / (aspect * aspect)).sqrt(),
    };
    Ok(2.0 * across.atan().to_degrees())
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Diagonal,
}
