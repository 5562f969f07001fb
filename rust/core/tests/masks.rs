//! What holds of masks and of targets that the fields reach badly: little may move, far too much is asked for.

mod character;

use character::{bound, posed, tube};
use glam::{DMat4, DVec3, DVec4};
use proptest::prelude::*;
use turgor::{Fields, Mesh, Mode, Options, Pose, Report, Solver, VolumeSkin};

const RINGS: usize = 25;
const SEGMENTS: usize = 10;

fn turns() -> impl Strategy<Value = Vec<DVec3>> {
    proptest::collection::vec([-1.2..1.2, -1.2..1.2, -1.2..1.2].prop_map(DVec3::from_array), 3)
}

fn kinds_of_fields() -> impl Strategy<Value = Fields> {
    prop_oneof![Just(Fields::Plain), Just(Fields::Even)]
}

fn solvers() -> impl Strategy<Value = Solver> {
    prop_oneof![Just(Solver::Simultaneous), Just(Solver::Sequential)]
}

fn modes() -> impl Strategy<Value = Mode> {
    prop_oneof![Just(Mode::Linear), Just(Mode::DualQuaternion)]
}

/// A tube whose vertices are not in rows.
fn rough_tube() -> character::Faces {
    let (mut positions, offsets, corners) = tube(RINGS, SEGMENTS);
    for (i, p) in positions.iter_mut().enumerate() {
        let i = i as f64;
        *p += 0.05 * DVec3::new((3.1 * i).sin(), (5.3 * i).sin(), (7.7 * i).sin());
    }
    (positions, offsets, corners)
}

/// 1 within a distance of a vertex.
fn patch(positions: &[DVec3], vertex: usize, radius: f64) -> Vec<f32> {
    let centre = positions[vertex % positions.len()];
    positions.iter().map(|p| if p.distance(centre) < radius { 1.0 } else { 0.0 }).collect()
}

struct Frame {
    report: Report,
    offsets: Vec<[f32; 3]>,
    skinned: Vec<DVec3>,
    corrected: Vec<DVec3>,
}

fn deformed(body: &VolumeSkin, matrices: &[DMat4], target_scale: f64) -> Frame {
    let (mut workspace, mut offsets) = (body.workspace(), vec![[0.0; 3]; body.vertex_count()]);
    let report = body.deform(&Pose { target_scale, ..Pose::new(matrices) }, &mut workspace, &mut offsets).expect("a sound pose").clone();
    let (skinned, corrected) = body.positions(&workspace);
    Frame { report, offsets, skinned, corrected }
}

fn of(faces: &character::Faces, mode: Mode, solver: Solver) -> VolumeSkin {
    bound(faces, 3, mode, &[], &[]).with_joints(&[], Options { solver, ..Options::default() }).expect("the same joints")
}

/// The tube on its bones, so many times as large.
fn of_size(faces: &character::Faces, size: f64, options: Options) -> VolumeSkin {
    let skinning = character::skinning_of_size(&faces.0, 3, Mode::Linear, size);
    let positions: Vec<DVec3> = faces.0.iter().map(|p| *p * size).collect();
    let topology = turgor::Topology::new(&positions, &faces.1, &faces.2, 0.0).expect("a sound tube");
    VolumeSkin::bind(&topology, &positions, &skinning, &[], options, &[], &DMat4::IDENTITY).expect("a character")
}

fn posed_of_size(turns: &[DVec3], size: f64) -> Vec<DMat4> {
    let mut matrices = posed(turns);
    for matrix in &mut matrices {
        matrix.w_axis *= DVec4::new(size, size, size, 1.0);
    }
    matrices
}

fn mesh_of(faces: &character::Faces) -> Mesh {
    Mesh::new(faces.0.clone(), &faces.1, &faces.2, 0.0).expect("a sound tube")
}

fn volume(faces: &character::Faces, positions: &[DVec3]) -> f64 {
    mesh_of(faces).component_volumes(positions).expect("as many positions").iter().sum()
}

/// A vertex that a mask pins stays as skinned, the volume is exact, and what may move goes no further than it must.
fn assert_given_back(faces: &character::Faces, mask: &[f32], frame: &Frame, target_scale: f64) {
    for (offset, _) in frame.offsets.iter().zip(mask).filter(|(_, m)| **m == 0.0) {
        assert_eq!(*offset, [0.0; 3]);
    }
    let target = target_scale * volume(faces, &faces.0);
    let found = volume(faces, &frame.corrected);
    assert!(((found - target) / target).abs() < 1e-12, "{found} instead of {target}");
    assert!(((frame.report.corrected_volumes[0] - target) / target).abs() < 1e-12);
    let lost: f64 = frame.report.joint_losses.iter().map(|loss| loss.abs()).sum();
    let asked = lost + (target - volume(faces, &frame.skinned)).abs() + 1e-3 * target;
    let gradient = mesh_of(faces).volume_gradient(&frame.skinned).expect("as many positions");
    let moved = frame.corrected.iter().zip(&frame.skinned).map(|(corrected, skinned)| *corrected - *skinned);
    let slope: f64 = gradient.iter().zip(moved).map(|(g, moved)| g.dot(moved)).sum();
    // Fields are trusted up to twice what is asked for by the slope of the volume at the skinned surface; the rest is linear.
    assert!(slope.abs() < 3.5 * asked, "worth {slope} where {asked} is asked for");
    let free: f64 = gradient.iter().zip(mask).map(|(g, m)| g.length() * f64::from(*m)).sum();
    let most = frame.report.max_displacement;
    assert!(most * free < 6.0 * asked, "{most} where {} on average were enough", asked / free);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// However far it must go: fields bend over before, so the last step is along one direction.
    #[test]
    fn a_small_patch_alone_gives_all_back_and_goes_no_further_than_it_must(
        turns in turns(), mode in modes(), solver in solvers(), vertex in any::<usize>(), radius in 0.01..0.6, target_scale in 0.5..1.5,
    ) {
        let faces = rough_tube();
        let mask = patch(&faces.0, vertex, radius);
        let frame = deformed(&of(&faces, mode, solver).with_mask(Some(&mask)).expect("a mask"), &posed(&turns), target_scale);
        assert_given_back(&faces, &mask, &frame, target_scale);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Without a mask, however far from what skinning leaves.
    #[test]
    fn every_target_is_reached(turns in turns(), mode in modes(), solver in solvers(), target_scale in 0.05..9.0) {
        let faces = rough_tube();
        let frame = deformed(&of(&faces, mode, solver), &posed(&turns), target_scale);
        let target = target_scale * volume(&faces, &faces.0);
        let found = volume(&faces, &frame.corrected);
        prop_assert!(((found - target) / target).abs() < 1e-12, "{found} instead of {target}");
        prop_assert!(((frame.report.corrected_volumes[0] - target) / target).abs() < 1e-12);
    }

    /// Metres or millimetres, and whatever may move: all lengths grow alike.
    #[test]
    fn a_larger_body_moves_as_much_further(turns in turns(), vertex in any::<usize>(), radius in 0.01..0.6, exponent in -30..30) {
        let faces = rough_tube();
        let mask = patch(&faces.0, vertex, radius);
        let size = 2f64.powi(exponent);
        let [own, larger] = [1.0, size].map(|size| {
            let body = of_size(&faces, size, Options::default()).with_mask(Some(&mask)).expect("a mask");
            let (matrices, mut workspace) = (posed_of_size(&turns, size), body.workspace());
            let pose = Pose { target_scale: 1.1, ..Pose::new(&matrices) };
            let mut offsets = vec![[0.0; 3]; body.vertex_count()];
            body.deform(&pose, &mut workspace, &mut offsets).expect("a sound pose");
            offsets
        });
        let most = own.iter().flatten().fold(0.0, |most: f32, x| most.max(x.abs()));
        for (a, b) in own.iter().flatten().zip(larger.iter().flatten()) {
            prop_assert!((f64::from(*a) - f64::from(*b) / size).abs() <= 1e-4 * f64::from(most), "{a} against {b}");
        }
    }

    /// A mask that takes next to nothing changes next to nothing.
    #[test]
    fn the_frame_is_continuous_in_the_mask(turns in turns(), mode in modes(), solver in solvers(), phase in 0.0..6.0f32) {
        let faces = rough_tube();
        let body = of(&faces, mode, solver);
        let mask: Vec<f32> = (0..faces.0.len()).map(|i| 1.0 - 1e-5 * (1.0 + (i as f32 + phase).sin())).collect();
        let [free, masked] = [None, Some(&*mask)].map(|mask| deformed(&body.with_mask(mask).expect("a mask"), &posed(&turns), 1.0));
        for (a, b) in free.corrected.iter().zip(&masked.corrected) {
            prop_assert!(a.distance(*b) <= 1e-3 * free.report.max_displacement + 1e-9);
        }
    }

    /// Beyond what single precision holds the skin is left alone: never a number that is none.
    #[test]
    fn whatever_is_asked_for_offsets_are_numbers(
        turns in turns(), solver in solvers(), size in -14.0..1.0, grown in prop_oneof![-160.0..0.0, 0.0..28.0], target in -9.0..9.0,
        keep_bone_scale in any::<bool>(), fields in kinds_of_fields(), masked in proptest::option::of(any::<usize>()),
    ) {
        let faces = rough_tube();
        let mask = masked.map(|vertex| patch(&faces.0, vertex, 0.3));
        let size = 10f64.powf(size);
        let body = of_size(&faces, size, Options { solver, keep_bone_scale, fields }).with_mask(mask.as_deref()).expect("a mask");
        let matrices: Vec<DMat4> = posed_of_size(&turns, size).into_iter().map(|matrix| matrix * DMat4::from_scale(DVec3::splat(10f64.powf(grown)))).collect();
        let (mut workspace, mut offsets) = (body.workspace(), vec![[0.0; 3]; body.vertex_count()]);
        let pose = Pose { target_scale: 10f64.powf(target), ..Pose::new(&matrices) };
        if let Ok(report) = body.deform(&pose, &mut workspace, &mut offsets) {
            prop_assert!(report.corrected_volumes[0].is_finite() && report.max_displacement.is_finite());
            prop_assert!(offsets.iter().flatten().all(|x| x.is_finite()));
        }
    }
}

#[test]
fn nothing_moves_at_rest() {
    for solver in [Solver::Simultaneous, Solver::Sequential] {
        let faces = rough_tube();
        for mask in [None, Some(patch(&faces.0, 7, 0.3))] {
            let body = of(&faces, Mode::Linear, solver).with_mask(mask.as_deref()).expect("a mask");
            let frame = deformed(&body, &posed(&[DVec3::ZERO; 3]), 1.0);
            assert!(frame.offsets.iter().flatten().all(|x| *x == 0.0));
        }
    }
}

/// One step after the other has moved them by then: the last one starts from the skinned surface, along its own gradient.
#[test]
fn few_vertices_that_take_much_do_not_fly_off() {
    let faces = rough_tube();
    let turns = [DVec3::ZERO, DVec3::new(0.0, -0.534_117_950_980_605_3, 0.981_034_287_158_91), DVec3::new(0.0, -0.663_897_671_583_51, 0.0)];
    let target_scale = 0.566_563_923_470_039_6;
    for vertex in 0..faces.0.len() {
        let mask = patch(&faces.0, vertex, 0.265);
        let body = of(&faces, Mode::DualQuaternion, Solver::Sequential).with_mask(Some(&mask)).expect("a mask");
        assert_given_back(&faces, &mask, &deformed(&body, &posed(&turns), target_scale), target_scale);
    }
}
