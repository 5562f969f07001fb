//! Work away from the interpreter, also in a process that was forked: there the threads of the pool are gone.

use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that imported the module.
static IMPORTER: OnceLock<u32> = OnceLock::new();
/// Threads of a fork, and which process that is.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Called when the module is imported.
pub fn remember_process() {
    IMPORTER.get_or_init(process::id);
}

/// What `work` makes while other threads may use the interpreter.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| match pool_of_fork() {
        Some(pool) => pool.install(work),
        None => work(),
    })
}

/// None where the common pool lives, and where the system gives no threads.
fn pool_of_fork() -> Option<Arc<ThreadPool>> {
    let own = process::id();
    if IMPORTER.get() == Some(&own) {
        return None;
    }
    let mut forked = FORKED.lock().unwrap_or_else(PoisonError::into_inner);
    let known = forked.take().filter(|(process, _)| *process == own);
    *forked = known.or_else(|| Some((own, Arc::new(ThreadPoolBuilder::new().build().ok()?))));
    forked.as_ref().map(|(_, pool)| Arc::clone(pool))
}
