//! Skinning and correction of one frame: a tube of quads along a chain of bones, each bone turned.
//!
//! `make bench`. Blender's own Armature modifier is measured beside the engine, in one run, by `make demo`.

#[path = "../tests/character/mod.rs"]
mod character;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use turgor::{Mode, Pose};

fn deform(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("deform");
    for (mode, name) in [(Mode::Linear, "linear"), (Mode::DualQuaternion, "dual_quaternion")] {
        for (rings, segments, bones) in [(151, 44, 17), (151, 44, 200), (400, 250, 17), (400, 250, 200)] {
            let faces = character::tube(rings, segments);
            let body = character::bound(&faces, bones, mode, &[], &[]);
            let turn = |bone: usize| DVec3::new((bone as f64).sin(), (bone as f64).cos(), 0.5) * (2.0 / bones as f64);
            let pose = character::posed(&(0..bones).map(turn).collect::<Vec<DVec3>>());
            let vertices = faces.0.len();
            let mut workspace = body.workspace();
            let mut offsets = vec![[0.0f32; 3]; vertices];
            group.throughput(Throughput::Elements(vertices as u64));
            group.bench_function(BenchmarkId::new(name, format!("{vertices} vertices, {bones} bones")), |bencher| {
                bencher.iter(|| {
                    body.deform(black_box(&Pose::new(&pose)), &mut workspace, &mut offsets).expect("a sound pose");
                });
            });
        }
    }
    group.finish();
}

/// Frames that others pose: as skinned, with a tenth of the tube moved, with all of it moved; and what is made for the first of
/// those with anything moved.
fn posed(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("posed");
    for (rings, segments) in [(151, 44), (400, 250)] {
        let faces = character::tube(rings, segments);
        let bones = 17;
        let turns: Vec<DVec3> = (0..bones).map(|bone| DVec3::new((bone as f64).sin(), (bone as f64).cos(), 0.5) * 0.12).collect();
        let matrices = character::posed(&turns);
        let body = character::bound(&faces, bones, Mode::Linear, &[], &[]);
        let vertices = faces.0.len();
        let mut workspace = body.workspace();
        let mut offsets = vec![[0.0f32; 3]; vertices];
        body.deform(&Pose::new(&matrices), &mut workspace, &mut offsets).expect("a sound pose");
        let skinned = body.positions(&workspace).0;
        for (name, part) in [("nothing", 0.0), ("a tenth", 0.1), ("all", 1.0)] {
            let moved = |(at, p): (&DVec3, &DVec3)| {
                let depth = (character::LENGTH * part - at.z).max(0.0);
                (*p + DVec3::new(0.02 * depth.sin(), 0.0, 0.0)).as_vec3().to_array()
            };
            let positions: Vec<[f32; 3]> = faces.0.iter().zip(&skinned).map(moved).collect();
            let pose = Pose { posed_positions: Some(&positions), ..Pose::new(&matrices) };
            group.bench_function(BenchmarkId::new(name, vertices), |bencher| {
                bencher.iter(|| {
                    body.deform(black_box(&pose), &mut workspace, &mut offsets).expect("a sound pose");
                });
            });
            if part == 1.0 {
                group.sample_size(10).bench_function(BenchmarkId::new("first", vertices), |bencher| {
                    let fresh = || character::bound(&faces, bones, Mode::Linear, &[], &[]);
                    bencher.iter_with_setup(fresh, |body| {
                        body.deform(&pose, &mut workspace, &mut offsets).expect("a sound pose");
                        body
                    });
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, deform, posed);
criterion_main!(benches);
