//! Dual quaternions as Blender's Armature modifier makes and blends them, scale included.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

/// How far a matrix may be from orthonormal before its scale is split off.
const ORTHONORMAL_TOLERANCE: f64 = 1e-5;
/// How far axis lengths may be from 1, squared, before the scale is split off.
const SCALE_TOLERANCE_SQUARED: f64 = 1e-8;

/// Rotation and translation of one bone, with its scale apart. Components are (w, x, y, z).
#[derive(Debug, Clone, Copy)]
pub(crate) struct DualQuaternion {
    rotation: DVec4,
    translation: DVec4,
    scale: Option<DAffine3>,
}

impl DualQuaternion {
    pub const IDENTITY: Self = Self { rotation: DVec4::X, translation: DVec4::ZERO, scale: None };

    /// The motion `channel` (pose · rest⁻¹) of a bone that rests at `rest`.
    pub fn new(rest: &DAffine3, channel: &DAffine3) -> Self {
        let posed = *channel * *rest;
        let lengths = DVec3::new(posed.matrix3.x_axis.length(), posed.matrix3.y_axis.length(), posed.matrix3.z_axis.length());
        let has_scale = !is_orthonormal(&channel.matrix3)
            || channel.matrix3.determinant() < 0.0
            || (lengths - 1.0).length_squared() > SCALE_TOLERANCE_SQUARED;
        if !has_scale || rest.matrix3.determinant() == 0.0 {
            return Self::rigid(rotation_of(&channel.matrix3), channel.translation, None);
        }
        let rotation = DMat3::from_quat(rotation_of(&orthogonalised_by_y(&posed.matrix3)));
        let rotated = DAffine3 { matrix3: rotation, translation: posed.translation };
        let rest_inverse = rest.inverse();
        let rigid = rotated * rest_inverse;
        let scale = *rest * (rotated.inverse() * posed) * rest_inverse;
        Self::rigid(rotation_of(&rigid.matrix3), rigid.translation, Some(scale))
    }

    fn rigid(q: DQuat, t: DVec3, scale: Option<DAffine3>) -> Self {
        let v = DVec3::new(q.x, q.y, q.z);
        let vector = 0.5 * (t * q.w + t.cross(v));
        Self { rotation: DVec4::new(q.w, q.x, q.y, q.z), translation: DVec4::new(-0.5 * t.dot(v), vector.x, vector.y, vector.z), scale }
    }

    /// The affine map this dual quaternion is when alone.
    pub fn to_affine(self) -> DAffine3 {
        let map = |p: DVec3| {
            let mut blend = Blend::default();
            blend.add(&self, 1.0, p);
            blend.transform(p)
        };
        let origin = map(DVec3::ZERO);
        DAffine3 { matrix3: DMat3::from_cols(map(DVec3::X) - origin, map(DVec3::Y) - origin, map(DVec3::Z) - origin), translation: origin }
    }
}

/// A weighted sum of dual quaternions at one vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Blend {
    rotation: DVec4,
    translation: DVec4,
}

impl Blend {
    /// Adds one bone; its sign is chosen against the sum so far, so the order of bones matters as in Blender.
    #[inline]
    pub fn add(&mut self, bone: &DualQuaternion, weight: f64, p: DVec3) {
        let mut dual = bone.translation;
        if let Some(scale) = &bone.scale {
            // The pivot's shift under the bone's scale, as a translation before the rotation.
            let shift = scale.transform_point3(p) - p;
            let (w, v) = (bone.rotation.x, DVec3::new(bone.rotation.y, bone.rotation.z, bone.rotation.w));
            let vector = 0.5 * (shift * w + v.cross(shift));
            dual += DVec4::new(-0.5 * v.dot(shift), vector.x, vector.y, vector.z);
        }
        let signed = if bone.rotation.dot(self.rotation) < 0.0 { -weight } else { weight };
        self.rotation += bone.rotation * signed;
        self.translation += dual * signed;
    }

    /// The blended motion of a point. A blend without rotation leaves it in place.
    #[inline]
    pub fn transform(&self, p: DVec3) -> DVec3 {
        let length_squared = self.rotation.length_squared();
        if length_squared == 0.0 {
            return p;
        }
        let (w, v) = (self.rotation.x, DVec3::new(self.rotation.y, self.rotation.z, self.rotation.w));
        let (t0, t) = (self.translation.x, DVec3::new(self.translation.y, self.translation.z, self.translation.w));
        let rotated = p * (w * w - v.length_squared()) + 2.0 * (v * v.dot(p) + v.cross(p) * w);
        let moved = 2.0 * (t * w - v * t0 + v.cross(t));
        (rotated + moved) / length_squared
    }
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
