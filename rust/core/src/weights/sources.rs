//! What a bone sees of the solid: voxels with a straight way to it, where distance is exact.

use glam::DVec3;

use super::voxels::Voxels;

/// Distance beyond the nearest voxel up to which all voxels are seen. Below two voxels less the way to the nearest one: a
/// bone does not reach across a gap of two voxels.
const CONTACT: f64 = 1.0;
/// Crossings of a line with borders of cells that are no farther apart than this are one, through an edge or a corner.
const TIE: f64 = 1e-9;

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
    p.distance(closest_on_segment(head, tail, p))
}

/// Voxels that a bone sees, all in voxels, with their distances. Those farther than `limit` says are not looked at. A
/// bone outside of all voxels sees through the air up to the nearest of them.
pub fn sources(voxels: &Voxels, bone: [DVec3; 2], near: f64, limit: impl Fn(u32) -> f32) -> Vec<(u32, f32)> {
    let mut found = Vec::new();
    for voxel in 0..voxels.len() as u32 {
        let far = straight_distance(bone, voxels.centre(voxel));
        if far <= near || far as f32 <= limit(voxel) && is_seen(voxels, bone, voxel, near / far) {
            found.push((voxel, far as f32));
        }
    }
    found
}

/// Distance up to which a bone sees all voxels.
pub fn contact(voxels: &Voxels, bone: [DVec3; 2]) -> f64 {
    let distance = |voxel: u32| straight_distance(bone, voxels.centre(voxel));
    let about = voxels.in_box(bone[0].min(bone[1]) - 1.0, bone[0].max(bone[1]) + 1.0);
    let nearest = about.into_iter().map(distance).fold(f64::INFINITY, f64::min);
    // Beyond the box no voxel is nearer than 1.
    let is_certain = nearest <= 1.0;
    CONTACT + if is_certain { nearest } else { (0..voxels.len() as u32).map(distance).fold(f64::INFINITY, f64::min) }
}

/// What a bone sees not farther than `view`.
pub fn near_sources(voxels: &Voxels, bone: [DVec3; 2], near: f64, view: f64) -> Vec<(u32, f32)> {
    let reach = near.max(view);
    let about = voxels.in_box(bone[0].min(bone[1]) - reach, bone[0].max(bone[1]) + reach);
    let all = about.into_iter().map(|voxel| (voxel, straight_distance(bone, voxels.centre(voxel))));
    let is_source = |voxel: u32, far: f64| far <= near || far <= view && is_seen(voxels, bone, voxel, near / far);
    all.filter(|&(voxel, far)| is_source(voxel, far)).map(|(voxel, far)| (voxel, far as f32)).collect()
}

/// Whether all cells on the straight way from a voxel to the bone are solid, but for the last part of the way.
fn is_seen(voxels: &Voxels, [head, tail]: [DVec3; 2], voxel: u32, last_part: f64) -> bool {
    let centre = voxels.centre(voxel);
    let way = (closest_on_segment(head, tail, centre) - centre).to_array();
    let mut cell = voxels.cells[voxel as usize].map(i64::from);
    let each = way.map(|w| 1.0 / w.abs());
    // Parts of the way at which it enters the next cell along each axis.
    let mut next = each.map(|e| 0.5 * e);
    loop {
        let first = next[0].min(next[1]).min(next[2]);
        if first >= 1.0 - last_part {
            return true;
        }
        for axis in 0..3 {
            if next[axis] <= first + TIE {
                cell[axis] += if way[axis] > 0.0 { 1 } else { -1 };
                next[axis] += each[axis];
            }
        }
        if !voxels.is_solid(cell) {
            return false;
        }
    }
}
