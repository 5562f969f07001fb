//! Weights from distances, before the skin evens them out.

use rayon::prelude::*;

/// Distance, in voxels, below which bones are as good as touching.
const TOUCH: f32 = 0.5;
/// A bone counts where its part of the nearest bone's strength is above this.
const LEAST_STRENGTH: f64 = 1e-3;

/// How many times farther than the nearest bone a bone still counts.
pub fn range(falloff: f64) -> f64 {
    LEAST_STRENGTH.powf(-1.0 / falloff)
}

/// Turns distances, a column of `count` per bone, into weights that sum to 1 at each point: in proportion to
/// (stiffness / distance) ^ falloff, less what makes it fade to 0 at `range`. Continuous in the distances.
///
/// Returns the distance to the nearest bone, per point.
pub fn weights_from_distances(columns: &mut [f32], count: usize, stiffness: &[f64], falloff: f64) -> Vec<f32> {
    let mut nearest = vec![f32::INFINITY; count];
    let mut least = vec![f32::INFINITY; count];
    for (column, &stiffness) in columns.chunks_mut(count.max(1)).zip(stiffness) {
        for ((distance, nearest), least) in column.iter_mut().zip(&mut nearest).zip(&mut least) {
            *nearest = nearest.min(*distance);
            *distance = distance.hypot(TOUCH) / stiffness as f32;
            *least = least.min(*distance);
        }
    }
    columns.par_chunks_mut(count.max(1)).for_each(|column| {
        for (value, &least) in column.iter_mut().zip(&least) {
            let strength = (f64::from(least) / f64::from(*value)).powf(falloff) - LEAST_STRENGTH;
            *value = strength.max(0.0) as f32;
        }
    });
    let mut sums = vec![0.0f64; count];
    for column in columns.chunks(count.max(1)) {
        for (sum, &strength) in sums.iter_mut().zip(column) {
            *sum += f64::from(strength);
        }
    }
    columns.par_chunks_mut(count.max(1)).for_each(|column| {
        for (value, &sum) in column.iter_mut().zip(&sums) {
            *value = (f64::from(*value) / sum) as f32;
        }
    });
    nearest
}
