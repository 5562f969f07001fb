//! A surface at rest, as a core is made from it.

use glam::DVec3;

use crate::numeric::csr::Csr;

/// Points are slots of patches.
pub(crate) struct RestSurface {
    /// Per slot.
    pub places: Vec<DVec3>,
    /// Per slot: its part of the faces around it; 0 where it has none of its own.
    pub areas: Vec<f64>,
    /// Slots of the corners of each face, of sound shells and their caps.
    pub faces: Csr<u32>,
    /// Per component: its slots; those without any face are left out.
    pub slots_of_component: Csr<u32>,
}
