//! All meshes that get weights together, as one list of welded points and oriented faces.

use glam::DVec3;

use crate::error::Result;
use crate::numeric::csr::Csr;
use crate::surface::topology::OrientedFaces;

/// Corners of open edges closer than this part of the diagonal are one point, as in `Mesh`.
const WELD_TOLERANCE: f64 = 1e-6;
/// Shell of a point without faces.
pub const NO_SHELL: u32 = u32::MAX;

/// One mesh, in the space of the bones.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// (N,) vertices.
    pub positions: &'a [DVec3],
    /// (F + 1,) where the corners of each face start.
    pub face_offsets: &'a [i32],
    /// (C,) vertex of each corner.
    pub face_corners: &'a [i32],
    /// Part of the body; otherwise its points take from the nearest place of the body.
    pub is_solid: bool,
}

/// Points and faces of all meshes.
pub struct Skin {
    /// Vertices of all meshes one after the other: the point of each.
    pub point_of_vertex: Vec<u32>,
    pub points: Vec<DVec3>,
    pub faces: Csr<u32>,
    pub shell_of_face: Vec<u32>,
    pub shell_of_point: Vec<u32>,
    /// Per shell, whether it is part of the body.
    pub is_solid: Vec<bool>,
    /// Per shell, whether no edge has more than two faces.
    pub is_manifold: Vec<bool>,
}

impl Skin {
    pub fn new(surfaces: &[Surface]) -> Result<Self> {
        let (mut point_of_vertex, mut points, mut faces) = (Vec::new(), Vec::new(), Csr::default());
        let (mut shell_of_face, mut is_solid, mut is_manifold) = (Vec::new(), Vec::new(), Vec::new());
        for surface in surfaces {
            let oriented = OrientedFaces::new(surface.positions, surface.face_offsets, surface.face_corners, WELD_TOLERANCE)?;
            let (first_point, first_shell) = (points.len() as u32, is_solid.len() as u32);
            point_of_vertex.extend(oriented.point_of_vertex.iter().map(|point| first_point + point));
            points.extend(oriented.points);
            for face in oriented.faces.rows() {
                faces.push_row(face.iter().map(|point| first_point + point));
            }
            shell_of_face.extend(oriented.shell_of_face.iter().map(|shell| first_shell + shell));
            is_manifold.extend(oriented.is_manifold);
            is_solid.resize(is_manifold.len(), surface.is_solid);
        }
        let mut shell_of_point = vec![NO_SHELL; points.len()];
        for (face, &shell) in faces.rows().zip(&shell_of_face) {
            for &point in face {
                shell_of_point[point as usize] = shell;
            }
        }
        Ok(Self { point_of_vertex, points, faces, shell_of_face, shell_of_point, is_solid, is_manifold })
    }

    /// Faces of each shell.
    pub fn faces_of_shell(&self) -> Csr<u32> {
        let pairs: Vec<(u32, u32)> = self.shell_of_face.iter().enumerate().map(|(face, &shell)| (shell, face as u32)).collect();
        Csr::from_pairs(self.is_solid.len(), &pairs)
    }
}
