//! Rotation-minimising frames from place to place, by double reflection with exact tangents (Wang, Jüttler, Zheng, Liu:
//! *Computation of rotation minimizing frames*, 2008; fourth order).

use glam::DVec3;

use crate::spine::quintic::Quintic;

/// 1 + cosine below which a tangent counts as turned back, where no least rotation is.
pub(crate) const TURNED_BACK: f64 = 1e-9;

/// The normal at the end of a cell, of a frame with `normal` at its start; tangents there and here.
pub(crate) fn carried(part: &Quintic, [start, end]: [DVec3; 2], normal: DVec3) -> DVec3 {
    // The cell's start is its origin: differences of positions far off would lose digits.
    let mut local = *part;
    local.0[0] = DVec3::ZERO;
    let [middle, velocity, ..] = local.derivatives(0.5);
    let tangent = velocity.normalize_or(start);
    let halfway = double_reflection(middle, [start, tangent], normal);
    double_reflection(local.at(1.0) - middle, [tangent, end], halfway)
}

/// The normal at the other end of a chord, of a frame with `normal` at this one; tangents here and there.
fn double_reflection(chord: DVec3, tangents: [DVec3; 2], normal: DVec3) -> DVec3 {
    let reflected = |v: DVec3, mirror: DVec3| {
        let square = mirror.length_squared();
        if square > f64::MIN_POSITIVE { v - (2.0 * mirror.dot(v) / square) * mirror } else { v }
    };
    let [here, there] = tangents;
    let mirror = there - reflected(here, chord);
    across(reflected(reflected(normal, chord), mirror), there)
}

/// The part of a vector across a unit vector, of length 1; any if there is none.
pub(crate) fn across(v: DVec3, unit: DVec3) -> DVec3 {
    let part = v - v.dot(unit) * unit;
    // Once more, so that it is across to rounding also where little was left.
    let part = part.try_normalize().map(|part| part - part.dot(unit) * unit);
    part.and_then(DVec3::try_normalize).unwrap_or_else(|| any_across(unit))
}

/// A unit vector across a unit vector: the coordinate axis that is least along it.
pub(crate) fn any_across(unit: DVec3) -> DVec3 {
    let [x, y, z] = unit.abs().to_array();
    let axis = if x <= y && x <= z {
        DVec3::X
    } else if y <= z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    (axis - axis.dot(unit) * unit).normalize()
}

/// `v` turned by the least rotation that takes one unit vector to another; as across `to` as it was across `from`.
pub(crate) fn least_rotation(from: DVec3, to: DVec3, v: DVec3) -> DVec3 {
    let one = 1.0 + from.dot(to);
    if one < TURNED_BACK {
        return across(v, to);
    }
    across(v - v.dot(to) / one * (from + to), to)
}
