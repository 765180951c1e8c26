//! Jobs on the threads of rayon's current pool.
//!
//! Work and jobs are behind pointers, so that what runs them is compiled once, not for every integrand.

use core::ops::Range;
use std::sync::{
    Mutex, MutexGuard,
    atomic::{AtomicUsize, Ordering},
};

/// How many jobs can run at a time.
pub(super) fn number() -> usize {
    rayon::current_num_threads()
}

/// Runs `work` on a thread of the pool, so that the loops in it need not change threads each.
pub(crate) fn inside(work: &mut (dyn FnMut() + Send)) {
    rayon::scope(|_| work());
}

/// The values of two jobs that know nothing of each other: while one has nothing to share out, there is the other.
pub(crate) fn both<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(one, other)
}

/// Hands the values of `job` to `take`, in order, until it returns `false`.
///
/// This thread takes what is ready and runs jobs between, the others run jobs: nobody waits for anybody before the jobs
/// run out.
pub(super) fn take_in_order<T: Send>(
    jobs: Range<u64>,
    job: &(dyn Fn(u64) -> T + Sync),
    take: &mut (dyn FnMut(T) -> bool + Send),
) {
    let length = usize::try_from(jobs.end - jobs.start).expect("results that memory can hold");
    let places: Vec<Mutex<Option<T>>> = (0..length).map(|_| Mutex::new(None)).collect();
    // Jobs go by a counter, not by parts of the range: values come nearly in order, so that few are held.
    let next = AtomicUsize::new(0);
    let run_one = || {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let Some(place) = places.get(number) else {
            return false;
        };
        let value = job(jobs.start + number as u64);
        *open(place) = Some(value);
        true
    };
    let mut waiting = places.iter().peekable();
    let mut wanted = true;
    let mut take_ready = || {
        while wanted && let Some(value) = waiting.peek().and_then(|place| open(place).take()) {
            waiting.next();
            wanted = take(value);
        }
        wanted
    };
    let helpers = number().min(length) - 1;
    beside(helpers, &|| while run_one() {}, &mut || {
        while take_ready() && run_one() {}
        // Nobody begins another one, if there is any left.
        next.store(length, Ordering::Relaxed);
    });
    take_ready();
}

fn open<T>(place: &Mutex<T>) -> MutexGuard<'_, T> {
    place.lock().expect("nobody panics with it")
}

/// Runs `work` here while up to so many other threads run `help`; waits for them.
fn beside(helpers: usize, help: &(dyn Fn() + Sync), work: &mut (dyn FnMut() + Send)) {
    rayon::scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|_| help());
        }
        work();
    });
}
