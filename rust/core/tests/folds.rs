//! What holds of repaired folds, for every mesh and every pose.

mod character;

use character::{bound, posed, tube};
use glam::{DMat4, DVec3};
use proptest::prelude::*;
use turgor::{Mode, Pose, Report, VolumeSkin, Workspace};

/// Bends about one axis, deep ones too.
fn bends(bones: usize) -> impl Strategy<Value = Vec<DVec3>> {
    proptest::collection::vec((-2.6..2.6, -0.3..0.3).prop_map(|(bend, twist)| DVec3::new(bend, 0.0, twist)), bones)
}

fn modes() -> impl Strategy<Value = Mode> {
    prop_oneof![Just(Mode::Linear), Just(Mode::DualQuaternion)]
}

struct Frame {
    report: Report,
    offsets: Vec<[f32; 3]>,
    skinned: Vec<DVec3>,
    corrected: Vec<DVec3>,
}

fn deformed(body: &VolumeSkin, matrices: &[DMat4], repair_folds: bool, workspace: &mut Workspace) -> Frame {
    let mut offsets = vec![[0.0; 3]; body.vertex_count()];
    let report = body.deform(&Pose { repair_folds, ..Pose::new(matrices) }, workspace, &mut offsets).expect("a sound pose").clone();
    let (skinned, corrected) = body.positions(workspace);
    Frame { report, offsets, skinned, corrected }
}

fn volume(faces: &character::Faces, positions: &[DVec3]) -> f64 {
    let mesh = turgor::Mesh::new(faces.0.clone(), &faces.1, &faces.2, 0.0).expect("a sound tube");
    mesh.component_volumes(positions).expect("as many positions").iter().sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn blocked_vertices_stand_on_their_way_and_the_volume_is_exact(bends in bends(3), mode in modes()) {
        let faces = tube(41, 16);
        let body = bound(&faces, 3, mode, &[], &[]);
        let mut workspace = body.workspace();
        let plain = deformed(&body, &posed(&bends), false, &mut workspace);
        let repaired = deformed(&body, &posed(&bends), true, &mut workspace);
        prop_assert!(repaired.report.folds_left <= repaired.report.folds_found);
        let rest = volume(&faces, &faces.0);
        prop_assert!(((volume(&faces, &repaired.corrected) - rest) / rest).abs() < 1e-12);
        for &vertex in &repaired.report.blocked_vertices {
            let vertex = vertex as usize;
            let (way, gone) = (plain.corrected[vertex] - plain.skinned[vertex], repaired.corrected[vertex] - plain.skinned[vertex]);
            let share = gone.dot(way) / way.length_squared();
            prop_assert!((-1e-6..=1.0 + 1e-6).contains(&share) && gone.distance(way * share) <= 1e-6 * way.length());
        }
        if repaired.report.folds_found == 0 {
            prop_assert_eq!(plain.offsets, repaired.offsets);
        }
    }

    #[test]
    fn a_repaired_frame_does_not_depend_on_threads_or_on_the_frame_before(bends in bends(3), before in bends(3)) {
        let faces = tube(61, 24);
        let body = bound(&faces, 3, Mode::Linear, &[], &[]);
        let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
        let one = pool(1).install(|| deformed(&body, &posed(&bends), true, &mut body.workspace()));
        let mut workspace = body.workspace();
        let three = pool(3).install(|| {
            deformed(&body, &posed(&before), true, &mut workspace);
            deformed(&body, &posed(&bends), true, &mut workspace)
        });
        prop_assert_eq!(one.report, three.report);
        prop_assert_eq!(one.offsets, three.offsets);
        prop_assert_eq!(one.corrected, three.corrected);
    }
}
