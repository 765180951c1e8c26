//! Error bars by replicates: the same integral with the same number of evaluations, by points of several kinds.
//!
//! Each method makes 16 independent randomisations; the error bar is the spread of their means, and the
//! exact value tells whether it spoke the truth.

use estimand::points::{Independent, NRooks, Owen, PointSet, Sobol, Stratified};
use estimand::{Error, Estimator, Replicated, cube};

const REPLICATES: u64 = 16;
const COUNT: u64 = 1 << 12;

fn main() -> Result<(), Error> {
    println!("{REPLICATES} x {COUNT} evaluations of exp(x y)\n");
    println!(
        "{:12} {:>13} {:>11} {:>11}",
        "points", "mean", "error bar", "true error"
    );
    row("independent", Independent::new)?;
    row("n-rooks", |seed| {
        NRooks::new(COUNT, seed).expect("a positive count")
    })?;
    row("stratified", |seed| {
        Stratified::new(COUNT, 2, seed).expect("a positive count")
    })?;
    let sobol = Sobol::new(2)?;
    row("sobol", |seed| sobol.clone().scrambled(Owen { seed }))
}

/// Prints one method's estimate beside the truth.
fn row<P: PointSet>(name: &str, points: impl Fn(u64) -> P) -> Result<(), Error> {
    /// The sum over k of 1 / (k! (k + 1)^2).
    const EXACT: f64 = 1.317_902_151_454_404;
    let f = cube(|[x, y]| (x * y).exp());
    let estimate = Replicated::new(REPLICATES, COUNT, points).estimate(&f)?;
    let error = estimate.std_error.expect("replicates have a spread");
    println!(
        "{name:12} {:13.10} {error:11.2e} {:11.2e}",
        estimate.mean,
        (estimate.mean - EXACT).abs()
    );
    Ok(())
}
