//! Your own integrand on a page of its own: error against run time, method by method.

use estimand::convergence::{Study, Truth};
use estimand::points::{HashedOwen, Sobol, Stratified};
use estimand::report::Page;
use estimand::{Average, Estimator, MonteCarlo, Replicated, cube};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The integrand: here the mean distance of two points of the unit square.
    let f = cube(|[a, b, c, d]: [f64; 4]| (a - c).hypot(b - d));
    let sobol = Sobol::new(4)?;
    let scrambled = |seed| sobol.clone().scrambled(HashedOwen { seed });

    // Its integral: exact if it is known, or else a much longer run that knows its own error.
    let long = Replicated::new(32, 1 << 16, scrambled).estimate(&f)?;
    let truth = Truth::of(&long)?;

    let found = Study::new((3..13).map(|k| 1 << k), 16)?
        .integral(&f, truth)
        .method("plain Monte Carlo", MonteCarlo::new)
        .method("stratified", |count, seed| {
            Average::new(
                Stratified::new(count, 4, seed).expect("a positive count"),
                count,
            )
        })
        .method("Sobol', scrambled", |count, seed| {
            Average::new(scrambled(seed), count)
        })
        .method("16 x Sobol'", |count, seed| {
            Replicated::new(16, count.div_ceil(16), scrambled).seed(seed)
        })
        .run()?;

    let mut page = Page::new("The mean distance of two points of a square");
    page.study("Error against run time", &found);
    println!("{}", page.write("out/own_study")?.display());
    Ok(found.write_csv("out/own_study/study.csv")?)
}
