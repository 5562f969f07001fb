//! Skin in short: enough to tell how far two motions take it apart.

use glam::{DAffine3, DMat3, DVec3};

/// How much skin, its centre, and its second moments about it: how far two motions take it apart.
#[derive(Debug, Clone, Default)]
pub(crate) struct Moments {
    pub amount: f64,
    centre: DVec3,
    second: DMat3,
}

impl Moments {
    /// Of amounts at places.
    pub fn new(skin: &[(f64, DVec3)]) -> Self {
        let amount: f64 = skin.iter().map(|s| s.0).sum();
        let centre = skin.iter().map(|&(amount, p)| p * amount).sum::<DVec3>() / amount.max(f64::MIN_POSITIVE);
        let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        let second = skin.iter().fold(DMat3::ZERO, |sum, &(amount, p)| sum + outer(p - centre) * amount);
        Self { amount, centre, second }
    }

    /// Σ |a(p) − b(p)|² over the skin.
    pub fn apart(&self, a: &DAffine3, b: &DAffine3) -> f64 {
        let by = a.matrix3 - b.matrix3;
        let middle = a.transform_point3(self.centre) - b.transform_point3(self.centre);
        let spread = by * self.second;
        let around: f64 = spread.to_cols_array().iter().zip(by.to_cols_array()).map(|(s, b)| s * b).sum();
        around.max(0.0) + self.amount * middle.length_squared()
    }
}
