//! An integral in five lines.
//!
//! The mean over the unit square of exp(x y), whose exact value is the sum over k of 1 / (k! (k + 1)^2).

use estimand::{Error, Estimator, MonteCarlo, cube};

fn main() -> Result<(), Error> {
    let f = cube(|[x, y]| (x * y).exp());
    let estimate = MonteCarlo::new(1 << 20, 1).estimate(&f)?;
    let error = estimate
        .std_error
        .expect("many independent points have a sample variance");
    println!("estimate  {:.9} +- {error:.9}", estimate.mean);
    println!("exact     1.317902151");
    Ok(())
}
