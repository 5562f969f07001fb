//! Exact volume for skinned meshes.
//!
//! Pure geometry: knows neither Python nor Blender. Lengths are in the caller's units; f64, but for what fields add.
//! `MATH §n` in comments refers to the formulas collected in `docs/ARCHITECTURE.md`, [RHC09] to Rohmer, Hahmann, Cani:
//! *Exact volume preserving skinning with shape control*, SCA 2009, [ZR13] to Zhuo, Rossignac: *Fleshing: spine-driven
//! bending with local volume preservation*, 2013.

mod affinity;
mod binding;
mod block_rows;
mod correction;
mod crew;
mod csr;
mod dual_quaternion;
mod error;
mod fields;
mod frame;
mod heights;
mod joint;
mod lanes;
mod many_poses;
mod mask;
mod mesh;
mod motions;
mod nearness;
mod patches;
mod profile;
mod repair;
mod report;
mod sites;
mod skeleton;
mod skinning;
mod spine;
mod split;
mod stages;
mod strips;
mod supports;
mod surface;
mod sweeps;
mod topology;
mod union_find;
mod volume;
mod volume_forms;
mod volume_loss;
mod volume_skin;
mod weights;
mod weld;
mod workspaces;

pub use error::{Error, Result, check_numbers};
pub use frame::{JointField, Pose, RefinementNeed, Workspace};
pub use joint::{Joint, Profiles, Shares};
pub use mesh::{Mesh, Target};
pub use profile::Profile;
pub use report::{FoldCounts, Report};
pub use skeleton::Skeleton;
pub use skinning::{Mode, Skinning};
pub use spine::{
    Blend, ClosestPoint, Flesh, FleshFrame, Fleshing, FleshingReport, Kind, KnotFlags, Match, Method, Parameters, Resolution, Spine, Twist,
    Validity,
};
pub use topology::{Component, Status, Topology};
pub use volume::VolumeCubic;
pub use volume_skin::{Options, Solver, VolumeSkin};
pub use weights::{Bones, Plane, Surface, Symmetry, WeightRows, WeightSettings, Weights, automatic_weights};
pub use workspaces::Workspaces;
