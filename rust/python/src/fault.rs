//! Panics of the engine: faults of ours, told to the caller, who goes on.

use std::panic::{UnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::{Mutex, PoisonError};

/// Where and why the engine panicked first since a fault was told: the thread that asks may learn of it at second hand.
static FIRST: Mutex<Option<String>> = Mutex::new(None);

/// Called when the module is imported: from now on panics are remembered, besides being printed.
pub fn remember() {
    let print = take_hook();
    set_hook(Box::new(move |panic| {
        FIRST.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| panic.to_string());
        print(panic);
    }));
}

/// What `work` makes, or what a fault's message says of its panic.
pub fn caught<T>(work: impl FnOnce() -> T + UnwindSafe) -> Result<T, String> {
    catch_unwind(work).map_err(|_| {
        let first = FIRST.lock().unwrap_or_else(PoisonError::into_inner).take();
        let first = first.unwrap_or_else(|| "it panicked".into());
        format!("the engine has a fault and made nothing of this call: please report it, with the file if you can; {first}")
    })
}
