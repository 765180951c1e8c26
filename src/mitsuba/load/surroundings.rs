//! Light that no shape emits.

use std::path::Path;

use glam::{DMat3, DVec3, Vec2};

use crate::Error;
use crate::mitsuba::{Description, Emitter, SceneError, Spot};
use crate::path::light::{
    Background, Constant, DirectionalLight, PointLight, Sky, Source, SpotLight,
};
use crate::path::texture;

/// Light that no shape emits.
#[derive(Debug)]
pub(super) struct Surroundings {
    pub(super) sources: Vec<Source>,
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
    for emitter in &description.emitters {
        if is_dark(emitter) {
            all.left_out.push("an emitter without power".to_owned());
            continue;
        }
        let refused = |e: Error| description.place.error(e);
        match emitter {
            Emitter::EnvironmentMap {
                file,
                scale,
                to_world,
            } => {
                let outward = DMat3::from_mat4(*to_world);
                match sky(file, *scale, outward).map_err(|e| description.place.error(e))? {
                    Some(sky) => all.background = Background::Sky(Box::new(sky)),
                    None => all.left_out.push("a black envmap".to_owned()),
                }
            }
            Emitter::Constant { radiance } => {
                let constant = Constant::new(narrow(*radiance)).map_err(refused)?;
                all.background = Background::Constant(constant);
            }
            Emitter::Point {
                position,
                intensity,
            } => {
                let light = PointLight::new(narrow(*position), narrow(*intensity));
                all.sources.push(Source::Point(light.map_err(refused)?));
            }
            Emitter::Directional {
                direction,
                irradiance,
            } => {
                let light = DirectionalLight::new(narrow(*direction), narrow(*irradiance));
                all.sources
                    .push(Source::Directional(light.map_err(refused)?));
            }
            Emitter::Spot(spot) => {
                if spot.texture.is_some() {
                    return Err(description
                        .place
                        .error("a spot with a `texture` is not supported; leave it out"));
                }
                all.sources
                    .push(Source::Spot(spot_light(spot).map_err(refused)?));
            }
        }
    }
    Ok(all)
}

fn is_dark(emitter: &Emitter) -> bool {
    match emitter {
        Emitter::Point { intensity, .. } => *intensity == DVec3::ZERO,
        Emitter::Spot(spot) => spot.intensity == DVec3::ZERO,
        Emitter::Directional { irradiance, .. } => *irradiance == DVec3::ZERO,
        Emitter::Constant { radiance } => *radiance == DVec3::ZERO,
        Emitter::EnvironmentMap { scale, .. } => *scale == 0.0,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to f32")]
fn spot_light(spot: &Spot) -> Result<SpotLight, Error> {
    SpotLight::new(
        narrow(spot.to_world.w_axis.truncate()),
        narrow(spot.to_world.z_axis.truncate()),
        narrow(spot.intensity),
        spot.beam_width as f32,
        spot.cutoff_angle as f32,
    )
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
