//! Which fields a sweep is for, and from where components are solved again.

use crate::fields::patch_sums::Move;

/// Which jobs a sum is for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pass<'a> {
    /// All, with profile weights sampled anew.
    All,
    /// These, with profile weights as they are.
    Some(&'a [usize]),
    /// None: only the field of the whole shell.
    Shell,
    /// All of the components that are solved again, with profile weights as they are.
    Again(&'a Restart),
}

impl Pass<'_> {
    pub fn concerns(self, job: usize) -> bool {
        match self {
            Self::All | Self::Again(_) => true,
            Self::Shell => false,
            Self::Some(jobs) => jobs.contains(&job),
        }
    }

    pub fn passes_over(self, component: u32) -> bool {
        matches!(self, Self::Again(restart) if !restart.is_affected[component as usize])
    }
}

/// Which components are solved again, and from where.
#[derive(Debug)]
pub(super) struct Restart {
    /// Per component.
    pub is_affected: Vec<bool>,
    /// Per component, the volume that holding points back took.
    pub gaps: Vec<f64>,
    /// Per slot, how points stand before.
    pub moves: Vec<Move>,
}
