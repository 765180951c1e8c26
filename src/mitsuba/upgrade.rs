//! Scene files of versions before 2.0, whose properties had other names.

use glam::{DMat4, DVec3};

use super::document::{Object, Property, Value};

/// The name that a property has now: `toWorld` is `to_world`.
pub(super) fn name(old: &str) -> String {
    let mut new = String::with_capacity(old.len() + 4);
    let mut before = ' ';
    let mut lowering = false;
    for c in old.chars() {
        if c.is_ascii_uppercase() && (before.is_ascii_lowercase() || lowering) {
            if !lowering {
                new.push('_');
            }
            new.push(c.to_ascii_lowercase());
            lowering = true;
        } else {
            new.push(c);
            lowering = false;
        }
        before = c;
    }
    new
}

/// Renames and joins what one plugin called otherwise.
pub(super) fn object(object: &mut Object) {
    if object.plugin == "diffuse" {
        for property in &mut object.properties {
            if property.name == "diffuse_reflectance" {
                "reflectance".clone_into(&mut property.name);
            }
        }
    }
    let number = |key: &str, default: f64| {
        object
            .properties
            .iter()
            .find(|property| property.name == key)
            .map_or(default, |property| match property.value {
                Value::Float(value) => value,
                Value::Integer(value) => value as f64,
                _ => f64::NAN,
            })
    };
    let offset = DVec3::new(number("uoffset", 0.0), number("voffset", 0.0), 0.0);
    let scale = DVec3::new(number("uscale", 1.0), number("vscale", 1.0), 1.0);
    let is_part = |property: &Property| {
        ["uoffset", "voffset", "uscale", "vscale"].contains(&property.name.as_str())
    };
    let Some(place) = object
        .properties
        .iter()
        .find(|property| is_part(property))
        .map(|property| property.place.clone())
    else {
        return;
    };
    // Those of another type stay, to be refused with their names.
    if !(offset.is_finite() && scale.is_finite()) {
        return;
    }
    object.properties.retain(|property| !is_part(property));
    object.properties.push(Property {
        name: "to_uv".to_owned(),
        value: Value::Transform(DMat4::from_scale(scale) * DMat4::from_translation(offset)),
        place,
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of Mitsuba's own `test_parser.py`, and what its rule makes of others.
    #[test]
    fn camel_case_becomes_snake_case() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("sampleCount", "sample_count"),
            ("fovAxis", "fov_axis"),
            ("alpha", "alpha"),
            ("B", "B"),
            ("rrDepth", "rr_depth"),
        ] {
            assert_eq!(name(old), new);
        }
    }
}
