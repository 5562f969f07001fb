//! The fields that give volume back, one per joint and component, and how much of each [RHC09 §4, MATH §2–3].

use glam::{DAffine3, DMat3, DVec3};

use crate::fields::joint::{Joint, Shares};
use crate::fields::supports::Supports;
use crate::skinning::motions::Motions;

/// Sine of the bend at which half of the volume follows the joint's frame, half needs none.
const FRAME_BEND: f64 = 0.2;
/// Steepest slope of a displacement along the limb: folds finer than they are high would be teeth.
const SLOPE_MAX: f64 = 0.8;
/// An axis, or a profile, whose capacity is below this part of the whole one hands its share over, smoothly.
const HOLD_MIN: f64 = 1e-3;
/// A vicinity whose capacity is less than this part of its shell's counts as none.
const SHELL_PART_MIN: f64 = 1e-9;
/// Where a mask leaves less than this part of a vicinity's capacity, volume goes to the whole shell, smoothly: pinned skin
/// cannot take it, and the little that is left should not take all.
const FREE_PART_MIN: f64 = 0.05;
/// Volume that a flex of 1 bulges by, over that of the vicinity, and what it adds to the largest displacement, over that.
const FLEX_VOLUME: f64 = 0.1;
const FLEX_HEIGHT: f64 = 1.5;
/// Losses below this part of the vicinity's volume are rounding.
const ROUNDING: f64 = 1e-9;

/// How one joint's field lies in space in one frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FieldFrame {
    pub origin: DVec3,
    /// e0, e1, e2.
    pub axes: [DVec3; 3],
    pub inverse_length: f64,
    /// One over the volume of the joint's vicinity.
    inverse_volume: f64,
    /// Part of the volume that goes along the axes.
    pub frame_part: f64,
    /// How that part is shared.
    shares: Shares,
    /// How far folds have set in, 0..1.
    folded: f64,
    /// Volume that the shape adds, and all of the vicinity gives.
    flex: f64,
    displacement_max: f64,
    pub is_active: bool,
}

impl FieldFrame {
    /// The frame of a joint in this pose; `volume` is what it is to give back.
    pub fn new(motions: &Motions, joint: usize, settings: &Joint, supports: &Supports, volume: f64) -> Self {
        let (tree, extents) = (&motions.tree, supports.extents);
        let parent = motions.channels[tree.parents[joint] as usize];
        let length = supports.lengths[joint] * parent.matrix3.determinant().abs().cbrt();
        let mut frame = Self {
            origin: motions.channels[joint].transform_point3(tree.heads[joint]) - motions.palette.origin,
            inverse_length: 1.0 / length,
            inverse_volume: (extents.vicinity_volume * length.powi(3)).recip(),
            displacement_max: extents.displacement_max * length,
            is_active: (volume != 0.0 || settings.flex > 0.0) && length > 0.0 && length.is_finite(),
            shares: settings.shares,
            ..Self::default()
        };
        frame.flex = settings.flex * FLEX_VOLUME / frame.inverse_volume;
        let automatic = settings.shares.automatic;
        if settings.profiles.is_none() && automatic == 1.0 {
            frame.displacement_max *= 1.0 + FLEX_HEIGHT * settings.flex;
            return frame;
        }
        if let Some(profiles) = &settings.profiles {
            let mut steepness = profiles.axes[0].steepness();
            if let Some((folded, loss)) = &profiles.folded {
                frame.folded = (frame.relative(volume) / loss).min(1.0);
                steepness += (folded[0].steepness() - steepness) * frame.folded;
            }
            frame.displacement_max = frame.displacement_max.min(SLOPE_MAX / steepness.max(SLOPE_MAX) * length);
        }
        frame.displacement_max *= 1.0 + FLEX_HEIGHT * settings.flex;
        (frame.axes, frame.frame_part) = axes_of_bend(motions, joint);
        if settings.profiles.is_none() && automatic > 0.0 {
            // The bell is the same without axes, and its least displacement needs none.
            frame.frame_part *= 1.0 - automatic;
            frame.shares = Shares::along(settings.shares.axes.map(|share| share / (1.0 - automatic)));
        }
        frame
    }

    /// The same some part of the way to another origin, and with e0 turned to another direction about e1.
    pub fn turn_to(&mut self, origin: DVec3, along: DVec3, part: f64) {
        self.origin += (origin - self.origin) * part;
        let [e0, e1, _] = self.axes;
        let across = along.reject_from(e1.normalize_or(along.any_orthonormal_vector()));
        if let (true, Some(turned)) = (self.frame_part > 0.0, (e0 + (across.normalize_or(e0) - e0) * part).try_normalize()) {
            self.axes = [turned, e1, e1.cross(turned)];
        }
    }

    /// The frame of another field of the same joint, after one that moved points by up to `displacement`.
    pub fn after(&self, displacement: f64) -> Self {
        Self { displacement_max: (self.displacement_max - displacement).max(0.0), flex: 0.0, ..*self }
    }

    /// Parts of the volume for e0, e1, e2 and the frame-free rest, each solved on the mesh so far.
    pub fn ordered_shares(&self, capacity: &Capacity) -> [f64; 4] {
        let total: f64 = capacity.along.iter().sum();
        if total <= 0.0 {
            return [0.0, 0.0, 0.0, 1.0];
        }
        let part = self.frame_part;
        let along = |axis: usize| (self.shares.axes[axis] + self.shares.automatic * (capacity.along[axis] / total)) * part;
        [along(0), along(1), along(2), 1.0 - part]
    }

    /// The frame of one step of `ordered_shares`, and the step's share.
    pub fn for_step(&self, step: usize, share: f64) -> Self {
        let shares = Shares::along(std::array::from_fn(|axis| f64::from(u8::from(axis == step))));
        Self { frame_part: if step < 3 { 1.0 } else { 0.0 }, shares, flex: self.flex * share, ..*self }
    }

    /// A volume over that of the joint's vicinity.
    pub fn relative(&self, volume: f64) -> f64 {
        volume.abs() * self.inverse_volume
    }

    /// How far folds have set in, 0..1.
    pub fn folded(&self) -> f64 {
        self.folded
    }

    /// Whether any of the volume goes along the axes.
    pub fn has_axes(&self) -> bool {
        self.frame_part > 0.0
    }
}

/// What a field could do: per unit of coefficient, the volume it adds and the most it moves a point.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Capacity {
    pub along: [f64; 3],
    pub bell: f64,
    pub all: f64,
    /// `all` without the mask.
    pub unmasked: f64,
    pub along_most: [f64; 3],
    pub bell_most: f64,
    pub all_most: f64,
}

impl Capacity {
    /// Part of the volume that stays in the vicinity; 1 without a mask.
    fn free_part(&self) -> f64 {
        let free = (self.all / (FREE_PART_MIN * self.unmasked)).min(1.0);
        free * free * (3.0 - 2.0 * free)
    }

    /// Adds another part of the same field, whose sums are in units of `unit`.
    pub fn join(&mut self, other: &Self, unit: f64) {
        for axis in 0..3 {
            self.along[axis] += other.along[axis] * unit;
            self.along_most[axis] = self.along_most[axis].max(other.along_most[axis]);
        }
        self.bell += other.bell * unit;
        self.all += other.all * unit;
        self.unmasked += other.unmasked * unit;
        self.bell_most = self.bell_most.max(other.bell_most);
        self.all_most = self.all_most.max(other.all_most);
    }
}

/// A joint's field in one component, ready to be applied: displacement = matrix · gradient, by the heights of
/// the profile, the bell, and the whole vicinity.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Field {
    pub shaped: DMat3,
    pub bell: f64,
    pub all: f64,
    /// Volume the field adds, to first order.
    pub volume: f64,
    /// Bound on the displacement.
    pub displacement: f64,
    pub is_capped: bool,
}

impl Field {
    /// The field that adds `volume`, shaped as far as the cap on displacements allows. What it leaves (`volume` minus
    /// the field's own) is for a wider one: that of the whole shell, whose capacity is `shell`.
    pub fn new(frame: &FieldFrame, capacity: &Capacity, shell: f64, volume: f64) -> Self {
        let field = Self::shaped(frame, capacity, shell, volume);
        if field.is_usable() { field } else { Self { shaped: DMat3::ZERO, is_capped: true, ..Self::default() } }
    }

    /// Whether single precision can hold it.
    fn is_usable(&self) -> bool {
        let coefficients = self.shaped.to_cols_array();
        coefficients.iter().chain([&self.bell, &self.all, &self.volume]).all(|c| c.abs() < f64::from(f32::MAX))
    }

    fn shaped(frame: &FieldFrame, capacity: &Capacity, shell: f64, volume: f64) -> Self {
        let mut field = Self { shaped: DMat3::ZERO, ..Self::default() };
        let free = capacity.free_part();
        let is_rounding = frame.relative(volume) <= ROUNDING;
        let is_masked = capacity.all < capacity.unmasked && shell > 0.0 && !is_rounding;
        let trust = |part: f64, whole: f64| part * part / (part * part + (HOLD_MIN * whole).powi(2));
        let total: f64 = capacity.along.iter().sum();
        let own_capacity = if frame.frame_part > 0.5 { total } else { capacity.bell };
        // A profile that a mask has taken away is as good as too narrow.
        field.is_capped = is_masked && (free < 1.0 || trust(own_capacity, capacity.all) < 0.5);
        let volume = volume * free;
        let bulge = volume + frame.flex * free;
        if capacity.all <= SHELL_PART_MIN * shell || capacity.all <= 0.0 {
            return field;
        }
        let most = frame.displacement_max;
        if frame.frame_part > 0.0 && total > 0.0 {
            let wanted = bulge * frame.frame_part * trust(total, capacity.all);
            let shares = frame.shares.axes;
            let trusted: [f64; 3] = std::array::from_fn(|i| trust(capacity.along[i], total));
            // The automatic share goes to all axes by their capacity, and so does what an axis that hardly has any cannot take.
            let missing: f64 = shares.iter().zip(trusted).map(|(share, trusted)| share * (1.0 - trusted)).sum();
            let by_capacity = (missing + frame.shares.automatic) / total;
            let alpha: [f64; 3] = std::array::from_fn(|i| {
                let own = if capacity.along[i] > 0.0 { shares[i] * trusted[i] / capacity.along[i] } else { 0.0 };
                wanted * (own + by_capacity)
            });
            let bound = (0..3).map(|i| (alpha[i] * capacity.along_most[i]).powi(2)).sum::<f64>().sqrt();
            let kept = part_within(most, bound);
            field.is_capped |= kept < 1.0;
            field.displacement += kept * bound;
            field.volume += kept * (0..3).map(|i| alpha[i] * capacity.along[i]).sum::<f64>();
            for (e, a) in frame.axes.iter().zip(alpha) {
                field.shaped += DMat3::from_cols(*e * e.x, *e * e.y, *e * e.z) * (a * kept);
            }
        }
        if capacity.bell > 0.0 {
            let wanted = bulge * (1.0 - frame.frame_part) * trust(capacity.bell, capacity.all);
            let bound = (wanted / capacity.bell * capacity.bell_most).abs();
            let kept = part_within(most, bound);
            field.is_capped |= kept < 1.0;
            field.displacement += kept * bound;
            field.bell = kept * wanted / capacity.bell;
            field.volume += kept * wanted;
        }
        let wanted = volume - field.volume;
        let bound = (wanted / capacity.all * capacity.all_most).abs();
        let kept = part_within(most, bound);
        field.displacement += kept * bound;
        field.all = kept * wanted / capacity.all;
        field.volume += kept * wanted;
        field
    }
}

/// e0, e1, e2 of a joint in this pose, and the part w of its volume that goes along them; a straight one has no axes.
pub(crate) fn axes_of_bend(motions: &Motions, joint: usize) -> ([DVec3; 3], f64) {
    let [along, own] = directions(motions, joint);
    if let (Some(e0), Some(direction)) = (along, own) {
        let bend = e0.cross(direction);
        if let Some(e1) = bend.try_normalize() {
            let sine_squared = bend.length_squared();
            return ([e0, e1, e1.cross(e0)], sine_squared / (sine_squared + FRAME_BEND * FRAME_BEND));
        }
    }
    ([DVec3::ZERO; 3], 0.0)
}

/// Axes for a joint that has none of its own: e0 along the parent, else along the joint's own body, else x.
pub(crate) fn axes_of_no_bend(motions: &Motions, joint: usize) -> [DVec3; 3] {
    let [along, own] = directions(motions, joint);
    let e0 = along.or(own).unwrap_or(DVec3::X);
    let e1 = e0.any_orthonormal_vector();
    [e0, e1, e1.cross(e0)]
}

/// Unit vectors along the parent and along the joint's own body, in this pose.
fn directions(motions: &Motions, joint: usize) -> [Option<DVec3>; 2] {
    let tree = &motions.tree;
    let parent = &motions.channels[tree.parents[joint] as usize];
    let turned = |map: &DAffine3, v: Option<DVec3>| v.and_then(|v| (map.matrix3 * v).try_normalize());
    [turned(parent, tree.along_parent[joint]), turned(&motions.channels[joint], tree.along_own[joint])]
}

fn part_within(most: f64, bound: f64) -> f64 {
    if bound > most { most / bound } else { 1.0 }
}
