//! What an estimator costs beside the loop that one would write by hand on the same points.
//!
//! Run with `RAYON_NUM_THREADS=1` for a fair comparison: the loops by hand have one thread. The ratios need loop and library
//! side by side, in turns, so that what else the machine does hits both:
//!
//! `ESTIMATORS_RATIO=101 RAYON_NUM_THREADS=1 cargo bench --all-features --bench estimators`
//!
//! prints them, and those of one thread and two. For instruction counts, which do not depend on what else the machine
//! does, run one case alone:
//!
//! `ESTIMATORS_ONCE=monte_carlo/library RAYON_NUM_THREADS=1 valgrind --tool=callgrind target/release/deps/estimators-*`

#![expect(clippy::cast_possible_truncation, reason = "small numbers")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput};
use estimand::estimators::{Bounded, Strata, Vegas};
use estimand::hash::hash;
use estimand::integrands::Roulette;
use estimand::points::{HashedOwen, Independent, LinearMatrix, PointSet, Sobol};
use estimand::{Average, Estimator, MonteCarlo, Replicated, Sampler, Stream, cube};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};

const COUNT: u64 = 1 << 18;
const DIMENSIONS: usize = 5;

fn function(x: [f64; DIMENSIONS]) -> f64 {
    let square: f64 = x.iter().map(|x| (x - 0.5) * (x - 0.5)).sum();
    (-25.0 * square).exp()
}

/// Mean and standard error of shifted values, as one writes them by hand.
fn by_hand(count: u64, mut value: impl FnMut(u64) -> f64) -> [f64; 2] {
    let first = value(0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 1..count {
        let d = value(index) - first;
        sum += d;
        squares += d * d;
    }
    let n = count as f64;
    [
        first + sum / n,
        ((squares - sum * sum / n) / (n - 1.0) / n).sqrt(),
    ]
}

/// By hand on the points of a set, a block of coordinates at a time.
fn by_hand_on(points: &impl PointSet, count: u64) -> [f64; 2] {
    const ROWS: usize = 512;
    let mut ahead = vec![0.0; ROWS * DIMENSIONS];
    let dimensions = 0..DIMENSIONS as u32;
    by_hand(count, |index| {
        let row = index as usize % ROWS;
        if row == 0 {
            points.fill(index, dimensions.clone(), &mut ahead);
        }
        let x = &ahead[row * DIMENSIONS..][..DIMENSIONS];
        function(x.try_into().expect("five coordinates"))
    })
}

/// By hand in the cells of a grid, `CELLS` along each of the first three axes: points in equal numbers.
fn by_hand_in_cells(count: u64) -> [f64; 2] {
    let cells = CELLS.pow(3);
    let each = count / cells;
    let mut ahead = Ahead::new(Independent::new(1));
    let (mut mean, mut variance) = (0.0, 0.0);
    for cell in 0..cells {
        let corner = [cell, cell / CELLS, cell / CELLS / CELLS].map(|place| (place % CELLS) as f64);
        let [here, error] = by_hand(each, |index| {
            let mut x = ahead.point(cell * each + index);
            for (x, place) in x.iter_mut().zip(corner) {
                *x = (place + *x) / CELLS as f64;
            }
            function(x)
        });
        mean += here;
        variance += error * error;
    }
    let cells = cells as f64;
    [mean / cells, variance.sqrt() / cells]
}

/// The points of a set in the order of their indices, computed ahead.
struct Ahead<P> {
    points: P,
    room: Vec<f64>,
}

impl<P: PointSet> Ahead<P> {
    const ROWS: usize = 256;

    fn new(points: P) -> Self {
        let room = vec![0.0; Self::ROWS * DIMENSIONS];
        Self { points, room }
    }

    #[inline]
    fn point(&mut self, index: u64) -> [f64; DIMENSIONS] {
        let row = index as usize % Self::ROWS;
        if row == 0 {
            self.points
                .fill(index, 0..DIMENSIONS as u32, &mut self.room);
        }
        let x = &self.room[row * DIMENSIONS..][..DIMENSIONS];
        x.try_into().expect("five coordinates")
    }
}

/// VEGAS by hand, as far as its loop goes: bins and strata as the library has them for this count, with more points in strata
/// that vary more.
fn vegas_by_hand(count: u64) -> [f64; 2] {
    const BINS: usize = 161;
    const SIDE: u64 = 5;
    const ITERATIONS: u64 = 10;
    let strata = SIDE.pow(5);
    let mut counts = vec![count / ITERATIONS / strata; strata as usize];
    let mut ends = [[0.0; BINS + 1]; DIMENSIONS];
    for axis in &mut ends {
        for (place, end) in axis.iter_mut().enumerate() {
            *end = place as f64 / BINS as f64;
        }
    }
    let (mut all, mut variance) = (0.0, 0.0);
    for iteration in 0..ITERATIONS {
        let mut squares = [[0.0; BINS]; DIMENSIONS];
        let mut hits = [[0.0; BINS]; DIMENSIONS];
        let mut ahead = Ahead::new(Independent::new(hash(1, iteration)));
        let (mut mean, mut errors) = (0.0, 0.0);
        let mut scores = Vec::with_capacity(counts.len());
        let mut first = 0;
        for (mut rest, &each) in (0..).zip(&counts) {
            let corner: [f64; DIMENSIONS] = std::array::from_fn(|_| {
                let place = rest % SIDE;
                rest /= SIDE;
                place as f64
            });
            let [here, error] = by_hand(each, |index| {
                let mut x = ahead.point(first + index);
                let mut bins = [0; DIMENSIONS];
                let mut jacobian = 1.0;
                for axis in 0..DIMENSIONS {
                    let scaled = (corner[axis] + x[axis]) * (BINS as f64 / SIDE as f64);
                    let bin = (scaled as usize).min(BINS - 1);
                    let width = ends[axis][bin + 1] - ends[axis][bin];
                    x[axis] = ends[axis][bin] + (scaled - bin as f64) * width;
                    jacobian *= width * BINS as f64;
                    bins[axis] = bin;
                }
                let value = jacobian * function(x);
                for (axis, bin) in bins.into_iter().enumerate() {
                    squares[axis][bin] += value * value;
                    hits[axis][bin] += 1.0;
                }
                value
            });
            mean += here;
            errors += error * error;
            scores.push((error * error * each as f64).powf(0.375));
            first += each;
        }
        let sum: f64 = scores.iter().sum();
        let free = (count / ITERATIONS - 2 * strata) as f64;
        let (mut share, mut given) = (0.0, 0);
        for (count, score) in counts.iter_mut().zip(&scores) {
            share += 0.2 / strata as f64 + 0.8 * score / sum;
            let end = (share * free) as u64;
            *count = 2 + end - given;
            given = end;
        }
        all += mean / strata as f64;
        variance += errors / (strata * strata) as f64;
        for ((ends, squares), hits) in ends.iter_mut().zip(&squares).zip(&hits) {
            let weights: [f64; BINS] =
                std::array::from_fn(|bin| (squares[bin] / f64::max(hits[bin], 1.0)).powf(0.25));
            let share = weights.iter().sum::<f64>() / BINS as f64;
            let old = *ends;
            let (mut bin, mut before) = (0, 0.0);
            for (place, end) in ends.iter_mut().enumerate().take(BINS).skip(1) {
                let target = share * place as f64;
                while bin < BINS - 1 && before + weights[bin] < target {
                    before += weights[bin];
                    bin += 1;
                }
                let within = ((target - before) / weights[bin]).clamp(0.0, 1.0);
                *end = old[bin] + within * (old[bin + 1] - old[bin]);
            }
        }
    }
    let iterations = ITERATIONS as f64;
    [all / iterations, variance.sqrt() / iterations]
}

/// Cells along an axis of the grid of `Strata`.
const CELLS: u64 = 8;

type Case = (&'static str, Box<dyn Fn()>);
type ThreadedCase = (&'static str, Box<dyn Fn() + Sync>);

fn cases() -> Vec<Case> {
    let f = || cube(function);
    let sobol = || Sobol::new(DIMENSIONS as u32).expect("five dimensions");
    let owen = move |seed| sobol().scrambled(HashedOwen { seed });
    vec![
        (
            "monte_carlo/by_hand",
            Box::new(|| {
                let mut stream = Stream(Xoshiro256PlusPlus::seed_from_u64(1));
                black_box(by_hand(COUNT, |_| {
                    function(std::array::from_fn(|_| stream.next_1d()))
                }));
            }),
        ),
        (
            "monte_carlo/library",
            Box::new(move || drop(black_box(MonteCarlo::new(COUNT, 1).estimate(&f())))),
        ),
        (
            "average/by_hand",
            Box::new(move || {
                black_box(by_hand_on(&owen(1), COUNT));
            }),
        ),
        (
            "average/library",
            Box::new(move || drop(black_box(Average::new(owen(1), COUNT).estimate(&f())))),
        ),
        (
            "replicated/by_hand",
            Box::new(move || {
                let means: Vec<f64> = (0..16)
                    .map(|replicate| by_hand_on(&owen(hash(0, replicate)), COUNT / 16)[0])
                    .collect();
                black_box(by_hand(16, |index| means[index as usize]));
            }),
        ),
        (
            "replicated/library",
            Box::new(move || {
                drop(black_box(
                    Replicated::new(16, COUNT / 16, owen).estimate(&f()),
                ));
            }),
        ),
        (
            "median/by_hand",
            Box::new(move || {
                let mut means: Vec<f64> = (0..15)
                    .map(|replicate| {
                        let matrix = LinearMatrix {
                            seed: hash(0, replicate),
                        };
                        by_hand_on(&sobol().scrambled(matrix), COUNT / 16)[0]
                    })
                    .collect();
                means.sort_by(f64::total_cmp);
                black_box(means);
            }),
        ),
        (
            "median/library",
            Box::new(move || {
                let linear = |seed| sobol().scrambled(LinearMatrix { seed });
                let median = Replicated::new(15, COUNT / 16, linear).median();
                drop(black_box(median.estimate(&f())));
            }),
        ),
        (
            "roulette/by_hand",
            Box::new(|| {
                let mut stream = Stream(Xoshiro256PlusPlus::seed_from_u64(1));
                black_box(by_hand(COUNT, |_| {
                    if stream.next_1d() < 0.5 {
                        2.0 * function(std::array::from_fn(|_| stream.next_1d()))
                    } else {
                        0.0
                    }
                }));
            }),
        ),
        (
            "roulette/library",
            Box::new(move || {
                let roulette = Roulette::new(f(), 0.5).expect("a probability");
                drop(black_box(MonteCarlo::new(COUNT, 1).estimate(&roulette)));
            }),
        ),
        (
            "strata/by_hand",
            Box::new(|| {
                black_box(by_hand_in_cells(COUNT));
            }),
        ),
        (
            "strata/library",
            Box::new(move || {
                let strata = Strata::new(CELLS, 3, COUNT, 1).expect("valid");
                drop(black_box(strata.estimate(&f())));
            }),
        ),
        (
            "bounded/by_hand",
            Box::new(|| {
                let mut stream = Stream(Xoshiro256PlusPlus::seed_from_u64(1));
                let mut within = true;
                black_box(by_hand(COUNT, |_| {
                    let value = function(std::array::from_fn(|_| stream.next_1d()));
                    within &= (0.0..=1.0).contains(&value);
                    value
                }));
                black_box(within);
            }),
        ),
        (
            "bounded/library",
            Box::new(move || {
                let bounded = Bounded::new(COUNT, 1, 0.0, 1.0).expect("bounds");
                drop(black_box(bounded.estimate(&f())));
            }),
        ),
        (
            "neyman/library",
            Box::new(move || {
                let strata = Strata::new(CELLS, 3, COUNT, 1).expect("valid").neyman();
                drop(black_box(strata.estimate(&f())));
            }),
        ),
        (
            "vegas/by_hand",
            Box::new(|| {
                black_box(vegas_by_hand(COUNT));
            }),
        ),
        (
            "vegas/library",
            Box::new(move || {
                let vegas = Vegas::new(DIMENSIONS as u32, COUNT, 1).expect("valid");
                drop(black_box(vegas.estimate(&f())));
            }),
        ),
    ]
}

/// Seconds that each of two jobs takes when they run in turns.
fn in_turns(rounds: usize, jobs: [&dyn Fn(); 2]) -> [Vec<f64>; 2] {
    let mut seconds = [Vec::new(), Vec::new()];
    for _ in 0..rounds {
        for (job, seconds) in jobs.iter().zip(&mut seconds) {
            let clock = Instant::now();
            job();
            seconds.push(clock.elapsed().as_secs_f64());
        }
    }
    seconds
}

/// Prints the medians of two jobs in milliseconds and their ratio, and the quartiles of the ratios of neighbouring runs.
fn compare(name: &str, rounds: usize, jobs: [&dyn Fn(); 2]) {
    let seconds = in_turns(rounds, jobs);
    let mut ratios: Vec<f64> = seconds[1]
        .iter()
        .zip(&seconds[0])
        .map(|(b, a)| b / a)
        .collect();
    ratios.sort_by(f64::total_cmp);
    let [a, b] = seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        1e3 * seconds[rounds / 2]
    });
    let (low, high) = (ratios[rounds / 4], ratios[rounds - 1 - rounds / 4]);
    println!(
        "| {name} | {a:.2} | {b:.2} | {:.2} | {low:.2} to {high:.2} |",
        b / a
    );
}

/// Every loop by hand beside the library, and one thread beside two.
fn ratios(rounds: usize) {
    let cases = cases();
    println!("| estimator | by hand: ms | library: ms | ratio | quartiles |");
    for pair in cases.windows(2) {
        let [(name, by_hand), (_, library)] = pair else {
            continue;
        };
        if let Some(name) = name.strip_suffix("/by_hand") {
            compare(name, rounds, [by_hand, library]);
        }
    }
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (one, two) = (pool(1).expect("a thread"), pool(2).expect("two threads"));
    println!("| estimator | two threads: ms | one: ms | ratio | quartiles |");
    for (name, case) in &threaded() {
        compare(name, rounds, [&|| two.install(case), &|| one.install(case)]);
    }
}

/// Estimators that take long enough for the threads to be worth while.
fn threaded() -> Vec<ThreadedCase> {
    const MANY: u64 = 1 << 21;
    let f = || cube(function);
    let sobol = || Sobol::new(DIMENSIONS as u32).expect("five dimensions");
    let owen = move |seed| sobol().scrambled(HashedOwen { seed });
    vec![
        (
            "MonteCarlo",
            Box::new(move || drop(black_box(MonteCarlo::new(MANY, 1).estimate(&f())))),
        ),
        (
            "Average",
            Box::new(move || drop(black_box(Average::new(owen(1), MANY).estimate(&f())))),
        ),
        (
            "Replicated",
            Box::new(move || {
                drop(black_box(
                    Replicated::new(16, MANY / 16, owen).estimate(&f()),
                ));
            }),
        ),
        (
            "Bounded",
            Box::new(move || {
                let bounded = Bounded::new(MANY, 1, 0.0, 1.0).expect("bounds");
                drop(black_box(bounded.estimate(&f())));
            }),
        ),
        (
            "Strata, neyman",
            Box::new(move || {
                let strata = Strata::new(CELLS, 3, MANY, 1).expect("valid").neyman();
                drop(black_box(strata.estimate(&f())));
            }),
        ),
        (
            "Vegas",
            Box::new(move || {
                let vegas = Vegas::new(DIMENSIONS as u32, MANY, 1).expect("valid");
                drop(black_box(vegas.estimate(&f())));
            }),
        ),
    ]
}

fn main() {
    if let Some(name) = std::env::var_os("ESTIMATORS_ONCE") {
        let cases = cases();
        let case = cases.iter().find(|(case, _)| name == *case);
        case.expect("the name of a case").1();
        return;
    }
    if let Some(rounds) = std::env::var_os("ESTIMATORS_RATIO") {
        let rounds = rounds.to_str().and_then(|rounds| rounds.parse().ok());
        ratios(
            rounds
                .filter(|&rounds| rounds > 0)
                .expect("a number of rounds"),
        );
        return;
    }
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("estimators");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
        .throughput(Throughput::Elements(COUNT));
    for (name, case) in cases() {
        group.bench_function(name, |bencher| bencher.iter(&case));
    }
    group.finish();
    criterion.final_summary();
}
