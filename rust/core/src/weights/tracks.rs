//! Bones as rows of samples, tied together where one begins at another: the ways that lead along the bones of a rig.

use glam::DVec3;

use super::sources::closest_on_segment;

/// No bone there.
pub const NO_BONE: u32 = u32::MAX;
/// From sample to sample, in voxels: no voxel is passed over.
const STEP: f64 = 0.5;
/// Samples of one bone: more than cross the finest lattice.
const MOST: f64 = 4096.0;
/// Ends closer than this part of the longer bone are one joint.
const SAME: f64 = 1e-3;

/// Samples of all bones and of the ways between them.
pub struct Tracks {
    /// In voxels.
    pub places: Vec<DVec3>,
    /// Bone of each sample; `NO_BONE` on the way from a parent to a bone that begins elsewhere.
    pub bones: Vec<u32>,
    /// Neighbouring samples.
    pub ties: Vec<[u32; 2]>,
}

impl Tracks {
    /// `bones` in voxels. Bones are tied to their parents, and where they share an end.
    pub fn new(bones: &[[DVec3; 2]], parents: Option<&[i32]>) -> Self {
        let mut tracks = Self { places: Vec::new(), bones: Vec::new(), ties: Vec::new() };
        let ranges: Vec<[u32; 2]> = bones.iter().enumerate().map(|(bone, &ends)| tracks.add(ends, bone as u32)).collect();
        for (child, &parent) in parents.into_iter().flatten().enumerate() {
            let Ok(parent) = usize::try_from(parent) else { continue };
            let head = bones[child][0];
            let from = closest_on_segment(bones[parent][0], bones[parent][1], head);
            let way = tracks.add([from, head], NO_BONE);
            let nearest = (ranges[parent][0]..=ranges[parent][1])
                .min_by(|&i, &j| tracks.places[i as usize].distance(from).total_cmp(&tracks.places[j as usize].distance(from)));
            tracks.ties.extend([[nearest.unwrap_or(ranges[parent][0]), way[0]], [way[1], ranges[child][0]]]);
        }
        for (i, a) in bones.iter().enumerate() {
            for (j, b) in bones.iter().enumerate().skip(i + 1) {
                let tolerance = SAME * a[0].distance(a[1]).max(b[0].distance(b[1]));
                for (m, n) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if a[m].distance(b[n]) <= tolerance {
                        tracks.ties.push([ranges[i][m], ranges[j][n]]);
                    }
                }
            }
        }
        tracks
    }

    /// Adds one straight piece; its first and last sample.
    fn add(&mut self, [from, to]: [DVec3; 2], bone: u32) -> [u32; 2] {
        let steps = (from.distance(to) / STEP).ceil().clamp(1.0, MOST);
        let first = self.places.len() as u32;
        for step in 0..=steps as u32 {
            self.places.push(from.lerp(to, f64::from(step) / steps));
            self.bones.push(bone);
        }
        let last = self.places.len() as u32 - 1;
        self.ties.extend((first..last).map(|i| [i, i + 1]));
        [first, last]
    }
}
