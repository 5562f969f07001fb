//! Many poses of one character, frames side by side.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::error::{Error, Result};
use crate::frame::{Details, Needs, Pose, RefinementNeed, Workspace};
use crate::parallel::crew::{self, locked};
use crate::report::{FoldCounts, Report};
use crate::volume_skin::VolumeSkin;
use crate::workspaces::Workspaces;

/// Memory that the frames under way at one time may take.
const MEMORY_MAX: usize = 1 << 30;

impl VolumeSkin {
    /// Figures of each pose, the same as `deform` one by one; frames are under way at once as far as memory goes.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused.
    pub fn measure(&self, poses: &[Pose], workspaces: &Workspaces) -> Result<Vec<Report>> {
        self.side_by_side(poses.len(), workspaces, |frame, workspace, offsets| {
            offsets.resize(self.vertex_count(), [0.0; 3]);
            self.deform(&poses[frame], workspace, offsets).cloned()
        })
    }

    /// Writes what each pose makes of every vertex to `positions`, frame after frame, object space: skinned, and `effects`
    /// of the way to corrected. The same bits as `deform` one by one. Returns how folds were repaired, frame by frame.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused; `effects` or `positions` of another length.
    pub fn deform_many(
        &self,
        poses: &[Pose],
        effects: &[f64],
        positions: &mut [[f32; 3]],
        workspaces: &Workspaces,
    ) -> Result<Vec<FoldCounts>> {
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
        self.side_by_side(frames, workspaces, |frame, workspace, _| {
            let mut row = rows.get(frame).map(locked);
            let row = row.as_deref_mut().map_or(&mut [][..], |row| row);
            self.deform_to_positions(&poses[frame], effects[frame], workspace, row)?;
            Ok(workspace.report.fold_counts())
        })
    }

    /// Where all of these poses together ask for more vertices; their order does not matter.
    ///
    /// # Errors
    /// As `deform`, of the first pose that is refused.
    pub fn refinement_need(&self, poses: &[Pose], workspaces: &Workspaces) -> Result<RefinementNeed> {
        let details = Details::new(self.joints());
        let needs = Mutex::new(Needs::new(self.binding()));
        self.side_by_side(poses.len(), workspaces, |frame, workspace, _| {
            self.skin_pose(&poses[frame], workspace)?;
            let mut own = Needs::new(self.binding());
            self.add_needs(workspace, &details, &mut own);
            locked(&needs).join(&own);
            Ok(())
        })?;
        let needs = needs.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(needs.of_vertices(self.binding()))
    }

    /// What `work` makes of each of so many frames, in a workspace and an empty buffer that it shares with others.
    fn side_by_side<T: Send + Sync>(
        &self,
        frame_count: usize,
        workspaces: &Workspaces,
        work: impl Fn(usize, &mut Workspace, &mut Vec<[f32; 3]>) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let first = workspaces.borrow(self);
        let at_once = (MEMORY_MAX / first.memory_bytes().max(1)).max(1);
        let spare = Mutex::new(Some(first));
        let (next, begun, is_refused) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
        let results: Vec<OnceLock<Result<T>>> = (0..frame_count).map(|_| OnceLock::new()).collect();
        // Each thread has a workspace of its own.
        let compute = |_: usize| {
            let mut buffers = None;
            let is_wanted = begun.fetch_add(1, Ordering::Relaxed) < at_once;
            while is_wanted && !is_refused.load(Ordering::Relaxed) {
                let frame = next.fetch_add(1, Ordering::Relaxed);
                let Some(result) = results.get(frame) else { break };
                let (workspace, offsets) = buffers.get_or_insert_with(|| {
                    let spare = locked(&spare).take();
                    (spare.unwrap_or_else(|| workspaces.borrow(self)), Vec::new())
                });
                let outcome = work(frame, workspace, offsets);
                is_refused.fetch_or(outcome.is_err(), Ordering::Relaxed);
                result.get_or_init(|| outcome);
            }
            if let Some((workspace, _)) = buffers {
                workspaces.release(workspace);
            }
        };
        crew::with_helpers(at_once.min(frame_count).saturating_sub(1), || crew::share(&compute));
        if let Some(unused) = spare.into_inner().unwrap_or_else(PoisonError::into_inner) {
            workspaces.release(unused);
        }
        // Frames are begun in order: those before the first refused one are all there.
        let mut finished = Vec::with_capacity(frame_count);
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
