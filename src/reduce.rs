//! The only parallel loop: jobs are fixed by the count alone and their results taken in the order of
//! their indices, so that neither the number of threads nor the feature `parallel` changes a bit.

#[cfg(feature = "parallel")]
mod threads;
#[cfg(feature = "parallel")]
use threads::inside;
#[cfg(feature = "parallel")]
use threads::take_in_order;
#[cfg(feature = "parallel")]
pub(crate) use threads::{both, number, several};

/// Runs `job` for `0..count` and hands the results to `take` in the order of their indices.
///
/// Stops at the first `Err` that `take` returns; jobs past it may have run, their results are dropped.
pub(crate) fn in_order<T: Send, E: Send>(
    count: u64,
    job: impl Fn(u64) -> T + Sync,
    mut take: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    // One after the other each is taken at once, with what it holds in the nearest caches.
    if count <= 1 || number() == 1 {
        return (0..count).try_for_each(|index| take(job(index)));
    }
    /// Jobs whose results are held at once at most: enough to keep any machine busy, few enough to bound the memory.
    const WAVE: u64 = 1024;
    let mut outcome = Ok(());
    inside(&mut || {
        let mut first = 0;
        while first < count && outcome.is_ok() {
            let last = count.min(first.saturating_add(WAVE));
            take_in_order(first..last, &job, &mut |value| {
                outcome = take(value);
                outcome.is_ok()
            });
            first = last;
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
/// If `count` values do not fit into memory, twice and some 16 bytes more for each while they are computed.
pub fn each<T: Send>(count: u64, job: impl Fn(u64) -> T + Sync) -> Vec<T> {
    if count <= 1 || number() == 1 {
        return (0..count).map(job).collect();
    }
    let length = usize::try_from(count).expect("values that memory can hold");
    let mut values = Vec::with_capacity(length);
    take_in_order(0..count, &job, &mut |value| {
        values.push(value);
        true
    });
    values
}

/// What `job` gives for one block of `items` after the other, in order; it is told which. The blocks are the same for any
/// number of threads, and long enough for work of a few nanoseconds an item.
pub(crate) fn in_blocks<S: Sync, T: Send>(
    items: &[S],
    job: impl Fn(usize, &[S]) -> T + Sync,
) -> Vec<T> {
    const BLOCK: usize = 1024;
    let blocks: Vec<&[S]> = items.chunks(BLOCK).collect();
    at_each(&blocks, |place, block| job(place, block))
}

/// What `job` gives for each of `items`, in order; it is told which.
pub(crate) fn at_each<S: Sync, T: Send>(
    items: &[S],
    job: impl Fn(usize, &S) -> T + Sync,
) -> Vec<T> {
    each(items.len() as u64, |index| {
        let place = usize::try_from(index).expect("below a length");
        job(place, &items[place])
    })
}

// Without threads.

/// How many jobs can run at a time.
#[cfg(not(feature = "parallel"))]
pub(crate) fn number() -> usize {
    1
}

/// Runs `work`.
#[cfg(not(feature = "parallel"))]
fn inside(work: &mut (dyn FnMut() + Send)) {
    work();
}

/// Runs `work` that consists of several loops.
#[cfg(not(feature = "parallel"))]
pub(crate) fn several(work: &mut (dyn FnMut() + Send)) {
    work();
}

/// The values of two jobs.
#[cfg(not(feature = "parallel"))]
pub(crate) fn both<A, B>(one: impl FnOnce() -> A, other: impl FnOnce() -> B) -> (A, B) {
    (one(), other())
}

/// Hands the values of `job` to `take`, in order, until it returns `false`.
#[cfg(not(feature = "parallel"))]
fn take_in_order<T>(
    jobs: core::ops::Range<u64>,
    job: &dyn Fn(u64) -> T,
    take: &mut dyn FnMut(T) -> bool,
) {
    let _ = jobs.map(job).all(take);
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
