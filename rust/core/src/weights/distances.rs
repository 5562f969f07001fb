//! Distances of places under the skin to all bones, inside of the body: straight where the bone sees the voxels about a
//! place, else by the voxels.

use glam::DVec3;
use rayon::prelude::*;

use super::geodesic::Front;
use super::inset;
use super::sampling::Sampler;
use super::skin::Skin;
use super::solid::Solid;
use super::sources::{FARTHEST, Source, contact, near_sources, sources, straight_distance};
use super::voxels::{SKIN, Voxels};
use crate::error::{Error, Result};
use crate::numeric::csr::Csr;

/// How far bones see while only the nearest one is wanted, in voxels.
const VIEW: f64 = 4.0;
/// Voxels beyond the bound of a bone's influence where distances are still found, for places that see them.
const SLACK: f32 = 6.0;

/// Distances in voxels, a column per bone.
pub struct Distances {
    pub columns: Vec<f32>,
    /// How deep under the skin they were taken, per point.
    pub depths: Vec<f32>,
    /// Per shell, whether a bone reaches it inside of the body.
    pub is_reached: Vec<bool>,
    pub memory_bytes: usize,
}

impl Distances {
    /// `bones` with their numbers among all, which the solid knows. `range` is how many times farther than its nearest bone a bone may be and still count: no farther ones are found.
    /// `step` is called with the part that is done.
    pub fn inside(
        solid: &Solid,
        skin: &Skin,
        bones: &[(u32, [DVec3; 2])],
        range: f64,
        mut step: impl FnMut(f64) -> Result<()>,
    ) -> Result<Self> {
        let voxels = &solid.voxels;
        let source = |&(index, bone): &(u32, [DVec3; 2])| {
            let ends = bone.map(|p| solid.lattice.in_voxels(p));
            Source { index, ends, near: contact(voxels, index, ends) }
        };
        let bones: Vec<Source> = bones.par_iter().map(source).collect();
        let starts: Vec<Vec<(u32, f32)>> = bones.par_iter().map(|bone| near_sources(voxels, bone, VIEW)).collect();
        let mut reached_parts = vec![false; voxels.part_count];
        for &(voxel, _) in starts.iter().flatten() {
            reached_parts[voxels.part[voxel as usize] as usize] = true;
        }
        let mut front = Front::default();
        front.spread(voxels, &starts.concat(), None);
        let viewers: Vec<u32> = skin.shell_of_point.iter().map(|&shell| voxels.viewer(shell)).collect();
        let sampler = Sampler::new(voxels, &reached_parts, &front.distances);
        let (places, depths) = inset::places(solid, skin, &sampler.rows(&solid.points, &viewers), &front.distances, &viewers);
        let rows = sampler.rows(&places, &viewers);
        drop(sampler);
        step(0.1)?;
        let bounds = bounds(voxels, front, &rows, range as f32);
        let count = places.len();
        let mut columns = zeros(count, bones.len())?;
        let batch = rayon::current_num_threads();
        for (first, columns) in columns.chunks_mut(batch * count.max(1)).enumerate() {
            columns.par_chunks_mut(count.max(1)).enumerate().for_each_init(Front::default, |front, (bone, column)| {
                let bone = &bones[first * batch + bone];
                let seen = sources(voxels, bone, |voxel| bounds[voxel as usize]);
                front.spread(voxels, &seen, Some(&bounds));
                let mut is_seen = vec![false; voxels.len()];
                for &(voxel, distance) in &seen {
                    is_seen[voxel as usize] = front.distances[voxel as usize] == distance;
                }
                for ((distance, row), &place) in column.iter_mut().zip(rows.rows()).zip(&places) {
                    let straight = straight_distance(bone.ends, place) as f32;
                    let beyond = (voxels.least_distance(row, place) - SKIN).max(0.0) as f32;
                    let by_way_of = |&(voxel, weight): &(u32, f32)| {
                        weight * if is_seen[voxel as usize] { straight } else { front.distances[voxel as usize] + beyond }
                    };
                    *distance = row.iter().map(by_way_of).sum();
                }
            });
            step(0.1 + 0.9 * ((first + 1) * batch).min(bones.len()) as f64 / bones.len() as f64)?;
        }
        let fronts = batch * voxels.len() * 4 * size_of::<f32>();
        let memory_bytes = size_of_val(&*columns)
            + size_of_val(&*depths)
            + rows.memory_bytes()
            + fronts
            + starts.iter().map(|s| size_of_val(&**s)).sum::<usize>();
        Ok(Self { columns, depths, is_reached: solid.shells_in(&reached_parts), memory_bytes })
    }

    /// Straight distances, where there is no body at all.
    pub fn straight(points: &[DVec3], bones: &[[DVec3; 2]], shell_count: usize, unit: f64) -> Result<Self> {
        let mut columns = zeros(points.len(), bones.len())?;
        for (column, &bone) in columns.chunks_mut(points.len().max(1)).zip(bones) {
            for (distance, &p) in column.iter_mut().zip(points) {
                *distance = (straight_distance(bone, p) / unit).min(FARTHEST) as f32;
            }
        }
        let memory_bytes = size_of_val(&*columns);
        Ok(Self { columns, depths: vec![0.0; points.len()], is_reached: vec![false; shell_count], memory_bytes })
    }
}

/// A column of zeros per bone.
fn zeros(points: usize, bones: usize) -> Result<Vec<f32>> {
    let mut columns = Vec::new();
    columns.try_reserve_exact(points * bones).map_err(|_| Error::TooManyWeights { points, bones })?;
    columns.resize(points * bones, 0.0);
    Ok(columns)
}

/// Per voxel the largest distance of a bone that may still count at some place beyond it: with m the distance to the
/// nearest bone, which `front` has found, the maximum over voxels y that places see of range m(y) − distance(x, y). Found
/// by one front that starts from all y.
fn bounds(voxels: &Voxels, mut front: Front, rows: &Csr<(u32, f32)>, range: f32) -> Vec<f32> {
    let mut is_seen = vec![false; voxels.len()];
    for &(voxel, _) in rows.values() {
        is_seen[voxel as usize] = true;
    }
    let mut limits: Vec<(u32, f32)> = (0..voxels.len() as u32)
        .filter(|&voxel| is_seen[voxel as usize])
        .map(|voxel| (voxel, range * front.distances[voxel as usize] + SLACK))
        .filter(|limit| limit.1.is_finite())
        .collect();
    // About the top of each connected part: of a part far from all bones, the digits of one beside a bone would be lost.
    let mut tops = vec![0.0f32; voxels.part_count];
    for &(voxel, limit) in &limits {
        let top = &mut tops[voxels.part[voxel as usize] as usize];
        *top = top.max(limit);
    }
    for (voxel, limit) in &mut limits {
        *limit = tops[voxels.part[*voxel as usize] as usize] - *limit;
    }
    front.spread(voxels, &limits, None);
    front.distances.iter().zip(&voxels.part).map(|(below, &part)| tops[part as usize] - below).collect()
}
