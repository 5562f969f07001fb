//! What a bound character is made of: everything that does not change from frame to frame, nor with the artist's settings.

use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DVec3};

use crate::cores::following::Core;
use crate::cores::rest::RestSurface;
use crate::error::{Error, Result};
use crate::fields::joint::{Fields, Joint};
use crate::fields::normals::{EvenNormals, even_normals};
use crate::fields::supports::{Supports, automatic_lengths};
use crate::flesh::{Anatomy as FleshAnatomy, Parts};
use crate::folds::Skin;
use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, V4};
use crate::skinning::bases::bases;
use crate::skinning::blend::{Influences, Mode, Skinning};
use crate::skinning::cut_chains::{Hanging, Weighted};
use crate::skinning::hung_joints::hung_joints;
use crate::skinning::joint_tree::JointTree;
use crate::skinning::motions::Motions;
use crate::skinning::sites::Sites;
use crate::surface::patches::{NO_SLOT, Patches};
use crate::surface::topology::{Component, Topology};
use crate::surface::volume::face_area_vector;
use crate::volume_losses::job::{Anatomy, FaceJoints};
use crate::volume_losses::plan::LossPlan;

/// A mesh bound to its weights.
pub(crate) struct Binding {
    pub components: Vec<Component>,
    pub patches: Patches,
    /// Per vertex; `NO_SLOT` for one of no sound component.
    pub slot_of_vertex: Vec<u32>,
    /// Per vertex, the component that its slot is of: one of those that share the point. Of vertices without a slot, any.
    pub component_of_vertex: Vec<u32>,
    /// All vertices, in order of their slots.
    pub vertices_by_slot: Vec<u32>,
    pub sites: Sites,
    pub rest_centre: DVec3,
    /// Per shape key, displacement per site.
    pub shape_deltas: Vec<Vec<V4>>,
    /// Motions at rest, to be copied into workspaces.
    pub motions: Motions,
    pub plan: LossPlan,
    /// Mean rest area of a point, armature space: gradients are stored in units of it.
    pub area_unit: f64,
    /// `area_unit` / rest area per slot; 0 where the surface has none.
    pub inverse_areas: Vec<f32>,
    /// Per joint and for the world, weight and weighted mean of the vertices.
    pub masses: Vec<(f64, DVec3)>,
    /// Largest distance from the centre, armature space.
    pub size: f64,
    /// The same of the rest mesh, and per shape key the longest displacement, rest space.
    radius: f64,
    shape_radii: Vec<f64>,
    pub bone_count: usize,
    /// Points of no sound component, with each of their vertices, in order.
    pub unsound: Vec<(u32, u32)>,
    armature_from_rest: DAffine3,
    given_faces: Arc<Csr<u32>>,
    /// Faces of sound components with their caps, as points.
    faces: Arc<Csr<u32>>,
    /// Made when a frame first brings offsets that move anything.
    core: OnceLock<Core>,
    /// Made when a joint first follows the law of flesh.
    anatomy: OnceLock<FleshAnatomy>,
    /// Made when fields are even.
    normals: OnceLock<EvenNormals>,
    /// Made when folds are repaired for the first time.
    skin: OnceLock<Skin>,
    /// Made when a frame first brings offsets or a body of its own.
    vertices_of_slot: OnceLock<Csr<u32>>,
}

impl Binding {
    pub fn new(
        topology: &Topology,
        rest: &[DVec3],
        skinning: &Skinning,
        shape_deltas: &[Vec<DVec3>],
        armature_from_object: DAffine3,
    ) -> Self {
        let rest_centre = rest.iter().copied().sum::<DVec3>() / rest.len().max(1) as f64;
        let armature_from_rest = armature_from_object * DAffine3::from_translation(rest_centre);
        let centred: Vec<DVec3> = rest.iter().map(|&p| p - rest_centre).collect();
        let in_armature: Vec<DVec3> = centred.iter().map(|&p| armature_from_rest.transform_point3(p)).collect();
        let areas = vertex_areas(topology, &in_armature);
        let bones = Weighted::new(&skinning.skeleton, &skinning.influences, &in_armature, &areas);
        let hanging = Hanging::new(&bones);
        let tree = JointTree::new(&bones, &hanging);
        let hung = hung_joints(&tree, &bones, &hanging);
        let influences = on_joints(&skinning.influences, skinning.skeleton.len(), &tree);
        let bones_of_point = bones_of_points(topology, &influences, tree.len());
        let face_joints = FaceJoints::new(topology, &bones_of_point, &tree);
        let bases = bases(topology, &tree, &skinning.skeleton, &influences, &bones_of_point, &face_joints.tops, &areas);
        let points = topology.points(&in_armature);
        let point_keys = strongest_joints(topology, &influences);
        let patches = Patches::new(topology, &face_joints.tops, &point_keys, &points);
        let sites = Sites::new(topology, &patches, &centred, &influences, shape_deltas);
        let mut deltas_of_sites = vec![vec![lanes::ZERO; sites.len()]; shape_deltas.len()];
        for (of_sites, of_vertices) in deltas_of_sites.iter_mut().zip(shape_deltas) {
            for (&site, &delta) in sites.site_of_vertex.iter().zip(of_vertices) {
                of_sites[site as usize] = lanes::from(delta);
            }
        }
        let rest_from_armature = armature_from_rest.inverse();
        let mut heads: Vec<V4> = tree.heads.iter().map(|&head| lanes::from(rest_from_armature.transform_point3(head))).collect();
        heads.push(lanes::ZERO);
        let has_shapes = !shape_deltas.is_empty();
        let anatomy = Anatomy { topology, patches: &patches, sites: &sites, joints: &face_joints, tree: &tree, heads: &heads };
        let plan = LossPlan::new(&anatomy, skinning.mode, has_shapes);
        let (area_unit, inverse_areas) = inverse_areas(topology, &patches, &points);
        let slot_of_vertex: Vec<u32> = topology.point_of_vertex.iter().map(|&point| patches.slot_of_point[point as usize]).collect();
        let component_of_vertex = slot_of_vertex.iter().zip(&topology.point_of_vertex).map(|(&slot, &point)| {
            if slot == NO_SLOT { topology.component_of_point[point as usize] } else { patches.component_of_slot(slot as usize) }
        });
        let component_of_vertex = component_of_vertex.collect();
        let mut vertices_by_slot: Vec<u32> = (0..slot_of_vertex.len() as u32).collect();
        vertices_by_slot.sort_by_key(|&vertex| slot_of_vertex[vertex as usize]);
        Self {
            components: topology.components.clone(),
            slot_of_vertex,
            vertices_by_slot,
            component_of_vertex,
            masses: masses(&influences, &centred, tree.len()),
            size: in_armature.iter().map(|p| p.distance(armature_from_rest.translation)).fold(0.0, f64::max),
            motions: Motions::new(tree, hung, bases, skinning.skeleton.rest(), skinning.mode),
            shape_deltas: deltas_of_sites,
            radius: centred.iter().map(|p| p.length()).fold(0.0, f64::max),
            shape_radii: shape_deltas.iter().map(|deltas| deltas.iter().map(|d| d.length()).fold(0.0, f64::max)).collect(),
            bone_count: skinning.skeleton.len(),
            unsound: unsound(topology, &patches),
            given_faces: Arc::clone(&topology.given_faces),
            faces: Arc::clone(&topology.faces),
            core: OnceLock::new(),
            anatomy: OnceLock::new(),
            normals: OnceLock::new(),
            skin: OnceLock::new(),
            vertices_of_slot: OnceLock::new(),
            patches,
            sites,
            rest_centre,
            plan,
            area_unit,
            inverse_areas,
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

    pub fn supports(&self, settings: &[Joint], fields: Fields) -> Supports {
        let (tree, rest) = (&self.motions.tree, self.sites_in_armature());
        if fields == Fields::Even {
            // Now, not in the first frame.
            self.normals();
        }
        Supports::new(&self.patches, &self.sites, tree, &self.plan.jobs, &rest, &self.inverse_areas, (settings, fields))
    }

    fn sites_in_armature(&self) -> Vec<DVec3> {
        self.sites.rest.iter().map(|&p| self.armature_from_rest.transform_point3(lanes::to(p))).collect()
    }

    /// What even fields push along, per slot; see `even_normals`.
    pub fn normals(&self) -> &EvenNormals {
        self.normals.get_or_init(|| {
            let lengths = automatic_lengths(&self.motions.tree, &self.sites, &self.sites_in_armature(), Fields::Even);
            let to_rest = self.armature_from_rest.inverse().matrix3;
            let areas = (self.area_unit, &*self.inverse_areas);
            even_normals(&self.faces_of_slots(), &self.slots_in_armature(), areas, &self.sites, &lengths, &to_rest)
        })
    }

    /// Faces with their caps, as slots.
    fn faces_of_slots(&self) -> Csr<u32> {
        let mut faces = Csr::default();
        for face in self.faces.rows() {
            faces.push_row(face.iter().map(|&point| self.patches.slot_of_point[point as usize]));
        }
        faces
    }

    fn slots_in_armature(&self) -> Vec<DVec3> {
        (0..self.patches.slot_count()).map(|slot| self.rest_in_armature(slot)).collect()
    }

    /// What can pass through what.
    pub fn skin(&self) -> &Skin {
        self.skin.get_or_init(|| {
            let rest = |site: usize| self.sites.rest[site];
            Skin::new(
                &self.given_faces,
                &self.points(|slot| self.sites.mean(slot, rest), |vertex| rest(self.sites.site_of_vertex[vertex] as usize)),
            )
        })
    }

    /// What lies under the bound skin.
    pub fn core(&self) -> &Core {
        self.core.get_or_init(|| {
            let faces = self.faces_of_slots();
            let mut is_used = vec![false; self.patches.slot_count()];
            for &slot in faces.values() {
                is_used[slot as usize] = true;
            }
            let used = (0..is_used.len()).filter(|&slot| is_used[slot]);
            let pairs: Vec<(u32, u32)> = used.map(|slot| (self.patches.component_of_slot(slot), slot as u32)).collect();
            let rest = RestSurface {
                places: self.slots_in_armature(),
                areas: self.slot_areas(),
                faces,
                slots_of_component: Csr::from_pairs(self.components.len(), &pairs),
            };
            Core::new(rest, &self.patches)
        })
    }

    /// The body as the law of flesh sees it.
    pub fn anatomy(&self) -> &FleshAnatomy {
        self.anatomy.get_or_init(|| self.anatomy_of(self.motions.palette.mode == Mode::Linear))
    }

    /// The same for one way of skinning.
    pub fn anatomy_of(&self, is_linear: bool) -> FleshAnatomy {
        FleshAnatomy::new(&Parts {
            patches: &self.patches,
            sites: &self.sites,
            tree: &self.motions.tree,
            rest: self.motions.rest(),
            places: &self.slots_in_armature(),
            areas: &self.slot_areas(),
            is_linear,
        })
    }

    /// Area at rest of the point in each slot, armature space; 0 where the surface has none.
    fn slot_areas(&self) -> Vec<f64> {
        self.inverse_areas.iter().map(|&inverse| if inverse > 0.0 { self.area_unit / f64::from(inverse) } else { 0.0 }).collect()
    }

    /// Where the point in a slot rests, armature space as it stood at bind.
    pub fn rest_in_armature(&self, slot: usize) -> DVec3 {
        self.armature_from_rest.transform_point3(lanes::to(self.sites.mean(slot, |site| self.sites.rest[site])))
    }

    /// Vertices of the point in each slot, which coincide.
    pub fn vertices_of_slot(&self) -> &Csr<u32> {
        self.vertices_of_slot.get_or_init(|| {
            let in_slots: Vec<(u32, u32)> = self.slot_of_vertex.iter().copied().zip(0..).filter(|(slot, _)| *slot != NO_SLOT).collect();
            Csr::from_pairs(self.patches.slot_count(), &in_slots)
        })
    }

    /// True where vertices that rest and move alike are skinned as one.
    pub fn has_shared_sites(&self) -> bool {
        self.sites.len() < self.slot_of_vertex.len()
    }

    /// Anything per point: of the slots of sound components, the mean over the vertices of others.
    pub fn points(&self, of_slot: impl Fn(usize) -> V4, of_vertex: impl Fn(usize) -> V4) -> Vec<DVec3> {
        let slots = self.patches.slot_of_point.iter();
        let mut points: Vec<DVec3> =
            slots.map(|&slot| if slot == NO_SLOT { DVec3::ZERO } else { lanes::to(of_slot(slot as usize)) }).collect();
        for coincident in self.unsound.chunk_by(|a, b| a.0 == b.0) {
            let sum: DVec3 = coincident.iter().map(|&(_, vertex)| lanes::to(of_vertex(vertex as usize))).sum();
            points[coincident[0].0 as usize] = sum / coincident.len() as f64;
        }
        points
    }

    /// No rest position with shape keys mixed in is farther from the centre.
    pub fn radius_with(&self, shape_values: &[f64]) -> f64 {
        self.radius + shape_values.iter().zip(&self.shape_radii).map(|(value, radius)| value.abs() * radius).sum::<f64>()
    }

    /// Rest position per site with shape keys mixed in.
    pub fn mix_shapes(&self, values: &[f64], rest: &mut [V4]) {
        rest.copy_from_slice(&self.sites.rest);
        for (&value, deltas) in values.iter().zip(&self.shape_deltas).filter(|(value, _)| **value != 0.0) {
            for (p, &delta) in rest.iter_mut().zip(deltas) {
                *p = lanes::add_scaled(*p, delta, value);
            }
        }
    }

    pub fn memory_bytes(&self) -> usize {
        self.patches.memory_bytes()
            + size_of_val(&*self.slot_of_vertex)
            + size_of_val(&*self.component_of_vertex)
            + size_of_val(&*self.vertices_by_slot)
            + self.sites.memory_bytes()
            + self.shape_deltas.iter().map(|d| size_of_val(&**d)).sum::<usize>()
            + self.plan.memory_bytes()
            + size_of_val(&*self.inverse_areas)
            + self.anatomy.get().map_or(0, FleshAnatomy::memory_bytes)
            + self.skin.get().map_or(0, Skin::memory_bytes)
            + self.normals.get().map_or(0, EvenNormals::memory_bytes)
            + self.core.get().map_or(0, Core::memory_bytes)
            + self.vertices_of_slot.get().map_or(0, Csr::memory_bytes)
    }
}

fn unsound(topology: &Topology, patches: &Patches) -> Vec<(u32, u32)> {
    let of_vertices = topology.point_of_vertex.iter().copied().zip(0..);
    let mut unsound: Vec<(u32, u32)> = of_vertices.filter(|(point, _)| patches.slot_of_point[*point as usize] == NO_SLOT).collect();
    unsound.sort_unstable();
    unsound
}

/// Influences renamed from bones to joints.
fn on_joints(influences: &Influences, world_bone: usize, tree: &JointTree) -> Influences {
    let mut joint_of_bone = vec![tree.world() as u16; world_bone + 1];
    for (joint, &bone) in tree.bones.iter().enumerate() {
        joint_of_bone[bone as usize] = joint as u16;
    }
    let mut renamed = influences.clone();
    for bone in &mut renamed.bones {
        *bone = joint_of_bone[usize::from(*bone)];
    }
    renamed
}

/// Joints (and the world) that move each point.
fn bones_of_points(topology: &Topology, influences: &Influences, world: usize) -> Csr<u16> {
    let mut result = Csr::default();
    let mut row = Vec::new();
    for vertices in topology.vertices_of_point.rows() {
        row.clear();
        for &vertex in vertices {
            row.extend_from_slice(influences.of(vertex as usize).0);
            if influences.mask(vertex as usize) < 1.0 {
                row.push(world as u16);
            }
        }
        row.sort_unstable();
        row.dedup();
        result.push_row(row.iter().copied());
    }
    result
}

/// The two joints that move each point most, as one number.
fn strongest_joints(topology: &Topology, influences: &Influences) -> Vec<u32> {
    let of_vertex = |vertex: u32| {
        let (joints, weights) = influences.of(vertex as usize);
        let mut strongest = [(0.0, 0); 2];
        for (&weight, &joint) in weights.iter().zip(joints) {
            if weight > strongest[0].0 {
                strongest = [(weight, joint), strongest[0]];
            } else if weight > strongest[1].0 {
                strongest[1] = (weight, joint);
            }
        }
        u32::from(strongest[0].1) << 16 | u32::from(strongest[1].1)
    };
    topology.vertices_of_point.rows().map(|vertices| vertices.first().map_or(0, |&vertex| of_vertex(vertex))).collect()
}

/// Area of each vertex: its part of the faces around its point.
fn vertex_areas(topology: &Topology, rest: &[DVec3]) -> Vec<f64> {
    let points = topology.points(rest);
    let mut of_point = vec![0.0; points.len()];
    for face in topology.faces.rows() {
        let part = face_area_vector(&points, face).length() / face.len() as f64;
        for &point in face {
            of_point[point as usize] += part;
        }
    }
    let count = |point: u32| topology.vertices_of_point.row(point as usize).len() as f64;
    topology.point_of_vertex.iter().map(|&point| of_point[point as usize] / count(point)).collect()
}

fn masses(influences: &Influences, rest: &[DVec3], world: usize) -> Vec<(f64, DVec3)> {
    let mut sums = vec![(0.0, DVec3::ZERO); world + 1];
    for (vertex, &p) in rest.iter().enumerate() {
        let (bones, weights) = influences.of(vertex);
        for (&bone, &weight) in bones.iter().zip(weights) {
            let sum = &mut sums[usize::from(bone)];
            sum.0 += weight;
            sum.1 += p * weight;
        }
    }
    sums.into_iter().map(|(mass, sum)| (mass, if mass > 0.0 { sum / mass } else { DVec3::ZERO })).collect()
}

/// A point's area is its part of the faces around it. Mean area, and it over the area of each slot.
///
/// Where shells share a point it belongs to neither alone: it has no area, and stays as skinned.
fn inverse_areas(topology: &Topology, patches: &Patches, points: &[DVec3]) -> (f64, Vec<f32>) {
    let mut areas = vec![0.0; patches.slot_count()];
    let mut component_of_slot = vec![None; patches.slot_count()];
    for (face, component) in topology.faces.rows().zip(&topology.component_of_face) {
        let part = face_area_vector(points, face).length() / face.len() as f64;
        for &point in face {
            let slot = patches.slot_of_point[point as usize] as usize;
            areas[slot] += part;
            if component_of_slot[slot].get_or_insert(component) != &component {
                areas[slot] = f64::NEG_INFINITY;
            }
        }
    }
    let counted = areas.iter().filter(|area| **area > 0.0).count();
    let unit = areas.iter().filter(|area| **area > 0.0).sum::<f64>() / counted.max(1) as f64;
    let inverse = |area: f64| (unit / area) as f32;
    let usable = |area: f64| area > 0.0 && inverse(area).is_finite();
    (if unit > 0.0 { unit } else { 1.0 }, areas.into_iter().map(|area| if usable(area) { inverse(area) } else { 0.0 }).collect())
}
