//! What leaves the engine, against what is computed apart: skin, offsets, positions, what another deformer adds, refusals.

mod character;

use character::{bound, posed, skinning, tube};
use glam::{DMat4, DQuat, DVec3};
use proptest::prelude::*;
use turgor::{Error, Mesh, Mode, Options, Pose, Report, Skeleton, Skinning, Topology, VolumeCubic, VolumeSkin};

fn vector() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
}

fn turns() -> impl Strategy<Value = Vec<DVec3>> {
    proptest::collection::vec(vector(), 3)
}

/// Somewhere, turned, and not scaled evenly.
fn place(turn: DVec3, at: DVec3) -> DMat4 {
    DMat4::from_translation(at * 3.0) * DMat4::from_quat(DQuat::from_scaled_axis(turn)) * DMat4::from_scale(DVec3::new(1.4, 0.7, 1.1))
}

/// Two tubes side by side, and a loose vertex: an odd number of vertices.
fn two_tubes() -> character::Faces {
    let (mut positions, mut offsets, mut corners) = tube(9, 7);
    let count = positions.len() as i32;
    positions.extend(positions.clone().iter().map(|p| *p * 0.9 + DVec3::X * 2.0));
    positions.push(DVec3::new(-2.0, 0.0, 1.0));
    offsets.extend(offsets.clone().iter().skip(1).map(|offset| offset + corners.len() as i32));
    corners.extend(corners.clone().iter().map(|corner| corner + count));
    (positions, offsets, corners)
}

fn mesh_of(faces: &character::Faces) -> Mesh {
    Mesh::new(faces.0.clone(), &faces.1, &faces.2, 0.0).expect("sound tubes")
}

/// Skinning may turn a shell over or flatten it, and then no field need reach its volume: only there, and the report has it.
fn is_exact_or_told(faces: &character::Faces, moved: &[DVec3], report: &Report, exact: f64) -> Result<(), TestCaseError> {
    let volumes = mesh_of(faces).component_volumes(moved).expect("as many positions");
    let told = report.skinned_volumes.iter().zip(&report.corrected_volumes);
    for ((found, target), (skinned, told)) in volumes.iter().zip(&report.target_volumes).zip(told) {
        prop_assert!(((found - told) / target).abs() < exact, "{found}, told {told}");
        prop_assert!(skinned < &(0.25 * target) || ((told - target) / target).abs() < 1e-12, "{told} instead of {target} after {skinned}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Weighted means of what each bone makes of a vertex, its mask a part of the way.
    #[test]
    fn linear_skin_is_the_mean_of_what_bones_make(
        turns in turns(), at in vector(), weights in proptest::collection::vec(0.0..1.0f64, 3 * 20), part in proptest::option::of(0.1..0.9f64),
    ) {
        let rest: Vec<DVec3> = (0..20).map(|i| DVec3::new((f64::from(i) * 0.7).sin(), (f64::from(i) * 1.3).cos(), f64::from(i) * 0.2)).collect();
        let skeleton = Skeleton::new(&[-1, 0, 1], &character::heads(3).into_iter().map(DMat4::from_translation).collect::<Vec<_>>()).expect("a chain");
        let (offsets, bones): (Vec<i32>, Vec<i32>) = ((0..=20).map(|i| 3 * i).collect(), (0..60).map(|i| i % 3).collect());
        let mask = part.map(|part| vec![part; 20]);
        let pose = posed(&turns);
        let object = place(turns[0], at);
        let into_armature = object.inverse();
        let skin = Skinning::new(skeleton, &offsets, &bones, &weights, Mode::Linear, mask.as_deref()).expect("sound weights");
        let found = skin.deform(&rest, &pose, &object).expect("a sound pose");
        for ((p, row), found) in rest.iter().zip(weights.chunks(3)).zip(&found) {
            let sum: f64 = row.iter().sum();
            let moved: DVec3 = pose.iter().zip(row).map(|(m, w)| (object * *m * into_armature).transform_point3(*p) * (w / sum)).sum();
            prop_assert!(found.distance(p.lerp(moved, part.unwrap_or(1.0))) < 1e-12);
        }
    }

    /// The offsets of a frame lead from the skin to what has the volume, in object space, shell by shell; loose vertices have none.
    #[test]
    fn offsets_lead_from_the_skin_to_the_volume(turns in turns(), at in vector(), mode in prop_oneof![Just(Mode::Linear), Just(Mode::DualQuaternion)]) {
        let faces = two_tubes();
        let body = bound(&faces, 3, mode, &[], &[]);
        let (matrices, object) = (posed(&turns), place(turns[1], at));
        let pose = Pose { object_from_armature: object, ..Pose::new(&matrices) };
        let (mut workspace, mut offsets) = (body.workspace(), vec![[f32::NAN; 3]; faces.0.len()]);
        let report = body.deform(&pose, &mut workspace, &mut offsets).expect("a sound pose").clone();
        let offsets: Vec<DVec3> = offsets.iter().map(|o| DVec3::from_array(o.map(f64::from))).collect();
        let skin = skinning(&faces.0, 3, mode).deform(&faces.0, &matrices, &object).expect("a sound pose");
        let moved: Vec<DVec3> = skin.iter().zip(&offsets).map(|(p, offset)| *p + *offset).collect();
        is_exact_or_told(&faces, &moved, &report, 1e-6)?;
        let most = offsets.iter().map(|offset| offset.length()).fold(0.0, f64::max);
        prop_assert!((most - report.max_displacement).abs() <= 1e-6 * most);
        prop_assert_eq!(offsets[faces.0.len() - 1], DVec3::ZERO);
        for (a, b) in body.positions(&workspace).1.iter().zip(&moved) {
            prop_assert!(a.distance(*b) < 1e-5);
        }
    }

    /// What another deformer adds is part of the skin: it stays, and the volume is exact with it, frame by frame and many at once.
    #[test]
    fn what_is_added_is_skin(turns in turns(), at in vector(), shift in vector()) {
        let faces = two_tubes();
        let body = bound(&faces, 3, Mode::Linear, &[], &[]);
        let (matrices, object) = (posed(&turns), place(turns[1], at));
        let added: Vec<[f32; 3]> = (0..faces.0.len()).map(|i| (shift * (0.02 * (i % 5) as f64 + 0.1)).as_vec3().to_array()).collect();
        let pose = Pose { object_from_armature: object, added_offsets: Some(&added), ..Pose::new(&matrices) };
        let (mut workspace, mut offsets) = (body.workspace(), vec![[f32::NAN; 3]; faces.0.len()]);
        let report = body.deform(&pose, &mut workspace, &mut offsets).expect("a sound pose").clone();
        let skin = skinning(&faces.0, 3, Mode::Linear).deform(&faces.0, &matrices, &object).expect("a sound pose");
        let (skinned, corrected) = body.positions(&workspace);
        for ((found, plain), added) in skinned.iter().zip(&skin).zip(&added) {
            prop_assert!(found.distance(*plain + DVec3::from_array(added.map(f64::from))) < 1e-6);
        }
        is_exact_or_told(&faces, &corrected, &report, 1e-12)?;
    }

    /// Where a cubic rises or falls throughout, its root is found, and is one.
    #[test]
    fn the_root_of_a_cubic_is_one(c0 in -5.0..5.0f64, c1 in 0.3..3.0f64, c2 in -1.0..1.0f64, part in 0.4..2.0f64, target in -9.0..9.0f64, sign in prop_oneof![Just(1.0), Just(-1.0)]) {
        // The slope c1 + 2 c2 t + 3 c3 t² has no root.
        let c3 = part * c2 * c2 / c1;
        let cubic = VolumeCubic([c0, sign * c1, sign * c2, sign * c3]);
        let root = cubic.root_nearest_zero(target);
        prop_assert!(root.is_some_and(|t| (cubic.at(t) - target).abs() <= 1e-9 * (target - c0).abs() + 1e-13), "{root:?}");
        let by_powers = |t: f64| c0 + sign * (c1 * t + c2 * t * t + c3 * t * t * t);
        prop_assert!((cubic.at(0.7) - by_powers(0.7)).abs() < 1e-12);
    }
}

#[test]
fn a_cubic_that_does_not_reach_has_no_root() {
    // 1 − t²/4 and a constant.
    assert_eq!(VolumeCubic([1.0, 1e-9, -0.25, 0.0]).root_nearest_zero(5.0), None);
    assert_eq!(VolumeCubic([1.0, 0.0, 0.0, 0.0]).root_nearest_zero(2.0), None);
    assert_eq!(VolumeCubic([1.0, 0.0, 0.0, 0.0]).root_nearest_zero(1.0), Some(0.0));
    assert_eq!(VolumeCubic([1.0, 1.0, 0.0, 0.0]).root_nearest_zero(f64::INFINITY), None);
}

#[test]
fn what_is_no_skin_or_pose_is_refused() {
    let faces = tube(9, 7);
    let skeleton = || Skeleton::new(&[-1], &[DMat4::IDENTITY]).expect("a bone");
    let offsets: Vec<i32> = (0..=2).collect();
    let refused = Skinning::new(skeleton(), &offsets, &[0, 0], &[1.0, -0.5], Mode::Linear, None);
    assert!(matches!(refused, Err(Error::Value { what: "weights", .. })));
    let refused = Skinning::new(skeleton(), &offsets, &[0, 0], &[1.0, 0.5], Mode::Linear, Some(&[0.5, -0.5]));
    assert!(matches!(refused, Err(Error::Value { what: "vertex_mask", .. })));
    assert!(Skinning::new(skeleton(), &offsets, &[0, 0], &[1.0, 0.0], Mode::Linear, Some(&[0.0, 1.0])).is_ok());

    let body = bound(&faces, 3, Mode::Linear, &[], &[]);
    let (mut workspace, mut room) = (body.workspace(), vec![[0.0; 3]; body.vertex_count()]);
    let two = posed(&[DVec3::ZERO; 2]);
    assert!(matches!(body.deform(&Pose::new(&two), &mut workspace, &mut room), Err(Error::BoneCount { found: 2, bound: 3 })));
    let matrices = posed(&[DVec3::ZERO; 3]);
    for (scale, is_sound) in
        [(DVec3::new(1.0, 0.0, 1.0), false), (DVec3::new(1e-13, 1.0, 1.0), true), (DVec3::splat(1e-9), true), (DVec3::splat(1e3), true)]
    {
        let turned = DMat4::from_quat(DQuat::from_rotation_x(0.3)) * DMat4::from_scale(scale);
        let found = body.deform(&Pose { object_from_armature: turned, ..Pose::new(&matrices) }, &mut workspace, &mut room);
        assert_eq!(matches!(found, Err(Error::Singular { .. })), !is_sound, "{scale}");
    }
    // Two columns that are one but for rounding: as good as without an inverse, at any size.
    for size in [1e-6, 1.0, 1e6] {
        let flat = DMat4::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 1.0, 1e-13, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let flat = DMat4::from_scale(DVec3::splat(size)) * flat;
        let found = body.deform(&Pose { object_from_armature: flat, ..Pose::new(&matrices) }, &mut workspace, &mut room);
        assert!(matches!(found, Err(Error::Singular { .. })), "{size}");
    }
    let topology = Topology::new(&faces.0, &faces.1, &faces.2, 0.0).expect("a sound tube");
    let short = skinning(&faces.0[1..], 3, Mode::Linear);
    assert!(VolumeSkin::bind(&topology, &faces.0, &short, &[], Options::default(), &[], &DMat4::IDENTITY).is_err());
}
