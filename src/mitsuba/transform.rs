//! Transforms, as chains of translations, rotations, scalings, views and matrices.

use glam::{DAffine2, DMat2, DMat3, DMat4, DVec2, DVec3, DVec4};
use roxmltree::Node;

use super::error::{Place, SceneError};
use super::number::{numbers, one_or_three, triple};

/// One step of a chain; the steps of a chain are applied in their order in the document.
///
/// `attribute` gives the text of an attribute after the parameters were put in.
pub(super) fn step(
    node: Node<'_, '_>,
    place: &Place,
    mut attribute: impl FnMut(&str) -> Result<Option<String>, SceneError>,
) -> Result<DMat4, SceneError> {
    let name = node.tag_name().name();
    let allowed: &[&str] = match name {
        "translate" | "scale" => &["value", "x", "y", "z"],
        "rotate" => &["value", "x", "y", "z", "angle"],
        "lookat" => &["origin", "target", "up"],
        "matrix" => &["value"],
        _ => {
            return Err(place.error(
                "no step of a transform; there are translate, rotate, scale, lookat and matrix",
            ));
        }
    };
    if let Some(other) = node.attributes().find(|a| !allowed.contains(&a.name())) {
        return Err(place.error(format_args!(
            "unexpected attribute `{}`; it has {}",
            other.name(),
            allowed.join(", ")
        )));
    }
    let required = |value: Option<String>, name: &str| {
        value.ok_or_else(|| place.error(format_args!("the attribute `{name}` is missing")))
    };
    let matrix = match name {
        "translate" => DMat4::from_translation(vector(place, 0.0, &mut attribute)?),
        "scale" => DMat4::from_scale(vector(place, 1.0, &mut attribute)?),
        "rotate" => {
            let axis = vector(place, 0.0, &mut attribute)?;
            let angle = required(attribute("angle")?, "angle")?;
            let angle = super::number::number(&angle).map_err(|e| place.error(e))?;
            if axis == DVec3::ZERO {
                return Err(place.error("the axis of a rotation must not be zero"));
            }
            rotation(axis, angle.to_radians())
        }
        "lookat" => {
            let read = |text: String| triple(&text).map_err(|e| place.error(e));
            let origin = read(required(attribute("origin")?, "origin")?)?;
            let target = read(required(attribute("target")?, "target")?)?;
            let up = attribute("up")?.map(read).transpose()?;
            look_at(origin, target, up.unwrap_or(DVec3::ZERO)).ok_or_else(|| {
                place.error("the target must differ from the origin, and up must not point at it")
            })?
        }
        _ => {
            let text = required(attribute("value")?, "value")?;
            matrix(&numbers(&text).map_err(|e| place.error(e))?).ok_or_else(|| {
                place.error(
                    "a matrix has 9 numbers or 16, row by row, the last row of 16 being 0 0 0 1",
                )
            })?
        }
    };
    Ok(matrix)
}

/// Rodrigues' formula. As Mitsuba has it, an axis of another length than 1 is taken as it is, which stretches.
fn rotation(axis: DVec3, angle: f64) -> DMat4 {
    let (sine, cosine) = angle.sin_cos();
    let column = |unit: DVec3| {
        let turned = unit * cosine + axis.cross(unit) * sine;
        (turned + axis * (axis.dot(unit) * (1.0 - cosine))).extend(0.0)
    };
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(column);
    DMat4::from_cols(x, y, z, DVec4::W)
}

/// The vector of `value`, or of `x`, `y` and `z`.
fn vector(
    place: &Place,
    default: f64,
    attribute: &mut impl FnMut(&str) -> Result<Option<String>, SceneError>,
) -> Result<DVec3, SceneError> {
    let parts = [attribute("x")?, attribute("y")?, attribute("z")?];
    if let Some(value) = attribute("value")? {
        if parts.iter().any(Option::is_some) {
            return Err(place.error("either `value` or `x`, `y` and `z`, not both"));
        }
        return one_or_three(&value).map_err(|e| place.error(e));
    }
    let mut result = DVec3::splat(default);
    for (axis, part) in parts.iter().enumerate() {
        if let Some(text) = part {
            result[axis] = super::number::number(text).map_err(|e| place.error(e))?;
        }
    }
    Ok(result)
}

/// The view from `origin` along +z to `target`, with +x to the left in a picture and +y upwards; `up` may be zero, and
/// is then any. `None` where these do not fix an orientation.
pub(super) fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<DMat4> {
    let forward = (target - origin).try_normalize()?;
    let up = if up == DVec3::ZERO {
        tangent(forward)
    } else {
        up
    };
    let left = up.try_normalize()?.cross(forward).try_normalize()?;
    let matrix = DMat4::from_cols(
        left.extend(0.0),
        forward.cross(left).extend(0.0),
        forward.extend(0.0),
        origin.extend(1.0),
    );
    matrix.is_finite().then_some(matrix)
}

/// The first of two tangents of a unit vector.
///
/// Duff, T. et al. (2017). Building an orthonormal basis, revisited. *JCGT* 6(1).
pub(super) fn tangent(normal: DVec3) -> DVec3 {
    let sign = 1.0_f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    DVec3::new(
        1.0 + sign * normal.x * normal.x * a,
        sign * normal.x * normal.y * a,
        -sign * normal.x,
    )
}

/// The matrix of 9 or 16 numbers, row by row.
fn matrix(values: &[f64]) -> Option<DMat4> {
    match values.len() {
        9 => Some(DMat4::from_mat3(DMat3::from_cols_slice(values).transpose())),
        16 => {
            let matrix = DMat4::from_cols_slice(values).transpose();
            (matrix.row(3) == DMat4::IDENTITY.row(3)).then_some(matrix)
        }
        _ => None,
    }
}

/// What a transform does to texture coordinates: its upper left 2x2 block and the x and y of its translation.
pub(super) fn on_texture_coordinates(transform: &DMat4) -> DAffine2 {
    let columns = [transform.x_axis, transform.y_axis, transform.w_axis]
        .map(|column| DVec2::new(column.x, column.y));
    DAffine2::from_mat2_translation(DMat2::from_cols(columns[0], columns[1]), columns[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_look_along_z() {
        let view = look_at(DVec3::Z, DVec3::new(0.0, 0.0, 5.0), DVec3::Y).unwrap();
        assert_eq!(view.transform_point3(DVec3::Z), DVec3::new(0.0, 0.0, 2.0));
        assert_eq!(view.transform_vector3(DVec3::X), DVec3::X);
        assert!(look_at(DVec3::ONE, DVec3::ONE, DVec3::Y).is_none());
        assert!(look_at(DVec3::ZERO, DVec3::Y, DVec3::Y).is_none());
        let any = look_at(DVec3::ZERO, DVec3::new(1.0, 2.0, -3.0), DVec3::ZERO).unwrap();
        assert!((any.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn matrices_are_written_by_rows() {
        let translation = matrix(&[
            1.0, 0.0, 0.0, 7.0, 0.0, 1.0, 0.0, 8.0, 0.0, 0.0, 1.0, 9.0, 0.0, 0.0, 0.0, 1.0,
        ]);
        assert_eq!(
            translation,
            Some(DMat4::from_translation(DVec3::new(7.0, 8.0, 9.0)))
        );
        assert_eq!(matrix(&[0.0; 16]), None);
        assert_eq!(matrix(&[0.0; 12]), None);
        let small = matrix(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]).unwrap();
        assert_eq!(small.x_axis.truncate(), DVec3::new(1.0, 4.0, 7.0));
    }
}
