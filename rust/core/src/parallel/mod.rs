//! Work in several threads: helpers that come to a frame, on which processor, and how arrays are cut for them.

pub(crate) mod affinity;
pub(crate) mod crew;
pub(crate) mod split;
