//! The largest ball that touches the skin at a point from below and holds no other point of it.

use std::ops::Range;

use glam::DVec3;

/// Points of a leaf.
const LEAF: usize = 8;
/// Boxes that wait to be looked at, at most: one for each time that 2³² points can be halved, and one more.
const OPEN_MAX: usize = 34;
/// What reaches no farther than this part beyond a ball may lie in it, whatever rounding does.
const CERTAIN: f64 = 1e-9;
/// Points that are closer than this part of the largest radius are one.
const COINCIDENT: f64 = 1e-9;

/// Skin in boxes in boxes. Around a ball that touches a limb all around, boxes reach into it whose skin does not: so each knows
/// between which heights it lies along the mean direction into the flesh.
pub(crate) struct SkinTree {
    /// In order of the leaves.
    places: Vec<DVec3>,
    nodes: Vec<Node>,
}

struct Node {
    low: DVec3,
    high: DVec3,
    /// Unit vector, or 0.
    inwards: DVec3,
    heights: (f64, f64),
    range: Range<usize>,
    /// Both halves; `None` for a leaf.
    halves: Option<[usize; 2]>,
}

impl Node {
    /// False only where no point of it lies in a ball.
    fn reaches(&self, centre: DVec3, radius: f64) -> bool {
        let radius = radius * (1.0 + CERTAIN);
        let square = radius * radius;
        if self.distance_squared(centre) > square {
            return false;
        }
        let at = centre.dot(self.inwards);
        let height = at.clamp(self.heights.0, self.heights.1) - at;
        if height == 0.0 {
            return true;
        }
        // What the ball has beyond that height lies around its cap's foot.
        let (depth, around) = (radius - height.abs(), square - height * height);
        depth >= 0.0 && self.distance_squared(centre + self.inwards * height) <= around + depth * depth
    }

    fn distance_squared(&self, place: DVec3) -> f64 {
        place.clamp(self.low, self.high).distance_squared(place)
    }
}

impl SkinTree {
    /// A tree over some points. `inwards`: unit vectors into the flesh, or 0.
    pub fn new(places: &[DVec3], inwards: &[DVec3], mut some: Vec<u32>) -> Self {
        let mut nodes = Vec::new();
        if !some.is_empty() {
            let whole = 0..some.len();
            grow(places, inwards, &mut some, whole, &mut nodes);
        }
        Self { places: some.iter().map(|&i| places[i as usize]).collect(), nodes }
    }

    /// Radius of the ball at `place`, its centre in direction `inwards`, a unit vector; at most `largest`.
    pub fn radius(&self, place: DVec3, inwards: DVec3, largest: f64) -> f64 {
        let same = (COINCIDENT * largest) * (COINCIDENT * largest);
        let mut radius = largest;
        let mut open = [0usize; OPEN_MAX];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let node = &self.nodes[open[count]];
            if !node.reaches(place + inwards * radius, radius) {
                continue;
            }
            if let Some([left, right]) = node.halves {
                // Around the place first: what lies there leaves little of the ball.
                let is_left_nearer = self.nodes[left].distance_squared(place) <= self.nodes[right].distance_squared(place);
                let halves = if is_left_nearer { [right, left] } else { [left, right] };
                open[count..count + 2].copy_from_slice(&halves);
                count += 2;
                continue;
            }
            for point in &self.places[node.range.clone()] {
                let to = *point - place;
                let (square, twice) = (to.length_squared(), 2.0 * to.dot(inwards));
                if square < twice * radius && square > same {
                    radius = square / twice;
                }
            }
        }
        radius
    }
}

fn grow(places: &[DVec3], inwards: &[DVec3], order: &mut [u32], range: Range<usize>, nodes: &mut Vec<Node>) -> usize {
    let at = |&i: &u32| places[i as usize];
    let own = &order[range.clone()];
    let (low, high) = own.iter().map(at).fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let mean = own.iter().map(|&i| inwards[i as usize]).sum::<DVec3>().normalize_or_zero();
    let along = own.iter().map(|i| at(i).dot(mean));
    let heights = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)));
    let node = nodes.len();
    nodes.push(Node { low, high, inwards: mean, heights, range: range.clone(), halves: None });
    if range.len() > LEAF {
        let sides = high - low;
        let axis = (0..3).fold(0, |longest, axis| if sides[axis] > sides[longest] { axis } else { longest });
        let middle = range.start + range.len() / 2;
        order[range.clone()].select_nth_unstable_by(range.len() / 2, |a, b| at(a)[axis].total_cmp(&at(b)[axis]).then(a.cmp(b)));
        let halves = [grow(places, inwards, order, range.start..middle, nodes), grow(places, inwards, order, middle..range.end, nodes)];
        nodes[node].halves = Some(halves);
    }
    node
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vectors(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<DVec3>> {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array), count)
    }

    fn plain(places: &[DVec3], place: DVec3, inwards: DVec3, largest: f64) -> f64 {
        let of = |p: &DVec3| (*p - place).length_squared() / (2.0 * (*p - place).dot(inwards));
        places.iter().filter(|p| p.distance(place) > COINCIDENT * largest).map(of).filter(|r| *r > 0.0).fold(largest, f64::min)
    }

    proptest! {
        /// Whichever way the skin is said to face.
        #[test]
        fn the_ball_is_the_least_of_those_through_another_point(places in vectors(1..200), facing in vectors(200..201)) {
            let inwards: Vec<DVec3> = facing.iter().map(|v| v.normalize_or_zero()).collect();
            let tree = SkinTree::new(&places, &inwards, (0..places.len() as u32).collect());
            for (place, inwards) in places.iter().zip(&inwards) {
                let wanted = plain(&places, *place, *inwards, 2.0);
                prop_assert!((tree.radius(*place, *inwards, 2.0) - wanted).abs() <= 1e-12 * wanted);
            }
        }

        #[test]
        fn a_tube_s_ball_is_its_own(sides in 3usize..40, rings in 3usize..40, turn in 0.0..3.0f64) {
            let at = |i: usize| {
                let angle = std::f64::consts::TAU * (i % sides) as f64 / sides as f64;
                let (sin, cos) = turn.sin_cos();
                let p = DVec3::new(angle.cos(), angle.sin(), (i / sides) as f64 * 0.1);
                DVec3::new(p.x, cos * p.y - sin * p.z, sin * p.y + cos * p.z)
            };
            let axis = DVec3::new(0.0, -turn.sin(), turn.cos());
            let places: Vec<DVec3> = (0..sides * rings).map(at).collect();
            let inwards: Vec<DVec3> = places.iter().map(|p| -p.reject_from_normalized(axis)).collect();
            let tree = SkinTree::new(&places, &inwards, (0..places.len() as u32).collect());
            for (place, inwards) in places.iter().zip(&inwards) {
                prop_assert!((tree.radius(*place, *inwards, 5.0) - 1.0).abs() <= 1e-9);
            }
        }
    }
}
