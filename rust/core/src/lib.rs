//! Exact volume for skinned meshes.
//!
//! Pure geometry: knows neither Python nor Blender. Lengths are in the caller's units; f64, but for what fields add.
//! `MATH §n` in comments refers to the formulas collected in `docs/ARCHITECTURE.md`, [RHC09] to Rohmer, Hahmann, Cani:
//! *Exact volume preserving skinning with shape control*, SCA 2009, [ZR13] to Zhuo, Rossignac: *Fleshing: spine-driven
//! bending with local volume preservation*, 2013.

mod binding;
mod error;
mod fields;
mod folds;
mod frame;
mod losses;
mod many_poses;
mod numeric;
mod parallel;
mod report;
mod skinning;
mod spine;
mod surface;
mod volume_skin;
mod weights;
mod workspaces;

pub use error::{Error, Result, check_numbers};
pub use fields::joint::{Joint, Profiles, Shares};
pub use fields::profile::Profile;
pub use frame::{JointField, Pose, RefinementNeed, Workspace};
pub use report::{FoldCounts, Report};
pub use skinning::blend::{Mode, Skinning};
pub use skinning::skeleton::Skeleton;
pub use spine::{
    Blend, ClosestPoint, Flesh, FleshFrame, Fleshing, FleshingReport, Kind, KnotFlags, Match, Method, Parameters, Resolution, Spine, Twist,
    Validity,
};
pub use surface::mesh::{Mesh, Target};
pub use surface::topology::{Component, Status, Topology};
pub use surface::volume::VolumeCubic;
pub use volume_skin::{Options, Solver, VolumeSkin};
pub use weights::{Bones, Plane, Surface, Symmetry, WeightRows, WeightSettings, Weights, automatic_weights};
pub use workspaces::Workspaces;
