//! Heat flows over the skin: what is given per point is evened out over a length that is given per point.
//!
//! Two implicit steps, (2M/ℓ² + L) w = 2M/ℓ² w₀: exact for constants, so that sums stay 1, and without new extremes. One alone
//! leaves a crest in the slope of a step, two take less volume at the same stretch. One sparse Cholesky factor serves both, and
//! all bones.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Side};
use glam::DVec3;
use rayon::prelude::*;

use super::laplacian::Laplacian;
use crate::error::Result;

/// Columns that are solved together. Fixed: results never depend on the number of threads.
const COLUMNS: usize = 8;
/// Steps, each over a length of ℓ/√STEPS.
const STEPS: usize = 2;
/// Mass of points that have none, against the mean: they follow their neighbours.
const LEAST_MASS: f64 = 1e-9;

/// The factor of one surface.
pub struct Diffusion {
    factor: Llt<u32, f64>,
    /// 2M/ℓ², with the middles of polygons.
    masses_per_step: Vec<f64>,
    laplacian: Laplacian,
    count: usize,
}

impl Diffusion {
    /// `lengths` per point of the mesh, above 0, in the unit of the Laplacian; None where numbers are beyond factoring.
    pub fn new(laplacian: Laplacian, lengths: &[f64]) -> Option<Self> {
        let count = lengths.len();
        let size = laplacian.masses.len();
        let mean = laplacian.masses.iter().sum::<f64>() / size as f64;
        let mean_length = |corners: &[u32]| corners.iter().map(|&p| lengths[p as usize]).sum::<f64>() / corners.len() as f64;
        let lengths = lengths.iter().copied().chain(laplacian.polygons.rows().map(mean_length));
        let masses_per_step: Vec<f64> = laplacian
            .masses
            .iter()
            .zip(lengths)
            .map(|(&mass, length)| if mean > 0.0 { STEPS as f64 * mass.max(LEAST_MASS * mean) / (length * length) } else { 1.0 })
            .collect();
        let mut diagonal = masses_per_step.clone();
        let mut entries = Vec::with_capacity(size + laplacian.edges.len());
        for &(a, b, weight) in &laplacian.edges {
            diagonal[a as usize] += weight;
            diagonal[b as usize] += weight;
            entries.push(Triplet::new(b, a, -weight));
        }
        entries.extend(diagonal.iter().enumerate().map(|(i, &value)| Triplet::new(i as u32, i as u32, value)));
        let matrix = SparseColMat::<u32, f64>::try_new_from_triplets(size, size, &entries).ok()?;
        let order = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok()?;
        let factor = Llt::try_new_with_symbolic(order, matrix.as_ref(), Side::Lower).ok()?;
        Some(Self { factor, masses_per_step, laplacian, count })
    }

    /// Diffuses columns of weights in place. `step` is called with the part that is done.
    pub fn run(&self, columns: &mut [f32], mut step: impl FnMut(f64) -> Result<()>) -> Result<()> {
        let total = columns.len().max(1);
        let mut done = 0;
        for batch in columns.chunks_mut(self.count.max(1) * COLUMNS * rayon::current_num_threads()) {
            batch.par_chunks_mut(self.count.max(1) * COLUMNS).for_each(|columns| self.solve(columns));
            done += batch.len();
            step(done as f64 / total as f64)?;
        }
        Ok(())
    }

    fn solve(&self, columns: &mut [f32]) {
        // Most bones are nowhere near most parts: columns of zeros stay zeros.
        let mut filled: Vec<&mut [f32]> = columns.chunks_mut(self.count).filter(|column| column.iter().any(|w| *w != 0.0)).collect();
        let mut values = Vec::with_capacity(self.masses_per_step.len() * filled.len());
        for column in &filled {
            self.append(&mut values, column.iter().map(|&w| f64::from(w)));
        }
        self.flow(&mut values);
        for (column, values) in filled.iter_mut().zip(values.chunks(self.masses_per_step.len())) {
            for (w, value) in column.iter_mut().zip(values) {
                *w = value.max(0.0) as f32;
            }
        }
    }

    /// Vectors per point, evened out.
    pub fn vectors(&self, vectors: &[DVec3]) -> Vec<DVec3> {
        let mut values = Vec::with_capacity(3 * self.masses_per_step.len());
        for axis in 0..3 {
            self.append(&mut values, vectors.iter().map(|v| v[axis]));
        }
        self.flow(&mut values);
        let at = |axis: usize, point: usize| values[axis * self.masses_per_step.len() + point];
        (0..self.count).map(|point| DVec3::new(at(0, point), at(1, point), at(2, point))).collect()
    }

    /// Appends a column, with the middles of polygons.
    fn append(&self, values: &mut Vec<f64>, column: impl Iterator<Item = f64>) {
        let start = values.len();
        values.extend(column);
        for corners in self.laplacian.polygons.rows() {
            values.push(corners.iter().map(|&p| values[start + p as usize]).sum::<f64>() / corners.len() as f64);
        }
        debug_assert_eq!(values.len() - start, self.masses_per_step.len());
    }

    /// All steps, of whole columns.
    fn flow(&self, values: &mut [f64]) {
        let size = self.masses_per_step.len();
        for _ in 0..STEPS {
            for column in values.chunks_mut(size) {
                column.iter_mut().zip(&self.masses_per_step).for_each(|(value, mass)| *value *= mass);
            }
            let count = values.len() / size;
            self.factor.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(values, size, count));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::csr::Csr;

    #[test]
    fn a_step_gets_the_width_asked_for_at_less_volume_and_stretch_than_an_exponential() {
        // A strip of squares along x, the step in its middle.
        let (count, length) = (400u32, 12.0);
        let points: Vec<DVec3> = (0..2 * count).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
        let mut faces = Csr::default();
        for i in 0..count - 1 {
            faces.push_row([2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]);
        }
        let diffusion = Diffusion::new(Laplacian::new(&points, &faces), &vec![length; points.len()]).expect("numbers are sound");
        let mut column: Vec<f32> = (0..2 * count).map(|i| f32::from(u8::from(i / 2 >= count / 2))).collect();
        diffusion.run(&mut column, |_| Ok(())).expect("nothing cancels");
        let w: Vec<f64> = column.iter().step_by(2).map(|&w| f64::from(w)).collect();
        let slope = |pair: &[f64]| pair[1] - pair[0];
        let middle = f64::from(count / 2) - 0.5;
        let moment: f64 = w.windows(2).enumerate().map(|(i, pair)| slope(pair) * (i as f64 + 0.5 - middle).powi(2)).sum();
        assert!(((0.5 * moment).sqrt() / length - 1.0).abs() < 0.01);
        // 175/1024 for two steps, 3/16 for one.
        let volume: f64 = w.iter().map(|w| w * (1.0 - w)).sum();
        let stretch: f64 = w.windows(2).map(|pair| slope(pair).powi(2)).sum();
        assert!((volume * stretch - 175.0 / 1024.0).abs() < 1e-3, "{}", volume * stretch);
        assert!(w.windows(2).all(|pair| slope(pair) > -1e-6));
    }
}
