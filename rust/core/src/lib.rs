//! Exact volume for skinned meshes.
//!
//! A mesh that bones bend loses volume. A [`VolumeSkin`] gives it back on every frame, exactly, and where an artist wants it:
//! bind a [`Mesh`] to its [`Skinning`] once, then [`deform`](VolumeSkin::deform) each [`Pose`].
//!
//! ```
//! use glam::{DMat4, DVec3};
//! use turgor::{Mesh, Mode, Options, Pose, Skeleton, Skinning, VolumeSkin};
//!
//! // A square rod along z in five rings, and two bones that meet in its middle.
//! let ring = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
//! let rest: Vec<DVec3> = (0..5).flat_map(|z| ring.map(|(x, y)| DVec3::new(x, y, f64::from(z)))).collect();
//! let mut faces = vec![vec![3, 2, 1, 0], vec![16, 17, 18, 19]];
//! for z in 0..4 {
//!     faces.extend((0..4).map(|i| [i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4].map(|corner| corner + 4 * z).to_vec()));
//! }
//! let offsets: Vec<i32> = (0..=faces.len()).map(|face| 4 * face as i32).collect();
//! let mesh = Mesh::new(rest.clone(), &offsets, &faces.concat(), 0.0)?;
//!
//! let skeleton = Skeleton::new(&[-1, 0], &[DMat4::IDENTITY, DMat4::from_translation(2.0 * DVec3::Z)])?;
//! let upper = |p: &DVec3| (0.5 * p.z - 0.5).clamp(0.0, 1.0);
//! let weights: Vec<f64> = rest.iter().flat_map(|p| [1.0 - upper(p), upper(p)]).collect();
//! let first_of_vertex: Vec<i32> = (0..=20).map(|vertex| 2 * vertex).collect();
//! let skinning = Skinning::new(skeleton, &first_of_vertex, &[0, 1].repeat(20), &weights, Mode::Linear, None)?;
//! let body = VolumeSkin::bind(mesh.topology(), &rest, &skinning, &[], Options::default(), &[], &DMat4::IDENTITY)?;
//!
//! // The upper bone bends by a right angle about the joint.
//! let joint = DMat4::from_translation(2.0 * DVec3::Z);
//! let pose = [DMat4::IDENTITY, joint * DMat4::from_rotation_x(1.57) * joint.inverse()];
//! let (mut workspace, mut corrections) = (body.workspace(), vec![[0.0; 3]; rest.len()]);
//! body.deform(&Pose::new(&pose), &mut workspace, &mut corrections)?;
//! let (skinned, corrected) = body.positions(&workspace);
//! assert!(mesh.component_volumes(&skinned)?[0] < 3.6);
//! assert!((mesh.component_volumes(&corrected)?[0] - 4.0).abs() < 1e-12);
//! # Ok::<(), turgor::Error>(())
//! ```
//!
//! [`spine`] bends bodies along curves, every chunk of flesh keeping its volume; [`weights`] computes skinning weights.
//!
//! Pure geometry: knows neither Python nor Blender. Lengths are in the caller's units; f64, but for what fields add.
//! `MATH §n` in comments refers to the formulas collected in `docs/ARCHITECTURE.md`, \[RHC09\] to Rohmer, Hahmann, Cani:
//! *Exact volume preserving skinning with shape control*, SCA 2009, \[ZR13\] to Zhuo, Rossignac: *Fleshing: spine-driven
//! bending with local volume preservation*, 2013.

mod binding;
mod cores;
mod error;
mod fields;
mod flesh;
mod folds;
mod frame;
mod many_poses;
mod numeric;
mod parallel;
mod report;
mod skinning;
pub mod spine;
mod surface;
mod volume_losses;
mod volume_skin;
pub mod weights;
mod workspaces;

pub use error::{Error, Result, check_numbers};
pub use fields::bare_correction::Target;
pub use fields::joint::{Fields, Joint, Profiles, Shares};
pub use fields::profile::Profile;
pub use flesh::settings::Flesh;
pub use frame::{JointField, Pose, RefinementNeed, Workspace};
pub use report::{FoldCounts, Report};
pub use skinning::blend::{Mode, Skinning};
pub use skinning::skeleton::Skeleton;
pub use surface::mesh::Mesh;
pub use surface::topology::{Component, Status, Topology};
pub use surface::volume::VolumeCubic;
pub use volume_skin::{Options, Solver, VolumeSkin};
pub use workspaces::Workspaces;
