//! Figures of one frame.

/// Volumes are signed like their component, in cubic units of object space; positive losses are lost.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// Per component, as skinned; 0 where not sound.
    pub skinned_volumes: Vec<f64>,
    /// Per component.
    pub target_volumes: Vec<f64>,
    /// Per component, as solved: its cubic at the step that was taken, in double precision. `Mesh::component_volumes` of
    /// positions measures it.
    pub corrected_volumes: Vec<f64>,
    /// Per component, whether the mask lets nothing of it move: it stays as skinned.
    pub component_is_pinned: Vec<bool>,
    /// Per joint, volume its turn took, over all components.
    pub joint_losses: Vec<f64>,
    /// Per joint, volume given back by its field, to first order.
    pub joint_regained: Vec<f64>,
    /// Per joint, bound on the displacement by its field, armature space.
    pub joint_displacements: Vec<f64>,
    /// Per joint, whether part of its volume went to a wider field.
    pub joint_is_capped: Vec<bool>,
    /// Largest distance between skinned vertices of one point, object space.
    pub seam_gap: f64,
    /// Largest correction of a vertex, object space.
    pub max_displacement: f64,
    /// Where folds are repaired: pairs of triangles that the correction alone makes pass through each other.
    pub folds_found: usize,
    /// Those of them, and of new ones, that are left.
    pub folds_left: usize,
    /// Vertices that were backed off and held, in order.
    pub blocked_vertices: Vec<u32>,
}

/// Folds of one frame, as in its `Report`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FoldCounts {
    /// Pairs of triangles before repair.
    pub found: usize,
    /// Pairs after it.
    pub left: usize,
    /// Vertices held.
    pub blocked: usize,
}

impl Report {
    /// How many folds there were and are.
    pub fn fold_counts(&self) -> FoldCounts {
        FoldCounts { found: self.folds_found, left: self.folds_left, blocked: self.blocked_vertices.len() }
    }

    pub(crate) fn new(component_count: usize, joint_count: usize) -> Self {
        Self {
            skinned_volumes: vec![0.0; component_count],
            target_volumes: vec![0.0; component_count],
            corrected_volumes: vec![0.0; component_count],
            component_is_pinned: vec![false; component_count],
            joint_losses: vec![0.0; joint_count],
            joint_regained: vec![0.0; joint_count],
            joint_displacements: vec![0.0; joint_count],
            joint_is_capped: vec![false; joint_count],
            seam_gap: 0.0,
            max_displacement: 0.0,
            folds_found: 0,
            folds_left: 0,
            blocked_vertices: Vec::new(),
        }
    }

    /// Largest |corrected − target| / |target| over components that have a target and may move; infinite where that is no
    /// number.
    pub fn relative_error(&self) -> f64 {
        self.corrected_volumes
            .iter()
            .zip(&self.target_volumes)
            .zip(&self.component_is_pinned)
            .filter(|((_, target), is_pinned)| **target != 0.0 && !**is_pinned)
            .map(|((corrected, target), _)| ((corrected - target) / target).abs())
            .fold(0.0, |largest, error| if error.is_nan() { f64::INFINITY } else { error.max(largest) })
    }
}
