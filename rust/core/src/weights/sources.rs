//! What a bone sees of the solid: voxels with a straight way to it, where distance is exact.

use glam::DVec3;

use super::voxels::{NONE, Voxels, step_to};

/// Distance beyond the nearest voxel up to which all voxels are seen. Below two voxels less the way to the nearest one: a
/// bone does not reach across a gap of two voxels.
const CONTACT: f64 = 1.0;
/// Crossings of a line with borders of cells that are no farther apart than this part of the line are one, through an edge
/// or a corner…
const TIE: f64 = 1e-9;
/// …and no farther than this part of a voxel, on lines to bones far away.
const TIE_IN_VOXELS: f64 = 1e-4;
/// Bones are no farther than this, in voxels: products with any range are numbers of single precision.
pub const FARTHEST: f64 = 1e20;

/// Closest point of a segment.
#[inline]
pub fn closest_on_segment(head: DVec3, tail: DVec3, p: DVec3) -> DVec3 {
    let along = tail - head;
    let length_squared = along.length_squared();
    let t = if length_squared > 0.0 { ((p - head).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    head + t * along
}

/// Straight distance to a segment.
#[inline]
pub fn straight_distance([head, tail]: [DVec3; 2], p: DVec3) -> f64 {
    p.distance(closest_on_segment(head, tail, p)).min(FARTHEST)
}

/// One bone.
#[derive(Debug, Clone, Copy)]
pub struct Source {
    pub index: u32,
    /// In voxels.
    pub ends: [DVec3; 2],
    /// Distance up to which it sees all voxels that it may hold.
    pub near: f64,
}

/// Voxels that a bone sees, all in voxels, with their distances. Those farther than `limit` says are not looked at. A
/// bone outside of all voxels sees through the air up to the nearest of them.
pub fn sources(voxels: &Voxels, bone: &Source, limit: impl Fn(u32) -> f32) -> Vec<(u32, f32)> {
    let mut found = Vec::new();
    for voxel in 0..voxels.len() as u32 {
        let far = straight_distance(bone.ends, voxels.centre(voxel));
        if is_source(voxels, bone, voxel, far, |far| far as f32 <= limit(voxel)) {
            found.push((voxel, far as f32));
        }
    }
    found
}

/// Distance up to which a bone sees all voxels that it may hold.
pub fn contact(voxels: &Voxels, index: u32, bone: [DVec3; 2]) -> f64 {
    let is_held = |voxel: &u32| voxels.is_held(*voxel, index);
    let distance = |voxel: u32| straight_distance(bone, voxels.centre(voxel));
    let about = voxels.in_box(bone[0].min(bone[1]) - 1.0, bone[0].max(bone[1]) + 1.0);
    let nearest = about.into_iter().filter(is_held).map(distance).fold(f64::INFINITY, f64::min);
    // Beyond the box no voxel is nearer than 1.
    let is_certain = nearest <= 1.0;
    CONTACT + if is_certain { nearest } else { (0..voxels.len() as u32).filter(is_held).map(distance).fold(f64::INFINITY, f64::min) }
}

/// What a bone sees not farther than `view`.
pub fn near_sources(voxels: &Voxels, bone: &Source, view: f64) -> Vec<(u32, f32)> {
    let [head, tail] = bone.ends;
    let reach = bone.near.max(view);
    let about = voxels.in_box(head.min(tail) - reach, head.max(tail) + reach);
    let all = about.into_iter().map(|voxel| (voxel, straight_distance(bone.ends, voxels.centre(voxel))));
    all.filter(|&(voxel, far)| is_source(voxels, bone, voxel, far, |far| far <= view)).map(|(voxel, far)| (voxel, far as f32)).collect()
}

/// Whether a bone holds a voxel that is `far` from it, or sees it where `is_in_view` says so.
fn is_source(voxels: &Voxels, bone: &Source, voxel: u32, far: f64, is_in_view: impl Fn(f64) -> bool) -> bool {
    if far <= bone.near { voxels.is_held(voxel, bone.index) } else { is_in_view(far) && is_seen(voxels, bone, voxel, bone.near / far) }
}

/// Whether all cells on the straight way from a voxel to the bone are solid, but for the last part of the way. Where solids
/// pass through each other, the way stays in its own.
fn is_seen(voxels: &Voxels, bone: &Source, voxel: u32, last_part: f64) -> bool {
    let [head, tail] = bone.ends;
    let mut node = voxel;
    let centre = voxels.centre(voxel);
    let way = (closest_on_segment(head, tail, centre) - centre).to_array();
    let mut cell = voxels.cells[voxel as usize].map(i64::from);
    let each = way.map(|w| 1.0 / w.abs());
    let tie = TIE.min(TIE_IN_VOXELS * each[0].min(each[1]).min(each[2]));
    // Parts of the way at which it enters the next cell along each axis.
    let mut next = each.map(|e| 0.5 * e);
    loop {
        let first = next[0].min(next[1]).min(next[2]);
        if first >= 1.0 - last_part {
            return voxels.is_held(node, bone.index);
        }
        let mut step = [0; 3];
        for axis in 0..3 {
            if next[axis] <= first + tie {
                step[axis] = if way[axis] > 0.0 { 1 } else { -1 };
                cell[axis] += step[axis];
                next[axis] += each[axis];
            }
        }
        if voxels.sheets.is_none() {
            if !voxels.is_solid(cell) {
                return false;
            }
            continue;
        }
        node = voxels.neighbours[node as usize][step_to(step)];
        if node == NONE {
            return false;
        }
    }
}
