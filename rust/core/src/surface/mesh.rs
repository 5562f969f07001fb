//! A mesh alone: its volume, and the gradient of it [MATH §1].

use glam::DVec3;

use crate::error::{Error, Result, check_finite};
use crate::surface::measures;
use crate::surface::topology::Topology;

/// A surface with its rest positions.
pub struct Mesh {
    topology: Topology,
    rest: Vec<DVec3>,
}

impl Mesh {
    /// See `Topology::new`.
    ///
    /// # Errors
    /// As `Topology::new`.
    pub fn new(rest: Vec<DVec3>, face_offsets: &[i32], face_corners: &[i32], weld_tolerance: f64) -> Result<Self> {
        let topology = Topology::new(&rest, face_offsets, face_corners, weld_tolerance)?;
        Ok(Self { topology, rest })
    }

    /// Welded faces, components and caps.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Rest positions, one per vertex.
    pub fn rest(&self) -> &[DVec3] {
        &self.rest
    }

    /// Signed volume of each component, 0 where not sound.
    ///
    /// # Errors
    /// Wrong length, positions that are not finite.
    pub fn component_volumes(&self, positions: &[DVec3]) -> Result<Vec<f64>> {
        Ok(measures::volumes(&self.topology, &self.centred_points(positions)?))
    }

    /// Derivative of the sum of component volumes by each vertex; coincident ones share that of their point.
    ///
    /// # Errors
    /// Wrong length, positions that are not finite.
    pub fn volume_gradient(&self, positions: &[DVec3]) -> Result<Vec<DVec3>> {
        let gradient = measures::gradient(&self.topology, &self.centred_points(positions)?);
        let of_vertex = |&point: &u32| {
            let count = self.topology.vertices_of_point.row(point as usize).len() as f64;
            gradient[point as usize] / count
        };
        Ok(self.topology.point_of_vertex.iter().map(of_vertex).collect())
    }

    /// Points about their mean: sums about it keep their digits far from the origin.
    pub(crate) fn centred_points(&self, positions: &[DVec3]) -> Result<Vec<DVec3>> {
        if positions.len() != self.rest.len() {
            return Err(Error::VertexCount { found: positions.len(), bound: self.rest.len() });
        }
        check_finite("positions", positions)?;
        let mut points = self.topology.points(positions);
        let centre = points.iter().copied().sum::<DVec3>() / points.len().max(1) as f64;
        for p in &mut points {
            *p -= centre;
        }
        Ok(points)
    }
}
