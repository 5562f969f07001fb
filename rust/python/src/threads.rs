//! Work away from the interpreter, also in a process that was forked: there the threads of the pool are gone.

use std::panic::AssertUnwindSafe;
use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::{FaultError, fault, refused};

/// The process that imported the module.
static IMPORTER: OnceLock<u32> = OnceLock::new();
/// Threads of a fork, and which process that is.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Called when the module is imported.
pub fn remember_process() {
    IMPORTER.get_or_init(process::id);
}

/// What `work` makes while other threads may use the interpreter. What it refuses becomes a `TurgorError`, a panic a
/// `FaultError`: what pyo3 makes of a panic passes every `except Exception`.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> turgor::Result<T> + Send) -> PyResult<T> {
    let caught = py.detach(|| {
        // What a panic leaves half done is never looked at: buffers under way are dropped or written anew.
        fault::caught(AssertUnwindSafe(|| match pool_of_fork() {
            Some(pool) => pool.install(work),
            None => work(),
        }))
    });
    caught.map_err(FaultError::new_err)?.map_err(refused)
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
