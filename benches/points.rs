//! What a coordinate costs: whole blocks (`fill/d8`, `fill/d32`, `fill/d128`) and single ones (`coordinate`), beside the
//! generators and point sets that one could take instead, and beside a plain store as the limit.
//!
//! Criterion reports elements, which are coordinates, per second.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use estimand::points::{
    BlueNoise, DigitPermutation, DigitalShift, Faure, Halton, Hammersley, HashedOwen, Independent,
    Kronecker, Lattice, LatticeSequence, LinearMatrix, MultiJittered, NRooks, OrthogonalArray,
    Owen, PointSet, Rescrambled, Sobol, Stratified,
};
use rand::{RngExt, SeedableRng, rngs::Xoshiro256PlusPlus};

/// Coordinates in a block: half a MiB, which the second-level cache holds.
const BLOCK: usize = 1 << 16;

/// Points of a finite set, and of a sequence before it starts again: all blocks of them are filled in turn, as an
/// estimate fills them.
const COUNT: u64 = 1 << 16;

const SEED: u64 = 1;

fn settings<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(400));
    group
}

/// Every set of the crate whose blocks are timed.
fn sets(dimensions: u32) -> Vec<(&'static str, Box<dyn PointSet>)> {
    let sobol = Sobol::new(dimensions).unwrap();
    let halton = Halton::new(dimensions).unwrap();
    vec![
        ("Independent", Box::new(Independent::new(SEED))),
        ("NRooks", Box::new(NRooks::new(COUNT, SEED).unwrap())),
        (
            "NRooks, 50000 points",
            Box::new(NRooks::new(50_000, SEED).unwrap()),
        ),
        (
            "Stratified",
            Box::new(Stratified::new(COUNT, 2, SEED).unwrap()),
        ),
        (
            "MultiJittered",
            Box::new(MultiJittered::new(COUNT, SEED).unwrap()),
        ),
        (
            "OrthogonalArray",
            Box::new(OrthogonalArray::new(COUNT, dimensions, SEED).unwrap()),
        ),
        ("Sobol", Box::new(sobol.clone())),
        (
            "Sobol, DigitalShift",
            Box::new(sobol.clone().scrambled(DigitalShift { seed: SEED })),
        ),
        (
            "Sobol, LinearMatrix",
            Box::new(sobol.clone().scrambled(LinearMatrix { seed: SEED })),
        ),
        (
            "Sobol, HashedOwen",
            Box::new(sobol.clone().scrambled(HashedOwen { seed: SEED })),
        ),
        (
            "Sobol, Owen",
            Box::new(sobol.scrambled(Owen { seed: SEED })),
        ),
        ("Rescrambled", Box::new(Rescrambled::new(4, SEED).unwrap())),
        ("Halton", Box::new(halton.clone())),
        (
            "Halton, DigitPermutation",
            Box::new(halton.clone().scrambled(DigitPermutation { seed: SEED })),
        ),
        (
            "Halton, Owen",
            Box::new(halton.scrambled(Owen { seed: SEED })),
        ),
        (
            "Hammersley, DigitPermutation",
            Box::new(
                Hammersley::new(COUNT, dimensions)
                    .unwrap()
                    .scrambled(DigitPermutation { seed: SEED }),
            ),
        ),
        ("Faure", Box::new(Faure::new(dimensions).unwrap())),
        (
            "Lattice",
            Box::new(Lattice::published(COUNT, dimensions).unwrap()),
        ),
        (
            "LatticeSequence",
            Box::new(LatticeSequence::new(dimensions).unwrap()),
        ),
        ("Kronecker", Box::new(Kronecker::r(dimensions).unwrap())),
        (
            "BlueNoise",
            Box::new(BlueNoise::new(COUNT, SEED).unwrap().pixel([3, 4])),
        ),
    ]
}

fn fill(criterion: &mut Criterion, dimensions: u32) {
    let mut group = settings(criterion, &format!("fill/d{dimensions}"));
    let width = dimensions as usize;
    let mut out = vec![0.0; BLOCK];
    let rows = (BLOCK / width) as u64;
    group.throughput(Throughput::Elements(out.len() as u64));

    let mut value = 0.0;
    group.bench_function("limit: store", |bencher| {
        bencher.iter(|| {
            value += 1.0;
            black_box(&mut out[..]).fill(black_box(value));
        });
    });
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(SEED);
    group.bench_function("peer: rand Xoshiro256PlusPlus", |bencher| {
        bencher.iter(|| {
            for u in black_box(&mut out[..]) {
                *u = generator.random();
            }
        });
    });
    let table = sobol_qmc::params::JoeKuoD6::STANDARD;
    group.bench_function("peer: sobol-qmc", |bencher| {
        let mut sobol = sobol_qmc::Sobol::<f64>::new(width, &table).unwrap();
        bencher.iter(|| {
            for (row, point) in black_box(&mut out[..])
                .chunks_exact_mut(width)
                .zip(&mut sobol)
            {
                row.copy_from_slice(&point);
            }
        });
    });
    group.bench_function("peer: halton", |bencher| {
        // The crate's bases are at most 255: the first 54 primes.
        let mut sequences: Vec<_> = PRIMES
            .iter()
            .cycle()
            .take(width)
            .map(|&base| halton::Sequence::new(base))
            .collect();
        bencher.iter(|| {
            for (column, sequence) in sequences.iter_mut().enumerate() {
                let column = out[column..].iter_mut().step_by(width);
                for (u, coordinate) in column.zip(sequence) {
                    *u = coordinate;
                }
            }
            black_box(&mut out);
        });
    });
    if dimensions <= 32 {
        group.bench_function("peer: quasi-rd", |bencher| {
            let mut sequence = quasi_rd::Sequence::new(width);
            bencher.iter(|| {
                for u in black_box(&mut out[..]) {
                    *u = sequence.next_f64();
                }
            });
        });
    }
    group.bench_function(
        "peer: sobol_burley, 4 at once, f32, hashed Owen",
        |bencher| {
            bencher.iter(|| {
                for (index, row) in (0..).zip(out.chunks_exact_mut(width)) {
                    for (set, four) in (0..).zip(row.chunks_exact_mut(4)) {
                        let coordinates = sobol_burley::sample_4d(index, set, 1);
                        for (u, coordinate) in four.iter_mut().zip(coordinates) {
                            *u = coordinate.into();
                        }
                    }
                }
            });
        },
    );
    for (name, points) in sets(dimensions) {
        group.bench_function(name, |bencher| {
            let mut first = 0;
            bencher.iter(|| {
                points.fill(first, 0..dimensions, black_box(&mut out));
                first = (first + rows) % COUNT;
            });
        });
    }
    group.finish();
}

const PRIMES: [u8; 54] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97,
    101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193,
    197, 199, 211, 223, 227, 229, 233, 239, 241, 251,
];

fn coordinate(criterion: &mut Criterion) {
    const DIMENSIONS: u32 = 32;
    let mut group = settings(criterion, "coordinate");
    group.throughput(Throughput::Elements(DIMENSIONS.into()));

    fn bench(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, points: &impl PointSet) {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let index = black_box(1_000_000);
                (0..DIMENSIONS)
                    .map(|dimension| points.coordinate(index, dimension))
                    .sum::<f64>()
            });
        });
    }
    let seed = SEED;
    let sobol = Sobol::new(DIMENSIONS).unwrap();
    let halton = Halton::new(DIMENSIONS).unwrap();
    bench(&mut group, "Independent", &Independent::new(seed));
    bench(&mut group, "NRooks", &NRooks::new(1 << 20, seed).unwrap());
    bench(&mut group, "Sobol", &sobol);
    let hashed = sobol.clone().scrambled(HashedOwen { seed });
    bench(&mut group, "Sobol, HashedOwen", &hashed);
    let owen = sobol.scrambled(Owen { seed });
    bench(&mut group, "Sobol, Owen", &owen);
    bench(
        &mut group,
        "Rescrambled",
        &Rescrambled::new(4, seed).unwrap(),
    );
    bench(&mut group, "Halton", &halton);
    let permuted = halton.clone().scrambled(DigitPermutation { seed });
    bench(&mut group, "Halton, DigitPermutation", &permuted);
    let owen = halton.scrambled(Owen { seed });
    bench(&mut group, "Halton, Owen", &owen);
    group.bench_function(
        "peer: sobol_burley, f32, hashed Owen (index 10^4)",
        |bencher| {
            bencher.iter(|| {
                let index = black_box(10_000);
                (0..DIMENSIONS)
                    .map(|dimension| sobol_burley::sample(index, dimension, 1))
                    .sum::<f32>()
            });
        },
    );
    group.finish();
}

/// The same block by one thread, and by two of which each writes a half.
fn threads(criterion: &mut Criterion) {
    const DIMENSIONS: u32 = 32;
    const ROUNDS: u64 = 64;
    let mut group = settings(criterion, "threads/d32");
    group.throughput(Throughput::Elements(ROUNDS * BLOCK as u64));
    let points = Sobol::new(DIMENSIONS)
        .unwrap()
        .scrambled(HashedOwen { seed: SEED });
    let rows = (BLOCK / DIMENSIONS as usize) as u64;
    for count in [1, 2] {
        let mut outs = vec![vec![0.0; BLOCK]; count];
        group.bench_function(format!("Sobol, HashedOwen, {count} thread(s)"), |bencher| {
            bencher.iter(|| {
                std::thread::scope(|scope| {
                    for (thread, out) in (0..).zip(&mut outs) {
                        let points = &points;
                        scope.spawn(move || {
                            for round in (thread..ROUNDS).step_by(count) {
                                points.fill(round * rows, 0..DIMENSIONS, black_box(out));
                            }
                        });
                    }
                });
            });
        });
    }
    group.finish();
}

fn points(criterion: &mut Criterion) {
    threads(criterion);
    for dimensions in [8, 32, 128] {
        fill(criterion, dimensions);
    }
    coordinate(criterion);
}

criterion_group!(benches, points);
criterion_main!(benches);
