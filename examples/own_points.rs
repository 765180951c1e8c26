//! A third party's own point set in one file, used by every estimator and adaptor of the crate.
//!
//! The set: a Kronecker sequence of the plastic number in two dimensions, shifted by a seed so that its
//! replicates differ (Roberts 2018, <https://extremelearning.com.au/unreasonable-effectiveness-of-quasirandom-sequences/>).

use estimand::hash::{hash, unit};
use estimand::integrands::Roulette;
use estimand::points::PointSet;
use estimand::{Average, Error, Estimator, Replicated, cube};

/// The multiples of (1/g, 1/g^2) modulo 1, with g^3 = g + 1, moved by a random shift.
struct Plastic {
    shift: [u64; 2],
}

impl Plastic {
    /// 1/g and 1/g^2 as fractions of 2^64: modulo 1 is then what wrapping arithmetic does by itself.
    const STEPS: [u64; 2] = [0xc13f_a9a9_02a6_328f, 0x91e1_0da5_c79e_7b1d];

    fn new(seed: u64) -> Self {
        Self {
            shift: [hash(seed, 0), hash(seed, 1)],
        }
    }
}

impl PointSet for Plastic {
    fn coordinate(&self, index: u64, dimension: u32) -> f64 {
        match dimension {
            0 | 1 => {
                let axis = dimension as usize;
                unit(
                    index
                        .wrapping_mul(Self::STEPS[axis])
                        .wrapping_add(self.shift[axis]),
                )
            }
            // Past the last dimension: independent of everything before.
            _ => unit(hash(hash(self.shift[0], u64::from(dimension)), index)),
        }
    }

    fn dimensions(&self) -> u32 {
        2
    }
}

fn main() -> Result<(), Error> {
    // A quarter of a disk: pi / 4.
    let disk = cube(|[x, y]| if x * x + y * y < 1.0 { 1.0_f64 } else { 0.0 });

    let average = Average::new(Plastic::new(1), 100_000).estimate(&disk)?;
    println!("pi by one set           {:.6}", 4.0 * average.mean);

    let replicated = Replicated::new(16, 6250, Plastic::new).estimate(&disk)?;
    let error = replicated.std_error.expect("replicates have a spread");
    println!(
        "pi by 16 replicates     {:.6} +- {:.6}",
        4.0 * replicated.mean,
        4.0 * error
    );

    let roulette = Roulette::new(&disk, 0.5)?;
    let survivors = Replicated::new(16, 6250, Plastic::new).estimate(&roulette)?;
    let error = survivors.std_error.expect("replicates have a spread");
    println!(
        "pi, half the points     {:.6} +- {:.6}",
        4.0 * survivors.mean,
        4.0 * error
    );
    Ok(())
}
