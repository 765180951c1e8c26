//! Jobs on the threads of rayon's current pool.
//!
//! Work and jobs are behind pointers, so that what runs them is compiled once, not for every integrand.

use core::ops::Range;
use core::time::Duration;
use std::sync::{
    Arc, Mutex, MutexGuard,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};
use std::time::Instant;

/// How many jobs can run at a time.
pub(crate) fn number() -> usize {
    rayon::current_num_threads()
}

/// Runs `work` on a thread of the pool, so that the loops in it need not change threads each; here, if there is one thread only. The
/// other threads stay awake between the loops.
pub(crate) fn inside(work: &mut (dyn FnMut() + Send)) {
    if number() == 1 {
        return work();
    }
    rayon::scope(|_| {
        let over = Over::default();
        for _ in 1..number() {
            let over = Arc::clone(&over.0);
            // Nobody waits for its end, which may be that of a long job.
            rayon::spawn(move || stay(&over));
        }
        work();
    });
}

/// Runs what there is to do in the pool until it is `over`, or until there has been nothing for a while. A thread that sleeps takes some 60
/// us to wake, which is as long as much of what one thread does between two loops.
fn stay(over: &AtomicBool) {
    const WHILE: Duration = Duration::from_millis(1);
    let mut idle = Instant::now();
    while !over.load(Ordering::Relaxed) && idle.elapsed() < WHILE {
        match rayon::yield_now() {
            Some(rayon::Yield::Executed) => idle = Instant::now(),
            // Other programs may have something to do.
            _ => std::thread::yield_now(),
        }
    }
}

/// Says that something is over when it is dropped, by a panic too.
#[derive(Default)]
struct Over(Arc<AtomicBool>);

impl Drop for Over {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
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
/// This thread takes what is ready and runs jobs between, the others run jobs: nobody waits for anybody before these
/// run out. If any of them panics no more are begun.
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
        let last = OnPanic(&next, length);
        let value = job(jobs.start + number as u64);
        *open(place) = Some(value);
        core::mem::forget(last);
        true
    };
    let mut waiting = places.iter().peekable();
    let mut wanted = true;
    let mut take_ready = || {
        let last = OnPanic(&next, length);
        while wanted && let Some(value) = waiting.peek().and_then(|place| open(place).take()) {
            waiting.next();
            wanted = take(value);
        }
        core::mem::forget(last);
        wanted
    };
    let helpers = number().min(length) - 1;
    rayon::scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|scope| help(scope, &run_one));
        }
        while take_ready() && run_one() {}
        // Nobody begins another one, if there is any left.
        next.store(length, Ordering::Relaxed);
    });
    take_ready();
}

/// Runs one job, and has the next one run by whoever is free: a thread that waits for others, and helps here in the meantime, is
/// not kept for longer than a job.
fn help<'a>(scope: &rayon::Scope<'a>, run_one: &'a (dyn Fn() -> bool + Sync)) {
    if run_one() {
        scope.spawn(move |scope| help(scope, run_one));
    }
}

/// Sets the number of the next job to one past the last, if it is dropped: by a panic.
struct OnPanic<'a>(&'a AtomicUsize, usize);

impl Drop for OnPanic<'_> {
    fn drop(&mut self) {
        self.0.store(self.1, Ordering::Relaxed);
    }
}

fn open<T>(place: &Mutex<T>) -> MutexGuard<'_, T> {
    place.lock().expect("nobody panics with it")
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;

    #[test]
    fn after_a_panic_no_job_is_begun() {
        for who in [0, 7] {
            let run = AtomicUsize::new(0);
            let all = catch_unwind(AssertUnwindSafe(|| {
                let job = |index| {
                    run.fetch_add(1, Ordering::Relaxed);
                    // The others wait, so that they have hardly begun.
                    std::thread::sleep(core::time::Duration::from_millis(1));
                    assert!(index != who, "as it should");
                };
                take_in_order(0..2000, &job, &mut |()| true);
            }));
            let run = run.into_inner();
            assert!(all.is_err() && run < 1000, "{run} jobs");
        }
        let run = AtomicUsize::new(0);
        let all = catch_unwind(AssertUnwindSafe(|| {
            let job = |_| {
                run.fetch_add(1, Ordering::Relaxed);
                std::thread::sleep(core::time::Duration::from_millis(1));
            };
            take_in_order(0..2000, &job, &mut |()| panic!("as it should"));
        }));
        let run = run.into_inner();
        assert!(all.is_err() && run < 1000, "{run} jobs");
    }
}
