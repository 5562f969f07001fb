//! What a bound character is made of: everything that does not change from frame to frame, nor with the artist's settings.

use glam::{DAffine3, DVec3};

use crate::csr::Csr;
use crate::error::{Error, Result};
use crate::joint::Joint;
use crate::sites::Sites;
use crate::skeleton::JointTree;
use crate::skinning::{Influences, Skinning};
use crate::supports::Supports;
use crate::surface::Surface;
use crate::topology::Topology;
use crate::volume::face_area_vector;
use crate::volume_loss::{FaceGroups, LossPlan, Moment, Motions};

/// A mesh bound to its weights.
pub(crate) struct Binding {
    pub topology: Topology,
    /// Skinned sites; rest positions are about `rest_centre`.
    pub sites: Sites,
    pub rest_centre: DVec3,
    /// Per shape key, displacement per site.
    pub shape_deltas: Vec<Vec<DVec3>>,
    /// Motions at rest, to be copied into workspaces.
    pub motions: Motions,
    pub plan: LossPlan,
    pub surface: Surface,
    /// Component of each group of the surface.
    pub component_of_group: Vec<u32>,
    pub rest_moments: Vec<Moment>,
    /// 1 / rest area per point, armature space; 0 where the surface has none.
    pub inverse_areas: Vec<f32>,
    /// Per joint and for the world, weight and weighted mean of the sites.
    pub masses: Vec<(f64, DVec3)>,
    /// Largest distance from the centre, armature space.
    pub size: f64,
    pub bone_count: usize,
    armature_from_rest: DAffine3,
}

impl Binding {
    pub fn new(
        topology: Topology,
        rest: &[DVec3],
        skinning: &Skinning,
        shape_deltas: &[Vec<DVec3>],
        armature_from_object: DAffine3,
    ) -> Self {
        let rest_centre = rest.iter().copied().sum::<DVec3>() / rest.len().max(1) as f64;
        let armature_from_rest = armature_from_object * DAffine3::from_translation(rest_centre);
        let centred: Vec<DVec3> = rest.iter().map(|&p| p - rest_centre).collect();
        let in_armature: Vec<DVec3> = centred.iter().map(|&p| armature_from_rest.transform_point3(p)).collect();
        let tree = JointTree::new(&skinning.skeleton, &skinning.influences, &in_armature);
        let influences = on_joints(&skinning.influences, skinning.skeleton.len(), &tree);
        let mut sites = Sites::new(&topology, &centred, influences, shape_deltas);
        let mut deltas_of_sites = vec![vec![DVec3::ZERO; sites.len()]; shape_deltas.len()];
        for (of_sites, of_vertices) in deltas_of_sites.iter_mut().zip(shape_deltas) {
            for (vertex, &delta) in of_vertices.iter().enumerate() {
                of_sites[sites.site_of_vertex(vertex)] = delta;
            }
        }
        sites.influences.shrink();
        let points: Vec<DVec3> = (0..topology.point_count).map(|point| sites.mean(point, |site| sites.rest[site])).collect();
        let bones_of_point = bones_of_points(&topology, &sites, tree.len());
        let groups = FaceGroups::new(&topology, &bones_of_point, &tree);
        let plan = LossPlan::new(&topology, &groups, &bones_of_point, &tree, &points);
        let faces: Vec<(u32, &[u32])> = groups.of_face.iter().copied().zip(topology.faces.rows()).collect();
        let surface = Surface::new(&faces, groups.components.len(), &points);
        let mut rest_moments = vec![(0.0, DVec3::ZERO); surface.group_count()];
        surface.moments(&points, &mut rest_moments);
        let in_armature: Vec<DVec3> = points.iter().map(|&p| armature_from_rest.transform_point3(p)).collect();
        let joint_rest = tree.bones.iter().map(|&bone| skinning.skeleton.rest()[bone as usize]).collect();
        Self {
            masses: masses(&sites, tree.len()),
            inverse_areas: inverse_areas(&topology, &in_armature),
            size: in_armature.iter().map(|p| p.distance(armature_from_rest.translation)).fold(0.0, f64::max),
            motions: Motions::new(tree, joint_rest, skinning.mode),
            shape_deltas: deltas_of_sites,
            component_of_group: groups.components,
            bone_count: skinning.skeleton.len(),
            topology,
            sites,
            rest_centre,
            plan,
            surface,
            rest_moments,
            armature_from_rest,
        }
    }

    /// One setting per joint: the artist's where named, else isotropic.
    pub fn settings(&self, joints: &[Joint]) -> Result<Vec<Joint>> {
        let mut of_bone: Vec<Option<&Joint>> = vec![None; self.bone_count];
        for joint in joints {
            let Some(slot) = of_bone.get_mut(joint.bone) else {
                return Err(Error::Index { what: "joints", row: joint.bone, found: joint.bone as i64, limit: self.bone_count });
            };
            if slot.replace(joint).is_some() {
                return Err(Error::JointTwice { bone: joint.bone });
            }
        }
        let bones = self.motions.tree.bones.iter().map(|&bone| bone as usize);
        bones.map(|bone| of_bone[bone].cloned().unwrap_or_else(|| Joint::isotropic(bone)).checked()).collect()
    }

    pub fn supports(&self, settings: &[Joint]) -> Supports {
        let rest: Vec<DVec3> = self.sites.rest.iter().map(|&p| self.armature_from_rest.transform_point3(p)).collect();
        Supports::new(&self.topology, &self.sites, &self.motions.tree, &self.plan.jobs, &rest, &self.inverse_areas, settings)
    }

    /// Rest position per site with shape keys mixed in.
    pub fn mix_shapes(&self, values: &[f64], rest: &mut [DVec3]) {
        rest.copy_from_slice(&self.sites.rest);
        for (&value, deltas) in values.iter().zip(&self.shape_deltas).filter(|(value, _)| **value != 0.0) {
            for (p, &delta) in rest.iter_mut().zip(deltas) {
                *p += delta * value;
            }
        }
    }

    pub fn memory_bytes(&self) -> usize {
        self.topology.memory_bytes()
            + self.sites.memory_bytes()
            + self.shape_deltas.iter().map(|d| size_of_val(&**d)).sum::<usize>()
            + self.plan.memory_bytes()
            + self.surface.memory_bytes()
            + size_of_val(&*self.inverse_areas)
    }
}

/// Influences renamed from bones to joints.
fn on_joints(influences: &Influences, world_bone: usize, tree: &JointTree) -> Influences {
    let mut joint_of_bone = vec![tree.world() as u16; world_bone + 1];
    for (joint, &bone) in tree.bones.iter().enumerate() {
        joint_of_bone[bone as usize] = joint as u16;
    }
    let mut renamed = influences.clone();
    for bone in &mut renamed.bones {
        *bone = joint_of_bone[*bone as usize];
    }
    renamed
}

/// Joints (and the world) that move each point of a sound component.
fn bones_of_points(topology: &Topology, sites: &Sites, world: usize) -> Csr<u16> {
    let mut result = Csr::default();
    let mut row = Vec::new();
    for point in 0..topology.point_count {
        row.clear();
        sites.visit(point, |site, _| {
            row.extend_from_slice(sites.influences.of(site).0);
            if sites.influences.mask(site) < 1.0 {
                row.push(world as u16);
            }
        });
        row.sort_unstable();
        row.dedup();
        result.push_row(row.iter().copied());
    }
    result
}

fn masses(sites: &Sites, world: usize) -> Vec<(f64, DVec3)> {
    let mut sums = vec![(0.0, DVec3::ZERO); world + 1];
    for (site, &p) in sites.rest.iter().enumerate() {
        let (bones, weights) = sites.influences.of(site);
        for (&bone, &weight) in bones.iter().zip(weights) {
            let sum = &mut sums[bone as usize];
            sum.0 += weight;
            sum.1 += p * weight;
        }
    }
    sums.into_iter().map(|(mass, sum)| (mass, if mass > 0.0 { sum / mass } else { DVec3::ZERO })).collect()
}

/// A point's area is its part of the faces around it.
fn inverse_areas(topology: &Topology, points: &[DVec3]) -> Vec<f32> {
    let mut areas = vec![0.0; points.len()];
    for face in topology.faces.rows() {
        let part = face_area_vector(points, face).length() / face.len() as f64;
        for &point in face {
            areas[point as usize] += part;
        }
    }
    let inverse = |area: f64| (1.0 / area) as f32;
    areas.into_iter().map(|area| if area > 0.0 && inverse(area).is_finite() { inverse(area) } else { 0.0 }).collect()
}
