//! What a coordinate costs: whole blocks (`fill/d8`, `fill/d32`, `fill/d128`), all samples of one pixel after the other (`pixel/1` to
//! `pixel/256`) and single ones (`coordinate`), beside the generators and point sets that one could take instead, and beside a plain store
//! as the limit.
//!
//! Criterion reports elements, which are coordinates, per second. A ratio needs both sides in turns, so that what else the machine does
//! hits both:
//!
//! `POINTS_TURNS=301 cargo bench --all-features --bench points`
//!
//! prints medians, quartiles, and ratios to the fastest peer; and those of one thread and two.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use estimand::points::{
    BlueNoise, DigitPermutation, DigitalShift, Faure, Halton, Hammersley, HashedOwen, Independent,
    Kronecker, Lattice, LatticeSequence, LinearMatrix, MultiJittered, NRooks, OrthogonalArray,
    Owen, PointSet, Rescrambled, Sobol, Stratified, pixel,
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

/// A block is written, again and again.
type Fill = Box<dyn FnMut(&mut [f64])>;

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

/// What one could take instead, and a plain store.
fn peers(dimensions: u32) -> Vec<(&'static str, Fill)> {
    let width = dimensions as usize;
    let mut value = 0.0;
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let table = sobol_qmc::params::JoeKuoD6::STANDARD;
    let mut sobol = sobol_qmc::Sobol::<f64>::new(width, &table).unwrap();
    // The crate's bases are at most 255: the first 54 primes.
    let mut sequences: Vec<_> = PRIMES
        .iter()
        .cycle()
        .take(width)
        .map(|&base| halton::Sequence::new(base))
        .collect();
    let mut peers: Vec<(&str, Fill)> = vec![
        (
            "limit: store",
            Box::new(move |out| {
                value += 1.0;
                out.fill(black_box(value));
            }),
        ),
        (
            "peer: rand Xoshiro256PlusPlus",
            Box::new(move |out| out.fill_with(|| generator.random())),
        ),
        (
            "peer: sobol-qmc",
            Box::new(move |out| {
                for (row, point) in out.chunks_exact_mut(width).zip(&mut sobol) {
                    row.copy_from_slice(&point);
                }
            }),
        ),
        (
            "peer: halton",
            Box::new(move |out| {
                for (column, sequence) in sequences.iter_mut().enumerate() {
                    let column = out[column..].iter_mut().step_by(width);
                    for (u, coordinate) in column.zip(sequence) {
                        *u = coordinate;
                    }
                }
            }),
        ),
        (
            "peer: sobol_burley, 4 at once, f32, hashed Owen",
            Box::new(move |out| {
                for (index, row) in (0..).zip(out.chunks_exact_mut(width)) {
                    for (set, four) in (0..).zip(row.chunks_exact_mut(4)) {
                        let coordinates = sobol_burley::sample_4d(index, set, 1);
                        for (u, coordinate) in four.iter_mut().zip(coordinates) {
                            *u = coordinate.into();
                        }
                    }
                }
            }),
        ),
    ];
    if dimensions <= 32 {
        let mut sequence = quasi_rd::Sequence::new(width);
        let fill = move |out: &mut [f64]| out.fill_with(|| sequence.next_f64());
        peers.push(("peer: quasi-rd", Box::new(fill)));
    }
    peers
}

/// All that is timed.
fn cases(dimensions: u32) -> Vec<(&'static str, Fill)> {
    let rows = BLOCK as u64 / u64::from(dimensions);
    let mut cases = peers(dimensions);
    for (name, points) in sets(dimensions) {
        let mut first = 0;
        let fill = move |out: &mut [f64]| {
            points.fill(first, 0..dimensions, out);
            first = (first + rows) % COUNT;
        };
        cases.push((name, Box::new(fill)));
    }
    cases
}

fn fill(criterion: &mut Criterion, dimensions: u32) {
    let mut group = settings(criterion, &format!("fill/d{dimensions}"));
    let mut out = vec![0.0; BLOCK];
    group.throughput(Throughput::Elements(out.len() as u64));
    for (name, mut fill) in cases(dimensions) {
        group.bench_function(name, |bencher| {
            bencher.iter(|| fill(black_box(&mut out)));
        });
    }
    group.finish();
}

/// Some samples of many pixels, of which each has points of its own, in as many dimensions as paths ask for at once.
fn pixels(criterion: &mut Criterion, samples: u64) {
    const DIMENSIONS: u32 = 24;
    let mut group = settings(criterion, &format!("pixel/{samples}"));
    let mut out = vec![0.0; usize::try_from(samples).unwrap() * DIMENSIONS as usize];
    group.throughput(Throughput::Elements(out.len() as u64));
    let image = BlueNoise::new(samples, SEED).unwrap();
    let groups = Rescrambled::new(4, SEED).unwrap();
    let mut bench = |name, fill: &dyn Fn([u32; 2], &mut [f64])| {
        let mut pixels = (0..256).flat_map(|y| (0..256).map(move |x| [x, y])).cycle();
        group.bench_function(name, |bencher| {
            bencher.iter(|| fill(pixels.next().unwrap(), black_box(&mut out)));
        });
    };
    bench("BlueNoise", &|pixel, out| {
        image.pixel(pixel).fill(0, 0..DIMENSIONS, out);
    });
    let seed = |pixel| pixel::seed(pixel, SEED);
    bench("Rescrambled", &|pixel, out| {
        groups.reseeded(seed(pixel)).fill(0, 0..DIMENSIONS, out);
    });
    bench("Sobol, HashedOwen", &|pixel, out| {
        let sobol = Sobol::new(DIMENSIONS).unwrap();
        let seed = seed(pixel);
        let points = sobol.scrambled(HashedOwen { seed });
        points.fill(0, 0..DIMENSIONS, out);
    });
    bench("Independent", &|pixel, out| {
        Independent::new(seed(pixel)).fill(0, 0..DIMENSIONS, out);
    });
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
    let image = BlueNoise::new(1 << 20, seed).unwrap();
    bench(&mut group, "BlueNoise", &image.pixel([3, 4]));
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

/// How many blocks are written by one thread, and by two of which each writes a half: so many that starting the threads, about 50
/// microseconds, does not count.
const ROUNDS: u64 = 512;

/// Writes the blocks in turns, each thread into its own room.
fn on_threads(points: &impl PointSet, rooms: &mut [Vec<f64>]) {
    let (count, rows) = (rooms.len(), BLOCK as u64 / 32);
    std::thread::scope(|scope| {
        for (thread, out) in (0..).zip(rooms) {
            scope.spawn(move || {
                for round in (thread..ROUNDS).step_by(count) {
                    points.fill(round * rows, 0..32, black_box(out));
                }
            });
        }
    });
}

fn threads(criterion: &mut Criterion) {
    let mut group = settings(criterion, "threads/d32");
    group.throughput(Throughput::Elements(ROUNDS * BLOCK as u64));
    let points = Sobol::new(32).unwrap();
    let points = points.scrambled(HashedOwen { seed: SEED });
    for count in [1, 2] {
        let mut rooms = vec![vec![0.0; BLOCK]; count];
        group.bench_function(format!("Sobol, HashedOwen, {count} thread(s)"), |bencher| {
            bencher.iter(|| on_threads(&points, &mut rooms));
        });
    }
    group.finish();
}

/// The times of a case in all rounds, in nanoseconds for each coordinate.
struct Times {
    name: String,
    times: Vec<f64>,
}

impl Times {
    fn of(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            times: Vec::new(),
        }
    }

    fn time(&mut self, coordinates: u64, run: impl FnOnce()) {
        let start = Instant::now();
        run();
        let seconds = start.elapsed().as_secs_f64();
        self.times.push(seconds * 1e9 / coordinates as f64);
    }

    /// Median and quartiles, and those of the ratios to another case in the same rounds.
    fn print(&self, other: &Self) {
        let ratios = self.times.iter().zip(&other.times).map(|(a, b)| a / b);
        let [time, ratio] = [self.times.clone(), ratios.collect()].map(|mut values| {
            values.sort_by(f64::total_cmp);
            [1, 2, 3].map(|quartile| values[(values.len() - 1) * quartile / 4])
        });
        println!(
            "| {} | {:.3} | {:.3} to {:.3} | {:.2} | {:.2} to {:.2} |",
            self.name, time[1], time[0], time[2], ratio[1], ratio[0], ratio[2]
        );
    }
}

/// All cases in turns.
fn turns(rounds: usize) {
    for dimensions in [8, 32, 128] {
        let mut cases = cases(dimensions);
        let mut out = vec![0.0; BLOCK];
        let mut all: Vec<Times> = cases.iter().map(|(name, _)| Times::of(name)).collect();
        for _ in 0..rounds {
            for ((_, fill), times) in cases.iter_mut().zip(&mut all) {
                times.time(BLOCK as u64, || fill(black_box(&mut out)));
            }
        }
        let median = |times: &Times| {
            let mut times = times.times.clone();
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        };
        let fastest = all
            .iter()
            .filter(|times| times.name.starts_with("peer"))
            .min_by(|a, b| median(a).total_cmp(&median(b)))
            .expect("some peers");
        println!(
            "| d = {dimensions} | ns | quartiles | to {} | quartiles |",
            fastest.name
        );
        all.iter().for_each(|times| times.print(fastest));
    }
    let points = Sobol::new(32).unwrap();
    let points = points.scrambled(HashedOwen { seed: SEED });
    let mut rooms = vec![vec![0.0; BLOCK]; 2];
    let [mut one, mut two] = ["one thread", "two threads"].map(Times::of);
    for _ in 0..rounds {
        one.time(ROUNDS * BLOCK as u64, || {
            on_threads(&points, &mut rooms[..1]);
        });
        two.time(ROUNDS * BLOCK as u64, || on_threads(&points, &mut rooms));
    }
    println!("| Sobol, HashedOwen, d = 32 | ns | quartiles | to two threads | quartiles |");
    one.print(&two);
    two.print(&two);
}

fn main() {
    if let Some(rounds) = std::env::var_os("POINTS_TURNS") {
        let rounds = rounds.to_str().and_then(|rounds| rounds.parse().ok());
        return turns(
            rounds
                .filter(|&rounds| rounds > 0)
                .expect("a number of rounds"),
        );
    }
    let mut criterion = Criterion::default().configure_from_args();
    threads(&mut criterion);
    for dimensions in [8, 32, 128] {
        fill(&mut criterion, dimensions);
    }
    for samples in [1, 4, 16, 64, 256] {
        pixels(&mut criterion, samples);
    }
    coordinate(&mut criterion);
    criterion.final_summary();
}
