//! How one joint turns in one frame, taken apart into a swing and a twist, and how far the law of flesh follows it.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::limb::Limb;
use super::settings::Flesh;
use super::smoothstep;

/// The law fades out over this angle before a half turn, where neither axis nor direction of a turn can be told.
const FADE: f64 = FRAC_PI_6;
/// It follows a bone's map whose determinant, over its longest column cubed, is above the second, and none below the first.
const FLATTENED: [f64; 2] = [0.02, 0.15];
/// A turn by less than this is none: rounding of matrices in single precision.
const ANGLE_MIN: f64 = 1e-7;

/// Largest shifts to the inside and from the outside, in radii, and the bends up to which they grow.
const INSIDE: f64 = 0.45;
const OUTSIDE: f64 = 0.16;
const OUTSIDE_END: f64 = 2.0 * PI / 3.0;
/// Growth across, over 1 − cos of half a bend, and the bend up to which it grows: beyond it the limbs have met.
const WIDER: f64 = 0.5;
const WIDER_END: f64 = 7.0 * PI / 12.0;
/// A joint that lies so far out of its section's middle, as a part of its reach, has bone right under the outer skin.
const BONY: f64 = 0.4;

/// One joint in one frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Turn {
    /// How far the law follows, 0..1: the artist's amount, faded.
    pub amount: f64,
    /// About the limb's axis: the part of the twist that is turned by angle.
    pub twist: f64,
    /// Part of it that is spread along the bone.
    pub spread: f64,
    /// What the bone does that the one above does not, at rest.
    pub local: DAffine3,
    pub bend: Bend,
}

/// The bend of a joint: axes at rest, in the bone above, and posed; armature space.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bend {
    pub angle: f64,
    /// sin of the bend, up to 90°, times the amount: how much of the skin around is this joint's.
    pub strength: f64,
    /// Along the limb, to the inside of the bend, and along its axis.
    pub along: DVec3,
    pub inside: DVec3,
    pub axis: DVec3,
    /// Displacements by one radius.
    pub posed_along: DVec3,
    pub posed_inside: DVec3,
    pub posed_axis: DVec3,
    /// 1 / reach of the section to the inside, the outside, along the axis and against it.
    pub sides: [f64; 4],
    /// Shifts in radii, and growth across.
    pub to_inside: f64,
    pub from_outside: f64,
    pub wider: f64,
    /// Part of the crease that closes.
    pub crease: f64,
}

impl Turn {
    /// `above` and `own`: what the bones do, pose · rest⁻¹; `holds`: how far the law may be told of these.
    pub fn new(limb: &Limb, settings: &Flesh, above: &DAffine3, own: &DAffine3, holds: f64) -> Self {
        let amount = settings.amount * holds;
        if amount <= 0.0 {
            return Self::default();
        }
        if above == own {
            return Self { amount, local: DAffine3::IDENTITY, ..Self::default() };
        }
        let soundness = |m: &DMat3| {
            let longest = m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
            let volume = m.determinant() / longest.powi(3);
            if volume.is_nan() { 0.0 } else { smoothstep((volume - FLATTENED[0]) / (FLATTENED[1] - FLATTENED[0])) }
        };
        let sound = soundness(&above.matrix3) * soundness(&own.matrix3);
        if sound <= 0.0 {
            return Self::default();
        }
        let local = above.inverse() * *own;
        let Some(turn) = turn_of(&local.matrix3) else { return Self::default() };
        let along_axis = turn.xyz().dot(limb.axis);
        let twist = 2.0 * along_axis.atan2(turn.w);
        let swing = turn * DQuat::from_axis_angle(limb.axis, -twist);
        // In 0..180°, as long as the scalar part is not negative.
        let swing = if swing.w < 0.0 { -swing } else { swing };
        let twist = wrapped(twist);
        let angle = 2.0 * swing.xyz().length().atan2(swing.w);
        let fade = |angle: f64| 1.0 - smoothstep((angle - (PI - FADE)) / FADE);
        let amount = amount * sound * fade(angle);
        let twist = if twist.abs() > ANGLE_MIN { twist * fade(twist.abs()) * amount } else { 0.0 };
        let spread = settings.spread_twist * limb.slender;
        let mut result = Self { amount, twist, spread, local, bend: Bend::default() };
        if let Some(axis) = swing.xyz().try_normalize().filter(|_| angle > ANGLE_MIN && amount > 0.0) {
            result.bend = Bend::new(limb, settings, above, axis, angle, amount);
        }
        result
    }

    pub fn is_still(&self) -> bool {
        self.twist == 0.0 && self.bend.strength == 0.0
    }

    /// Part of the twist that a point takes.
    pub fn share(&self, [blended, along]: [f32; 2]) -> f64 {
        let (blended, along) = (f64::from(blended), f64::from(along));
        blended + (along - blended) * self.spread
    }

    /// How much of a turn it is: a measure for what it may cost.
    pub fn extent(&self) -> f64 {
        (1.0 - self.twist.cos()) + (1.0 - self.bend.angle.cos()) * self.amount
    }
}

impl Bend {
    fn new(limb: &Limb, settings: &Flesh, above: &DAffine3, axis: DVec3, angle: f64, amount: f64) -> Self {
        let along = limb.along.reject_from_normalized(axis).normalize_or(limb.axis);
        let inside = axis.cross(along);
        let sides = [limb.reach(inside), limb.reach(-inside), limb.reach(axis), limb.reach(-axis)];
        // A section without extent to one side has nothing there to move.
        let inverse = sides.map(|side| side.max(1e-3 * limb.radius).recip());
        let off = (limb.head - limb.middle).dot(inside) * inverse[1];
        let softness = settings.outside.unwrap_or((1.0 + off.min(0.0) / BONY).clamp(0.0, 1.0));
        let half = DQuat::from_axis_angle(axis, 0.5 * angle);
        let sine = angle.min(FRAC_PI_2).sin();
        Self {
            angle,
            strength: sine * amount,
            along,
            inside,
            axis,
            posed_along: above.matrix3 * (half * along) * limb.radius,
            posed_inside: above.matrix3 * (half * inside) * limb.radius,
            posed_axis: above.matrix3 * axis * limb.radius,
            sides: inverse,
            to_inside: INSIDE * sine * (sides[0] / limb.radius).min(1.0) * amount,
            from_outside: OUTSIDE * softness * (1.5 * angle.min(OUTSIDE_END)).sin() * amount,
            wider: WIDER * (1.0 - (0.5 * angle.min(WIDER_END)).cos()) * amount,
            crease: if limb.runs_on { settings.crease * amount } else { 0.0 },
        }
    }
}

/// In −180°..180°.
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - 2.0 * PI
    } else if angle < -PI {
        angle + 2.0 * PI
    } else {
        angle
    }
}

/// The turn in a map, by Newton's iteration of its polar decomposition; `None` where that finds none.
fn turn_of(m: &DMat3) -> Option<DQuat> {
    let mut r = *m;
    for _ in 0..30 {
        let next = (r + r.inverse().transpose()) * 0.5;
        let step = next - r;
        r = next;
        if step.to_cols_array().iter().all(|s| s.abs() < 1e-14) {
            break;
        }
    }
    (r.is_finite() && r.determinant() > 0.5).then(|| DQuat::from_mat3(&r).normalize())
}
