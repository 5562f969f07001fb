//! Checks a pose, and how bones move the mesh in it.

use glam::{DAffine3, DVec3};

use super::Pose;
use super::buffers::Posed;
use crate::binding::Binding;
use crate::error::{Error, LARGEST, Result};
use crate::fields::joint::{FACTOR_MAX, check_strengths};
use crate::skinning::blend::{check_object, check_pose};

impl Posed {
    /// Checks a pose and sets the frame to it.
    pub(super) fn set(&mut self, binding: &Binding, pose: &Pose, keep_bone_scale: bool) -> Result<&Self> {
        if let Some(strengths) = pose.strengths {
            if strengths.len() != binding.bone_count {
                return Err(Error::Length { what: "strengths", found: strengths.len(), needed: binding.bone_count });
            }
            check_strengths("strengths", strengths)?;
        }
        if let Some(is_fleshed) = pose.is_fleshed.filter(|bones| bones.len() != binding.bone_count) {
            return Err(Error::Length { what: "fleshed", found: is_fleshed.len(), needed: binding.bone_count });
        }
        if !(pose.target_scale > 0.0 && pose.target_scale <= FACTOR_MAX) {
            return Err(Error::Value { what: "target_scale", found: pose.target_scale, needed: "a number above 0, up to 1e9" });
        }
        let (rest_centre, radius) = self.body.set(binding, pose)?;
        check_pose(pose.matrices, &mut self.channels)?;
        self.object = check_object(&pose.object_from_armature)?;
        let armature_from_rest = self.object.inverse() * DAffine3::from_translation(rest_centre);
        // Near the mean of the skinned points: sums about it keep their digits far from the world's origin.
        let mut origin = DVec3::ZERO;
        let mut total = 0.0;
        for (joint, &(mass, centre)) in binding.masses.iter().enumerate() {
            let bone = binding.motions.tree.bones.get(joint);
            let channel = bone.map_or(DAffine3::IDENTITY, |&bone| self.channels[bone as usize]);
            let armature_from_rest = channel * armature_from_rest;
            if mass > 0.0 {
                let reach = reach(&armature_from_rest, radius).max(reach(&(self.object * armature_from_rest), radius));
                // What is no number is too far too.
                if !(0.0..=LARGEST).contains(&reach) {
                    return Err(Error::TooFar { bone: bone.map_or(0, |&bone| bone as usize), reach });
                }
            }
            origin += armature_from_rest.transform_point3(centre) * mass;
            total += mass;
        }
        if total > 0.0 {
            origin /= total;
        }
        let origin = self.added.set(binding, pose.added_offsets, pose.posed_positions, origin, &self.object)?;
        self.motions.set(&self.channels, armature_from_rest, origin, binding.size, keep_bone_scale);
        Ok(self)
    }
}

/// How far from 0 a map takes what is within a radius of 0, at most.
fn reach(map: &DAffine3, radius: f64) -> f64 {
    map.translation.length() + radius * (map.x_axis.length() + map.y_axis.length() + map.z_axis.length())
}
