//! Jobs on the threads of rayon's current pool.
//!
//! Work and jobs are behind pointers, so that what runs them is compiled once, not for every integrand.

use core::cell::Cell;
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

/// Runs `work` on a thread of the pool, so that the loops in it need not change threads each; here, if there is one thread only.
pub(crate) fn inside(work: &mut (dyn FnMut() + Send)) {
    if number() == 1 {
        return work();
    }
    rayon::scope(|_| work());
}

/// Runs `work` that consists of loops one after the other: the other threads stay awake between them, unless this is itself a part of such
/// work, or a job.
pub(crate) fn several(work: &mut (dyn FnMut() + Send)) {
    inside(&mut || {
        let over = Over::default();
        let occupied = Occupied::at_first();
        if occupied.is_some() && number() > 1 {
            let over = Arc::clone(&over.0);
            // Nobody waits for its end, which may be that of a long job.
            rayon::spawn_broadcast(move |_| stay(&over));
        }
        work();
    });
}

/// Runs what there is to do in the pool until it is `over`, or until there has been nothing for a while. A thread that sleeps takes some 60
/// us to wake, which is as long as much of what one thread does between two loops.
fn stay(over: &AtomicBool) {
    const WHILE: Duration = Duration::from_millis(1);
    // A thread that waits for others, and finds this in the meantime, has better things to do.
    let Some(_occupied) = Occupied::at_first() else {
        return;
    };
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

/// A thread that works on something, until this is dropped.
struct Occupied {
    before: bool,
}

thread_local! {
    static OCCUPIED: Cell<bool> = const { Cell::new(false) };
}

impl Occupied {
    fn new() -> Self {
        Self {
            before: OCCUPIED.replace(true),
        }
    }

    /// Unless it is already.
    fn at_first() -> Option<Self> {
        (!OCCUPIED.get()).then(Self::new)
    }
}

impl Drop for Occupied {
    fn drop(&mut self) {
        OCCUPIED.set(self.before);
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
    rayon::scope(|_| {
        // The thread that waits for the others, which may not be this one.
        let _occupied = Occupied::new();
        take_here(jobs, job, take);
    });
}

fn take_here<T: Send>(
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
        let _occupied = Occupied::new();
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
    use std::sync::atomic::AtomicU64;

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

    #[test]
    fn threads_know_what_they_are_at() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let pool = pool.unwrap();
        let total = AtomicU64::new(0);
        let work = || {
            several(&mut || {
                assert!(OCCUPIED.get());
                for _ in 0..2 {
                    take_in_order(0..200, &|job| (OCCUPIED.get(), job), &mut |(busy, job)| {
                        assert!(busy && OCCUPIED.get());
                        total.fetch_add(job, Ordering::Relaxed);
                        true
                    });
                }
            });
        };
        pool.install(|| take_in_order(0..20, &|_| work(), &mut |()| true));
        pool.install(work);
        assert_eq!(total.into_inner(), 21 * 2 * 199 * 100);
        assert_eq!(pool.broadcast(|_| OCCUPIED.get()), [false; 3]);
    }

    #[test]
    fn work_that_panics_is_over() {
        let over = Over::default();
        let told = Arc::clone(&over.0);
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let _over = over;
            panic!("as it should")
        }));
        assert!(outcome.is_err() && told.load(Ordering::Relaxed));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
        pool.unwrap().install(|| {
            let outcome = catch_unwind(|| several(&mut || panic!("as it should")));
            assert!(outcome.is_err() && !OCCUPIED.get());
        });
    }
}
