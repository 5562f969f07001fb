//! The mesh as a surface that encloses a volume: welding, shells, patches, and the volume itself [MATH §1].

pub(crate) mod delaunay;
pub(crate) mod diffusion;
pub(crate) mod laplacian;
pub(crate) mod measures;
pub(crate) mod mesh;
pub(crate) mod patches;
pub(crate) mod polygons;
pub(crate) mod strips;
pub(crate) mod sweeps;
pub(crate) mod topology;
pub(crate) mod volume;
pub(crate) mod weld;
