//! Many poses of one character, frames side by side.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::crew;
use crate::error::{Error, Result};
use crate::frame::{Details, Needs, Pose, RefinementNeed, Workspace};
use crate::report::{FoldCounts, Report};
use crate::volume_skin::VolumeSkin;

/// Memory that the frames under way at one time may take.
const MEMORY_MAX: usize = 1 << 30;

impl VolumeSkin {
    /// Figures of each pose, the same as `deform` one by one; frames are under way at once as far as memory goes.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused.
    pub fn measure(&self, poses: &[Pose]) -> Result<Vec<Report>> {
        let deform = |pose: &Pose, workspace: &mut Workspace, offsets: &mut [[f32; 3]]| self.deform(pose, workspace, offsets).map(drop);
        self.side_by_side(poses, deform, |_, workspace, _| workspace.report.clone())
    }

    /// Writes what each pose makes of every vertex to `positions`, frame after frame, object space: skinned, and `effects`
    /// of the way to corrected. The same bits as `deform` one by one. Returns how folds were repaired, frame by frame.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused; `effects` or `positions` of another length.
    pub fn deform_many(&self, poses: &[Pose], effects: &[f64], positions: &mut [[f32; 3]]) -> Result<Vec<FoldCounts>> {
        let (frames, vertices) = (poses.len(), self.vertex_count());
        if effects.len() != frames {
            return Err(Error::Length { what: "effect", found: effects.len(), needed: frames });
        }
        if let Some(&found) = effects.iter().find(|effect| !effect.is_finite()) {
            return Err(Error::Value { what: "effect", found, needed: "a finite number" });
        }
        if positions.len() != frames * vertices {
            return Err(Error::Length { what: "positions", found: positions.len(), needed: frames * vertices });
        }
        // Empty meshes have frames too.
        let rows: Vec<Mutex<&mut [[f32; 3]]>> = positions.chunks_mut(vertices.max(1)).map(Mutex::new).collect();
        let write = |frame: usize, workspace: &Workspace, offsets: &[[f32; 3]]| {
            if let Some(row) = rows.get(frame) {
                let mut row = row.lock().unwrap_or_else(PoisonError::into_inner);
                self.write_positions(workspace, offsets, effects[frame], &mut row);
            }
            workspace.report.fold_counts()
        };
        let deform = |pose: &Pose, workspace: &mut Workspace, offsets: &mut [[f32; 3]]| self.deform(pose, workspace, offsets).map(drop);
        self.side_by_side(poses, deform, write)
    }

    /// Where all of these poses together ask for more vertices; their order does not matter.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused.
    pub fn refinement_need(&self, poses: &[Pose]) -> Result<RefinementNeed> {
        let details = Details::new(self.joints());
        let needs = Mutex::new(Needs::new(self.binding()));
        let skin = |pose: &Pose, workspace: &mut Workspace, _: &mut [[f32; 3]]| self.skin_pose(pose, workspace);
        self.side_by_side(poses, skin, |_, workspace, _| {
            let mut own = Needs::new(self.binding());
            self.add_needs(workspace, &details, &mut own);
            needs.lock().unwrap_or_else(PoisonError::into_inner).join(&own);
        })?;
        let needs = needs.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(needs.of_vertices(self.binding()))
    }

    /// What `finish` makes of each frame that `work` has done: its place among the poses, and its offsets.
    fn side_by_side<T: Send + Sync>(
        &self,
        poses: &[Pose],
        work: impl Fn(&Pose, &mut Workspace, &mut [[f32; 3]]) -> Result<()> + Sync,
        finish: impl Fn(usize, &Workspace, &[[f32; 3]]) -> T + Sync,
    ) -> Result<Vec<T>> {
        let first = self.workspace();
        let at_once = (MEMORY_MAX / first.memory_bytes().max(1)).max(1);
        let spare = Mutex::new(Some(first));
        let (next, begun, is_refused) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
        let results: Vec<OnceLock<Result<T>>> = poses.iter().map(|_| OnceLock::new()).collect();
        // Each thread has a workspace of its own.
        let compute = |_: usize| {
            let mut buffers = None;
            let is_wanted = begun.fetch_add(1, Ordering::Relaxed) < at_once;
            while is_wanted && !is_refused.load(Ordering::Relaxed) {
                let frame = next.fetch_add(1, Ordering::Relaxed);
                let Some(pose) = poses.get(frame) else { break };
                let (workspace, offsets) = buffers.get_or_insert_with(|| {
                    let spare = spare.lock().unwrap_or_else(PoisonError::into_inner).take();
                    (spare.unwrap_or_else(|| self.workspace()), vec![[0.0; 3]; self.vertex_count()])
                });
                let outcome = work(pose, workspace, offsets);
                is_refused.fetch_or(outcome.is_err(), Ordering::Relaxed);
                results[frame].get_or_init(|| outcome.map(|()| finish(frame, workspace, offsets)));
            }
        };
        crew::with_helpers(at_once.min(poses.len()).saturating_sub(1), || crew::share(&compute));
        // Frames are begun in order: those before the first refused one are all there.
        let mut finished = Vec::with_capacity(poses.len());
        for (frame, result) in results.into_iter().enumerate() {
            match result.into_inner() {
                Some(Ok(value)) => finished.push(value),
                Some(Err(error)) => return Err(Error::Frame { frame, error: Box::new(error) }),
                None => break,
            }
        }
        Ok(finished)
    }
}
