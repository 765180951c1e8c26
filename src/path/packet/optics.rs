//! What the parts of a scene do to light, as packets know it.

use glam::Vec3A;

use crate::path::bsdf::{Bsdf, Lambertian};

/// What a part of a scene does to light.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Optics {
    pub(in crate::path) law: Law,
    pub(in crate::path) emitted: Emitted,
}

/// What it emits.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) enum Emitted {
    Nothing,
    /// As a flat shape whose light is the same all over.
    Flat(FlatLight),
    /// Light that the view is asked for.
    Asked,
}

impl Emitted {
    pub(super) fn is_flat(&self) -> bool {
        matches!(self, Self::Flat(_))
    }

    /// Of a flat light the probability with which it is chosen; [`DARK`] if nothing is emitted, which is negative.
    pub(super) fn chance(&self) -> f32 {
        match self {
            Self::Nothing => DARK,
            Self::Flat(light) => light.probability,
            Self::Asked => 0.0,
        }
    }
}

/// The `chance` of what emits nothing.
pub(super) const DARK: f32 = -1.0;

/// What the outer side of a flat shape emits.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct FlatLight {
    pub(in crate::path) emitter: u32,
    pub(in crate::path) radiance: Vec3A,
    /// The probability with which it is chosen among the lights.
    pub(in crate::path) probability: f32,
}

/// How light is scattered.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Law {
    /// Of the ideally diffuse law.
    pub(super) albedo: Vec3A,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Ideally diffuse on both sides.
    Diffuse,
    /// Ideally diffuse on the outer side, black on the inner one.
    OneSided,
    /// Ideally diffuse, as the scene says at every point.
    Varying,
    /// Any other, which the scene is asked for.
    Other,
    /// One that scatters light to single directions only.
    Delta,
}

impl Law {
    pub(in crate::path) fn of(bsdf: &impl Bsdf) -> Self {
        match bsdf.as_lambertian() {
            Some(law) => Self {
                albedo: law.albedo,
                kind: if Lambertian::has_inside(law) {
                    Kind::Diffuse
                } else {
                    Kind::OneSided
                },
            },
            None => Self {
                albedo: Vec3A::ZERO,
                kind: if bsdf.is_lambertian() {
                    Kind::Varying
                } else if bsdf.is_delta() {
                    Kind::Delta
                } else {
                    Kind::Other
                },
            },
        }
    }

    /// Whether it is ideally diffuse.
    pub(in crate::path) fn is_diffuse(&self) -> bool {
        matches!(self.kind, Kind::Diffuse | Kind::OneSided | Kind::Varying)
    }

    /// Whether the scene is asked for its albedo.
    pub(super) fn varies(&self) -> bool {
        self.kind == Kind::Varying
    }

    /// 0 for the ideally diffuse law, 1/2 where it varies, 1 for others, 2 for those of single directions.
    #[inline(always)]
    pub(super) fn kind(&self) -> f32 {
        match self.kind {
            Kind::Diffuse | Kind::OneSided => 0.0,
            Kind::Varying => VARYING,
            Kind::Other => OTHER,
            Kind::Delta => DELTA,
        }
    }

    /// 0 where the inner side is black, 1 elsewhere.
    #[inline(always)]
    pub(super) fn inner(&self) -> f32 {
        if self.kind == Kind::OneSided {
            0.0
        } else {
            1.0
        }
    }
}

pub(super) const VARYING: f32 = 0.5;
pub(super) const OTHER: f32 = 1.0;
pub(super) const DELTA: f32 = 2.0;
