//! A tube of quads along a chain of bones: what benches and laws bind and bend.

use std::f64::consts::TAU;

use glam::{DAffine3, DMat4, DQuat, DVec3};
use turgor::{Joint, Mode, Options, Skeleton, Skinning, Topology, VolumeSkin};

/// Length of the tube; its radius is 0.5.
pub const LENGTH: f64 = 4.0;

/// Positions, face offsets, face corners.
pub type Faces = (Vec<DVec3>, Vec<i32>, Vec<i32>);

/// A tube along z with closed ends.
pub fn tube(rings: usize, segments: usize) -> Faces {
    let mut positions: Vec<DVec3> = Vec::new();
    for ring in 0..rings {
        for segment in 0..segments {
            let angle = TAU * segment as f64 / segments as f64;
            positions.push(DVec3::new(0.5 * angle.cos(), 0.5 * angle.sin(), LENGTH * ring as f64 / (rings - 1) as f64));
        }
    }
    positions.extend([DVec3::ZERO, DVec3::new(0.0, 0.0, LENGTH)]);
    let (first, last) = (rings * segments, (rings - 1) * segments);
    let mut corners = Vec::new();
    let mut offsets = vec![0];
    let mut face = |points: &[usize]| {
        corners.extend(points.iter().map(|&p| p as i32));
        offsets.push(corners.len() as i32);
    };
    for segment in 0..segments {
        let next = (segment + 1) % segments;
        for ring in 0..rings - 1 {
            let (low, high) = (ring * segments, (ring + 1) * segments);
            face(&[low + segment, low + next, high + next, high + segment]);
        }
        face(&[first, next, segment]);
        face(&[first + 1, last + segment, last + next]);
    }
    (positions, offsets, corners)
}

/// Rest places of a chain of bones along the tube.
pub fn heads(bones: usize) -> Vec<DVec3> {
    (0..bones).map(|bone| DVec3::new(0.0, 0.0, LENGTH * bone as f64 / bones as f64)).collect()
}

/// The tube's weights on such a chain, at most four bones to a vertex.
pub fn skinning(positions: &[DVec3], bones: usize, mode: Mode) -> Skinning {
    skinning_of_size(positions, bones, mode, 1.0)
}

/// The same weights on a chain that is so many times as large.
pub fn skinning_of_size(positions: &[DVec3], bones: usize, mode: Mode, size: f64) -> Skinning {
    let step = LENGTH / bones as f64;
    let parents: Vec<i32> = (0..bones as i32).map(|bone| bone - 1).collect();
    let rest: Vec<DMat4> = heads(bones).into_iter().map(|head| DMat4::from_translation(head * size)).collect();
    let (mut offsets, mut influences, mut weights) = (vec![0], Vec::new(), Vec::new());
    for p in positions {
        let nearest = (p.z / step - 0.5).round().clamp(0.0, bones as f64 - 1.0) as usize;
        for bone in nearest.saturating_sub(1)..(nearest + 2).min(bones) {
            let distance = (p.z - (bone as f64 + 0.5) * step) / (0.7 * step);
            let weight = (-distance * distance).exp();
            if weight > 3e-3 {
                influences.push(bone as i32);
                weights.push(weight);
            }
        }
        offsets.push(weights.len() as i32);
    }
    let skeleton = Skeleton::new(&parents, &rest).expect("a chain");
    Skinning::new(skeleton, &offsets, &influences, &weights, mode, None).expect("sound weights")
}

/// The tube bound to the chain.
pub fn bound(faces: &Faces, bones: usize, mode: Mode, joints: &[Joint], shape_deltas: &[Vec<DVec3>]) -> VolumeSkin {
    let (positions, offsets, corners) = faces;
    let topology = Topology::new(positions, offsets, corners, 0.0).expect("a sound tube");
    let skinning = skinning(positions, bones, mode);
    VolumeSkin::bind(&topology, positions, &skinning, joints, Options::default(), shape_deltas, &DMat4::IDENTITY).expect("a character")
}

/// Pose matrices in which each bone turns by the length of its vector, about its direction.
pub fn posed(turns: &[DVec3]) -> Vec<DMat4> {
    let mut motion = DAffine3::IDENTITY;
    heads(turns.len())
        .into_iter()
        .zip(turns)
        .map(|(head, &turn)| {
            let turned = DAffine3::from_quat(DQuat::from_scaled_axis(turn));
            motion = motion * DAffine3::from_translation(head) * turned * DAffine3::from_translation(-head);
            DMat4::from(motion)
        })
        .collect()
}
