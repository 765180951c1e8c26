//! Every randomised point set of the crate, by name.

use estimand::hash::{hash, unit};
use estimand::points::{
    BlueNoise, DigitPermutation, DigitalShift, Faure, Folded, Halton, Hammersley, HashedOwen,
    Independent, Kronecker, Lattice, LatticeSequence, LinearMatrix, MultiJittered, NRooks,
    OrthogonalArray, Owen, Padded, PointSet, Rescrambled, Shifted, Sobol, Stratified, VanDerCorput,
};

/// How many points a set has, where it must be told.
pub(crate) const COUNT: u64 = 64;

/// Dimensions of the sets that must be told: paths that draw more go on with independent coordinates.
const DIMENSIONS: u32 = 16;

/// A point set for each seed.
pub(crate) type Randomised = Box<dyn Fn(u64) -> Box<dyn PointSet> + Sync>;

fn named<P: PointSet + 'static>(
    name: &'static str,
    set: impl Fn(u64) -> P + Sync + 'static,
) -> (&'static str, Randomised) {
    (name, Box::new(move |seed| Box::new(set(seed))))
}

/// All of them.
pub(crate) fn sets() -> Vec<(&'static str, Randomised)> {
    let mut sets = Vec::new();
    sets.extend(strata());
    sets.extend(digital());
    sets.extend(lattices());
    sets.extend(composed());
    sets
}

/// Sets that are random by themselves.
fn strata() -> [(&'static str, Randomised); 7] {
    [
        named("independent", Independent::new),
        named("stratified", |seed| {
            Stratified::new(COUNT, 2, seed).unwrap()
        }),
        named("stratified in four", |seed| {
            Stratified::new(COUNT, 4, seed).unwrap()
        }),
        named("n-rooks", |seed| NRooks::new(COUNT, seed).unwrap()),
        named("multi-jittered", |seed| {
            MultiJittered::new(COUNT, seed).unwrap()
        }),
        named("orthogonal array", |seed| {
            OrthogonalArray::new(COUNT, 6, seed).unwrap()
        }),
        named("blue noise", |seed| {
            BlueNoise::new(COUNT, seed).unwrap().pixel([3, 5])
        }),
    ]
}

/// Sets that are random by a scramble of their digits.
fn digital() -> Vec<(&'static str, Randomised)> {
    let (halton, sobol) = (
        Halton::new(DIMENSIONS).unwrap(),
        Sobol::new(DIMENSIONS).unwrap(),
    );
    let faure = Faure::new(DIMENSIONS).unwrap();
    let hammersley = |seed| {
        let offset = unit(hash(seed, 1));
        let points = Hammersley::new(COUNT, DIMENSIONS).unwrap();
        points.offset(offset).unwrap()
    };
    /// A plain set under a scramble.
    macro_rules! scrambled {
        ($name:literal, $set:ident, $scramble:ident) => {{
            let set = $set.clone();
            named($name, move |seed| set.clone().scrambled($scramble { seed }))
        }};
    }
    vec![
        scrambled!("Halton, digital shift", halton, DigitalShift),
        scrambled!("Halton permuted", halton, DigitPermutation),
        scrambled!("Halton, Owen", halton, Owen),
        named("Hammersley permuted", move |seed| {
            hammersley(seed).scrambled(DigitPermutation { seed })
        }),
        named("Hammersley, Owen", move |seed| {
            hammersley(seed).scrambled(Owen { seed })
        }),
        scrambled!("Faure, digital shift", faure, DigitalShift),
        scrambled!("Faure permuted", faure, DigitPermutation),
        scrambled!("Faure, Owen", faure, Owen),
        scrambled!("Sobol, digital shift", sobol, DigitalShift),
        scrambled!("Sobol, linear matrix", sobol, LinearMatrix),
        scrambled!("Sobol, Owen", sobol, Owen),
        scrambled!("Sobol, hashed Owen", sobol, HashedOwen),
    ]
}

/// Sets that are random by a shift.
fn lattices() -> [(&'static str, Randomised); 7] {
    let lattice = Lattice::published(COUNT, DIMENSIONS).unwrap();
    let made = Lattice::component_by_component(COUNT, 6).unwrap();
    let sequence = LatticeSequence::new(DIMENSIONS).unwrap();
    let kronecker = Kronecker::r(6).unwrap();
    let (halton, sobol) = (
        Halton::new(DIMENSIONS).unwrap(),
        Sobol::new(DIMENSIONS).unwrap(),
    );
    [
        named("van der Corput shifted", |seed| {
            Shifted::new(VanDerCorput::new(2).unwrap(), seed)
        }),
        named("Halton shifted", move |seed| {
            Shifted::new(halton.clone(), seed)
        }),
        named("Sobol shifted", move |seed| {
            Shifted::new(sobol.clone(), seed)
        }),
        named("lattice shifted", move |seed| {
            Shifted::new(lattice.clone(), seed)
        }),
        named("lattice made here shifted", move |seed| {
            Shifted::new(made.clone(), seed)
        }),
        named("lattice sequence shifted", move |seed| {
            Shifted::new(sequence.clone(), seed)
        }),
        named("Kronecker shifted", move |seed| {
            Shifted::new(kronecker.clone(), seed)
        }),
    ]
}

/// Sets that are made of others.
fn composed() -> [(&'static str, Randomised); 4] {
    let rescrambled = Rescrambled::new(4, 0).unwrap();
    let sobol = Sobol::new(4).unwrap();
    let lattice = Lattice::published(COUNT, DIMENSIONS).unwrap();
    let first = sobol.clone();
    [
        named("rescrambled", move |seed| rescrambled.reseeded(seed)),
        named("Sobol padded with n-rooks", move |seed| {
            let rest = NRooks::new(COUNT, hash(seed, 1)).unwrap();
            Padded::new(first.clone().scrambled(HashedOwen { seed }), 4, rest).unwrap()
        }),
        named("lattice shifted and folded", move |seed| {
            Folded::new(Shifted::new(lattice.clone(), seed))
        }),
        named("Sobol scrambled and folded", move |seed| {
            Folded::new(sobol.clone().scrambled(Owen { seed }))
        }),
    ]
}
