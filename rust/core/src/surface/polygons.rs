//! Faces as triangles. No diagonal is chosen where it can be avoided: a mirrored mesh would choose another.

use std::collections::HashMap;

use glam::DVec3;

/// Relative difference below which lengths are equal, and four corners on one circle.
const TIE: f64 = 1e-9;

/// How a face with more than four corners is cut.
pub enum Cut {
    /// Into triangles from the mean of its corners to each side.
    Fan(DVec3),
    /// Into triangles of its corners, as positions in the face: a fan would leave a concave face.
    Ears(Vec<[usize; 3]>),
}

/// Cuts a face that may be concave or not flat.
pub fn cut(corners: &[DVec3]) -> Cut {
    let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let side = |i: usize| (corners[i] - mean).cross(corners[(i + 1) % corners.len()] - mean);
    let area: DVec3 = (0..corners.len()).map(side).sum();
    if (0..corners.len()).all(|i| side(i).dot(area) >= 0.0) { Cut::Fan(mean) } else { Cut::Ears(ears(corners)) }
}

/// Whether a corner may be cut off.
enum State {
    /// The squared length of the cut.
    Ear(f64),
    /// The first corner that the cut would leave behind.
    Blocked(usize),
    Reflex,
}

/// Cuts off, one after the other, the corner whose cut is shortest among those that leave no corner behind, the first one
/// of those alike: a mirrored face is cut alike.
pub(crate) fn ears(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let area: DVec3 = (0..corners.len()).map(|i| (corners[i] - mean).cross(corners[(i + 1) % corners.len()] - mean)).sum();
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::with_capacity(corners.len() - 2);
    // Corners in a row are on the line, whatever rounding says.
    let slack = TIE * area.length_squared();
    let state_of = |i: usize, left: &[usize]| {
        let count = left.len();
        let at = |i: usize| left[i % count];
        let [a, b, c] = [at(i + count - 1), at(i), at(i + 1)].map(|k| corners[k]);
        if (b - a).cross(c - b).dot(area) <= slack {
            return State::Reflex;
        }
        let inside = |p: DVec3| [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (*to - *from).cross(p - *from).dot(area) >= -slack);
        let mut others = (i + 2..i + count - 1).map(at);
        let behind = others.find(|&k| corners[k] != a && corners[k] != c && inside(corners[k]));
        behind.map_or(State::Ear(a.distance_squared(c)), State::Blocked)
    };
    // What is told of a corner holds until a neighbour of it goes, or the corner that its cut would leave behind.
    let mut states: Vec<State> = (0..left.len()).map(|i| state_of(i, &left)).collect();
    while left.len() > 3 {
        let count = left.len();
        let length = |state: &State| if let State::Ear(length) = state { *length } else { f64::INFINITY };
        let mut shortest = states.iter().map(length).fold(f64::INFINITY, f64::min);
        let mut ear = states.iter().position(|state| length(state) <= shortest * (1.0 + TIE) && matches!(state, State::Ear(_)));
        if ear.is_none() {
            // A face that crosses itself may have no ear left: any corner ends it.
            let length = |i: usize| corners[left[(i + count - 1) % count]].distance_squared(corners[left[(i + 1) % count]]);
            shortest = (0..count).map(length).fold(f64::INFINITY, f64::min);
            ear = (0..count).find(|&i| length(i) <= shortest * (1.0 + TIE));
        }
        let ear = ear.unwrap_or(0);
        triangles.push([left[(ear + count - 1) % count], left[ear], left[(ear + 1) % count]]);
        let gone = left.remove(ear);
        states.remove(ear);
        for (i, state) in states.iter_mut().enumerate() {
            let is_beside = i == ear % left.len() || (i + 1) % left.len() == ear % left.len();
            if is_beside || matches!(state, State::Blocked(behind) if *behind == gone) {
                *state = state_of(i, &left);
            }
        }
    }
    triangles.push([left[0], left[1], left[2]]);
    flip_to_delaunay(corners, &mut triangles);
    triangles
}

/// Turns diagonals until the angles across each sum to at most half a turn: what is left does not depend on the choice of
/// ears, and no diagonal has a negative cotangent weight.
fn flip_to_delaunay(corners: &[DVec3], triangles: &mut [[usize; 3]]) {
    // Every flip makes the triangulation better; the limit is for faces that are far from flat.
    for _ in 0..4 * corners.len() {
        let mut across: HashMap<(usize, usize), (usize, usize)> = HashMap::new();
        let mut flips = Vec::new();
        for (triangle, t) in triangles.iter().enumerate() {
            for i in 0..3 {
                let (a, b, c) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
                match across.get(&(a.min(b), a.max(b))) {
                    Some(&(other, d)) if turned(corners, [a, b, c, d]) => flips.push([triangle, other, a, b, c, d]),
                    Some(_) => {}
                    None => drop(across.insert((a.min(b), a.max(b)), (triangle, c))),
                }
            }
        }
        if flips.is_empty() {
            return;
        }
        let mut is_touched = vec![false; triangles.len()];
        for [triangle, other, a, b, c, d] in flips {
            if !is_touched[triangle] && !is_touched[other] {
                is_touched[triangle] = true;
                is_touched[other] = true;
                triangles[triangle] = [c, a, d];
                triangles[other] = [d, b, c];
            }
        }
    }
}

/// Whether the angles at c and d, across from the diagonal a b, sum to more than half a turn.
fn turned(corners: &[DVec3], [a, b, c, d]: [usize; 4]) -> bool {
    let at = |apex: usize| {
        let (u, v) = (corners[a] - corners[apex], corners[b] - corners[apex]);
        (u.cross(v).length(), u.dot(v))
    };
    let ((sine_c, cosine_c), (sine_d, cosine_d)) = (at(c), at(d));
    let size = sine_c.hypot(cosine_c) * sine_d.hypot(cosine_d);
    sine_c * cosine_d + cosine_c * sine_d < -TIE * size
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The same ears, every corner looked at anew for each.
    fn plain_ears(corners: &[DVec3]) -> Vec<[usize; 3]> {
        let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let area: DVec3 = (0..corners.len()).map(|i| (corners[i] - mean).cross(corners[(i + 1) % corners.len()] - mean)).sum();
        let mut left: Vec<usize> = (0..corners.len()).collect();
        let mut triangles = Vec::new();
        let slack = TIE * area.length_squared();
        while left.len() > 3 {
            let count = left.len();
            let at = |i: usize| left[i % count];
            let length = |i: usize| corners[at(i + count - 1)].distance_squared(corners[at(i + 1)]);
            let is_ear = |&i: &usize| {
                let [a, b, c] = [at(i + count - 1), at(i), at(i + 1)].map(|k| corners[k]);
                let inside = |p: DVec3| [(a, b), (b, c), (c, a)].iter().all(|(f, t)| (*t - *f).cross(p - *f).dot(area) >= -slack);
                let mut others = (i + 2..i + count - 1).map(|k| corners[at(k)]);
                (b - a).cross(c - b).dot(area) > slack && !others.any(|p| p != a && p != c && inside(p))
            };
            let mut candidates: Vec<usize> = (0..count).filter(is_ear).collect();
            if candidates.is_empty() {
                candidates = (0..count).collect();
            }
            let shortest = candidates.iter().map(|&i| length(i)).fold(f64::INFINITY, f64::min);
            let ear = candidates.into_iter().find(|&i| length(i) <= shortest * (1.0 + TIE)).unwrap_or(0);
            triangles.push([at(ear + count - 1), at(ear), at(ear + 1)]);
            left.remove(ear);
        }
        triangles.push([left[0], left[1], left[2]]);
        flip_to_delaunay(corners, &mut triangles);
        triangles
    }

    proptest! {
        #[test]
        fn ears_are_those_of_corners_looked_at_anew(
            places in prop::collection::vec((0i8..6, 0i8..6, 0i8..2), 5..24), is_even in any::<bool>()
        ) {
            // On a grid many are alike, in a row, or at one place, and faces cross themselves.
            let bend = if is_even { 0.0 } else { 0.1 };
            let corner = |(i, &(x, y, z)): (usize, &(i8, i8, i8))| {
                DVec3::new(f64::from(x), f64::from(y), f64::from(z) * bend) + bend * (i as f64).sin()
            };
            let corners: Vec<DVec3> = places.iter().enumerate().map(corner).collect();
            prop_assert_eq!(ears(&corners), plain_ears(&corners));
        }
    }

    #[test]
    fn ears_fill_a_concave_face_and_nothing_else() {
        let corners: Vec<DVec3> = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 2.0], [4.0, 2.0], [4.0, 3.0], [0.0, 3.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.0))
            .to_vec();
        let Cut::Ears(triangles) = cut(&corners) else { panic!("a fan would leave the face") };
        let areas: Vec<f64> =
            triangles.iter().map(|t| 0.5 * (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]).z).collect();
        assert!(areas.iter().all(|area| *area >= 0.0));
        assert!((areas.iter().sum::<f64>() - 9.0).abs() < 1e-12);
    }

    #[test]
    fn convex_faces_and_collapsed_ones_are_cut_somehow() {
        let ring: Vec<DVec3> = (0..7).map(|i| DVec3::new(f64::from(i).cos(), f64::from(i).sin(), 0.0)).collect();
        assert!(matches!(cut(&ring), Cut::Fan(_)));
        assert!(matches!(cut(&[DVec3::ONE; 6]), Cut::Fan(_)));
    }
}
