//! A crew: the thread that computes a frame, and helpers that it never waits for before they have begun.
//!
//! Frames of some thousand vertices are over before a thread pool has taken them, woken a second thread and then their
//! caller again. Here the caller computes. Helpers are woken once for all of its sweeps, take their part of what is left
//! of the sweep that they come to, and stay awake for the next one.

use std::cell::{RefCell, UnsafeCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::thread::{self, Thread};

use crate::parallel::affinity::Affinity;

/// Of `Crew::door`: whether helpers may come in, and one helper that is in.
const OPEN: usize = 1;
const HELPER: usize = 2;
/// So many times a thread that waits for another only pauses; then it lets others run.
const PAUSES: usize = 256;
/// After so many times a helper without work goes back to sleep.
const PATIENCE: usize = 2048;

/// Called with a number for each thread, that of the caller is 0.
type Task<'a> = dyn Fn(usize) + Sync + 'a;

struct Crew {
    /// How many threads it has, the caller's among them.
    hands: AtomicUsize,
    /// Whether there will be more tasks.
    is_on: AtomicBool,
    /// `OPEN` while there is a task, and `HELPER` for each helper that is at it.
    door: AtomicUsize,
    /// Number of the task.
    turn: AtomicUsize,
    /// Written while the door is closed and nobody is in, read by those who came in through the open door.
    task: UnsafeCell<Option<&'static Task<'static>>>,
    has_panicked: AtomicBool,
}

// SAFETY: `task` is all that is not `Sync` of itself, and `door` keeps its reads apart from its writes.
unsafe impl Sync for Crew {}

thread_local! {
    /// The crew whose sweeps this thread computes.
    static OWN: RefCell<Option<Arc<Crew>>> = const { RefCell::new(None) };
    /// Crews that are not at work, so that a frame allocates none.
    static SPARE: RefCell<Vec<Arc<Crew>>> = const { RefCell::new(Vec::new()) };
}

/// Runs `work`; up to so many helpers, if they are free, take part in what it shares.
pub(crate) fn with_helpers<R>(count: usize, work: impl FnOnce() -> R) -> R {
    let crew = SPARE.with_borrow_mut(Vec::pop).unwrap_or_default();
    crew.is_on.store(true, Ordering::Release);
    crew.hands.store(1 + call_helpers(count, &crew), Ordering::Relaxed);
    let _shift = Shift { outer: OWN.replace(Some(crew)) };
    work()
}

/// Threads that may be at the next task; 1 is the caller alone.
pub(crate) fn hands() -> usize {
    OWN.with_borrow(|own| own.as_ref().map_or(1, |crew| crew.hands.load(Ordering::Relaxed)))
}

/// Runs `task` in this thread, and at the same time in helpers that have time. It must see to it that all is done once the
/// call in this thread is over and those in others are: they may begin late, or never.
pub(crate) fn share(task: &Task<'_>) {
    // Whatever the task shares is shared by crews of its own.
    let Some(crew) = OWN.take() else { return task(0) };
    let back = Back(Some(crew));
    if let Some(crew) = &back.0 {
        crew.run(task);
    }
}

/// Makes a crew the own one again.
struct Back(Option<Arc<Crew>>);

impl Drop for Back {
    fn drop(&mut self) {
        OWN.set(self.0.take());
    }
}

/// Sends the helpers home at its end.
struct Shift {
    outer: Option<Arc<Crew>>,
}

impl Drop for Shift {
    fn drop(&mut self) {
        if let Some(crew) = OWN.replace(self.outer.take()) {
            crew.is_on.store(false, Ordering::Release);
            SPARE.with_borrow_mut(|spare| spare.push(crew));
        }
    }
}

impl Default for Crew {
    fn default() -> Self {
        let (door, turn) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Self {
            hands: AtomicUsize::new(1),
            is_on: AtomicBool::new(false),
            door,
            turn,
            task: UnsafeCell::new(None),
            has_panicked: AtomicBool::new(false),
        }
    }
}

impl Crew {
    fn run(&self, task: &Task<'_>) {
        if self.hands.load(Ordering::Relaxed) == 1 {
            return task(0);
        }
        // SAFETY: the lifetime alone changes, and `Closing` waits until nobody is at the task before it ends.
        let task_for_helpers = unsafe { std::mem::transmute::<&Task<'_>, &'static Task<'static>>(task) };
        // SAFETY: the door is closed, and nobody is in who came through it while it was open.
        unsafe { *self.task.get() = Some(task_for_helpers) };
        self.has_panicked.store(false, Ordering::Relaxed);
        self.turn.fetch_add(1, Ordering::Release);
        self.door.fetch_or(OPEN, Ordering::Release);
        let closing = Closing(self);
        task(0);
        drop(closing);
        assert!(!self.has_panicked.load(Ordering::Relaxed), "a thread of the engine has panicked");
    }

    /// Takes part in tasks until there are no more, or none for long.
    fn help(&self, number: usize) {
        let mut done = self.turn.load(Ordering::Relaxed).wrapping_sub(1);
        let mut waits = 0;
        while self.is_on.load(Ordering::Acquire) && waits < PATIENCE {
            let is_open = self.door.load(Ordering::Relaxed) & OPEN != 0;
            if !is_open || self.turn.load(Ordering::Relaxed) == done {
                wait(&mut waits);
                continue;
            }
            if self.door.fetch_add(HELPER, Ordering::Acquire) & OPEN != 0 {
                done = self.turn.load(Ordering::Relaxed);
                // SAFETY: it was written before the door was opened, and lives as long as somebody is in.
                let task = unsafe { *self.task.get() };
                let outcome = catch_unwind(AssertUnwindSafe(|| task.map(|task| task(number))));
                self.has_panicked.fetch_or(outcome.is_err(), Ordering::Relaxed);
                waits = 0;
            }
            self.door.fetch_sub(HELPER, Ordering::Release);
        }
    }
}

/// Ends a task, also where it panics: closes the door, and waits for those who are in.
struct Closing<'a>(&'a Crew);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.door.fetch_and(!OPEN, Ordering::AcqRel);
        let mut waits = 0;
        while self.0.door.load(Ordering::Acquire) != 0 {
            wait(&mut waits);
        }
    }
}

fn wait(waits: &mut usize) {
    *waits += 1;
    if *waits <= PAUSES {
        std::hint::spin_loop();
    } else {
        thread::yield_now();
    }
}

/// One of the threads of this process that help any crew, one crew at a time.
struct Helper {
    thread: Thread,
    /// Whom it helps; it sleeps while there is nobody.
    crew: Arc<Mutex<Option<Arc<Crew>>>>,
    /// Set once the thread runs, where the system tells.
    affinity: Arc<OnceLock<Affinity>>,
}

/// As many as rayon has threads, less the caller.
static HELPERS: LazyLock<Vec<Helper>> = LazyLock::new(|| (1..rayon::current_num_threads()).map_while(start_helper).collect());

/// None where the system gives no more threads.
fn start_helper(number: usize) -> Option<Helper> {
    let crew = Arc::new(Mutex::new(None::<Arc<Crew>>));
    let own = Arc::clone(&crew);
    let affinity = Arc::new(OnceLock::new());
    let own_affinity = Arc::clone(&affinity);
    let work = move || {
        if let Some(found) = Affinity::own() {
            own_affinity.get_or_init(|| found);
        }
        loop {
            let helped = locked(&own).clone();
            if let Some(crew) = helped {
                crew.help(number);
                *locked(&own) = None;
            } else {
                thread::park();
            }
        }
    };
    let spawned = thread::Builder::new().name(format!("turgor {number}")).spawn(work).ok()?;
    Some(Helper { thread: spawned.thread().clone(), crew, affinity })
}

/// How many of the helpers, at most `count`, are with the crew now.
fn call_helpers(count: usize, crew: &Arc<Crew>) -> usize {
    if count == 0 {
        return 0;
    }
    HELPERS.iter().filter(|helper| helper.comes_to(crew)).take(count).count()
}

impl Helper {
    /// Whether it was free, and comes.
    fn comes_to(&self, crew: &Arc<Crew>) -> bool {
        let mut helped = match self.crew.try_lock() {
            Ok(helped) => helped,
            Err(TryLockError::Poisoned(error)) => error.into_inner(),
            Err(TryLockError::WouldBlock) => return false,
        };
        if let Some(helped) = &*helped {
            // Still there from the sweeps before, or with others.
            return Arc::ptr_eq(helped, crew);
        }
        *helped = Some(Arc::clone(crew));
        drop(helped);
        if let Some(affinity) = self.affinity.get() {
            affinity.avoid_caller();
        }
        self.thread.unpark();
        true
    }
}

/// What a mutex guards, also where a thread has panicked with it.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_comes_all_is_done_once() {
        for round in 0..20_000 {
            let next = AtomicUsize::new(0);
            let done: Vec<AtomicUsize> = (0..round % 40).map(|_| AtomicUsize::new(0)).collect();
            with_helpers(round % 5, || {
                for sweep in 1..4 {
                    next.store(0, Ordering::Relaxed);
                    share(&|_| {
                        while let Some(place) = done.get(next.fetch_add(1, Ordering::Relaxed)) {
                            place.fetch_add(1, Ordering::Relaxed);
                        }
                    });
                    assert!(done.iter().all(|place| place.load(Ordering::Relaxed) == sweep));
                }
            });
        }
    }

    #[test]
    fn helpers_come_to_a_task_that_lasts() {
        with_helpers(1, || {
            let came = AtomicBool::new(hands() == 1);
            share(&|number| {
                came.fetch_or(number > 0, Ordering::Relaxed);
                while !came.load(Ordering::Relaxed) {
                    thread::yield_now();
                }
            });
        });
    }

    #[test]
    fn crews_work_within_crews_and_side_by_side() {
        let sum = AtomicUsize::new(0);
        let callers = 4;
        thread::scope(|scope| {
            for _ in 0..callers {
                scope.spawn(|| {
                    for _ in 0..200 {
                        let next = AtomicUsize::new(0);
                        let outer = |_: usize| {
                            while next.fetch_add(1, Ordering::Relaxed) < 8 {
                                let inner_next = AtomicUsize::new(0);
                                with_helpers(3, || {
                                    share(&|_| {
                                        while inner_next.fetch_add(1, Ordering::Relaxed) < 8 {
                                            sum.fetch_add(1, Ordering::Relaxed);
                                        }
                                    });
                                });
                            }
                        };
                        with_helpers(3, || share(&outer));
                    }
                });
            }
        });
        assert_eq!(sum.into_inner(), callers * 200 * 64);
    }

    #[test]
    fn a_panic_reaches_the_caller_and_no_other_frame() {
        for _ in 0..50 {
            let is_caught = catch_unwind(|| with_helpers(3, || share(&|_| panic!("on purpose")))).is_err();
            assert!(is_caught);
            let calls = AtomicUsize::new(0);
            with_helpers(3, || {
                share(&|_| {
                    calls.fetch_add(1, Ordering::Relaxed);
                });
            });
            assert!(calls.into_inner() >= 1);
        }
    }
}
