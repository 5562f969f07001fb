//! Vectors padded to four lanes, the last one 0: what the sweeps over faces compute with. Compilers turn them into SIMD.

use glam::DVec3;

use crate::skinning::Columns;

/// (x, y, z, 0).
pub(crate) type V4 = [f64; 4];

pub(crate) const ZERO: V4 = [0.0; 4];

#[inline(always)]
pub(crate) fn from(v: DVec3) -> V4 {
    [v.x, v.y, v.z, 0.0]
}

#[inline(always)]
pub(crate) fn to(v: V4) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

#[inline(always)]
pub(crate) fn add(a: V4, b: V4) -> V4 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[inline(always)]
pub(crate) fn sub(a: V4, b: V4) -> V4 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[inline(always)]
pub(crate) fn mul(a: V4, b: V4) -> V4 {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}

#[inline(always)]
pub(crate) fn scale(a: V4, s: f64) -> V4 {
    [a[0] * s, a[1] * s, a[2] * s, a[3] * s]
}

/// a + b·s.
#[inline(always)]
pub(crate) fn add_scaled(a: V4, b: V4, s: f64) -> V4 {
    add(a, scale(b, s))
}

#[inline(always)]
pub(crate) fn cross(a: V4, b: V4) -> V4 {
    yzx(sub(mul(a, yzx(b)), mul(yzx(a), b)))
}

/// Sum of the lanes.
#[inline(always)]
pub(crate) fn sum(a: V4) -> f64 {
    (a[0] + a[1]) + (a[2] + a[3])
}

#[inline(always)]
fn yzx(a: V4) -> V4 {
    [a[1], a[2], a[0], a[3]]
}

/// Image of a point under an affine map.
#[inline(always)]
pub(crate) fn transform(m: &Columns, p: V4) -> V4 {
    add_scaled(add_scaled(add_scaled(m[3], m[0], p[0]), m[1], p[1]), m[2], p[2])
}

/// Four vectors side by side: one lane each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Four {
    x: V4,
    y: V4,
    z: V4,
}

impl Four {
    #[inline(always)]
    pub fn from_rows([a, b, c, d]: [V4; 4]) -> Self {
        Self { x: [a[0], b[0], c[0], d[0]], y: [a[1], b[1], c[1], d[1]], z: [a[2], b[2], c[2], d[2]] }
    }

    #[inline(always)]
    pub fn to_rows(self) -> [V4; 4] {
        let Self { x, y, z } = self;
        [[x[0], y[0], z[0], 0.0], [x[1], y[1], z[1], 0.0], [x[2], y[2], z[2], 0.0], [x[3], y[3], z[3], 0.0]]
    }

    #[inline(always)]
    pub fn add(self, b: Self) -> Self {
        Self { x: add(self.x, b.x), y: add(self.y, b.y), z: add(self.z, b.z) }
    }

    #[inline(always)]
    pub fn sub(self, b: Self) -> Self {
        Self { x: sub(self.x, b.x), y: sub(self.y, b.y), z: sub(self.z, b.z) }
    }

    #[inline(always)]
    pub fn scale(self, s: f64) -> Self {
        Self { x: scale(self.x, s), y: scale(self.y, s), z: scale(self.z, s) }
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self {
            x: sub(mul(self.y, b.z), mul(self.z, b.y)),
            y: sub(mul(self.z, b.x), mul(self.x, b.z)),
            z: sub(mul(self.x, b.y), mul(self.y, b.x)),
        }
    }

    #[inline(always)]
    pub fn dot(self, b: Self) -> V4 {
        add(add(mul(self.x, b.x), mul(self.y, b.y)), mul(self.z, b.z))
    }
}
