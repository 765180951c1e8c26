//! Sensors: from where the picture is taken.

use glam::{DMat4, DVec2};

use super::document::Kind;
use super::error::{Place, SceneError};
use super::field_of_view::FieldOfView;
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
    /// Where it stands in the file.
    pub place: Place,
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
            fov: fov(q, &film)?,
            principal_point_offset: DVec2::new(
                q.number("principal_point_offset_x", 0.0)?,
                q.number("principal_point_offset_y", 0.0)?,
            ),
        },
        "thinlens" => Projection::ThinLens {
            fov: fov(q, &film)?,
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
    let place = q.place().clone();
    query.finish()?;
    Ok(Sensor {
        projection,
        to_world,
        near_clip,
        far_clip,
        film,
        sampler,
        place,
    })
}

/// Whether a transform changes lengths.
fn scales(transform: &DMat4) -> bool {
    [transform.x_axis, transform.y_axis, transform.z_axis]
        .iter()
        .any(|axis| !((axis.length_squared() - 1.0).abs() < 1e-3))
}

/// The angle across the whole film.
fn fov(q: &mut Query<'_>, film: &Film) -> Result<f64, SceneError> {
    let aspect = f64::from(film.width) / f64::from(film.height);
    let half = FieldOfView::ask(q)?.half_width(aspect);
    Ok(2.0 * half.atan().to_degrees())
}
