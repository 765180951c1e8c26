//! Light that no shape emits.

use std::path::Path;

use glam::{DMat3, DMat4, DVec3, Vec2};

use super::material::{Images, Sources, Value};
use crate::Error;
use crate::mitsuba::{Description, Emitter, Projector, SceneError, Source, Spot, Texture};
use crate::path::light::{
    self, Background, Constant, DirectionalLight, PointLight, ProjectorLight, Sky, SpotLight,
};
use crate::path::texture;

/// Light that no shape emits.
#[derive(Debug)]
pub(super) struct Surroundings {
    pub(super) sources: Vec<light::Source>,
    pub(super) background: Background,
    pub(super) left_out: Vec<String>,
}

/// Loads the emitters of a scene, without those that have no power.
pub(super) fn load(description: &Description) -> Result<Surroundings, SceneError> {
    let mut all = Surroundings {
        sources: Vec::new(),
        background: Background::None,
        left_out: Vec::new(),
    };
    let mut images = Images::default();
    for Emitter { source, place } in &description.emitters {
        if is_dark(source) {
            let element = place.element();
            all.left_out
                .push(format!("{element} at {place}, without power"));
            continue;
        }
        match source {
            Source::EnvironmentMap {
                file,
                scale,
                to_world,
            } => {
                let outward = DMat3::from_mat4(*to_world);
                match sky(file, *scale, outward).map_err(|e| place.error(e))? {
                    Some(sky) => all.background = Background::Sky(Box::new(sky)),
                    None => all.left_out.push("a black envmap".to_owned()),
                }
            }
            Source::Constant { radiance } => {
                let constant = Constant::new(narrow(*radiance)).map_err(|e| place.error(e))?;
                all.background = Background::Constant(constant);
            }
            _ => {
                let point = without_size(source, &mut images).map_err(|e| place.error(e))?;
                all.sources.extend(point);
            }
        }
    }
    Ok(all)
}

/// A source without size; `None` of one that is around the scene.
fn without_size(source: &Source, images: &mut Images) -> Result<Option<light::Source>, String> {
    let refused = |e: Error| e.to_string();
    let made = match source {
        Source::EnvironmentMap { .. } | Source::Constant { .. } => return Ok(None),
        Source::Point {
            position,
            intensity,
        } => PointLight::new(narrow(*position), narrow(*intensity)).map(light::Source::Point),
        Source::Directional {
            direction,
            irradiance,
        } => {
            let light = DirectionalLight::new(narrow(*direction), narrow(*irradiance));
            light.map(light::Source::Directional)
        }
        Source::Spot(spot) => {
            return spot_light(spot, images).map(|light| Some(light::Source::Spot(light.into())));
        }
        Source::Projector(projector) => {
            let light = projector_light(projector, images)?;
            return Ok(Some(light::Source::Projector(light.into())));
        }
    };
    made.map(Some).map_err(refused)
}

fn is_dark(source: &Source) -> bool {
    match source {
        Source::Point { intensity, .. } => *intensity == DVec3::ZERO,
        Source::Spot(spot) => spot.intensity == DVec3::ZERO,
        Source::Projector(projector) => {
            projector.scale == 0.0 || projector.irradiance == Texture::Constant(DVec3::ZERO)
        }
        Source::Directional { irradiance, .. } => *irradiance == DVec3::ZERO,
        Source::Constant { radiance } => *radiance == DVec3::ZERO,
        Source::EnvironmentMap { scale, .. } => *scale == 0.0,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn spot_light(spot: &Spot, images: &mut Images) -> Result<SpotLight, String> {
    let refused = |e: Error| e.to_string();
    let [x, y, z, position] = columns(&spot.to_world);
    let light = SpotLight::new(
        position,
        z,
        narrow(spot.intensity),
        spot.beam_width as f32,
        spot.cutoff_angle as f32,
    )
    .map_err(refused)?;
    match &spot.texture {
        None => Ok(light),
        Some(texture) => {
            let picture = Value::value(texture, &mut Sources::of(images))?;
            light.projecting(picture, x, y).map_err(refused)
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn projector_light(projector: &Projector, images: &mut Images) -> Result<ProjectorLight, String> {
    let [x, y, z, position] = columns(&projector.to_world);
    let picture = Value::value(&projector.irradiance, &mut Sources::of(images))?;
    let aspect = match &picture {
        texture::Texture::Bitmap(bitmap) => {
            let [width, height] = bitmap.size();
            width as f64 / height as f64
        }
        _ => 1.0,
    };
    let half = projector.field_of_view.half_width(aspect);
    // As on the film of a camera, whose x axis goes to the left and whose y axis upwards.
    let backwards = [x, y].map(|axis| axis.map(|component| -component));
    let size = [half as f32, (half / aspect) as f32];
    ProjectorLight::new(
        position,
        z,
        backwards,
        size,
        picture,
        projector.scale as f32,
    )
    .map_err(|e| e.to_string())
}

/// The columns of a transform: where its axes go, and the origin.
fn columns(transform: &DMat4) -> [[f32; 3]; 4] {
    let DMat4 {
        x_axis,
        y_axis,
        z_axis,
        w_axis,
    } = *transform;
    [x_axis, y_axis, z_axis, w_axis].map(|column| narrow(column.truncate()))
}

/// The picture around a scene; `None` if it is all black.
#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn sky(file: &Path, scale: f64, outward: DMat3) -> Result<Option<Sky>, String> {
    let image = texture::Bitmap::read(file)
        .map_err(|e| e.to_string())?
        .filtered(texture::Filter::Nearest);
    let [width, height] = image.size();
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let x = (column as f64 + 0.5) / width as f64;
            let y = (row as f64 + 0.5) / height as f64;
            let color = image.color_at(Vec2::new(x as f32, y as f32));
            pixels.push((color * scale as f32).to_array());
        }
    }
    if pixels.as_flattened().iter().all(|&value| value == 0.0) {
        return Ok(None);
    }
    Sky::new(width, &pixels, outward)
        .map(Some)
        .map_err(|e| e.to_string())
}

/// Rounds to 32 bits.
pub(super) fn narrow(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}
