//! What holds for every mesh and every pose.

mod character;

use character::{bound, posed, skinning, tube};
use glam::{DMat4, DQuat, DVec3};
use proptest::prelude::*;
use turgor::{
    Joint, Mesh, Mode, Options, Pose, Profile, Profiles, Report, Shares, Skeleton, Skinning, Topology, VolumeSkin, Workspace, Workspaces,
};

/// A turn of a bone, at most about 100 degrees.
fn turn() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
}

fn turns(bones: usize) -> impl Strategy<Value = Vec<DVec3>> {
    proptest::collection::vec(turn(), bones)
}

fn modes() -> impl Strategy<Value = Mode> {
    prop_oneof![Just(Mode::Linear), Just(Mode::DualQuaternion)]
}

/// Figures of one frame.
fn deformed(body: &VolumeSkin, pose: &[DMat4], workspace: &mut Workspace) -> Report {
    let mut offsets = vec![[0.0; 3]; body.vertex_count()];
    body.deform(&Pose::new(pose), workspace, &mut offsets).expect("a sound pose").clone()
}

/// Corrected positions of one frame.
fn corrected(body: &VolumeSkin, pose: &[DMat4]) -> Vec<DVec3> {
    let mut workspace = body.workspace();
    deformed(body, pose, &mut workspace);
    body.positions(&workspace).1
}

fn volume(mesh: &Mesh, positions: &[DVec3]) -> f64 {
    mesh.component_volumes(positions).expect("as many positions").iter().sum()
}

/// Of what holds the shell beside, and of the limb's two bones.
const LIMB_HEADS: [DVec3; 3] = [DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 1.9), DVec3::new(0.0, 0.0, 2.0)];

/// Two tubes side by side: the first on two bones, blended in its middle, the second on their parent, unless they are cut off.
fn limb_beside_a_shell(mode: Mode, is_cut: bool) -> (character::Faces, Skinning) {
    let (mut positions, mut offsets, mut corners) = tube(33, 12);
    let count = positions.len();
    let beside: Vec<DVec3> = positions.iter().map(|&p| p + DVec3::new(3.0, 0.0, 0.0)).collect();
    offsets.extend(offsets.clone().iter().skip(1).map(|offset| offset + corners.len() as i32));
    corners.extend(corners.clone().iter().map(|corner| corner + count as i32));
    let (mut bones, mut weights, mut weight_offsets) = (Vec::new(), Vec::new(), vec![0]);
    for p in &positions {
        let after = (p.z / 1.2 - 1.2).clamp(0.0, 1.0);
        bones.extend([1, 2]);
        weights.extend([1.0 - after, after]);
        weight_offsets.push(weights.len() as i32);
    }
    for _ in &beside {
        bones.push(0);
        weights.push(1.0);
        weight_offsets.push(weights.len() as i32);
    }
    positions.extend(beside);
    let parents = if is_cut { [-1, -1, -1] } else { [-1, 0, 0] };
    let skeleton = Skeleton::new(&parents, &LIMB_HEADS.map(DMat4::from_translation)).expect("three bones");
    let skinning = Skinning::new(skeleton, &weight_offsets, &bones, &weights, mode, None).expect("sound weights");
    ((positions, offsets, corners), skinning)
}

fn bound_to(faces: &character::Faces, skinning: &Skinning, shape_deltas: &[Vec<DVec3>]) -> VolumeSkin {
    let (positions, offsets, corners) = faces;
    let topology = Topology::new(positions, offsets, corners, 0.0).expect("sound tubes");
    VolumeSkin::bind(&topology, positions, skinning, &[], Options::default(), shape_deltas, &DMat4::IDENTITY).expect("a character")
}

fn mesh_of(faces: &character::Faces) -> Mesh {
    Mesh::new(faces.0.clone(), &faces.1, &faces.2, 0.0).expect("a sound tube")
}

/// A bulge on the inside of the bend.
fn bulge(bone: usize) -> Joint {
    let curve = |f: fn(f64) -> f64| Profile::new(&(0..65).map(|i| f(f64::from(i) / 32.0 - 1.0)).collect::<Vec<f64>>()).expect("a curve");
    let bell = || curve(|x| (-16.0 * x * x).exp());
    let inside = curve(|x| x.max(0.0) * (-16.0 * x * x).exp());
    let profiles = Profiles { axes: [bell(), bell(), inside], folded: None };
    Joint { profiles: Some(profiles), shares: Shares::along([0.1, 0.1, 0.8]), ..Joint::isotropic(bone) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_gradient_of_a_closed_surface_sums_to_nothing_and_has_no_moment(seed in proptest::collection::vec(turn(), 14 * 9 + 2)) {
        let faces = tube(14, 9);
        let mesh = mesh_of(&faces);
        let positions: Vec<DVec3> = faces.0.iter().zip(&seed).map(|(p, s)| *p + *s * 0.1).collect();
        let gradient = mesh.volume_gradient(&positions).expect("as many positions");
        let sum: DVec3 = gradient.iter().sum();
        let moment: DVec3 = positions.iter().zip(&gradient).map(|(p, g)| p.cross(*g)).sum();
        let thrice: f64 = positions.iter().zip(&gradient).map(|(p, g)| p.dot(*g)).sum();
        prop_assert!(sum.length() < 1e-13 && moment.length() < 1e-13);
        prop_assert!((thrice - 3.0 * volume(&mesh, &positions)).abs() < 1e-12);
    }

    #[test]
    fn every_pose_keeps_its_volume(turns in turns(5), mode in modes(), is_shaped in any::<bool>()) {
        let faces = tube(41, 16);
        let joints: Vec<Joint> = if is_shaped { (0..5).map(bulge).collect() } else { Vec::new() };
        let mesh = mesh_of(&faces);
        let found = volume(&mesh, &corrected(&bound(&faces, 5, mode, &joints, &[]), &posed(&turns)));
        let rest = volume(&mesh, &faces.0);
        prop_assert!(((found - rest) / rest).abs() < 1e-13, "{found} instead of {rest}");
    }

    #[test]
    fn losses_sum_to_what_skinning_takes(turns in turns(5), mode in modes()) {
        let faces = tube(41, 16);
        let body = bound(&faces, 5, mode, &[], &[]);
        let mut workspace = body.workspace();
        let report = deformed(&body, &posed(&turns), &mut workspace);
        let lost = report.target_volumes[0] - report.skinned_volumes[0];
        prop_assert!((report.joint_losses.iter().sum::<f64>() - lost).abs() < 1e-12);
    }

    /// A shape key that moves nothing makes the engine sweep stages where it would use the closed form.
    #[test]
    fn closed_form_and_stages_find_the_same_losses(turns in turns(5)) {
        let faces = tube(41, 16);
        let still = vec![DVec3::ZERO; faces.0.len()];
        let (closed, staged) = (bound(&faces, 5, Mode::Linear, &[], &[]), bound(&faces, 5, Mode::Linear, &[], &[still]));
        let pose = posed(&turns);
        let (mut first, mut second) = (closed.workspace(), staged.workspace());
        let first = deformed(&closed, &pose, &mut first);
        let second = deformed(&staged, &pose, &mut second);
        for (a, b) in first.joint_losses.iter().zip(&second.joint_losses) {
            prop_assert!((a - b).abs() < 1e-12, "{a} against {b}");
        }
    }

    /// A limb on two bones whose parent holds another shell: it is told against a base of its own, and cut chains are put together.
    #[test]
    fn closed_form_and_stages_agree_below_a_bone_whose_skin_is_elsewhere(turns in turns(3), shift in turn(), is_cut in any::<bool>()) {
        let (faces, skinning) = limb_beside_a_shell(Mode::Linear, is_cut);
        let still = vec![DVec3::ZERO; faces.0.len()];
        let turned = |bone: usize| {
            let head = LIMB_HEADS[bone];
            DMat4::from_translation(head) * DMat4::from_quat(DQuat::from_scaled_axis(turns[bone])) * DMat4::from_translation(-head)
        };
        let root = turned(0);
        let together = root * DMat4::from_translation(shift * 9.0);
        let pose = [root, together * turned(1), together * turned(2)];
        let figures = [&[][..], std::slice::from_ref(&still)].map(|shapes| {
            let body = bound_to(&faces, &skinning, shapes);
            deformed(&body, &pose, &mut body.workspace())
        });
        for (a, b) in figures[0].joint_losses.iter().zip(&figures[1].joint_losses) {
            prop_assert!((a - b).abs() < 1e-11, "{a} against {b}");
        }
        let lost = |shell: usize| figures[0].target_volumes[shell] - figures[0].skinned_volumes[shell];
        prop_assert!((figures[0].joint_losses.iter().sum::<f64>() - lost(0) - lost(1)).abs() < 1e-11);
        let rest = mesh_of(&faces).component_volumes(&faces.0).expect("as many positions");
        for (target, rest) in figures[0].target_volumes.iter().zip(rest) {
            prop_assert!((target - rest).abs() < 1e-10, "{target} against {rest}");
        }
    }

    /// In a surface of several patches, each point is skinned with those it shares a patch with: not otherwise than alone.
    #[test]
    fn the_skin_is_that_of_skinning_alone(turns in turns(5), mode in modes()) {
        let faces = tube(41, 16);
        let pose = posed(&turns);
        let body = bound(&faces, 5, mode, &[], &[]);
        let mut workspace = body.workspace();
        let report = deformed(&body, &pose, &mut workspace);
        let alone = skinning(&faces.0, 5, mode).deform(&faces.0, &pose, &DMat4::IDENTITY).expect("a sound pose");
        for (a, b) in body.positions(&workspace).0.iter().zip(&alone) {
            prop_assert!(a.distance(*b) < 1e-13);
        }
        prop_assert!((report.skinned_volumes[0] - volume(&mesh_of(&faces), &alone)).abs() < 1e-12);
    }

    #[test]
    fn a_frame_does_not_depend_on_threads_or_on_the_frame_before(turns in turns(5), before in turns(5), mode in modes()) {
        let faces = tube(161, 24);
        let body = bound(&faces, 5, mode, &[], &[]);
        let pose = posed(&turns);
        let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
        let one = pool(1).install(|| corrected(&body, &pose));
        let three = pool(3).install(|| corrected(&body, &pose));
        let mut workspace = body.workspace();
        deformed(&body, &posed(&before), &mut workspace);
        deformed(&body, &pose, &mut workspace);
        prop_assert_eq!(&one, &three);
        prop_assert_eq!(&one, &body.positions(&workspace).1);
    }

    /// Positions of many poses at once against each frame's own, with what another deformer adds, objects anywhere, vertices at one
    /// place that are held differently.
    #[test]
    fn many_poses_give_the_bits_of_each_alone(turns in turns(5), shift in turn(), effect in 0.0..1.0, mode in modes(), is_split in any::<bool>(), is_added in any::<bool>()) {
        let faces = if is_split { split_apart(&tube(9, 7)) } else { tube(9, 7) };
        let body = bound(&faces, 5, mode, &[], &[]);
        let matrices = posed(&turns);
        let added: Vec<[f32; 3]> = (0..faces.0.len()).map(|i| shift.to_array().map(|x| (x * ((i % 7) as f64 - 3.0) * 0.01) as f32)).collect();
        let pose = Pose {
            object_from_armature: DMat4::from_scale_rotation_translation(DVec3::splat(1.5), glam::DQuat::from_rotation_y(0.4), shift * 9.0),
            added_offsets: is_added.then_some(&*added),
            ..Pose::new(&matrices)
        };
        let mut many = vec![[f32::NAN; 3]; 2 * faces.0.len()];
        body.deform_many(&[pose, pose], &[effect, 1.0], &mut many, &Workspaces::default()).expect("sound poses");
        let (mut workspace, mut offsets) = (body.workspace(), vec![[0.0; 3]; faces.0.len()]);
        body.deform(&pose, &mut workspace, &mut offsets).expect("a sound pose");
        let skinned = body.positions(&workspace).0;
        for (part, rows) in [effect, 1.0].into_iter().zip(many.chunks(faces.0.len())) {
            for ((p, offset), row) in skinned.iter().zip(&offsets).zip(rows) {
                for axis in 0..3 {
                    prop_assert_eq!(row[axis], (p[axis] + part * f64::from(offset[axis])) as f32);
                }
            }
        }
    }
}

/// Every face with vertices of its own, as importers leave hard seams.
fn split_apart((positions, offsets, corners): &character::Faces) -> character::Faces {
    let own = corners.iter().map(|&corner| positions[corner as usize]).collect();
    (own, offsets.clone(), (0..corners.len() as i32).collect())
}
