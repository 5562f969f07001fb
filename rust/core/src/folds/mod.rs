//! Skin that a correction pushed through itself or through other skin, found and backed off [MATH §8].
//!
//! A *fold* is a pair of triangles that pass through each other when corrected, and did not when skinned.

mod back_off;
mod crossing;
mod ease;
mod search;
mod skin;
mod tree;

pub(crate) use back_off::BackOff;
pub(crate) use search::Search;
pub(crate) use skin::Skin;
