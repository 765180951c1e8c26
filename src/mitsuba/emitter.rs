//! Light that does not come from shapes.

use std::path::PathBuf;

use glam::{DMat4, DVec3};

use super::error::{Place, SceneError};
use super::field_of_view::FieldOfView;
use super::query::Query;
use super::spectrum::Role;
use super::texture::Texture;

/// Light that does not come from a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitter {
    /// What it is.
    pub source: Source,
    /// Where it stands in the file.
    pub place: Place,
}

/// What light that does not come from a shape is.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// `point`: from a point, in all directions alike.
    Point {
        /// The point.
        position: DVec3,
        /// Power per solid angle.
        intensity: DVec3,
    },
    /// `spot`: from a point, within a cone.
    Spot(Spot),
    /// `projector`: from a point, a picture.
    Projector(Projector),
    /// `directional`: from infinitely far away, in one direction.
    Directional {
        /// Where it goes, of length 1.
        direction: DVec3,
        /// Power per area across the direction.
        irradiance: DVec3,
    },
    /// `constant`: from all around, the same from everywhere.
    Constant {
        /// The radiance.
        radiance: DVec3,
    },
    /// `envmap`: from all around, as in an image.
    EnvironmentMap {
        /// The image, in latitude and longitude.
        file: PathBuf,
        /// A factor.
        scale: f64,
        /// From the image's coordinates, with +y upwards, to the scene's.
        to_world: DMat4,
    },
}

/// Light from a point within a cone.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// From the coordinates of the light, which is at the origin and shines along +z, to the scene's.
    pub to_world: DMat4,
    /// Power per solid angle in the middle.
    pub intensity: DVec3,
    /// The angle from the axis at which the light ends, in degrees.
    pub cutoff_angle: f64,
    /// The angle from the axis up to which the light is as in the middle, in degrees; from there to the cutoff it falls
    /// linearly with the angle.
    pub beam_width: f64,
    /// A factor over the cone, for slides; the cutoff touches the edges of its unit square.
    pub texture: Option<Texture>,
}

/// Light from a point that throws a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Projector {
    /// From the coordinates of the light, which is at the origin and shines along +z with +x to the left and +y upwards, to the
    /// scene's.
    pub to_world: DMat4,
    /// The picture: the radiance of a white plane at distance 1.
    pub irradiance: Texture,
    /// A factor.
    pub scale: f64,
    /// How wide the picture is.
    pub field_of_view: FieldOfView,
}

pub(super) fn describe(mut query: Query<'_>) -> Result<Emitter, SceneError> {
    let q = &mut query;
    let source = match q.plugin() {
        "point" => {
            let intensity = q.color("intensity", Role::Emission, 1.0)?;
            let position = match (q.vector("position")?, q.transform("to_world")?) {
                (Some(position), None) => position,
                (None, to_world) => {
                    to_world.map_or(DVec3::ZERO, |to_world| to_world.w_axis.truncate())
                }
                _ => return Err(q.error("either `position` or `to_world`, not both")),
            };
            Source::Point {
                position,
                intensity,
            }
        }
        "spot" => Source::Spot(spot(q)?),
        "projector" => Source::Projector(projector(q)?),
        "directional" => {
            let irradiance = q.color("irradiance", Role::Emission, 1.0)?;
            let direction = match (q.vector("direction")?, q.transform("to_world")?) {
                (Some(direction), None) => direction,
                (None, to_world) => to_world.unwrap_or_default().z_axis.truncate(),
                _ => return Err(q.error("either `direction` or `to_world`, not both")),
            };
            let Some(direction) = direction.try_normalize() else {
                return Err(q.error("the direction must not be zero"));
            };
            Source::Directional {
                direction,
                irradiance,
            }
        }
        "constant" => {
            q.ignore(&["to_world"]);
            Source::Constant {
                radiance: q.color("radiance", Role::Emission, 1.0)?,
            }
        }
        "envmap" => {
            // It changes what is sampled, and so the noise alone.
            q.ignore(&["mis_compensation"]);
            let scale = q.number("scale", 1.0)?;
            if !(scale >= 0.0) {
                return Err(q.error(format_args!("`scale` must not be negative; it is {scale}")));
            }
            Source::EnvironmentMap {
                file: q.file("filename")?,
                scale,
                to_world: q.transform("to_world")?.unwrap_or_default(),
            }
        }
        _ => {
            return Err(q.unsupported(
                "there are point, spot, projector, directional, constant and envmap, and area within a shape",
            ));
        }
    };
    sampling_weight(q)?;
    let place = q.place().clone();
    query.finish()?;
    Ok(Emitter { source, place })
}

fn projector(q: &mut Query<'_>) -> Result<Projector, SceneError> {
    let scale = q.number("scale", 1.0)?;
    if !(scale >= 0.0) {
        return Err(q.error(format_args!("`scale` must not be negative; it is {scale}")));
    }
    Ok(Projector {
        to_world: q.transform("to_world")?.unwrap_or_default(),
        irradiance: q.texture_or("irradiance", Role::Emission, 1.0)?,
        scale,
        field_of_view: FieldOfView::ask(q)?,
    })
}

fn spot(q: &mut Query<'_>) -> Result<Spot, SceneError> {
    let intensity = q.color("intensity", Role::Emission, 1.0)?;
    let texture = q.texture("texture", Role::Fraction)?;
    if let Some(Texture::Constant(_)) = texture {
        return Err(q.error("`texture` must vary; a constant factor belongs in `intensity`"));
    }
    let cutoff_angle = q.positive("cutoff_angle", 20.0)?;
    let beam_width = q.number("beam_width", 0.75 * cutoff_angle)?;
    let widest = if texture.is_some() { 90.0 } else { 180.0 };
    if !(cutoff_angle < widest && beam_width >= 0.0 && beam_width <= cutoff_angle) {
        return Err(q.error(format_args!(
            "`cutoff_angle` must be in (0, 180), below 90 with a `texture`, and `beam_width` between 0 and it; they are {cutoff_angle} and {beam_width}"
        )));
    }
    Ok(Spot {
        to_world: q.transform("to_world")?.unwrap_or_default(),
        intensity,
        cutoff_angle,
        beam_width,
        texture,
    })
}

/// How often an emitter is sampled, which changes the noise alone unless it is never.
pub(super) fn sampling_weight(q: &mut Query<'_>) -> Result<(), SceneError> {
    q.positive("sampling_weight", 1.0).map(drop)
}
