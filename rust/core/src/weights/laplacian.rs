//! The cotangent Laplacian of a polygon surface, safe on any mesh.
//!
//! Weights of edges are never negative, so that a diffused weight stays between the weights it comes from. Quads count
//! as the mean of their two triangulations and larger polygons as a fan about a point of their own.

use glam::DVec3;
use rayon::prelude::*;

use super::polygons::{Cut, cut};
use crate::csr::Csr;

/// Area of a triangle against its squared sides below which cotangents grow no further.
const SLIVER: f64 = 1e-4;

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
        let mut all = Parts { points: points.to_vec(), masses: vec![0.0; points.len()], edges: Vec::new() };
        let mut polygons = Csr::default();
        for face in faces.rows() {
            match *face {
                [a, b, c] => all.add([a, b, c], 1.0),
                [a, b, c, d] => {
                    for triangle in [[a, b, c], [c, d, a], [b, c, d], [d, a, b]] {
                        all.add(triangle, 0.5);
                    }
                }
                _ => match cut(&face.iter().map(|&p| points[p as usize]).collect::<Vec<_>>()) {
                    Cut::Ears(ears) => ears.iter().for_each(|ear| all.add(ear.map(|i| face[i]), 1.0)),
                    Cut::Fan(mean) => {
                        let middle = all.points.len() as u32;
                        all.points.push(mean);
                        all.masses.push(0.0);
                        polygons.push_row(face.iter().copied());
                        for (i, &a) in face.iter().enumerate() {
                            all.add([a, face[(i + 1) % face.len()], middle], 1.0);
                        }
                    }
                },
            }
        }
        // A stable sort: sums are the same from any number of threads.
        all.edges.par_sort_by_key(|edge| (edge.0, edge.1));
        let edges = all
            .edges
            .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .map(|run| (run[0].0, run[0].1, run.iter().map(|edge| edge.2).sum::<f64>()))
            .filter(|edge| edge.2 > 0.0)
            .collect();
        Self { edges, masses: all.masses, polygons }
    }
}

struct Parts {
    points: Vec<DVec3>,
    masses: Vec<f64>,
    edges: Vec<(u32, u32, f64)>,
}

impl Parts {
    /// Half the cotangent of each angle goes to the edge across.
    fn add(&mut self, triangle: [u32; 3], share: f64) {
        let [a, b, c] = triangle.map(|p| self.points[p as usize]);
        let double_area = (b - a).cross(c - a).length();
        let squares = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
        if squares == 0.0 {
            return;
        }
        let across = double_area.max(SLIVER * squares);
        for i in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|k| triangle[(i + k) % 3]);
            let [at, left, right] = [p, q, r].map(|p| self.points[p as usize]);
            self.masses[p as usize] += share * double_area / 6.0;
            if q != r {
                self.edges.push((q.min(r), q.max(r), share * 0.5 * (left - at).dot(right - at) / across));
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
        assert_eq!(laplacian.edges, vec![(0, 1, 0.5), (0, 3, 0.5), (1, 2, 0.5), (2, 3, 0.5)]);
        assert_eq!(laplacian.masses, vec![0.25; 4]);
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
