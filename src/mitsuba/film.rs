//! Films: the grid of pixels, and how samples become pixels.

use super::document::Kind;
use super::error::SceneError;
use super::query::{Child, Query};

/// The grid of pixels, `hdrfilm`.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Pixels across the whole film.
    pub width: u32,
    /// Pixels down the whole film.
    pub height: u32,
    /// The part of it that is rendered.
    pub crop: Crop,
    /// Whether samples outside the crop contribute to the pixels at its border.
    pub sample_border: bool,
    /// How samples become pixels.
    pub filter: Filter,
}

/// The part of a film that is rendered, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Pixels to the left of it.
    pub x: u32,
    /// Pixels above it.
    pub y: u32,
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
}

/// The weight of a sample by its distance from the centre of a pixel, in pixels, along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// 1 up to 1/2.
    Box,
    /// Falling linearly to 0 at a radius.
    Tent {
        /// The radius.
        radius: f64,
    },
    /// A Gaussian, cut off at four standard deviations and shifted to be 0 there.
    Gaussian {
        /// The standard deviation.
        stddev: f64,
    },
    /// The cubic of Mitchell and Netravali.
    Mitchell {
        /// The parameter B.
        b: f64,
        /// The parameter C.
        c: f64,
    },
    /// The cubic of Catmull and Rom.
    CatmullRom,
    /// A sinc, windowed by a sinc.
    Lanczos {
        /// How many lobes, which is also the radius.
        lobes: u32,
    },
}

/// The most pixels of a film: more than this is taken for an error.
const MOST_PIXELS: u64 = 1 << 28;

pub(super) fn describe(mut query: Query<'_>) -> Result<Film, SceneError> {
    if query.plugin() != "hdrfilm" {
        return Err(query.unsupported("there is hdrfilm"));
    }
    // These are about files and not about the picture.
    query.ignore(&[
        "file_format",
        "pixel_format",
        "component_format",
        "banner",
        "compensate",
        "attach_log",
    ]);
    let width = query.count("width", 768)?;
    let height = query.count("height", 576)?;
    let crop = Crop {
        x: query.count("crop_offset_x", 0)?,
        y: query.count("crop_offset_y", 0)?,
        width: query.count("crop_width", width)?,
        height: query.count("crop_height", height)?,
    };
    let fits = |offset: u32, size: u32, whole: u32| {
        size > 0 && u64::from(offset) + u64::from(size) <= u64::from(whole)
    };
    if !fits(crop.x, crop.width, width) || !fits(crop.y, crop.height, height) {
        return Err(query.error(format_args!(
            "the crop must lie within the film and not be empty; it is {} x {} at {}, {} of {width} x {height}",
            crop.width, crop.height, crop.x, crop.y
        )));
    }
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(query.error(format_args!(
            "{width} x {height} are more than {MOST_PIXELS} pixels"
        )));
    }
    let sample_border = query.flag("sample_border", false)?;
    let filter = match query.children_of(Kind::Filter)?[..] {
        [] => Filter::Gaussian { stddev: 0.5 },
        [child] => filter(query.enter(child)?)?,
        _ => return Err(query.error("a film has one rfilter")),
    };
    if sample_border && filter != Filter::Box {
        return Err(query.error(
            "`sample_border` is supported for the box filter only, which does without; leave it out",
        ));
    }
    query.finish()?;
    Ok(Film {
        width,
        height,
        crop,
        sample_border,
        filter,
    })
}

fn filter(mut query: Query<'_>) -> Result<Filter, SceneError> {
    let filter = match query.plugin() {
        "box" => Filter::Box,
        "tent" => Filter::Tent {
            radius: query.positive("radius", 1.0)?,
        },
        "gaussian" => Filter::Gaussian {
            stddev: query.positive("stddev", 0.5)?,
        },
        "mitchell" => Filter::Mitchell {
            b: query.number("B", 1.0 / 3.0)?,
            c: query.number("C", 1.0 / 3.0)?,
        },
        "catmullrom" => Filter::CatmullRom,
        "lanczos" => Filter::Lanczos {
            lobes: query.count("lobes", 3)?,
        },
        _ => {
            return Err(query
                .unsupported("there are box, tent, gaussian, mitchell, catmullrom and lanczos"));
        }
    };
    let radius = match filter {
        Filter::Tent { radius } => radius,
        Filter::Gaussian { stddev } => 4.0 * stddev,
        Filter::Lanczos { lobes } => f64::from(lobes),
        Filter::Box | Filter::Mitchell { .. } | Filter::CatmullRom => 2.0,
    };
    if !(radius > 0.0 && radius <= 32.0) {
        return Err(query.error(format_args!(
            "the radius must be in (0, 32] pixels; it is {radius}"
        )));
    }
    query.finish()?;
    Ok(filter)
}

/// The film of a sensor.
pub(super) fn child(query: &Query<'_>, child: Option<Child<'_>>) -> Result<Film, SceneError> {
    match child {
        Some(child) => describe(query.enter(child)?),
        None => Ok(Film {
            width: 768,
            height: 576,
            crop: Crop {
                x: 0,
                y: 0,
                width: 768,
                height: 576,
            },
            sample_border: false,
            filter: Filter::Gaussian { stddev: 0.5 },
        }),
    }
}
