//! Heat flows over the skin: weights are evened out over a length that is given per point.
//!
//! One implicit step, (M/ℓ² + L) w = M/ℓ² w₀: exact for constants, so that sums stay 1, and without new extremes. One sparse
//! Cholesky factor serves all bones.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Side};
use rayon::prelude::*;

use super::laplacian::Laplacian;
use crate::error::Result;

/// Columns that are solved together. Fixed: results never depend on the number of threads.
const COLUMNS: usize = 8;
/// Mass of points that have none, against the mean: they follow their neighbours.
const LEAST_MASS: f64 = 1e-9;

/// The factor of one surface.
pub struct Diffusion {
    factor: Llt<u32, f64>,
    /// M/ℓ², with the middles of polygons.
    hold: Vec<f64>,
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
        let hold: Vec<f64> = laplacian
            .masses
            .iter()
            .zip(lengths)
            .map(|(&mass, length)| if mean > 0.0 { mass.max(LEAST_MASS * mean) / (length * length) } else { 1.0 })
            .collect();
        let mut diagonal = hold.clone();
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
        Some(Self { factor, hold, laplacian, count })
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
        let size = self.hold.len();
        // Most bones are nowhere near most parts: columns of zeros stay zeros.
        let mut filled: Vec<&mut [f32]> = columns.chunks_mut(self.count).filter(|column| column.iter().any(|w| *w != 0.0)).collect();
        let mut values = Vec::with_capacity(size * filled.len());
        for column in &filled {
            let start = values.len();
            values.extend(column.iter().zip(&self.hold).map(|(&w, hold)| f64::from(w) * hold));
            for (corners, hold) in self.laplacian.polygons.rows().zip(&self.hold[self.count..]) {
                let mean = corners.iter().map(|&p| f64::from(column[p as usize])).sum::<f64>() / corners.len() as f64;
                values.push(mean * hold);
            }
            debug_assert_eq!(values.len() - start, size);
        }
        let right = MatMut::from_column_major_slice_mut(&mut values, size, filled.len());
        self.factor.solve_in_place_with_conj(Conj::No, right);
        for (column, values) in filled.iter_mut().zip(values.chunks(size)) {
            for (w, value) in column.iter_mut().zip(values) {
                *w = value.max(0.0) as f32;
            }
        }
    }
}
