//! Scenes of several laws of scattering.

use glam::Vec3A;

use super::{
    Blend, BumpMap, Conductor, Dielectric, Diffuse, Lambertian, Law, Mask, Mirror, NormalMap, Null,
    Plastic, RoughConductor, RoughDielectric, RoughPlastic, Scattered, Scattering, ThinDielectric,
    TwoSided, law,
};
use crate::Sampler;
use crate::path::texture::{Parameter, Uniform};
use crate::path::{Frame, Place, Surface};

/// Any of the laws of this module, for scenes that mix them.
///
/// With [`Uniform`] parameters it needs to know no more than the normal of a surface; with
/// [`Texture`](crate::path::texture::Texture) ones it asks for texture coordinates, and heeds interpolated normals.
///
/// ```
/// use estimand::path::bsdf::{Blend, Diffuse, Material, Mirror};
/// use estimand::path::texture::{Checkerboard, Texture, Uniform};
/// use glam::Affine2;
///
/// let colors = [Uniform::from(0.9).into(), Uniform::from(0.1).into()];
/// let tiles = Texture::from(Checkerboard::new(colors, Affine2::IDENTITY));
/// let laws = [Diffuse::new(tiles)?.into(), Mirror::new([1.0; 3])?.into()];
/// let polished = Material::from(Blend::new(Uniform::from(0.1).into(), laws));
/// # let _: Material<Texture> = polished;
/// # Ok::<(), estimand::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Material<P = Uniform> {
    /// Ideally diffuse on both sides.
    Lambertian(Lambertian),
    /// An ideal mirror.
    Mirror(Mirror),
    /// A smooth boundary between transparent media.
    Dielectric(Dielectric<P>),
    /// Ideally diffuse on one side.
    Diffuse(Diffuse<P>),
    /// A smooth metal.
    Conductor(Conductor<P>),
    /// A rough metal.
    RoughConductor(RoughConductor<P>),
    /// A pane.
    ThinDielectric(ThinDielectric<P>),
    /// A rough boundary between transparent media.
    RoughDielectric(RoughDielectric<P>),
    /// A diffuse base under a smooth coat.
    Plastic(Plastic<P>),
    /// A diffuse base under a rough coat.
    RoughPlastic(Box<RoughPlastic<P>>),
    /// Nothing.
    Null(Null),
    /// One-sided laws on both sides.
    TwoSided(Box<TwoSided<Self>>),
    /// A law with holes.
    Mask(Box<Mask<Self, P>>),
    /// A mixture of two laws.
    Blend(Box<Blend<Self, P>>),
    /// A law with normals that follow a height field.
    BumpMap(Box<BumpMap<Self, P>>),
    /// A law with normals from a texture.
    NormalMap(Box<NormalMap<Self, P>>),
}

impl<P> From<Lambertian> for Material<P> {
    fn from(law: Lambertian) -> Self {
        Self::Lambertian(law)
    }
}

impl<P> From<Mirror> for Material<P> {
    fn from(law: Mirror) -> Self {
        Self::Mirror(law)
    }
}

impl<P> From<Dielectric<P>> for Material<P> {
    fn from(law: Dielectric<P>) -> Self {
        Self::Dielectric(law)
    }
}

impl<P> From<Diffuse<P>> for Material<P> {
    fn from(law: Diffuse<P>) -> Self {
        Self::Diffuse(law)
    }
}

impl<P> From<Conductor<P>> for Material<P> {
    fn from(law: Conductor<P>) -> Self {
        Self::Conductor(law)
    }
}

impl<P> From<RoughConductor<P>> for Material<P> {
    fn from(law: RoughConductor<P>) -> Self {
        Self::RoughConductor(law)
    }
}

impl<P> From<ThinDielectric<P>> for Material<P> {
    fn from(law: ThinDielectric<P>) -> Self {
        Self::ThinDielectric(law)
    }
}

impl<P> From<RoughDielectric<P>> for Material<P> {
    fn from(law: RoughDielectric<P>) -> Self {
        Self::RoughDielectric(law)
    }
}

impl<P> From<Plastic<P>> for Material<P> {
    fn from(law: Plastic<P>) -> Self {
        Self::Plastic(law)
    }
}

impl<P> From<RoughPlastic<P>> for Material<P> {
    fn from(law: RoughPlastic<P>) -> Self {
        Self::RoughPlastic(Box::new(law))
    }
}

impl<P> From<Null> for Material<P> {
    fn from(law: Null) -> Self {
        Self::Null(law)
    }
}

impl<P> From<TwoSided<Self>> for Material<P> {
    fn from(law: TwoSided<Self>) -> Self {
        Self::TwoSided(Box::new(law))
    }
}

impl<P> From<Mask<Self, P>> for Material<P> {
    fn from(law: Mask<Self, P>) -> Self {
        Self::Mask(Box::new(law))
    }
}

impl<P> From<Blend<Self, P>> for Material<P> {
    fn from(law: Blend<Self, P>) -> Self {
        Self::Blend(Box::new(law))
    }
}

impl<P> From<BumpMap<Self, P>> for Material<P> {
    fn from(law: BumpMap<Self, P>) -> Self {
        Self::BumpMap(Box::new(law))
    }
}

impl<P> From<NormalMap<Self, P>> for Material<P> {
    fn from(law: NormalMap<Self, P>) -> Self {
        Self::NormalMap(Box::new(law))
    }
}

/// What a material does, as what its law does, and the place that the law asks for.
macro_rules! of {
    ($material:expr, ($law:ident, $place:ident) => $value:expr) => {
        match $material {
            Self::Lambertian($law) => of!(@anywhere, $place, $value),
            Self::Mirror($law) => of!(@anywhere, $place, $value),
            Self::Null($law) => of!(@anywhere, $place, $value),
            Self::Dielectric($law) => $value,
            Self::Diffuse($law) => $value,
            Self::Conductor($law) => $value,
            Self::RoughConductor($law) => $value,
            Self::ThinDielectric($law) => $value,
            Self::RoughDielectric($law) => $value,
            Self::Plastic($law) => $value,
            Self::RoughPlastic($law) => $value,
            Self::TwoSided($law) => $value,
            Self::Mask($law) => $value,
            Self::Blend($law) => $value,
            Self::BumpMap($law) => $value,
            Self::NormalMap($law) => $value,
        }
    };
    (@anywhere, $place:ident, $value:expr) => {{
        let $place = &();
        $value
    }};
}

impl<P: Parameter> Law for Material<P> {
    type Place = P::Place;

    fn is_delta(&self) -> bool {
        of!(self, (law, _place) => law.is_delta())
    }

    fn evaluate(&self, place: &P::Place, out: Vec3A, into: Vec3A) -> Scattering {
        of!(self, (law, place) => law.evaluate(place, out, into))
    }

    fn sample<S: Sampler>(&self, place: &P::Place, out: Vec3A, u: &mut S) -> Option<Scattered> {
        of!(self, (law, place) => law.sample(place, out, u))
    }
}

/// The laws that need no frame go without.
impl<P: Parameter> super::Bsdf for Material<P> {
    type Detail = <P::Place as Place>::Detail;

    fn as_lambertian(&self) -> Option<&Lambertian> {
        match self {
            Self::Lambertian(law) => Some(law),
            _ => None,
        }
    }

    fn is_lambertian(&self) -> bool {
        match self {
            Self::Lambertian(_) | Self::Diffuse(_) => true,
            Self::TwoSided(sides) => sides.same().is_some_and(super::Bsdf::is_lambertian),
            _ => false,
        }
    }

    #[inline]
    fn lambertian_at(&self, at: &Surface<Self::Detail>) -> Option<Lambertian> {
        match self {
            Self::Lambertian(law) => Some(*law),
            Self::Diffuse(law) => {
                let frame: Frame = P::Place::frame(at);
                Some(law.lambertian(&P::Place::of(at, &frame)))
            }
            Self::TwoSided(sides) => Some(sides.same()?.lambertian_at(at)?.both()),
            _ => None,
        }
    }

    #[inline]
    fn is_delta(&self) -> bool {
        Law::is_delta(self)
    }

    #[inline]
    fn evaluate(&self, at: &Surface<Self::Detail>, out: Vec3A, into: Vec3A) -> Scattering {
        match self.lambertian_at(at) {
            Some(law) => super::Bsdf::evaluate(&law, &shaded::<P>(at), out, into),
            None => law::evaluate(self, at, out, into),
        }
    }

    #[inline]
    fn sample<S: Sampler>(
        &self,
        at: &Surface<Self::Detail>,
        out: Vec3A,
        u: &mut S,
    ) -> Option<Scattered> {
        if let Some(law) = self.lambertian_at(at) {
            return super::Bsdf::sample(&law, &shaded::<P>(at), out, u);
        }
        match self {
            Self::Mirror(law) => super::Bsdf::sample(law, &shaded::<P>(at), out, u),
            Self::Dielectric(law) => {
                let frame: Frame = P::Place::frame(at);
                law.scatter(&P::Place::of(at, &frame), frame.normal(), out, u)
            }
            _ => law::sample(self, at, out, u),
        }
    }
}

/// The surface with the normal that light is scattered by.
#[inline]
fn shaded<P: Parameter>(at: &Surface<<P::Place as Place>::Detail>) -> Surface {
    let frame: Frame = P::Place::frame(at);
    Surface {
        point: at.point,
        normal: frame.normal(),
        margin: at.margin,
        detail: (),
    }
}
