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

criterion_group!(benches, deform);
criterion_main!(benches);
