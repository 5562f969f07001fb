//! Bones and what they do to points: skeletons, weights, blends of motions.

pub(crate) mod bases;
pub(crate) mod blend;
pub(crate) mod cut_chains;
pub(crate) mod dual_quaternion;
pub(crate) mod hung_joints;
pub(crate) mod joint_tree;
pub(crate) mod moments;
pub(crate) mod motions;
pub(crate) mod sites;
pub(crate) mod skeleton;
