//! Skinning and correction of one frame: a tube of quads along a chain of bones, each bone turned.
//!
//! `cargo bench -p turgor`. Compare with Blender's own Armature modifier through `make demo`, which measures both in one run.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use turgor::{Mode, Options, Pose, Skeleton, Skinning, Topology, VolumeSkin};

/// Length of the tube; its radius is 0.5.
const LENGTH: f64 = 4.0;

/// A tube along z with closed ends: positions, face offsets, face corners.
fn tube(rings: usize, segments: usize) -> (Vec<DVec3>, Vec<i32>, Vec<i32>) {
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

/// The tube on a chain of bones, at most four bones to a vertex, and a pose that turns each bone.
fn character(rings: usize, segments: usize, bones: usize, mode: Mode) -> (VolumeSkin, Vec<DMat4>) {
    let (positions, offsets, corners) = tube(rings, segments);
    let topology = Topology::new(&positions, &offsets, &corners, 0.0).expect("a sound tube");
    let step = LENGTH / bones as f64;
    let parents: Vec<i32> = (0..bones as i32).map(|bone| bone - 1).collect();
    let heads: Vec<DVec3> = (0..bones).map(|bone| DVec3::new(0.0, 0.0, bone as f64 * step)).collect();
    let rest: Vec<DMat4> = heads.iter().map(|&head| DMat4::from_translation(head)).collect();
    let (mut weight_offsets, mut weight_bones, mut weights) = (vec![0], Vec::new(), Vec::new());
    for p in &positions {
        let nearest = (p.z / step - 0.5).round().clamp(0.0, bones as f64 - 1.0) as usize;
        for bone in nearest.saturating_sub(1)..(nearest + 2).min(bones) {
            let distance = (p.z - (bone as f64 + 0.5) * step) / (0.7 * step);
            let weight = (-distance * distance).exp();
            if weight > 3e-3 {
                weight_bones.push(bone as i32);
                weights.push(weight);
            }
        }
        weight_offsets.push(weights.len() as i32);
    }
    let skeleton = Skeleton::new(&parents, &rest).expect("a chain");
    let skinning = Skinning::new(skeleton, &weight_offsets, &weight_bones, &weights, mode, None).expect("sound weights");
    let body = VolumeSkin::bind(&topology, &positions, &skinning, &[], Options::default(), &[], &DMat4::IDENTITY).expect("a character");
    let mut motion = DAffine3::IDENTITY;
    let pose = heads
        .iter()
        .enumerate()
        .map(|(bone, &head)| {
            let axis = DVec3::new((bone as f64).sin(), (bone as f64).cos(), 0.5).normalize();
            let turn = DAffine3::from_quat(DQuat::from_axis_angle(axis, 2.0 / bones as f64));
            motion = motion * DAffine3::from_translation(head) * turn * DAffine3::from_translation(-head);
            DMat4::from(motion)
        })
        .collect();
    (body, pose)
}

fn deform(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("deform");
    for (mode, name) in [(Mode::Linear, "linear"), (Mode::DualQuaternion, "dual_quaternion")] {
        for (rings, segments, bones) in [(151, 44, 17), (151, 44, 200), (400, 250, 17), (400, 250, 200)] {
            let (body, pose) = character(rings, segments, bones, mode);
            let vertices = rings * segments + 2;
            let mut workspace = body.workspace();
            let mut offsets = vec![[0.0f32; 3]; vertices];
            group.throughput(Throughput::Elements(vertices as u64));
            group.bench_function(BenchmarkId::new(name, format!("{vertices} vertices, {bones} bones")), |bencher| {
                bencher.iter(|| {
                    body.deform(black_box(&Pose::new(&pose)), &mut workspace).expect("a sound pose");
                    body.write_offsets(&workspace, &mut offsets);
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, deform);
criterion_main!(benches);
