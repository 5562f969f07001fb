//! Fleshing of one frame and binding: points about a wavy spine, bent to a helix.
//!
//! `make bench`. Blender's own Curve modifier is measured beside the engine, in one run, by `make demo SCENE=fleshing`.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use turgor::spine::{Blend, Flesh, FleshFrame, Fleshing, Kind, Match, Method, Parameters, Spine, Twist};

const STATIONS: usize = 17;

fn stations(at: impl Fn(f64) -> DVec3) -> Vec<DVec3> {
    (0..STATIONS).map(|i| at(i as f64 / (STATIONS - 1) as f64)).collect()
}

fn rest() -> Arc<Spine> {
    let points = stations(|x| DVec3::new(8.0 * x, 0.3 * (5.0 * x).sin(), 0.0));
    Arc::new(Spine::new(&points, Method::Spline, Parameters::Chord, None).expect("apart"))
}

fn posed(rest: &Spine) -> Spine {
    let points = stations(|x| DVec3::new(1.5 * (5.0 * x).cos(), 1.5 * (5.0 * x).sin(), 2.0 * x));
    rest.posed(&points, None).expect("apart")
}

/// Rings of a tube, as a mesh numbers them.
fn tube(rest: &Spine, count: usize) -> Vec<DVec3> {
    let sides = 250;
    let at = |i: usize| {
        let (ring, side) = (i / sides, i % sides);
        let [first, last] = rest.parameter_range();
        let t = first + (last - first) * ring as f64 / (count / sides) as f64;
        let [_, normal, binormal] = rest.frame(t);
        let (sine, cosine) = (std::f64::consts::TAU * side as f64 / sides as f64).sin_cos();
        rest.position(t) + 0.3 * (cosine * normal + sine * binormal)
    };
    (0..count).map(at).collect()
}

fn deform(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("flesh");
    let rest = rest();
    let kinds = [
        ("radial", Blend::from(Kind::Radial)),
        ("normal", Blend::from(Kind::Normal)),
        ("binormal", Blend::from(Kind::Binormal)),
        ("blend", Blend::new([1.0; 3]).expect("positive")),
    ];
    for count in [10_000, 100_000, 1_000_000] {
        for (name, blend) in &kinds {
            let flesh = Fleshing::bind(Arc::clone(&rest), tube(&rest, count), *blend, Match::Stations, None).expect("finite");
            let (mut frame, mut offsets) = (FleshFrame::default(), vec![[0.0f32; 3]; count]);
            group.throughput(Throughput::Elements(count as u64));
            for (way, twist, slide) in [("", 0.0, 0.0), (", twisted", 1.0, 0.0), (", sliding", 0.0, 0.3)] {
                if count != 100_000 && !(way.is_empty() && *name == "radial") {
                    continue;
                }
                group.bench_function(BenchmarkId::new(*name, format!("{count} points{way}")), |bencher| {
                    bencher.iter(|| {
                        let spine = posed(&rest);
                        let pose = Flesh { twist: Twist::Ends([0.0, twist]), slide, ..Flesh::along(&spine) };
                        flesh.deform(black_box(&pose), &mut frame, &mut offsets).expect("a sound pose")
                    });
                });
            }
        }
    }
    group.finish();
}

fn bind(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bind");
    let rest = rest();
    for count in [10_000, 100_000] {
        let points = tube(&rest, count);
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(BenchmarkId::new("radial", format!("{count} points")), |bencher| {
            bencher.iter(|| Fleshing::bind(Arc::clone(&rest), points.clone(), Kind::Radial.into(), Match::Stations, None).expect("finite"));
        });
    }
    group.finish();
}

criterion_group!(benches, deform, bind);
criterion_main!(benches);
