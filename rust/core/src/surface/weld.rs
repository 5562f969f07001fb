//! Importers split vertices at UV seams. Corners of open edges that coincide at rest are one point of the surface.

use glam::DVec3;

use crate::numeric::csr::Csr;
use crate::numeric::nearness::PointTree;
use crate::numeric::union_find::UnionFind;

/// Point of each vertex, numbered by first appearance: the identity where nothing is split.
pub struct Welding {
    /// (N,) point of each vertex.
    pub point_of_vertex: Vec<u32>,
    /// Distinct points.
    pub point_count: usize,
}

impl Welding {
    /// Welds vertices of open edges closer than `tolerance` times the diagonal of the box around `positions`.
    ///
    /// Vertices inside a closed shell are never welded: two shells may touch without becoming one.
    pub fn new(positions: &[DVec3], faces: &Csr<u32>, tolerance: f64) -> Self {
        let open = open_vertices(positions.len(), faces);
        let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let distance = if positions.is_empty() { 0.0 } else { (high - low).length() * tolerance };
        let mut sets = UnionFind::new(positions.len());
        let open: Vec<u32> = (0..positions.len() as u32).filter(|&vertex| open[vertex as usize]).collect();
        PointTree::new(positions, open).join_within(distance, &mut sets);
        let mut point_of_vertex = vec![u32::MAX; positions.len()];
        let mut point_count = 0;
        for vertex in 0..positions.len() {
            let root = sets.find(vertex as u32) as usize;
            if point_of_vertex[root] == u32::MAX {
                point_of_vertex[root] = point_count;
                point_count += 1;
            }
            point_of_vertex[vertex] = point_of_vertex[root];
        }
        Self { point_of_vertex, point_count: point_count as usize }
    }
}

/// Which vertices lie on an edge with one face only.
fn open_vertices(vertex_count: usize, faces: &Csr<u32>) -> Vec<bool> {
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(faces.values().len());
    for face in faces.rows() {
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            edges.push((a.min(b), a.max(b)));
        }
    }
    edges.sort_unstable();
    let mut open = vec![false; vertex_count];
    for run in edges.chunk_by(|a, b| a == b).filter(|run| run.len() == 1) {
        open[run[0].0 as usize] = true;
        open[run[0].1 as usize] = true;
    }
    open
}
