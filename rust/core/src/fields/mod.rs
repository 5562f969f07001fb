//! Where volume comes back: joints and their profiles, who may move what, and the displacements [MATH §2, §4].

pub(crate) mod bare_correction;
pub(crate) mod extents;
pub(crate) mod field;
pub(crate) mod joint;
pub(crate) mod normals;
pub(crate) mod patch_sums;
pub(crate) mod profile;
pub(crate) mod profile_weights;
pub(crate) mod supports;
