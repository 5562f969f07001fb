//! Bones as rows of samples, tied together where one begins at another: the ways that lead along the bones of a rig.

use glam::DVec3;

use super::sources::closest_on_segment;

/// No bone there.
pub const NO_BONE: u32 = u32::MAX;
/// From sample to sample, in voxels: no voxel is passed over.
const STEP: f64 = 0.5;
/// Steps of one bone: more than cross the finest lattice. Longer ones are sampled in and about the lattice only.
const MOST: f64 = 4096.0;
/// Room about the lattice where long bones are sampled too, in voxels: more samples than a gap may have.
const ROOM: f64 = 8.0;
/// Ends closer than this part of the longer bone are one joint.
const SAME: f64 = 1e-3;

/// Samples of all bones and of the ways between them.
pub struct BonePaths {
    /// In voxels.
    pub places: Vec<DVec3>,
    /// Bone of each sample; `NO_BONE` on the way from a parent to a bone that begins elsewhere.
    pub bones: Vec<u32>,
    /// Neighbouring samples.
    pub ties: Vec<[u32; 2]>,
    /// Per bone, how many samples all of it has, also where it is too long for them to be here.
    pub counts: Vec<f64>,
}

impl BonePaths {
    /// `bones` in voxels of a lattice of `dims`. Bones are tied to their parents, and where they share an end.
    pub fn new(dims: [usize; 3], bones: &[[DVec3; 2]], parents: Option<&[i32]>) -> Self {
        let end = DVec3::from_array(dims.map(|d| d as f64));
        let counts = bones.iter().map(|&[head, tail]| steps(head, tail) + 1.0).collect();
        let mut paths = Self { places: Vec::new(), bones: Vec::new(), ties: Vec::new(), counts };
        let ranges: Vec<[u32; 2]> = bones.iter().enumerate().map(|(bone, &ends)| paths.add(end, ends, bone as u32)).collect();
        for (child, &parent) in parents.into_iter().flatten().enumerate() {
            let Ok(parent) = usize::try_from(parent) else { continue };
            let head = bones[child][0];
            let from = closest_on_segment(bones[parent][0], bones[parent][1], head);
            let way = paths.add(end, [from, head], NO_BONE);
            let nearest = (ranges[parent][0]..=ranges[parent][1])
                .min_by(|&i, &j| paths.places[i as usize].distance(from).total_cmp(&paths.places[j as usize].distance(from)));
            paths.ties.extend([[nearest.unwrap_or(ranges[parent][0]), way[0]], [way[1], ranges[child][0]]]);
        }
        for (i, a) in bones.iter().enumerate() {
            for (j, b) in bones.iter().enumerate().skip(i + 1) {
                let tolerance = SAME * a[0].distance(a[1]).max(b[0].distance(b[1]));
                for (m, n) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if a[m].distance(b[n]) <= tolerance {
                        paths.ties.push([ranges[i][m], ranges[j][n]]);
                    }
                }
            }
        }
        paths
    }

    /// Adds one straight piece; its first and last sample. `end`: the far corner of the lattice.
    fn add(&mut self, end: DVec3, [from, to]: [DVec3; 2], bone: u32) -> [u32; 2] {
        let steps = steps(from, to);
        let first = self.places.len() as u32;
        if steps <= MOST {
            self.places.extend((0..=steps as u32).map(|step| from.lerp(to, f64::from(step) / steps)));
        } else {
            self.places.push(from);
            if let Some([enters, leaves]) = within(DVec3::splat(-ROOM), end + ROOM, from, to) {
                let steps = (steps * (leaves - enters)).ceil().clamp(1.0, MOST);
                let places = (0..=steps as u32).map(|step| from.lerp(to, enters + (leaves - enters) * f64::from(step) / steps));
                self.places.extend(places);
            }
            self.places.push(to);
        }
        self.bones.resize(self.places.len(), bone);
        let last = self.places.len() as u32 - 1;
        self.ties.extend((first..last).map(|i| [i, i + 1]));
        [first, last]
    }
}

fn steps(from: DVec3, to: DVec3) -> f64 {
    (from.distance(to) / STEP).ceil().max(1.0)
}

/// Parts of the way from a place to another at which it enters a box and leaves it; None where it passes it by.
fn within(low: DVec3, high: DVec3, from: DVec3, to: DVec3) -> Option<[f64; 2]> {
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (start, way) = (from[axis], to[axis] - from[axis]);
        if way == 0.0 {
            if start < low[axis] || start > high[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((low[axis] - start) / way, (high[axis] - start) / way);
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    (enters < leaves).then_some([enters, leaves])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const DIMS: [usize; 3] = [30, 20, 10];

    fn places() -> impl Strategy<Value = DVec3> {
        let part = || (-1.0..1.0f64, -2.0..14.0f64).prop_map(|(part, exponent)| part * 10f64.powf(exponent));
        (part(), part(), part()).prop_map(|(x, y, z)| DVec3::new(15.0, 10.0, 5.0) + DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn samples_are_few_and_pass_over_no_voxel_of_the_lattice(head in places(), tail in places()) {
            let paths = BonePaths::new(DIMS, &[[head, tail]], None);
            prop_assert!(paths.places.len() <= MOST as usize + 3);
            prop_assert_eq!(paths.bones.len(), paths.places.len());
            prop_assert_eq!(paths.ties.len() + 1, paths.places.len());
            prop_assert!(paths.counts[0] >= paths.places.len() as f64 - 2.0);
            // Where the bone is in the lattice, to what far ends are rounded to.
            let slack = 1e-14 * head.abs().max(tail.abs()).max_element();
            for step in 0..=100 {
                let Some([enters, leaves]) = within(DVec3::ZERO, DVec3::new(30.0, 20.0, 10.0), head, tail) else { break };
                let place = head.lerp(tail, enters + (leaves - enters) * f64::from(step) / 100.0);
                let nearest = paths.places.iter().map(|p| p.distance(place)).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= 0.5 * STEP + slack, "{} from {}", nearest, place);
            }
        }
    }

    #[test]
    fn bones_that_fit_into_the_lattice_are_sampled_whole() {
        let (head, tail) = (DVec3::new(-3.0, 1.0, 2.0), DVec3::new(40.0, 1.0, 2.0));
        let paths = BonePaths::new(DIMS, &[[head, tail]], None);
        assert_eq!(paths.places.len(), 87);
        assert_eq!(paths.counts, [87.0]);
        assert_eq!((paths.places[0], paths.places[86]), (head, tail));
    }
}
