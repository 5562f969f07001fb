//! The cotangent Laplacian of a polygon surface, safe on any mesh.
//!
//! Of the intrinsic Delaunay triangulation, so that weights are not negative and a diffused weight stays between the
//! weights it comes from; what is negative at borders is left out. Quads count as the mean of their two triangulations
//! and larger polygons as a fan about a point of their own.

use glam::DVec3;
use rayon::prelude::*;

use super::delaunay::{Triangulation, double_area};
use crate::numeric::csr::Csr;
use crate::surface::polygons::{Cut, cut};

/// Area of a triangle against its squared sides below which cotangents grow no further.
const SLIVER: f64 = 1e-4;
/// Weights below are rounding of corners on one circle.
const LEAST_WEIGHT: f64 = 1e-9;

/// Edges with their weights, masses of points. Points behind those of the mesh are the middles of polygons.
pub struct Laplacian {
    /// Smaller point, larger point, weight above 0; in order.
    pub edges: Vec<(u32, u32, f64)>,
    /// Third of the area about each point.
    pub masses: Vec<f64>,
    /// Corners of the polygon of each added point.
    pub polygons: Csr<u32>,
}

impl Laplacian {
    pub fn new(points: &[DVec3], faces: &Csr<u32>) -> Self {
        let mut points = points.to_vec();
        let mut polygons = Csr::default();
        let (mut triangles, mut quads) = (Vec::new(), Vec::new());
        for face in faces.rows() {
            match *face {
                [a, b, c] => triangles.push([a, b, c]),
                [a, b, c, d] => quads.push([a, b, c, d]),
                _ => match cut(&face.iter().map(|&p| points[p as usize]).collect::<Vec<_>>()) {
                    Cut::Ears(ears) => triangles.extend(ears.iter().map(|ear| ear.map(|i| face[i]))),
                    Cut::Fan(mean) => {
                        let middle = points.len() as u32;
                        points.push(mean);
                        polygons.push_row(face.iter().copied());
                        triangles.extend(face.iter().enumerate().map(|(i, &a)| [a, face[(i + 1) % face.len()], middle]));
                    }
                },
            }
        }
        let with_diagonal = |first: usize| {
            let half = move |q: &[u32; 4]| [0, 2].map(|turn| [0, 1, 2].map(|i| q[(first + turn + i) % 4]));
            Triangulation::new(&points, triangles.iter().copied().chain(quads.iter().flat_map(half)))
        };
        let both: Vec<Triangulation> = (0..if quads.is_empty() { 1 } else { 2 }).into_par_iter().map(with_diagonal).collect();
        let mut parts = Parts { masses: vec![0.0; points.len()], edges: Vec::new() };
        for triangulation in &both {
            for (corners, lengths) in triangulation.corners.iter().zip(&triangulation.lengths) {
                parts.add(*corners, *lengths, 1.0 / both.len() as f64);
            }
        }
        // A stable sort: sums are the same from any number of threads.
        parts.edges.par_sort_by_key(|edge| (edge.0, edge.1));
        let edges = parts
            .edges
            .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .map(|run| (run[0].0, run[0].1, run.iter().map(|edge| edge.2).sum::<f64>()))
            .filter(|edge| edge.2 > LEAST_WEIGHT)
            .collect();
        Self { edges, masses: parts.masses, polygons }
    }
}

struct Parts {
    masses: Vec<f64>,
    edges: Vec<(u32, u32, f64)>,
}

impl Parts {
    /// Half the cotangent of each angle goes to the edge across.
    fn add(&mut self, corners: [u32; 3], lengths: [f64; 3], share: f64) {
        let double_area = double_area(lengths);
        let squares = lengths.map(|l| l * l);
        let sum: f64 = squares.iter().sum();
        if sum == 0.0 {
            return;
        }
        let across = double_area.max(SLIVER * sum);
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            self.masses[p as usize] += share * double_area / 6.0;
            if p != q {
                self.edges.push((p.min(q), p.max(q), share * 0.25 * (sum - 2.0 * squares[i]) / across));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_the_mean_of_both_diagonals() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let mut faces = Csr::default();
        faces.push_row([0, 1, 2, 3]);
        let laplacian = Laplacian::new(&points, &faces);
        for (edge, ends) in laplacian.edges.iter().zip([(0, 1), (0, 3), (1, 2), (2, 3)]) {
            assert_eq!((edge.0, edge.1), ends);
            assert!((edge.2 - 0.5).abs() < 1e-12);
        }
        assert_eq!(laplacian.edges.len(), 4);
        assert!(laplacian.masses.iter().all(|mass| (mass - 0.25).abs() < 1e-12));
    }

    #[test]
    fn obtuse_flat_and_collapsed_triangles_give_finite_weights_that_are_not_negative() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 1e-9], [0.5, 0.1], [0.5, 0.1]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let mut faces = Csr::default();
        for face in [[0, 1, 2], [0, 1, 3], [2, 3, 4], [3, 4, 3]] {
            faces.push_row(face);
        }
        let laplacian = Laplacian::new(&points, &faces);
        assert!(laplacian.edges.iter().all(|edge| edge.2 > 0.0 && edge.2 < 1.0 / SLIVER));
        assert!(laplacian.masses.iter().all(|mass| mass.is_finite()));
    }
}
