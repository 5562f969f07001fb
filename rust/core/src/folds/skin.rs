//! All faces of a mesh as triangles of welded points: what can pass through what.

use glam::DVec3;

use super::tree::Tree;
use crate::numeric::csr::Csr;
use crate::surface::polygons::ears;

/// A face with more corners than this is cut as a fan from its first: cutting ears takes too long.
const EARS_MAX: usize = 64;

/// Triangles of all shells, sound or not.
#[derive(Debug, Clone)]
pub(crate) struct Skin {
    pub triangles: Vec<[u32; 3]>,
    /// Points along edges of triangles.
    pub neighbours: Csr<u32>,
    pub tree: Tree,
}

impl Skin {
    /// Cut at rest, and so for good: quads from their first corner to the third as Blender draws them, unless that leaves the
    /// quad; larger faces by their shortest ears.
    pub fn new(faces: &Csr<u32>, points: &[DVec3]) -> Self {
        let mut triangles = Vec::new();
        for face in faces.rows() {
            cut(face, points, &mut triangles);
        }
        let mut edges: Vec<(u32, u32)> =
            triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).flat_map(|(a, b)| [(a, b), (b, a)]).collect();
        edges.sort_unstable();
        edges.dedup();
        let neighbours = Csr::from_pairs(points.len(), &edges);
        let tree = Tree::new(&triangles, points);
        Self { triangles, neighbours, tree }
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.triangles) + self.neighbours.memory_bytes() + self.tree.memory_bytes()
    }
}

fn cut(face: &[u32], points: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    let fan = |first: usize| (1..face.len() - 1).map(move |i| [first, first + i, first + i + 1].map(|k| face[k % face.len()]));
    match face.len() {
        4 => {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| points[face[k] as usize]);
            let leaves = (b - a).cross(c - a).dot((c - a).cross(d - a)) < 0.0;
            triangles.extend(fan(usize::from(leaves)));
        }
        5..=EARS_MAX => {
            let corners: Vec<DVec3> = face.iter().map(|&p| points[p as usize]).collect();
            triangles.extend(ears(&corners).into_iter().map(|t| t.map(|k| face[k])));
        }
        // Welding leaves no face with fewer than three.
        _ => triangles.extend(fan(0)),
    }
}
