//! Whether two triangles pass through each other, by more than rounding.

use glam::DVec3;

/// Part of the longest side that counts as touching. Mirrored skin meets edge on edge, flat skin lies in one plane: what
/// rounding would decide there must come out alike whenever it is asked.
const TOUCH: f64 = 1e-6;

/// Whether two triangles pass through each other.
///
/// Each must have corners on both sides of the other's plane: touching is not passing, nor is lying in one plane. Of two
/// with a point in common, the sides across from it decide; two with an edge in common never pass.
pub(crate) fn cross(points: &[DVec3], a: [u32; 3], b: [u32; 3]) -> bool {
    let at = |corners: [u32; 3]| corners.map(|i| points[i as usize]);
    match a.iter().filter(|corner| b.contains(corner)).count() {
        0 => pass(&at(a), &at(b), 0),
        1 => pass(&at(shared_first(a, b)), &at(shared_first(b, a)), 1),
        _ => false,
    }
}

/// The corners in their order, that of `other` first.
fn shared_first(corners: [u32; 3], other: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = corners;
    if other.contains(&a) {
        [a, b, c]
    } else if other.contains(&b) {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

type Triangle = [DVec3; 3];

/// Of triangles whose first `shared` corners are one.
fn pass(p: &Triangle, q: &Triangle, shared: usize) -> bool {
    let touch = TOUCH * longest(p).max(longest(q)).sqrt();
    let Some(of_p) = sides(p, q, shared, touch) else { return false };
    let Some(of_q) = sides(q, p, shared, touch) else { return false };
    any_side_passes(p, of_p, q, shared, touch) || any_side_passes(q, of_q, p, shared, touch)
}

/// Square of the longest side.
fn longest([a, b, c]: &Triangle) -> f64 {
    a.distance_squared(*b).max(b.distance_squared(*c)).max(c.distance_squared(*a))
}

/// Where the corners of `p` lie beside the plane of `q`; `None` unless it goes through by more than a touch.
fn sides(p: &Triangle, q: &Triangle, shared: usize, touch: f64) -> Option<[f64; 3]> {
    let normal = (q[1] - q[0]).cross(q[2] - q[0]);
    let of = [0, 1, 2].map(|i| if i < shared { 0.0 } else { normal.dot(p[i] - q[0]) });
    let deep = touch * normal.length();
    (of.iter().any(|side| *side > deep) && of.iter().any(|side| *side < -deep)).then_some(of)
}

fn any_side_passes(p: &Triangle, of: [f64; 3], q: &Triangle, shared: usize, touch: f64) -> bool {
    (shared..3).map(|i| (i, (i + 1) % 3)).any(|(i, next)| of[i] * of[next] < 0.0 && goes_through(p[i], p[next], q, touch))
}

/// Whether the line through two points goes through a triangle, or past its border by no more than a touch.
fn goes_through(from: DVec3, to: DVec3, [a, b, c]: &Triangle, touch: f64) -> bool {
    let along = to - from;
    let slack = touch * along.length();
    let turns = [[a, b], [b, c], [c, a]].map(|[first, second]| {
        let turn = along.cross(*first - from).dot(*second - from);
        (turn, slack * first.distance(*second))
    });
    turns.iter().all(|(turn, slack)| *turn >= -slack) || turns.iter().all(|(turn, slack)| *turn <= *slack)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(rows: &[[f64; 3]]) -> Vec<DVec3> {
        rows.iter().copied().map(DVec3::from_array).collect()
    }

    #[test]
    fn triangles_that_pass_touch_or_lie_in_one_plane() {
        let flat = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let with = |more: [[f64; 3]; 3]| points(&[flat, more].concat());
        let found = |more: [[f64; 3]; 3]| {
            let points = with(more);
            let (there, back) = (cross(&points, [0, 1, 2], [3, 4, 5]), cross(&points, [4, 3, 5], [2, 1, 0]));
            assert_eq!(there, back);
            there
        };
        assert!(found([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 9.0, 1.0]]));
        assert!(found([[2.0, 2.0, -1.0], [2.0, 2.0, 1.0], [9.0, 9.0, 1.0]]), "edge on edge");
        assert!(!found([[1.0, 1.0, -1e-9], [1.0, 1.0, 1.0], [1.0, 9.0, 1.0]]), "no deeper than rounding");
        assert!(!found([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 9.0, 1.0]]), "touches");
        assert!(!found([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]), "in one plane");
        assert!(!found([[5.0, 1.0, -1.0], [5.0, 1.0, 1.0], [5.0, 9.0, 1.0]]), "beside it");
        assert!(!found([[f64::NAN, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 9.0, 1.0]]));
    }

    #[test]
    fn neighbours_pass_only_across_from_what_they_share() {
        let points = points(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]]);
        assert!(cross(&points, [0, 1, 2], [3, 0, 4]), "the side across from the corner goes through");
        assert!(!cross(&points, [0, 1, 2], [0, 4, 5]));
        assert!(!cross(&points, [0, 1, 2], [0, 1, 3]), "an edge in common");
    }
}
