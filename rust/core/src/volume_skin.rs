//! A bound character: bind once, deform each frame [MATH §2–3].

use std::sync::Arc;

use glam::{DMat4, DVec3};

use crate::binding::Binding;
use crate::error::{Error, Result, check_finite};
use crate::fields::joint::{Fields, Joint};
use crate::fields::supports::Supports;
use crate::frame::{Bound, Details, JointField, Mask, Needs, Pose, Workspace};
use crate::parallel::crew;
use crate::parallel::split::helpers_for;
use crate::report::Report;
use crate::skinning::blend::{Skinning, check_object};
use crate::surface::topology::Topology;

/// In which order joints give back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// All at the skinned pose from one gradient: no order, a few sweeps of the mesh whatever the number of bones.
    #[default]
    Simultaneous,
    /// Parents first, axis after axis, each on the mesh so far, as in \[RHC09\]: up to four gradients per joint.
    Sequential,
}

/// Settings of a bound character.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// In which order joints give back.
    pub solver: Solver,
    /// Bone scale and translation move the target volume.
    pub keep_bone_scale: bool,
    /// How fields lie on the skin.
    pub fields: Fields,
}

impl Default for Options {
    fn default() -> Self {
        Self { solver: Solver::default(), keep_bone_scale: true, fields: Fields::default() }
    }
}

/// A bound character. Immutable; frames are computed in a `Workspace`.
#[derive(Clone)]
pub struct VolumeSkin {
    binding: Arc<Binding>,
    supports: Arc<Supports>,
    /// One per joint of the tree.
    joints: Arc<Vec<Joint>>,
    options: Options,
    mask: Option<Arc<Mask>>,
}

impl VolumeSkin {
    /// Binds a mesh to its weights.
    ///
    /// `rest` per vertex and `shape_deltas` per shape key and vertex, object space; `object_from_armature` as it stands
    /// at bind: it turns the mesh's size into the skeleton's. Bones without an entry in `joints` are isotropic.
    ///
    /// # Errors
    /// Lengths that do not match, values that are not finite, an object matrix without inverse, joints named twice.
    pub fn bind(
        topology: &Topology,
        rest: &[DVec3],
        skinning: &Skinning,
        joints: &[Joint],
        options: Options,
        shape_deltas: &[Vec<DVec3>],
        object_from_armature: &DMat4,
    ) -> Result<Self> {
        let vertex_count = topology.point_of_vertex.len();
        if skinning.vertex_count() != vertex_count {
            return Err(Error::Length { what: "weights", found: skinning.vertex_count(), needed: vertex_count });
        }
        if rest.len() != vertex_count {
            return Err(Error::VertexCount { found: rest.len(), bound: vertex_count });
        }
        check_finite("rest_positions", rest)?;
        for deltas in shape_deltas {
            if deltas.len() != vertex_count {
                return Err(Error::Length { what: "shape_deltas", found: deltas.len(), needed: vertex_count });
            }
            check_finite("shape_deltas", deltas)?;
        }
        let armature_from_object = check_object(object_from_armature)?.inverse();
        let binding = Binding::new(topology, rest, skinning, shape_deltas, armature_from_object);
        let joints = binding.settings(joints)?;
        let supports = binding.supports(&joints, options.fields);
        Ok(Self { binding: Arc::new(binding), supports: Arc::new(supports), joints: Arc::new(joints), options, mask: None })
    }

    /// The same binding and mask with other settings.
    ///
    /// # Errors
    /// Joints out of range, named twice, or with settings out of range.
    pub fn with_joints(&self, joints: &[Joint], options: Options) -> Result<Self> {
        let joints = self.binding.settings(joints)?;
        let same_sizes = joints.iter().zip(&*self.joints).all(|(a, b)| a.size.to_bits() == b.size.to_bits());
        let is_same = same_sizes && options.fields == self.options.fields;
        let supports = if is_same { Arc::clone(&self.supports) } else { Arc::new(self.binding.supports(&joints, options.fields)) };
        Ok(Self { supports, joints: Arc::new(joints), options, ..self.clone() })
    }

    /// The same binding and settings with another mask: per vertex in 0..1, a factor on its weight in every field.
    ///
    /// A vertex of 0 stays as skinned, exactly. Workspaces may be used with any mask.
    ///
    /// # Errors
    /// A mask of another length, or numbers beyond 0..1.
    pub fn with_mask(&self, mask: Option<&[f32]>) -> Result<Self> {
        let mask = mask.map(|mask| Mask::new(&self.binding, mask)).transpose()?.flatten().map(Arc::new);
        Ok(Self { mask, ..self.clone() })
    }

    /// Settings as bound, one per joint.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Options as bound.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Bone of each joint, parents first: the order of per-joint figures.
    pub fn joint_bones(&self) -> &[u32] {
        &self.binding.motions.tree.bones
    }

    /// Length of each joint, armature space: the unit of its profiles.
    pub fn joint_lengths(&self) -> &[f64] {
        &self.supports.lengths
    }

    /// Vertices as bound.
    pub fn vertex_count(&self) -> usize {
        self.binding.slot_of_vertex.len()
    }

    /// Memory of the binding and one workspace.
    pub fn memory_bytes(&self) -> usize {
        let mask = self.mask.as_ref().map_or(0, |mask| mask.memory_bytes());
        self.binding.memory_bytes() + self.supports.memory_bytes() + mask + self.workspace().memory_bytes()
    }

    /// New buffers.
    pub fn workspace(&self) -> Workspace {
        Workspace::new(self.bound())
    }

    /// Skins and corrects one frame: writes corrected − skinned of every vertex, object space, to `offsets`. Positions are
    /// read from the workspace, which must be of this very `VolumeSkin`, or one with another mask. A pure function of its input.
    ///
    /// # Errors
    /// A pose that is not finite or of another skeleton, an object matrix without inverse, `offsets` of another length.
    /// The workspace is then stale.
    pub fn deform<'w>(&self, pose: &Pose, workspace: &'w mut Workspace, offsets: &mut [[f32; 3]]) -> Result<&'w Report> {
        let bound = self.binding.slot_of_vertex.len();
        if offsets.len() != bound {
            return Err(Error::VertexCount { found: offsets.len(), bound });
        }
        self.with_helpers(|| {
            self.correct(pose, workspace)?;
            workspace.report.max_displacement = workspace.solved(&self.binding).write_offsets(offsets);
            Ok(&workspace.report)
        })
    }

    /// The same, but for the largest displacement: writes skinned positions and `part` of the way to corrected.
    pub(crate) fn deform_to_positions(&self, pose: &Pose, part: f64, workspace: &mut Workspace, positions: &mut [[f32; 3]]) -> Result<()> {
        self.with_helpers(|| {
            self.correct(pose, workspace)?;
            workspace.solved(&self.binding).write_positions(part, positions);
            Ok(())
        })
    }

    /// How the field of the joint at the head of `bone` lies in a pose. The workspace is stale afterwards.
    ///
    /// # Errors
    /// As `deform`; a bone without a joint.
    pub fn joint_field(&self, bone: usize, pose: &Pose, workspace: &mut Workspace) -> Result<JointField> {
        let joint = self.joint_bones().iter().position(|&b| b as usize == bone).ok_or(Error::NoJoint { bone })?;
        self.skin_pose(pose, workspace)?;
        Ok(workspace.joint_field(self.bound(), joint))
    }

    /// Skins and measures a pose, and leaves the volume as it is.
    pub(crate) fn skin_pose(&self, pose: &Pose, workspace: &mut Workspace) -> Result<()> {
        self.with_helpers(|| self.skin(pose, workspace))
    }

    /// Adds the workspace's pose to what poses ask for.
    pub(crate) fn add_needs(&self, workspace: &Workspace, details: &Details, needs: &mut Needs) {
        workspace.add_needs(self.bound(), details, needs);
    }

    pub(crate) fn binding(&self) -> &Binding {
        &self.binding
    }

    fn with_helpers<R>(&self, work: impl FnOnce() -> R) -> R {
        crew::with_helpers(helpers_for(self.binding.patches.list.len()), work)
    }

    fn bound(&self) -> Bound<'_> {
        Bound { binding: &self.binding, supports: &self.supports, settings: &self.joints }
    }

    fn skin(&self, pose: &Pose, workspace: &mut Workspace) -> Result<()> {
        workspace.mask.clone_from(&self.mask);
        workspace.skin(self.bound(), pose, self.options.keep_bone_scale)
    }

    fn correct(&self, pose: &Pose, workspace: &mut Workspace) -> Result<()> {
        self.skin(pose, workspace)?;
        workspace.correct(self.bound(), self.options.solver == Solver::Sequential, pose.repair_folds);
        Ok(())
    }

    /// Skinned and corrected positions of every vertex, object space, after `deform`.
    pub fn positions(&self, workspace: &Workspace) -> (Vec<DVec3>, Vec<DVec3>) {
        let (binding, frame) = (&self.binding, workspace.solved(&self.binding));
        let vertices = binding.slot_of_vertex.iter().zip(&binding.component_of_vertex).enumerate();
        vertices
            .map(|(vertex, (&slot, &component))| {
                let skinned = frame.skinned_vertex(vertex);
                (frame.in_object(skinned), frame.in_object(skinned + frame.flesh_offset(slot) + frame.displacement(slot, component)))
            })
            .unzip()
    }
}
