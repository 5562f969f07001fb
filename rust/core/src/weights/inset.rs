//! Places in the flesh under the skin, as far from the skin as from the nearest bone: there bones are compared.
//!
//! Skin belongs to the bone that it wraps, which need not be the nearest one: at an armpit or a groin the skin of the
//! trunk is as near to the limb's bone. From the centre of the largest ball under it that holds no bone, the right one is
//! nearer.

use glam::DVec3;
use rayon::prelude::*;

use super::skin::Skin;
use super::solid::Solid;
use super::voxels::{SKIN, Voxels};
use crate::numeric::csr::Csr;

/// How far beneath and above a face is looked for flesh, in voxels.
const PROBE: f64 = 1.5;
/// Steps of the way through the flesh, in voxels.
const STEP: f64 = 0.5;
/// By which part steps grow beyond the diagonal of the lattice.
const GROWTH: f64 = 0.25;
/// Part of a shell's area, and of the angle about a point, by which faces must agree on the side where the flesh is.
const AGREEMENT: f64 = 0.1;
/// What a face with flesh on both sides has to say where an edge has more than two faces, against one with flesh on one.
const LEAST_SAY: f64 = 0.1;
/// Places per parallel piece.
const CHUNK: usize = 1024;

/// One place per point of the skin, and its depth under it. `rows` are the voxels that the points see, `nearest` per voxel
/// the distance to the nearest bone, `viewers` how the points look at them. Skin without an inside stays where it is; what
/// hovers takes the place of the skin below it.
pub fn places(solid: &Solid, skin: &Skin, rows: &Csr<(u32, f32)>, nearest: &[f32], viewers: &[u32]) -> (Vec<DVec3>, Vec<f32>) {
    let inward = inward(solid, skin);
    let voxels = &solid.voxels;
    let place = |point: usize| {
        let p = solid.points[point];
        let row = rows.row(point);
        let mean: DVec3 = row.iter().map(|&(voxel, weight)| f64::from(weight) * voxels.centre(voxel)).sum();
        let to_bone: f64 = row.iter().map(|&(voxel, weight)| f64::from(weight * nearest[voxel as usize])).sum::<f64>() + SKIN;
        let hovering = (voxels.least_distance(row, p) - 1.0).clamp(0.0, 1.0);
        let from = p + hovering * (mean - p);
        let along = (1.0 - hovering) * inward[point] + hovering * (mean - p).normalize_or_zero();
        let depth = depth(voxels, viewers[point], nearest, (from, to_bone), along);
        (from + depth * along, depth as f32)
    };
    (0..solid.points.len()).into_par_iter().with_min_len(CHUNK).map(place).unzip()
}

/// Per point the direction in which its flesh is, of length 1; shorter to 0 where it is on no side. Which way a shell is
/// turned does not matter, only where it is solid.
fn inward(solid: &Solid, skin: &Skin) -> Vec<DVec3> {
    let area_of = |face: usize| {
        let corners = skin.faces.row(face);
        let at = |i: usize| solid.points[corners[i % corners.len()] as usize];
        let mean = (0..corners.len()).map(at).sum::<DVec3>() / corners.len() as f64;
        let area = 0.5 * (0..corners.len()).map(|i| (at(i) - mean).cross(at(i + 1) - mean)).sum::<DVec3>();
        let probe = PROBE * area.normalize_or_zero();
        let is_flesh = |p: DVec3| f64::from(u8::from(solid.has(skin.shell_of_face[face], p)));
        (area, is_flesh(mean + probe) - is_flesh(mean - probe))
    };
    let areas: Vec<(DVec3, f64)> = (0..skin.faces.len()).into_par_iter().with_min_len(CHUNK).map(area_of).collect();
    // Faces of a shell are turned alike, so all of it has a say: in a narrow fold there is flesh on both sides.
    let mut votes = vec![(0.0, 0.0); skin.is_solid.len()];
    let mut sums = vec![(DVec3::ZERO, 0.0); solid.points.len()];
    for ((corners, &shell), &(area, side)) in skin.faces.rows().zip(&skin.shell_of_face).zip(&areas) {
        let least_say = if skin.is_manifold[shell as usize] { 1.0 } else { LEAST_SAY };
        let (vote, whole) = &mut votes[shell as usize];
        *vote += side * area.length();
        *whole += area.length();
        let at = |i: usize| solid.points[corners[i % corners.len()] as usize];
        for (i, &point) in corners.iter().enumerate() {
            // By angles: the direction does not depend on how large the faces about a point are. A wall inside of the flesh
            // does not turn the direction of the skin that it meets.
            let say = side.abs().max(least_say) * angle_between(at(i + 1) - at(i), at(i + corners.len() - 1) - at(i));
            sums[point as usize].0 += say * area.normalize_or_zero();
            sums[point as usize].1 += say;
        }
    }
    let direction = |(&(sum, whole), &shell): (&(DVec3, f64), &u32)| match votes.get(shell as usize) {
        Some(&(vote, all)) if whole > 0.0 && all > 0.0 => {
            (vote / (AGREEMENT * all)).clamp(-1.0, 1.0) * sum / sum.length().max(AGREEMENT * whole)
        }
        _ => DVec3::ZERO,
    };
    sums.iter().zip(&skin.shell_of_point).map(direction).collect()
}

fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// How far along a way into the flesh the nearest bone is as near as the skin; at most half of the way through. `start` is a
/// place of the skin and the distance to its nearest bone.
fn depth(voxels: &Voxels, viewer: u32, nearest: &[f32], start: (DVec3, f64), along: DVec3) -> f64 {
    let (from, mut to_bone) = start;
    let (mut way, mut depth) = (0.0, 0.0);
    loop {
        // No way is longer than the lattice, but for one that is on no side of its skin and leads nowhere.
        let step = STEP.max(GROWTH * (depth - voxels.diagonal()));
        let next = depth + step;
        while way < 2.0 * next {
            way += step;
            // The skin lies up to a voxel beside the solid.
            if way > 1.0 && !voxels.is_flesh(from + way * along, viewer) {
                way -= step;
                break;
            }
        }
        let found = distance_at(voxels, viewer, nearest, from + next * along).unwrap_or(to_bone);
        // From positive to negative: how much nearer the skin is than a bone.
        let (before, after) = (to_bone - depth, found - next);
        let reached = if after <= 0.0 { depth + step * (before / (before - after)).clamp(0.0, 1.0) } else { next };
        if after <= 0.0 || way < 2.0 * next {
            return reached.min(0.5 * way);
        }
        (depth, to_bone) = (next, found);
    }
}

/// The distance to the nearest bone between the centres of voxels; None where none is near.
fn distance_at(voxels: &Voxels, viewer: u32, nearest: &[f32], p: DVec3) -> Option<f64> {
    let low = (p - 0.5).floor();
    let part = p - 0.5 - low;
    let (mut sum, mut whole) = (0.0, 0.0);
    for corner in 0..8 {
        let at = [0, 1, 2].map(|axis| corner >> axis & 1);
        let voxel = voxels.at([0, 1, 2].map(|axis| low[axis] as i64 + at[axis]));
        let seen = voxels.nodes_in(voxel).filter(|&node| voxels.is_seen(node, viewer)).map(|node| nearest[node as usize]);
        let distance = seen.fold(f32::INFINITY, f32::min);
        if distance.is_finite() {
            let weight: f64 = (0..3).map(|axis| if at[axis] == 1 { part[axis] } else { 1.0 - part[axis] }).product();
            sum += weight * f64::from(distance);
            whole += weight;
        }
    }
    (whole > 0.0).then(|| sum / whole)
}
