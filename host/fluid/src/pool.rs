//! A persistent pool of threads that works plane by plane.
//!
//! Planes are dealt out in contiguous ranges that depend on nothing but their number and the
//! number of threads, and what is summed over them is added in their order: the bits of a
//! result are the same for any number of threads.
//!
//! A waiting thread spins for some tens of microseconds and then parks. Spinning spans the
//! gap between two phases of a step; parking gives the core away between two steps.

use std::{
    any::Any,
    array,
    cell::UnsafeCell,
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    ptr,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicPtr, AtomicU64, AtomicUsize, Ordering},
    },
    thread::{self, JoinHandle, Thread},
};

/// What one plane contributes to a [`Pool::fold`].
pub type Partial = [f64; 4];

/// Spins before a waiting thread parks: at 40 to 140 ns each, 20 to 60 us.
const SPINS: u32 = 500;

/// Whose turn it is in a [`Pool::fold_with`].
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// The plane.
    pub k: usize,
    /// True if the thread has not had the plane before it.
    pub is_first: bool,
}

/// More planes than this are computed by the caller alone, as there is no room for partials.
const MAX_PLANES: usize = 4096;

/// Less work than this many values is not worth waking anybody for.
const MIN_SHARED_VALUES: usize = 4096;

/// A pool of `threads` threads, of which the caller is the first.
///
/// Calls from several threads at once, and from inside a body, are allowed: whoever finds the
/// pool taken does all its planes itself.
pub struct Pool {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
}

struct Shared {
    threads: usize,
    /// Held by the caller whose job is being worked on.
    taken: AtomicBool,
    /// Raised by one for each job, after `job` has been set.
    epoch: AtomicU64,
    job: AtomicPtr<Job<'static>>,
    quit: AtomicBool,
    cells_done: Box<[AtomicU64]>,
    partials: Box<[PartialSlot]>,
}

/// Lives on the caller's stack until every worker has finished its part.
struct Job<'a> {
    part: &'a (dyn Fn(usize) + Sync),
    caller: Thread,
    unfinished: AtomicUsize,
    panic: Mutex<Option<Box<dyn Any + Send>>>,
}

struct PartialSlot(UnsafeCell<Partial>);

#[allow(unsafe_code, reason = "slots are shared between threads by plane")]
// SAFETY: slot k is written by the one thread that works on plane k, and read by the caller
// after all threads have finished (see `Pool::fold`).
unsafe impl Sync for PartialSlot {}

/// Planes of `M` arrays as raw parts, to be dealt out to threads.
struct Planes<const M: usize> {
    start: [*mut f32; M],
    plane_len: [usize; M],
}

#[allow(unsafe_code, reason = "planes of one array are written by several threads")]
// SAFETY: a plane is only made into a slice by the one thread that owns its index.
unsafe impl<const M: usize> Sync for Planes<M> {}

impl<const M: usize> Planes<M> {
    #[allow(unsafe_code, reason = "planes of one array are written by several threads")]
    #[allow(clippy::mut_from_ref, reason = "each index is handed to one thread, once a job")]
    /// # Safety
    /// `k` is below the number of planes in every array, and no other slice of plane `k` lives.
    unsafe fn plane(&self, k: usize) -> [&mut [f32]; M] {
        array::from_fn(|m| {
            let len = self.plane_len[m];
            // SAFETY: in bounds and unaliased, as the caller promises.
            unsafe { std::slice::from_raw_parts_mut(self.start[m].add(k * len), len) }
        })
    }
}

/// The values at the same place of every plane of an array: see [`Pool::columns`].
pub struct Column<'a> {
    all: &'a Planes<1>,
    planes: usize,
    first: usize,
    width: usize,
}

impl Column<'_> {
    /// Number of planes.
    #[must_use]
    #[inline(always)]
    pub fn planes(&self) -> usize {
        self.planes
    }

    /// The column's values in plane `k`.
    #[inline(always)]
    pub fn plane(&mut self, k: usize) -> &mut [f32] {
        assert!(k < self.planes, "plane {k} of {}", self.planes);
        #[allow(unsafe_code, reason = "columns are slices of raw parts")]
        // SAFETY: plane k is within the array and the column within the plane (`columns` makes
        // plane_len / width of them); no other column has its values, and `self` is borrowed.
        unsafe {
            let start = self.all.start[0].add(k * self.all.plane_len[0] + self.first);
            std::slice::from_raw_parts_mut(start, self.width)
        }
    }
}

impl Pool {
    /// A pool of `threads` threads (at least 1: the caller). With `pinned`, each started thread
    /// is bound to a core of its own, the second core first: the caller is left where it is, since
    /// threads that it starts later would inherit its core.
    ///
    /// A thread that the system refuses to start is done without.
    #[must_use]
    pub fn new(threads: usize, pinned: bool) -> Self {
        let threads = threads.clamp(1, 256);
        let shared = Arc::new(Shared {
            threads,
            taken: AtomicBool::new(false),
            epoch: AtomicU64::new(0),
            job: AtomicPtr::new(ptr::null_mut()),
            quit: AtomicBool::new(false),
            cells_done: (0..threads).map(|_| AtomicU64::new(0)).collect(),
            partials: (0..MAX_PLANES).map(|_| PartialSlot(UnsafeCell::new([0.0; 4]))).collect(),
        });
        let workers: Vec<_> =
            (1..threads).map_while(|index| start_worker(&shared, index, pinned)).collect();
        if workers.len() + 1 < threads {
            drop(Self { shared, workers });
            return Self::new(1, pinned);
        }
        Self { shared, workers }
    }

    /// A pool of the caller alone.
    #[must_use]
    pub fn inline() -> Self {
        Self::new(1, false)
    }

    /// Number of threads, the caller included.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.shared.threads
    }

    /// Values of first arrays (cells, with their padding) that each thread has written so far.
    #[must_use]
    pub fn cells_done(&self) -> Vec<u64> {
        self.shared.cells_done.iter().map(|done| done.load(Ordering::Relaxed)).collect()
    }

    /// Calls `body(k, planes)` for every plane k of the arrays `outs`, array m being cut into
    /// planes of `plane_len[m]` values; a remainder that fills no plane is left alone.
    pub fn planes<const M: usize>(
        &self,
        outs: [&mut [f32]; M],
        plane_len: [usize; M],
        body: impl Fn(usize, [&mut [f32]; M]) + Sync,
    ) {
        let body = |k, planes: [&mut [f32]; M]| {
            body(k, planes);
            [0.0; 4]
        };
        self.fold(None, outs, plane_len, body, |total, _| total);
    }

    /// As [`Pool::planes`], and adds up what `body` returns, in the order of the planes.
    pub fn planes_sum<const M: usize>(
        &self,
        outs: [&mut [f32]; M],
        plane_len: [usize; M],
        body: impl Fn(usize, [&mut [f32]; M]) -> f64 + Sync,
    ) -> f64 {
        let body = |k, planes: [&mut [f32]; M]| [body(k, planes), 0.0, 0.0, 0.0];
        self.fold(None, outs, plane_len, body, |a, b| [a[0] + b[0], 0.0, 0.0, 0.0])[0]
    }

    /// Adds up `body(k)` over `planes` planes, in their order.
    pub fn sum(&self, planes: usize, body: impl Fn(usize) -> f64 + Sync) -> f64 {
        let body = |k, _: [&mut [f32]; 0]| [body(k), 0.0, 0.0, 0.0];
        self.fold(Some(planes), [], [], body, |a, b| [a[0] + b[0], 0.0, 0.0, 0.0])[0]
    }

    /// The largest of 0 and `body(k)` over `planes` planes.
    pub fn max(&self, planes: usize, body: impl Fn(usize) -> f64 + Sync) -> f64 {
        let body = |k, _: [&mut [f32]; 0]| [body(k), 0.0, 0.0, 0.0];
        self.fold(Some(planes), [], [], body, |a, b| [a[0].max(b[0]), 0.0, 0.0, 0.0])[0]
    }

    /// What all the others are made of: `body` on every plane, its results combined from
    /// zeros in the order of the planes. `planes` may lower the number of planes that the
    /// arrays have, and gives it where there is no array.
    pub fn fold<const M: usize>(
        &self,
        planes: Option<usize>,
        outs: [&mut [f32]; M],
        plane_len: [usize; M],
        body: impl Fn(usize, [&mut [f32]; M]) -> Partial + Sync,
        combine: impl Fn(Partial, Partial) -> Partial,
    ) -> Partial {
        let held = (0..M).map(|m| outs[m].len() / plane_len[m].max(1)).min();
        let count = planes.unwrap_or(usize::MAX).min(held.unwrap_or(planes.unwrap_or(0)));
        let outs = Planes { start: outs.map(<[f32]>::as_mut_ptr), plane_len };
        let body = |_, k| {
            #[allow(unsafe_code, reason = "planes are slices of raw parts")]
            // SAFETY: `count` planes fit in every array, and `deal` gives k away once.
            let planes = unsafe { outs.plane(k) };
            body(k, planes)
        };
        self.deal(count, plane_len.first().copied(), body, combine)
    }

    /// As [`Pool::planes`], with work space of a thread's own: an equal share of `scratch`,
    /// whose values are whatever the last plane has left there.
    pub fn planes_with<const M: usize>(
        &self,
        scratch: &mut [f32],
        outs: [&mut [f32]; M],
        plane_len: [usize; M],
        body: impl Fn(usize, [&mut [f32]; M], &mut [f32]) + Sync,
    ) {
        let body = |turn: Turn, planes: [&mut [f32]; M], scratch: &mut [f32]| {
            body(turn.k, planes, scratch);
            [0.0; 4]
        };
        self.fold_with(scratch, outs, plane_len, body, |total, _| total);
    }

    /// As [`Pool::planes_with`], and combines what `body` returns, from zeros in the order of the
    /// planes.
    pub fn fold_with<const M: usize>(
        &self,
        scratch: &mut [f32],
        outs: [&mut [f32]; M],
        plane_len: [usize; M],
        body: impl Fn(Turn, [&mut [f32]; M], &mut [f32]) -> Partial + Sync,
        combine: impl Fn(Partial, Partial) -> Partial,
    ) -> Partial {
        let count = (0..M).map(|m| outs[m].len() / plane_len[m].max(1)).min().unwrap_or(0);
        let outs = Planes { start: outs.map(<[f32]>::as_mut_ptr), plane_len };
        let share = scratch.len() / self.shared.threads;
        let scratch = Planes { start: [scratch.as_mut_ptr()], plane_len: [share] };
        let body = |part, k| {
            #[allow(unsafe_code, reason = "planes are slices of raw parts")]
            // SAFETY: `count` planes fit in every array, and `deal` gives k away once; a part
            // is one thread, which works on one plane at a time, and all shares fit in scratch.
            let (planes, [scratch]) = unsafe { (outs.plane(k), scratch.plane(part)) };
            body(Turn { k, is_first: k == self.part_of(count, part).start }, planes, scratch)
        };
        self.deal(count, plane_len.first().copied(), body, combine)
    }

    /// Cuts all planes of `array` (of `plane_len` values each) across into columns of `width`
    /// values, and calls `body(c, column)` for each; a remainder that fills no column, or no
    /// plane, is left alone.
    pub fn columns(
        &self,
        array: &mut [f32],
        plane_len: usize,
        width: usize,
        body: impl Fn(usize, Column<'_>) + Sync,
    ) {
        let planes = array.len() / plane_len.max(1);
        let all = Planes { start: [array.as_mut_ptr()], plane_len: [plane_len] };
        let body = |_, column| {
            let column = Column { all: &all, planes, first: column * width, width };
            body(column.first / width, column);
            [0.0; 4]
        };
        self.deal(plane_len / width, Some(planes * width), body, |total, _| total);
    }

    /// Calls `body(part, k)` once for each k of `count`, part being the thread; combines what
    /// it returns from zeros in the order of k. `values` is the work in one k, if known.
    fn deal(
        &self,
        count: usize,
        values: Option<usize>,
        body: impl Fn(usize, usize) -> Partial + Sync,
        combine: impl Fn(Partial, Partial) -> Partial,
    ) -> Partial {
        let is_small = count < 2 || values.is_some_and(|v| count * v < MIN_SHARED_VALUES);
        let values = values.unwrap_or(1);
        if self.shared.threads == 1 || is_small || count > MAX_PLANES || !self.take() {
            self.count_cells(0, count * values);
            return (0..count).fold([0.0; 4], |total, k| combine(total, body(0, k)));
        }
        let partials = &self.shared.partials;
        self.run(&|part| {
            let range = self.part_of(count, part);
            self.count_cells(part, range.len() * values);
            for k in range {
                #[allow(unsafe_code, reason = "partials are shared by index")]
                // SAFETY: `count` fits in `partials`; `part_of` gives index k to this part
                // only, and the pool is taken by this job.
                unsafe {
                    *partials[k].0.get() = body(part, k);
                }
            }
        });
        let total = partials[..count].iter().fold([0.0; 4], |total, slot| {
            #[allow(unsafe_code, reason = "partials are read after the job")]
            // SAFETY: every part is finished, and the pool is still taken by this call.
            combine(total, unsafe { *slot.0.get() })
        });
        self.shared.taken.store(false, Ordering::Release);
        total
    }

    fn part_of(&self, count: usize, part: usize) -> Range<usize> {
        let threads = self.shared.threads;
        count * part / threads..count * (part + 1) / threads
    }

    fn count_cells(&self, part: usize, cells: usize) {
        self.shared.cells_done[part].fetch_add(cells as u64, Ordering::Relaxed);
    }

    fn take(&self) -> bool {
        !self.shared.taken.swap(true, Ordering::Acquire)
    }

    /// Runs `part(0)` here and `part(1)`, ... on the workers; returns when all are finished.
    /// A panic of a part is resumed here, after the others have ended.
    fn run(&self, part: &(dyn Fn(usize) + Sync)) {
        let job = Job {
            part,
            caller: thread::current(),
            unfinished: AtomicUsize::new(self.workers.len()),
            panic: Mutex::new(None),
        };
        self.shared.job.store(ptr::from_ref(&job).cast_mut().cast(), Ordering::Relaxed);
        self.shared.epoch.fetch_add(1, Ordering::Release);
        self.workers.iter().for_each(|worker| worker.thread().unpark());
        let own = catch_unwind(AssertUnwindSafe(|| part(0)));
        wait_until(|| job.unfinished.load(Ordering::Acquire) == 0);
        let panic = job.panic.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(panic) = own.err().or(panic) {
            self.shared.taken.store(false, Ordering::Release);
            resume_unwind(panic);
        }
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        self.shared.quit.store(true, Ordering::Relaxed);
        self.shared.epoch.fetch_add(1, Ordering::Release);
        for worker in self.workers.drain(..) {
            worker.thread().unpark();
            let _ = worker.join();
        }
    }
}

fn start_worker(shared: &Arc<Shared>, index: usize, pinned: bool) -> Option<JoinHandle<()>> {
    let shared = Arc::clone(shared);
    let work = move || {
        if pinned {
            pin_to_core(index);
        }
        work_until_quit(&shared, index);
    };
    thread::Builder::new().name(format!("fluid-{index}")).spawn(work).ok()
}

fn pin_to_core(index: usize) {
    let cores = core_affinity::get_core_ids().unwrap_or_default();
    if !cores.is_empty() {
        core_affinity::set_for_current(cores[index % cores.len()]);
    }
}

fn work_until_quit(shared: &Shared, index: usize) {
    let mut seen = 0;
    loop {
        wait_until(|| shared.epoch.load(Ordering::Acquire) != seen);
        seen = shared.epoch.load(Ordering::Acquire);
        if shared.quit.load(Ordering::Relaxed) {
            return;
        }
        #[allow(unsafe_code, reason = "the job is on the caller's stack")]
        // SAFETY: the epoch was raised after the job was stored, and its caller stays in `run`
        // until `unfinished` is 0, which needs this worker.
        let job = unsafe { &*shared.job.load(Ordering::Relaxed) };
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| (job.part)(index))) {
            *job.panic.lock().unwrap_or_else(PoisonError::into_inner) = Some(panic);
        }
        // The job may be gone as soon as it is counted down: keep the caller's handle.
        let caller = job.caller.clone();
        if job.unfinished.fetch_sub(1, Ordering::AcqRel) == 1 {
            caller.unpark();
        }
    }
}

/// Spins, then parks. Whoever makes `ready` true unparks this thread afterwards.
fn wait_until(ready: impl Fn() -> bool) {
    for _ in 0..SPINS {
        if ready() {
            return;
        }
        std::hint::spin_loop();
    }
    while !ready() {
        thread::park();
    }
}

#[cfg(test)]
mod tests;
