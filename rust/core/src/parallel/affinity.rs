//! Keeps a helper off the processor of the thread that wakes it.
//!
//! Where no processor is idle, Linux likes to wake a thread on the processor of who wakes it. Blender's own threads spin for a
//! while after their work is done, so there often is no idle one; the helper would wait for the frame's own thread to end
//! while others spin.

#[cfg(target_os = "linux")]
mod linux {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use rustix::thread::{CpuSet, Pid, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};

    /// Where one thread may run.
    pub(crate) struct Affinity {
        thread: Pid,
        /// What the system, or the artist, allows it.
        allowed: CpuSet,
        /// The processor that it was kept off last.
        avoided: AtomicUsize,
    }

    impl Affinity {
        /// Of the calling thread; None where the system does not tell.
        pub(crate) fn own() -> Option<Self> {
            let allowed = sched_getaffinity(None).ok()?;
            Some(Self { thread: gettid(), allowed, avoided: AtomicUsize::new(usize::MAX) })
        }

        /// From now on the thread runs on any allowed processor but the caller's. It stays where it is if there is no other.
        pub(crate) fn avoid_caller(&self) {
            let here = sched_getcpu();
            if self.avoided.swap(here, Ordering::Relaxed) == here || here >= CpuSet::MAX_CPU {
                return;
            }
            let mut others = self.allowed;
            others.unset(here);
            if others.count() > 0 {
                // Refused in some containers: slower, nothing else.
                let _ = sched_setaffinity(Some(self.thread), &others);
            }
        }
    }

    #[cfg(test)]
    mod tests {
        use std::sync::mpsc::channel;
        use std::thread;

        use super::*;

        #[test]
        fn a_thread_leaves_the_processor_of_its_caller_and_takes_none_that_was_not_allowed() {
            let (tell, told) = channel();
            let (ask, asked) = channel();
            let helper = thread::spawn(move || {
                tell.send(Affinity::own()).expect("somebody listens");
                asked.recv().ok().and_then(|()| sched_getaffinity(None).ok())
            });
            let affinity = told.recv().expect("it tells").expect("Linux tells");
            let before = sched_getcpu();
            affinity.avoid_caller();
            let is_moved = sched_getcpu() != before;
            ask.send(()).expect("somebody listens");
            let now = helper.join().expect("it ends").expect("Linux tells");

            let count = affinity.allowed.count();
            assert!((0..CpuSet::MAX_CPU).all(|cpu| affinity.allowed.is_set(cpu) || !now.is_set(cpu)));
            assert_eq!(now.count(), count.max(2) - 1);
            assert!(count == 1 || is_moved || !now.is_set(before));
        }
    }
}

#[cfg(target_os = "linux")]
pub(crate) use linux::Affinity;

/// There is none elsewhere: the system knows best.
#[cfg(not(target_os = "linux"))]
pub(crate) enum Affinity {}

#[cfg(not(target_os = "linux"))]
impl Affinity {
    pub(crate) fn own() -> Option<Self> {
        None
    }

    pub(crate) fn avoid_caller(&self) {
        match *self {}
    }
}
