//! Room for coordinates that are computed ahead.

use core::cell::Cell;

thread_local! {
    /// The room, kept for the next user on the thread, as large as the largest one needed it: a pixel of few samples would spend more time on
    /// making it than on using it. An integrand that runs an estimator of its own finds it taken, and makes another.
    static ROOM: Cell<Vec<f64>> = const { Cell::new(Vec::new()) };
}

/// Runs `job` with room for `length` coordinates, which hold anything.
pub(crate) fn with_room<R>(length: usize, job: impl FnOnce(&mut [f64]) -> R) -> R {
    let mut room = ROOM.take();
    if room.len() < length {
        room.resize(length, 0.0);
    }
    let result = job(&mut room[..length]);
    ROOM.set(room);
    result
}
