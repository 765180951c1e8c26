//! The only parallel loop: jobs are fixed by the count alone and their results taken in the order of
//! their indices, so that neither the number of threads nor the feature `parallel` changes a bit.

use core::ops::Range;
#[cfg(feature = "parallel")]
use std::sync::Mutex;

/// Jobs whose results are held at once: few at first, so that a run that has to stop early does so; then more,
/// enough to keep any machine busy and few enough to bound the memory.
const FIRST_WAVE: u64 = 16;
const LARGEST_WAVE: u64 = 1024;

/// Runs `job` for `0..count` and hands the results to `take` in the order of their indices.
///
/// Stops at the first `Err` that `take` returns; jobs past it may have run, their results are dropped.
pub(crate) fn in_order<T: Send, E: Send>(
    count: u64,
    job: impl Fn(u64) -> T + Sync,
    mut take: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    // One after the other each is taken at once, with what it holds in the nearest caches.
    if count == 1 || threads() == 1 {
        return (0..count).try_for_each(|index| take(job(index)));
    }
    let mut outcome = Ok(());
    inside(&mut || {
        let (mut first, mut length) = (0, FIRST_WAVE);
        while first < count && outcome.is_ok() {
            let last = count.min(first.saturating_add(length));
            outcome = wave(first..last, &job).into_iter().try_for_each(&mut take);
            first = last;
            length = LARGEST_WAVE.min(2 * length);
        }
    });
    outcome
}

/// The values of `job` at `0..count`, in order: many estimates side by side, as the pixels of an image
/// are. Runs on all threads of rayon's current pool with the feature `parallel`, with the same result
/// as without.
///
/// ```
/// use estimand::{Estimator, MonteCarlo, cube, each};
///
/// let means: Vec<f64> = each(4, |k| {
///     let power = cube(move |[x]| x.powi(k as i32));
///     MonteCarlo::new(10_000, k).estimate(&power).unwrap().mean
/// });
/// assert!((means[3] - 0.25).abs() < 0.02);
/// ```
///
/// # Panics
///
/// If `count` values do not fit into memory, of which each takes up to 24 bytes more while they are computed.
pub fn each<T: Send>(count: u64, job: impl Fn(u64) -> T + Sync) -> Vec<T> {
    wave(0..count, &job)
}

// Work and jobs are behind pointers, so that what runs them is compiled once, not for every integrand.

/// How many jobs can run at a time.
fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Runs `work` on a thread of rayon's current pool, so that its waves need not change threads each.
#[cfg(feature = "parallel")]
fn inside(work: &mut (dyn FnMut() + Send)) {
    rayon::scope(|_| work());
}

#[cfg(not(feature = "parallel"))]
fn inside(work: &mut (dyn FnMut() + Send)) {
    work();
}

/// The values of `job`, in order. Each is put into a place of its own, so that only what fills the places is compiled
/// for a type of values.
#[cfg(feature = "parallel")]
fn wave<T: Send>(jobs: Range<u64>, job: &(dyn Fn(u64) -> T + Sync)) -> Vec<T> {
    if threads() == 1 {
        return jobs.map(job).collect();
    }
    let length = usize::try_from(jobs.end - jobs.start).expect("results that memory can hold");
    let places: Vec<Mutex<Option<T>>> = (0..length).map(|_| Mutex::new(None)).collect();
    at_all(length, &|place| {
        let value = job(jobs.start + place as u64);
        *places[place].lock().expect("nobody panics with it") = Some(value);
    });
    let values = places
        .into_iter()
        .map(|place| place.into_inner().expect("nobody panics with it"));
    values
        .map(|value| value.expect("every job has run"))
        .collect()
}

#[cfg(feature = "parallel")]
fn at_all(length: usize, job: &(dyn Fn(usize) + Sync)) {
    use rayon::iter::{IntoParallelIterator, ParallelIterator};
    (0..length).into_par_iter().for_each(job);
}

#[cfg(not(feature = "parallel"))]
fn wave<T: Send>(jobs: Range<u64>, job: &(dyn Fn(u64) -> T + Sync)) -> Vec<T> {
    jobs.map(job).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_arrive_in_order_and_stop_at_the_first_error() {
        let mut seen = Vec::new();
        let stopped = in_order(
            5000,
            |index| index,
            |index| {
                if index == 3000 {
                    return Err(index);
                }
                seen.push(index);
                Ok(())
            },
        );
        assert_eq!(stopped, Err(3000));
        assert!(seen.into_iter().eq(0..3000));
    }

    #[test]
    fn nothing_to_do_is_done() {
        assert_eq!(in_order(0, |_| (), |()| Err(())), Ok(()));
        assert!(each(0, |index| index).is_empty());
    }
}
