//! The pair sum of the L2 star discrepancy by divide and conquer, in `O(n log^(d-1) n)`.

use super::compensated::Compensated;
use crate::discrepancy::Points;
use crate::reduce;

/// Points below which all pairs are taken one by one.
const FEW: usize = 48;
/// How often the points are halved before the parts become jobs.
const HALVINGS: u32 = 3;
/// How often a pair of lists is halved before the parts become jobs.
const PAIR_HALVINGS: u32 = 2;

/// Whether dividing beats taking all pairs: by the counts of operations, with constants as measured.
pub(super) fn pays(count: usize, dimensions: usize) -> bool {
    let levels = f64::from((count / FEW + 1).ilog2() + 1);
    let mut lists = 1.0;
    for level in 1..dimensions {
        lists *= (levels + level as f64) / level as f64;
    }
    count > 1000 && count as f64 * dimensions as f64 > 400.0 * lists
}

/// The sum over all ordered pairs of points of the product over the dimensions of `1 - max(x, y)`.[^heinrich]
///
/// With `u = 1 - x` the factor is `min(u, v)`. Halve the points along the last dimension: for a pair from both halves the
/// lesser of the two is known, and becomes a weight; so what is left has a dimension less. In one dimension
/// sorted lists and running sums do.
///
/// [^heinrich]: Heinrich, Stefan (1996). *Efficient Algorithms for Computing the L2-Discrepancy*. Mathematics of
///     Computation 65(216), 1621-1633.
pub(super) fn sum(points: &Points<'_>) -> Compensated {
    let mut parts = vec![List::new(points)];
    let mut total = Compensated::ZERO;
    let mut halvings = 0;
    while halvings < HALVINGS && parts[0].dimensions > 1 && parts[0].len() > 64 * FEW {
        let mut halves = Vec::with_capacity(2 * parts.len());
        for part in parts {
            match part.halve() {
                Halves::Equal(_) => halves.push(part),
                Halves::Two(low, high) => {
                    let pair = (low.lowered(), high.without_last());
                    across(pair, PAIR_HALVINGS, &mut total);
                    halves.extend([low, high]);
                }
            }
        }
        parts = halves;
        halvings += 1;
    }
    in_order(parts.len(), &mut total, |job, sum| {
        within(&parts[job], 1.0, sum);
    });
    total
}

/// Adds the results of jobs, in their order.
fn in_order(jobs: usize, total: &mut Compensated, job: impl Fn(usize, &mut Compensated) + Sync) {
    let taken: Result<(), core::convert::Infallible> = reduce::in_order(
        jobs as u64,
        |index| {
            let mut sum = Compensated::ZERO;
            job(
                usize::try_from(index).expect("a job is in memory"),
                &mut sum,
            );
            sum
        },
        |sum| {
            total.merge(sum);
            Ok(())
        },
    );
    let Ok(()) = taken;
}

/// Adds twice the sum over the pairs of a point of the one list with one of the other, in jobs.
fn across(pair: (List, List), halvings: u32, total: &mut Compensated) {
    let mut pairs = vec![pair];
    for _ in 0..halvings {
        pairs = pairs
            .into_iter()
            .flat_map(|(a, b)| quarters(&a, &b).unwrap_or_else(|| vec![(a, b)]))
            .collect();
    }
    in_order(pairs.len(), total, |job, sum| {
        between(&pairs[job].0, &pairs[job].1, 2.0, sum);
    });
}

/// The sum over all ordered pairs from one list, times `factor`.
fn within(list: &List, factor: f64, sum: &mut Compensated) {
    if list.dimensions == 1 {
        let (mut below, mut term) = (Compensated::ZERO, Compensated::ZERO);
        for (&u, &weight) in list.last().iter().zip(list.weights()) {
            term.add(weight * (2.0 * below.value() + weight * u));
            below.add(weight * u);
        }
        sum.merge(term.times(factor));
        return;
    }
    if list.len() <= FEW {
        one_by_one(list, list, factor, sum);
        return;
    }
    match list.halve() {
        Halves::Equal(u) => within(&list.without_last(), u * factor, sum),
        Halves::Two(low, high) => {
            between(&low.lowered(), &high.without_last(), 2.0 * factor, sum);
            within(&low, factor, sum);
            within(&high, factor, sum);
        }
    }
}

/// The sum over the pairs of a point of `a` with one of `b`, times `factor`.
fn between(a: &List, b: &List, factor: f64, sum: &mut Compensated) {
    if a.len() == 0 || b.len() == 0 {
        return;
    }
    if a.dimensions == 0 {
        sum.merge(a.weight().times(b.weight().value()).times(factor));
        return;
    }
    if a.dimensions == 1 {
        merge(a, b, factor, sum);
        return;
    }
    if a.len().min(b.len()) <= FEW / 4 || a.len().max(b.len()) <= FEW {
        one_by_one(a, b, factor, sum);
        return;
    }
    match quarters(a, b) {
        Some(quarters) => {
            for (a, b) in &quarters {
                between(a, b, factor, sum);
            }
        }
        None => {
            let u = a.last()[0];
            between(&a.without_last(), &b.without_last(), u * factor, sum);
        }
    }
}

/// Two lists of one dimension, both in order: a running sum over the one while passing along the other.
fn merge(a: &List, b: &List, factor: f64, sum: &mut Compensated) {
    let mut others = b.last().iter().zip(b.weights()).peekable();
    let (mut below, mut above) = (Compensated::ZERO, b.weight());
    let mut term = Compensated::ZERO;
    for (&u, &weight) in a.last().iter().zip(a.weights()) {
        while let Some((&v, &other)) = others.next_if(|&(&v, _)| v < u) {
            below.add(other * v);
            above.add(-other);
        }
        term.add(weight * (below.value() + u * above.value()));
    }
    sum.merge(term.times(factor));
}

fn one_by_one(a: &List, b: &List, factor: f64, sum: &mut Compensated) {
    let mut term = 0.0;
    let mut products = [0.0; FEW];
    for i in 0..a.len() {
        for (first, weights) in (0..).step_by(FEW).zip(b.weights().chunks(FEW)) {
            let products = &mut products[..weights.len()];
            products.copy_from_slice(weights);
            for dimension in 0..a.dimensions {
                let u = a.column(dimension)[i];
                let column = &b.column(dimension)[first..][..weights.len()];
                for (product, &v) in products.iter_mut().zip(column) {
                    *product *= if u < v { u } else { v };
                }
            }
            let inner: f64 = products.iter().sum();
            term += a.weights()[i] * inner;
        }
    }
    sum.add(term * factor);
}

/// The pairs of halves of two lists, halved at one value along the last dimension; `None` if all values are equal.
fn quarters(a: &List, b: &List) -> Option<Vec<(List, List)>> {
    if a.dimensions < 2 {
        return None;
    }
    let at = split(&[a.last(), b.last()])?;
    let ((a_low, a_high), (b_low, b_high)) = (a.cut(at), b.cut(at));
    let mixed = (a_low.lowered(), b_high.without_last());
    let mixed_too = (a_high.without_last(), b_low.lowered());
    Some(vec![(a_low, b_low), (a_high, b_high), mixed, mixed_too])
}

/// A value above some and not above others of the numbers in two lists, near their median; `None` if all are equal.
fn split(lists: &[&[f64]]) -> Option<f64> {
    const SAMPLE: usize = 31;
    let count: usize = lists.iter().map(|list| list.len()).sum();
    let step = count.div_ceil(SAMPLE).max(1);
    let all = || lists.iter().copied().flatten();
    let mut sample: Vec<f64> = all().step_by(step).copied().collect();
    let middle = sample.len() / 2;
    let (_, &mut at, _) = sample.select_nth_unstable_by(middle, f64::total_cmp);
    if all().any(|&u| u < at) {
        return Some(at);
    }
    // The sample's median is the least of all: the next larger value splits, if there is one.
    all().copied().filter(|&u| u > at).reduce(f64::min)
}

/// Weighted points, in the order of their first coordinates. A column for the weights, then one for each dimension.
struct List {
    columns: Vec<f64>,
    dimensions: usize,
    len: usize,
}

/// A list, halved along its last dimension.
enum Halves {
    /// All coordinates are this one.
    Equal(f64),
    /// Those below a value, and the others.
    Two(List, List),
}

impl List {
    fn new(points: &Points<'_>) -> Self {
        let mut rows: Vec<&[f64]> = points.rows().collect();
        rows.sort_by(|a, b| b[0].total_cmp(&a[0]));
        let weights = core::iter::repeat_n(1.0, rows.len());
        let columns = (0..points.dimensions())
            .flat_map(|dimension| rows.iter().map(move |row| 1.0 - row[dimension]));
        Self {
            columns: weights.chain(columns).collect(),
            dimensions: points.dimensions(),
            len: points.count(),
        }
    }

    fn len(&self) -> usize {
        self.len
    }

    fn weights(&self) -> &[f64] {
        &self.columns[..self.len]
    }

    fn column(&self, dimension: usize) -> &[f64] {
        &self.columns[(dimension + 1) * self.len..][..self.len]
    }

    fn last(&self) -> &[f64] {
        self.column(self.dimensions - 1)
    }

    /// The sum of all weights.
    fn weight(&self) -> Compensated {
        let mut sum = Compensated::ZERO;
        self.weights().iter().for_each(|&weight| sum.add(weight));
        sum
    }

    /// The list without its last dimension.
    fn without_last(&self) -> Self {
        Self {
            columns: self.columns[..self.dimensions * self.len].to_vec(),
            dimensions: self.dimensions - 1,
            len: self.len,
        }
    }

    /// The same, with the coordinate in the last dimension in the weight.
    fn lowered(&self) -> Self {
        let mut lowered = self.without_last();
        for (weight, u) in lowered.columns.iter_mut().zip(self.last()) {
            *weight *= u;
        }
        lowered
    }

    fn halve(&self) -> Halves {
        match split(&[self.last()]) {
            Some(at) => {
                let (low, high) = self.cut(at);
                Halves::Two(low, high)
            }
            None => Halves::Equal(self.last()[0]),
        }
    }

    /// The points below a value along the last dimension, and the others.
    fn cut(&self, at: f64) -> (Self, Self) {
        let low = self.last().iter().filter(|&&u| u < at).count();
        let empty = |len: usize| Self {
            columns: vec![0.0; len * (self.dimensions + 1)],
            dimensions: self.dimensions,
            len,
        };
        let (mut below, mut above) = (empty(low), empty(self.len - low));
        for (number, column) in self.columns.chunks_exact(self.len.max(1)).enumerate() {
            let mut low = number * below.len;
            let mut high = number * above.len;
            for (&value, &u) in column.iter().zip(self.last()) {
                if u < at {
                    below.columns[low] = value;
                    low += 1;
                } else {
                    above.columns[high] = value;
                    high += 1;
                }
            }
        }
        (below, above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrepancy::l2::kernel::Star;
    use crate::discrepancy::l2::pairs::Tiles;
    use crate::points::{Independent, PointSet};

    #[test]
    fn dividing_and_taking_all_pairs_give_the_same_sum() {
        for dimensions in 1..6_u32 {
            for count in [1, 2, FEW, FEW + 1, 700, 64 * FEW + 1, 5000] {
                let mut rows = vec![0.0; count * dimensions as usize];
                Independent::new(count as u64).fill(0, 0..dimensions, &mut rows);
                // Half of the cases with many equal coordinates, some of them 0 and 1.
                if count % 2 == 1 {
                    rows.iter_mut().for_each(|x| *x = (*x * 4.0).round() / 4.0);
                }
                let points = Points::from_rows(&rows, dimensions as usize).unwrap();
                let divided = sum(&points).value();
                let paired = Tiles::new::<Star>(&points)
                    .sum::<Star>(|_, pair| pair)
                    .value();
                // Both are 0 if all points have a coordinate 1.
                let off = (divided - paired).abs();
                assert!(
                    off <= 1e-15 * paired,
                    "{count} in {dimensions}: {divided} {paired}"
                );
            }
        }
    }
}
