//! Automatic weights of a tube on a chain of bones.
//!
//! `make bench`. Blender's own automatic weights are measured beside them, in one run, by `make demo SCENE=weights`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use turgor::weights::{Bones, Surface, WeightSettings, automatic_weights};

const LENGTH: f64 = 8.0;

struct Tube {
    positions: Vec<DVec3>,
    face_offsets: Vec<i32>,
    face_corners: Vec<i32>,
}

/// Rings of quads about the x axis, with both ends open.
fn tube(rings: usize, sides: usize) -> Tube {
    let at = |i: usize| {
        let (sine, cosine) = (std::f64::consts::TAU * (i % sides) as f64 / sides as f64).sin_cos();
        DVec3::new(LENGTH * (i / sides) as f64 / (rings - 1) as f64, 0.5 * cosine, 0.5 * sine)
    };
    let faces = (0..(rings - 1) * sides).map(|i| {
        let after = i / sides * sides + (i + 1) % sides;
        [i, after, after + sides, i + sides].map(|corner| corner as i32)
    });
    let face_corners: Vec<i32> = faces.flatten().collect();
    let face_offsets = (0..=face_corners.len() as i32).step_by(4).collect();
    Tube { positions: (0..rings * sides).map(at).collect(), face_offsets, face_corners }
}

fn weights(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("weights");
    group.sample_size(10);
    for (rings, sides) in [(132, 50), (1000, 100)] {
        let tube = tube(rings, sides);
        let surface =
            Surface { positions: &tube.positions, face_offsets: &tube.face_offsets, face_corners: &tube.face_corners, is_solid: true };
        for bone_count in [17, 60] {
            let joint = |i: usize| DVec3::X * (LENGTH * i as f64 / bone_count as f64);
            let (heads, tails): (Vec<_>, Vec<_>) = (0..bone_count).map(|i| (joint(i), joint(i + 1))).unzip();
            let bones = Bones { heads: &heads, tails: &tails, parents: None, stiffness: None, is_locked: None };
            for resolution in [Some(128), None] {
                let settings = WeightSettings { resolution, ..WeightSettings::default() };
                let fineness = resolution.map_or_else(|| String::from("automatic"), |r| r.to_string());
                group.throughput(Throughput::Elements(tube.positions.len() as u64));
                group.bench_function(BenchmarkId::new(format!("{} vertices, {bone_count} bones", tube.positions.len()), fineness), |b| {
                    b.iter(|| automatic_weights(black_box(&[surface]), &bones, None, &settings, &mut |_| true).expect("sound input"));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, weights);
criterion_main!(benches);
