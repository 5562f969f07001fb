//! Buffers of frames that have ended, for the next ones.

use std::sync::Mutex;

use crate::frame::Workspace;
use crate::parallel::crew::locked;
use crate::volume_skin::VolumeSkin;

/// Memory that buffers may take while nobody uses them; one set is kept whatever its size.
const IDLE_MAX: usize = 1 << 27;

/// Workspaces of one `VolumeSkin`, or of several that differ by their masks.
#[derive(Debug, Default)]
pub struct Workspaces {
    idle: Mutex<Vec<Workspace>>,
}

impl Workspaces {
    /// One that waits, or a new one; to be released after the frame.
    pub fn borrow(&self, skin: &VolumeSkin) -> Workspace {
        let idle = locked(&self.idle).pop();
        idle.unwrap_or_else(|| skin.workspace())
    }

    /// For the next frame.
    pub fn release(&self, workspace: Workspace) {
        let mut idle = locked(&self.idle);
        if (idle.len() + 1) * workspace.memory_bytes() <= IDLE_MAX || idle.is_empty() {
            idle.push(workspace);
        }
    }
}
