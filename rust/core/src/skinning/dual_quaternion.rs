//! Dual quaternions as Blender's Armature modifier makes and blends them, scale included.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::numeric::lanes::{self, V4, add, add_scaled, cross, mul, scale};

/// How far a matrix may be from orthonormal before its scale is split off.
const ORTHONORMAL_TOLERANCE: f64 = 1e-5;
/// How far axis lengths may be from 1, squared, before the scale is split off.
const SCALE_TOLERANCE_SQUARED: f64 = 1e-8;

/// Rotation, and translation with the scale's share of it, of one bone. Quaternions are (x, y, z, w).
#[derive(Debug, Clone, Copy)]
pub(crate) struct DualQuaternion {
    pub rotation: V4,
    /// Dual part at the point 0, and its slopes along x, y, z: 0 unless there is scale.
    pub dual: [V4; 4],
    pub has_scale: bool,
}

impl DualQuaternion {
    pub const IDENTITY: Self = Self { rotation: [0.0, 0.0, 0.0, 1.0], dual: [lanes::ZERO; 4], has_scale: false };

    /// The motion `channel` (pose · rest⁻¹) of a bone that rests at `rest`.
    pub fn new(rest: &DAffine3, channel: &DAffine3) -> Self {
        let posed = *channel * *rest;
        let lengths = DVec3::new(posed.matrix3.x_axis.length(), posed.matrix3.y_axis.length(), posed.matrix3.z_axis.length());
        let has_scale = !is_orthonormal(&channel.matrix3)
            || channel.matrix3.determinant() < 0.0
            || (lengths - 1.0).length_squared() > SCALE_TOLERANCE_SQUARED;
        if !has_scale || rest.matrix3.determinant() == 0.0 {
            return Self::rigid(rotation_of(&channel.matrix3), channel.translation);
        }
        let rotation = DMat3::from_quat(rotation_of(&orthogonalised_by_y(&posed.matrix3)));
        let rotated = DAffine3 { matrix3: rotation, translation: posed.translation };
        let rest_inverse = rest.inverse();
        let rigid = rotated * rest_inverse;
        let scale = *rest * (rotated.inverse() * posed) * rest_inverse;
        let mut result = Self::rigid(rotation_of(&rigid.matrix3), rigid.translation);
        // A point is first moved by the scale: a translation of its own, before the rotation.
        let [x, y, z, w] = result.rotation;
        let v = DVec3::new(x, y, z);
        let shifted = |shift: DVec3| {
            let vector = 0.5 * (shift * w + v.cross(shift));
            [vector.x, vector.y, vector.z, -0.5 * v.dot(shift)]
        };
        result.dual[0] = add(result.dual[0], shifted(scale.translation));
        result.dual[1] = shifted(scale.matrix3.x_axis - DVec3::X);
        result.dual[2] = shifted(scale.matrix3.y_axis - DVec3::Y);
        result.dual[3] = shifted(scale.matrix3.z_axis - DVec3::Z);
        result.has_scale = true;
        result
    }

    fn rigid(q: DQuat, t: DVec3) -> Self {
        let v = DVec3::new(q.x, q.y, q.z);
        let vector = 0.5 * (t * q.w + t.cross(v));
        Self {
            rotation: [q.x, q.y, q.z, q.w],
            dual: [[vector.x, vector.y, vector.z, -0.5 * t.dot(v)], lanes::ZERO, lanes::ZERO, lanes::ZERO],
            has_scale: false,
        }
    }

    /// The same motion with its rotation in the half space of `reference`: differences along a chain are then small.
    pub fn aligned_with(self, reference: &Self) -> Self {
        if lanes::sum(mul(self.rotation, reference.rotation)) >= 0.0 {
            return self;
        }
        Self { rotation: scale(self.rotation, -1.0), dual: self.dual.map(|part| scale(part, -1.0)), ..self }
    }

    /// Dual part at a point.
    #[inline(always)]
    pub fn dual_at(&self, p: V4) -> V4 {
        if !self.has_scale {
            return self.dual[0];
        }
        let slopes = add_scaled(add_scaled(scale(self.dual[1], p[0]), self.dual[2], p[1]), self.dual[3], p[2]);
        add(self.dual[0], slopes)
    }

    /// The affine map this dual quaternion is when alone.
    pub fn to_affine(self) -> DAffine3 {
        // A fixed rotation maps point and dual part together linearly: each column by itself keeps its digits.
        let column = |i: usize, axis: DVec3| lanes::to(transform(self.rotation, self.dual[i], lanes::from(axis)));
        DAffine3 {
            matrix3: DMat3::from_cols(column(1, DVec3::X), column(2, DVec3::Y), column(3, DVec3::Z)),
            translation: column(0, DVec3::ZERO),
        }
    }
}

/// A weighted sum of dual quaternions at one vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blend {
    rotation: V4,
    dual: V4,
}

impl Blend {
    pub const NONE: Self = Self { rotation: lanes::ZERO, dual: lanes::ZERO };

    /// Adds one bone; its sign is chosen against the sum so far, so the order of bones matters as in Blender.
    #[inline(always)]
    pub fn add(&mut self, bone: &DualQuaternion, weight: f64, p: V4) {
        let signed = if lanes::sum(mul(bone.rotation, self.rotation)) < 0.0 { -weight } else { weight };
        self.rotation = add_scaled(self.rotation, bone.rotation, signed);
        self.dual = add_scaled(self.dual, bone.dual_at(p), signed);
    }

    /// The blended motion of a point.
    #[inline(always)]
    pub fn transform(&self, p: V4) -> V4 {
        transform(self.rotation, self.dual, p)
    }

    /// A direction, turned.
    #[inline(always)]
    pub fn turn(&self, direction: V4) -> V4 {
        transform(self.rotation, lanes::ZERO, direction)
    }
}

/// Motion of a point by a dual quaternion of any length. One without rotation leaves the point in place.
#[inline(always)]
pub(crate) fn transform(rotation: V4, dual: V4, p: V4) -> V4 {
    let squares = mul(rotation, rotation);
    let vector_squared = (squares[0] + squares[1]) + squares[2];
    let length_squared = vector_squared + squares[3];
    if length_squared == 0.0 {
        return p;
    }
    let (w, v) = (rotation[3], [rotation[0], rotation[1], rotation[2], 0.0]);
    let (t0, t) = (dual[3], [dual[0], dual[1], dual[2], 0.0]);
    // (w² − v²) p + 2 (v·p) v + 2 w v×p + 2 (w t − t0 v + v×t), all over the squared length.
    let along = lanes::sum(mul(v, p));
    let turned = add(scale(v, along - t0), scale(add(t, cross(v, p)), w));
    let moved = add(turned, cross(v, t));
    let result = add_scaled(scale(p, squares[3] - vector_squared), moved, 2.0);
    scale(result, 1.0 / length_squared)
}

fn is_orthonormal(m: &DMat3) -> bool {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    [x.dot(y), x.dot(z), y.dot(z), x.length_squared() - 1.0, y.length_squared() - 1.0, z.length_squared() - 1.0]
        .iter()
        .all(|error| error.abs() <= ORTHONORMAL_TOLERANCE)
}

/// Rotation of a matrix by its normalised axes; a mirrored one is negated first.
fn rotation_of(m: &DMat3) -> DQuat {
    let unit = |v: DVec3| v.normalize_or_zero();
    let mut m = DMat3::from_cols(unit(m.x_axis), unit(m.y_axis), unit(m.z_axis));
    if m.determinant() < 0.0 {
        m = -m;
    }
    DQuat::from_mat3(&m).normalize()
}

/// Axes made orthogonal about y, with their lengths kept.
///
/// Blender compares a normalised y with an un-normalised x here; without that quirk results differ by up to 0.4.
fn orthogonalised_by_y(m: &DMat3) -> DMat3 {
    let lengths = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
    let (mut x, y, mut z) = (m.x_axis, m.y_axis.normalize_or_zero(), m.z_axis);
    if y.dot(x) < 1.0 {
        z = x.cross(y).normalize_or_zero();
        x = y.cross(z);
    } else if x.dot(z) < 1.0 {
        x = y.cross(z).normalize_or_zero();
        z = x.cross(y);
    } else {
        x = DVec3::new(y.y, y.z, y.x).cross(y).normalize_or_zero();
        z = x.cross(y);
    }
    DMat3::from_cols(x * lengths.x, y * lengths.y, z * lengths.z)
}
