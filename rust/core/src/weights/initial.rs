//! Weights from distances, before the skin evens them out.

use rayon::prelude::*;

/// Distance, in voxels, below which bones are as good as touching.
const TOUCH: f32 = 0.5;
/// A bone counts where its part of the nearest bone's strength is above this.
const LEAST_STRENGTH: f64 = 1e-3;

/// Shortest length of diffusion, in voxels: steps of the voxels do not show.
const LEAST_LENGTH: f64 = 1.0;
/// Longest: several times the finest lattice. Where bones are farther, weights are as good as even over the whole skin, and
/// longer lengths would only cost digits.
const LONGEST_LENGTH: f64 = 1e4;
/// Terms of the series for `own_length`; half of the last one is its error.
const TERMS: u32 = 1000;

/// Length over which weights are still to be evened out, in voxels: squares of lengths add up, and these weights are no
/// steps. `nearest` is the distance to the nearest bone from `depth` under the skin. Where flesh is round about its bone they
/// are the same; in a thin wall, or far from its bone, the skin's way is the smaller part. `own`: of `own_length`.
pub fn length_left(smoothing: f64, own: f64, nearest: f32, depth: f32) -> f64 {
    let (nearest, depth) = (f64::from(nearest), f64::from(depth));
    let (whole, own) = (smoothing * 0.5 * (depth + nearest), own * nearest);
    (whole * whole - own * own).max(LEAST_LENGTH * LEAST_LENGTH).sqrt().min(LONGEST_LENGTH)
}

/// Length of the diffusion that would turn a step into the weights of two bones in line, at distance 1 from both: half of the
/// second moment of their slope is √(Σ (−1)ᵏ⁺¹ / (k·falloff/2 − 1)) squared. Without end at a falloff of 2 and less.
pub fn own_length(falloff: f64) -> f64 {
    if falloff <= 2.0 {
        return f64::INFINITY;
    }
    let term = |k: u32| 1.0 / (f64::from(k) * 0.5 * falloff - 1.0);
    let sum: f64 = (1..=TERMS).rev().map(|k| if k % 2 == 1 { term(k) } else { -term(k) }).sum();
    (sum + 0.5 * term(TERMS + 1)).sqrt()
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_two_bones_in_line_are_as_wide_as_their_own_length_says() {
        // Beside the second bone, at distance 1 from the line of both: the first ends at 0. In voxels, many to a distance.
        for falloff in [6.0, 12.0, 24.0] {
            let (voxels, step) = (1000.0f64, 1e-3);
            let places: Vec<f64> = (0..8000).map(|i| (f64::from(i) + 0.5) * step).collect();
            let far = places.iter().map(|x| (voxels * x.hypot(1.0)) as f32);
            let mut columns: Vec<f32> = far.chain(std::iter::repeat_n(voxels as f32, places.len())).collect();
            weights_from_distances(&mut columns, places.len(), &[1.0, 1.0], falloff);
            // A diffusion over a length turns a step into weights whose slope has twice its square as second moment; by
            // parts, on both sides of the border.
            let moment: f64 = places.iter().zip(&columns).map(|(x, w)| 4.0 * x * f64::from(*w) * step).sum();
            let width = (0.5 * moment).sqrt();
            assert!((width / own_length(falloff) - 1.0).abs() < 0.03, "{falloff}: {width}");
        }
    }

    #[test]
    fn own_length_is_that_of_known_sums_and_grows_as_bones_hold_farther() {
        assert!((own_length(4.0).powi(2) - std::f64::consts::FRAC_PI_4).abs() < 1e-6);
        assert!([2.0, 2.5, 3.0, 6.0, 12.0, 32.0].windows(2).all(|two| own_length(two[0]) > own_length(two[1])));
    }

    #[test]
    fn a_round_limb_is_evened_out_over_what_the_weights_lack() {
        let own = own_length(12.0);
        let whole = length_left(0.83, own, 10.0, 10.0).hypot(own * 10.0);
        assert!((whole - 8.3).abs() < 1e-9);
        assert_eq!(length_left(0.1, own, 10.0, 10.0), LEAST_LENGTH);
        assert_eq!(length_left(0.83, f64::INFINITY, 10.0, 10.0), LEAST_LENGTH);
    }
}
