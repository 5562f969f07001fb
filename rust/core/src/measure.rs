//! Figures of many poses of one character.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::error::{Error, Result};
use crate::frame::Pose;
use crate::report::Report;
use crate::volume_skin::VolumeSkin;

/// Memory that the frames under way at one time may take.
const MEMORY_MAX: usize = 1 << 30;

impl VolumeSkin {
    /// Figures of each pose, the same as `deform` one by one; frames are under way at once as far as memory goes.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused.
    pub fn measure(&self, poses: &[Pose]) -> Result<Vec<Report>> {
        let first = self.workspace();
        let at_once = (MEMORY_MAX / first.memory_bytes().max(1)).max(1);
        let spare = Mutex::new(Some(first));
        let (next, is_refused) = (AtomicUsize::new(0), AtomicBool::new(false));
        let results: Vec<OnceLock<Result<Report>>> = poses.iter().map(|_| OnceLock::new()).collect();
        // One visit per thread, each with a workspace of its own: a stolen task could begin a frame within a frame.
        rayon::broadcast(|thread| {
            let mut buffers = None;
            while thread.index() < at_once && !is_refused.load(Ordering::Relaxed) {
                let frame = next.fetch_add(1, Ordering::Relaxed);
                let Some(pose) = poses.get(frame) else { break };
                let (workspace, offsets) = buffers.get_or_insert_with(|| {
                    let spare = spare.lock().unwrap_or_else(PoisonError::into_inner).take();
                    (spare.unwrap_or_else(|| self.workspace()), vec![[0.0; 3]; self.vertex_count()])
                });
                let result = self.deform(pose, workspace, offsets).cloned();
                is_refused.fetch_or(result.is_err(), Ordering::Relaxed);
                results[frame].get_or_init(|| result);
            }
        });
        // Frames are begun in order: those before the first refused one are all there.
        let mut reports = Vec::with_capacity(poses.len());
        for (frame, result) in results.into_iter().enumerate() {
            match result.into_inner() {
                Some(Ok(report)) => reports.push(report),
                Some(Err(error)) => return Err(Error::Frame { frame, error: Box::new(error) }),
                None => break,
            }
        }
        Ok(reports)
    }
}
