//! Where voxels lie: the box that is divided, and its division. Inside of it one voxel is the unit of length.

use glam::DVec3;

/// Room between the box of the surface and the border of the lattice, in voxels.
const MARGIN: f64 = 0.37;
/// Part of a voxel by which the longest side is shorter than its voxels. Not a simple number: models have round measures,
/// and where a flat surface lies exactly on voxel centres rounding would decide.
const TRIM: f64 = 0.381_966_011_250_105;

/// Bodies smaller than this are points: far places would be beyond all numbers of their voxels.
const LEAST_SIDE: f64 = 1e-30;

/// A plane of mirror symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Any point of it.
    pub point: DVec3,
    /// Of any length but 0.
    pub normal: DVec3,
}

impl Plane {
    /// The mirror image of a point.
    pub fn mirrored(&self, p: DVec3) -> DVec3 {
        p - self.normal * (2.0 * (p - self.point).dot(self.normal) / self.normal.length_squared())
    }
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    pub low: DVec3,
    pub high: DVec3,
}

impl Extent {
    /// Around some points; None when there are none.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        let start = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        let found = points.into_iter().fold(start, |e, p| Self { low: e.low.min(p), high: e.high.max(p) });
        (found.low.x <= found.high.x).then_some(found)
    }

    pub fn joined(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// With its mirror image, where the plane stands across an axis.
    pub fn mirrored_about(&self, plane: &Plane) -> Self {
        let [a, b] = [plane.mirrored(self.low), plane.mirrored(self.high)];
        let unit = plane.normal.normalize().abs();
        let across_an_axis = unit.max_element() > 1.0 - 1e-9;
        if across_an_axis { self.joined(&Self { low: a.min(b), high: a.max(b) }) } else { *self }
    }

    pub fn diagonal(&self) -> f64 {
        (self.high - self.low).length()
    }

    pub fn grown(&self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    pub fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// A division of space into voxels.
#[derive(Debug, Clone, Copy)]
pub struct Lattice {
    low: DVec3,
    /// Edge of a voxel, in the caller's units.
    pub size: f64,
    /// Voxels along each axis.
    pub dims: [usize; 3],
}

impl Lattice {
    /// `resolution` voxels along the longest side of the box, and the box in the middle: the same for a mirrored box. Even
    /// numbers of voxels, so that no centre lies in the middle, where bodies have seams.
    pub fn new(extent: &Extent, resolution: f64) -> Self {
        let sides = extent.high - extent.low;
        let longest = sides.max_element();
        let size = if longest > LEAST_SIDE { longest / (resolution - TRIM) } else { 1.0 };
        let dims = sides.to_array().map(|side| 2 * (0.5 * (side / size) + MARGIN).ceil().max(1.0) as usize);
        let half = DVec3::from_array(dims.map(|count| count as f64)) * (0.5 * size);
        Self { low: 0.5 * (extent.low + extent.high) - half, size, dims }
    }

    /// A place in voxels: voxel (i, j, k) is the cube from it to (i + 1, j + 1, k + 1).
    pub fn in_voxels(&self, p: DVec3) -> DVec3 {
        (p - self.low) / self.size
    }

    /// Number of voxels, solid or not.
    pub fn cell_count(&self) -> usize {
        self.dims.iter().product()
    }
}
