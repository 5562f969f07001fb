//! From columns of weights to what a vertex keeps: as many influences as allowed, locked ones as they were, sum 1.

use rayon::prelude::*;

/// Weights fade below this part of the whole: nobody sees them, and skinning pays for them.
const LEAST_WEIGHT: f64 = 1e-3;
/// Vertices per parallel piece.
const CHUNK: usize = 1024;

/// Weights of vertices; those of vertex v are `offsets[v]..offsets[v + 1]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WeightRows {
    /// (N + 1,)
    pub offsets: Vec<i32>,
    /// Bone of each influence.
    pub bones: Vec<i32>,
    /// In 0..1.
    pub weights: Vec<f64>,
}

impl WeightRows {
    /// Influences of one vertex.
    pub fn row(&self, vertex: usize) -> impl Iterator<Item = (i32, f64)> {
        let range = self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize;
        self.bones[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }
}

/// What limits rows.
pub struct Limits<'a> {
    /// Influences that a vertex may have.
    pub max_influences: usize,
    /// Bone of each column.
    pub bones: &'a [u32],
    /// Influences per vertex that stay as they are.
    pub locked: Option<&'a WeightRows>,
}

impl Limits<'_> {
    /// Rows of vertices from columns of `count` points.
    pub fn rows(&self, columns: &[f32], count: usize, point_of_vertex: &[u32]) -> WeightRows {
        let piece = |(chunk, points): (usize, &[u32])| {
            let mut rows = WeightRows::default();
            let mut row = Vec::new();
            for (i, &point) in points.iter().enumerate() {
                row.clear();
                let values = columns.chunks(count).zip(self.bones);
                row.extend(values.map(|(column, &bone)| (f64::from(column[point as usize]), bone)).filter(|w| w.0 > 0.0));
                self.finish(chunk * CHUNK + i, &mut row, &mut rows);
            }
            rows
        };
        let pieces: Vec<WeightRows> = point_of_vertex.par_chunks(CHUNK).enumerate().map(piece).collect();
        let mut all = WeightRows { offsets: vec![0], ..WeightRows::default() };
        for piece in pieces {
            let start = all.bones.len() as i32;
            all.offsets.extend(piece.offsets.iter().map(|end| start + end));
            all.bones.extend(piece.bones);
            all.weights.extend(piece.weights);
        }
        all
    }

    fn finish(&self, vertex: usize, row: &mut Vec<(f64, u32)>, rows: &mut WeightRows) {
        let mut left = 1.0;
        let mut room = self.max_influences;
        for (bone, weight) in self.locked.into_iter().flat_map(|locked| locked.row(vertex)).filter(|w| w.1 > 0.0) {
            rows.bones.push(bone);
            rows.weights.push(weight);
            left -= weight;
            room -= usize::from(room > 1);
        }
        // Rounding of stored weights is no room for others.
        if left > 1e-6 {
            limit(row, room);
            for &(weight, bone) in &*row {
                rows.bones.push(bone as i32);
                rows.weights.push(weight * left);
            }
        }
        rows.offsets.push(rows.bones.len() as i32);
    }
}

/// Keeps the largest `room` weights of a row, largest first, and makes their sum 1.
///
/// Weights fade to 0 as they come down to the first one that is left out: w (1 − (c/w)⁴) changes large weights little and
/// is continuous where two bones change places.
fn limit(row: &mut Vec<(f64, u32)>, room: usize) {
    row.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let sum: f64 = row.iter().map(|w| w.0).sum();
    let cut = row.get(room).map_or(0.0, |next| next.0).max(LEAST_WEIGHT * sum);
    row.truncate(room);
    let faded = |w: f64| w * (1.0 - (cut / w).powi(4)).max(0.0);
    if row.first().is_some_and(|largest| faded(largest.0) > LEAST_WEIGHT * cut) {
        for entry in row.iter_mut() {
            entry.0 = faded(entry.0);
        }
        row.retain(|entry| entry.0 > 0.0);
    }
    let sum: f64 = row.iter().map(|w| w.0).sum();
    for entry in row.iter_mut() {
        entry.0 /= sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limited(weights: &[f64], room: usize) -> Vec<(f64, u32)> {
        let mut row: Vec<(f64, u32)> = weights.iter().enumerate().map(|(i, &w)| (w, i as u32)).collect();
        limit(&mut row, room);
        row
    }

    #[test]
    fn rows_change_little_where_two_bones_change_places() {
        let before = limited(&[0.5, 0.3, 0.1 + 1e-9, 0.1 - 1e-9], 3);
        let after = limited(&[0.5, 0.3, 0.1 - 1e-9, 0.1 + 1e-9], 3);
        let of = |row: &[(f64, u32)], bone: u32| row.iter().find(|w| w.1 == bone).map_or(0.0, |w| w.0);
        for bone in 0..4 {
            assert!((of(&before, bone) - of(&after, bone)).abs() < 1e-7);
        }
    }

    #[test]
    fn equal_weights_beyond_the_limit_still_sum_to_one() {
        for row in [limited(&[0.2; 5], 4), limited(&[1.0], 4), limited(&[0.7, 0.3], 1), limited(&[0.5, 0.5], 1)] {
            assert!(!row.is_empty());
            assert!((row.iter().map(|w| w.0).sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
