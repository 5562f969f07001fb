//! The closed oriented surfaces of a mesh: points welded, shells separated, windings agreed, openings capped.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use crate::error::{Error, Result, check_finite, check_indices, check_offsets};
use crate::numeric::csr::Csr;
use crate::numeric::union_find::UnionFind;
use crate::surface::volume::{face_area_vector, face_volume};
use crate::surface::weld::Welding;

/// Share of a component's surface above which virtual caps are no longer small openings but most of the body.
const SHEET_CAP_SHARE: f64 = 0.5;
/// |V|³⁺ against area: a component whose volume is below this part of area^1.5 encloses nothing.
const FLAT_VOLUME: f64 = 1e-7;

/// What a component is, and so whether its volume can be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Without boundary.
    Closed,
    /// With openings, closed by virtual fans.
    Capped,
    /// So open that its caps would be most of its surface.
    Sheet,
    /// Encloses nothing.
    Flat,
    /// An edge with more than two faces.
    NonManifold,
    /// One-sided, like a Möbius strip.
    NotOrientable,
}

/// One connected shell.
#[derive(Debug, Clone)]
pub struct Component {
    /// Whether its volume can be kept.
    pub status: Status,
    /// Signed, with caps; 0 when not sound.
    pub rest_volume: f64,
    /// Vertices of the original mesh.
    pub vertex_count: usize,
    /// Faces without caps.
    pub face_count: usize,
    /// Edges with one face, after welding.
    pub boundary_edge_count: usize,
    /// Faces turned to agree with the majority.
    pub flipped_face_count: usize,
}

impl Component {
    /// True when the component is corrected.
    pub fn is_sound(&self) -> bool {
        matches!(self.status, Status::Closed | Status::Capped)
    }
}

/// The surface at rest. Checked once here, trusted everywhere else.
#[derive(Debug, Clone)]
pub struct Topology {
    /// (N,) welded point of each vertex.
    pub point_of_vertex: Vec<u32>,
    /// Distinct points.
    pub point_count: usize,
    /// Vertices of each point, which coincide.
    pub vertices_of_point: Csr<u32>,
    /// Faces of sound components with their caps, as points, outward or inward all alike within a component.
    pub faces: Arc<Csr<u32>>,
    /// Component of each of `faces`.
    pub component_of_face: Vec<u32>,
    /// Faces of all shells, sound or not, as points in the order of the mesh; without caps, and as they came.
    pub(crate) given_faces: Arc<Csr<u32>>,
    /// Component of each point; `NO_COMPONENT` for a loose one.
    pub component_of_point: Vec<u32>,
    /// All shells, sound or not.
    pub components: Vec<Component>,
}

/// Component of a point without faces.
pub const NO_COMPONENT: u32 = u32::MAX;

impl Topology {
    /// Welds, separates, orients and caps a mesh of triangles, quads and n-gons (MATH §1).
    ///
    /// # Errors
    /// Positions that are not finite, indices out of range, faces with fewer than three corners.
    pub fn new(positions: &[DVec3], face_offsets: &[i32], face_corners: &[i32], weld_tolerance: f64) -> Result<Self> {
        let (raw, welding) = welded(positions, face_offsets, face_corners, weld_tolerance)?;
        let points = mean_by_point(positions, &welding);
        let surface = Surface::new(&raw, &welding, &points);
        Ok(surface.into_topology(positions.len(), welding, &points))
    }

    /// True when vertices and points are the same, in the same order.
    pub fn is_identity(&self) -> bool {
        self.point_count == self.point_of_vertex.len()
    }

    /// Heap memory.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.point_of_vertex)
            + self.vertices_of_point.memory_bytes()
            + self.faces.memory_bytes()
            + size_of_val(&*self.component_of_face)
            + self.given_faces.memory_bytes()
            + size_of_val(&*self.component_of_point)
    }

    /// Means of the vertices of each point.
    pub fn points(&self, positions: &[DVec3]) -> Vec<DVec3> {
        if self.is_identity() {
            return positions.to_vec();
        }
        self.vertices_of_point
            .rows()
            .map(|coincident| coincident.iter().map(|&v| positions[v as usize]).sum::<DVec3>() / coincident.len() as f64)
            .collect()
    }
}

/// Checked faces of a mesh as it came, and its welding.
fn welded(positions: &[DVec3], face_offsets: &[i32], face_corners: &[i32], weld_tolerance: f64) -> Result<(Csr<u32>, Welding)> {
    check_finite("rest_positions", positions)?;
    check_offsets("face_offsets", face_offsets, face_corners.len())?;
    check_indices("face_corners", face_corners, positions.len())?;
    if !(0.0..=0.1).contains(&weld_tolerance) {
        return Err(Error::Value { what: "weld_tolerance", found: weld_tolerance, needed: "a part of the diagonal in 0..0.1" });
    }
    if let Some(face) = face_offsets.windows(2).position(|w| w[1] - w[0] < 3) {
        return Err(Error::Corners { face, found: (face_offsets[face + 1] - face_offsets[face]) as usize });
    }
    let mut raw = Csr::default();
    for w in face_offsets.windows(2) {
        raw.push_row(face_corners[w[0] as usize..w[1] as usize].iter().map(|&v| v as u32));
    }
    let welding = Welding::new(positions, &raw, weld_tolerance);
    Ok((raw, welding))
}

/// Welded faces turned to agree with their neighbours: what both volumes and weights start from.
pub struct OrientedFaces {
    /// (N,) welded point of each vertex.
    pub point_of_vertex: Vec<u32>,
    /// Means of the vertices of each point.
    pub points: Vec<DVec3>,
    /// Faces of all shells, sound or not, as points; those that welding left with fewer than three corners are gone.
    pub faces: Csr<u32>,
    /// Shell of each of `faces`.
    pub shell_of_face: Vec<u32>,
    /// Per shell, whether no edge has more than two faces; shells without faces left are among them.
    pub is_manifold: Vec<bool>,
}

impl OrientedFaces {
    /// As `Topology::new`, without judging which shells enclose a volume.
    ///
    /// # Errors
    /// As `Topology::new`.
    pub fn new(positions: &[DVec3], face_offsets: &[i32], face_corners: &[i32], weld_tolerance: f64) -> Result<Self> {
        let (raw, welding) = welded(positions, face_offsets, face_corners, weld_tolerance)?;
        let points = mean_by_point(positions, &welding);
        let surface = Surface::new(&raw, &welding, &points);
        let (mut faces, mut shell_of_face) = (Csr::default(), Vec::new());
        for (face, mut corners) in surface.faces.into_iter().enumerate().filter(|(_, corners)| corners.len() > 2) {
            if surface.flipped[face] {
                corners.reverse();
            }
            faces.push_row(corners);
            shell_of_face.push(surface.component_of_face[face]);
        }
        let is_manifold = surface.status.iter().map(|&status| status != Status::NonManifold).collect();
        Ok(Self { point_of_vertex: welding.point_of_vertex, points, faces, shell_of_face, is_manifold })
    }
}

fn mean_by_point(positions: &[DVec3], welding: &Welding) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); welding.point_count];
    for (&point, &p) in welding.point_of_vertex.iter().zip(positions) {
        sums[point as usize].0 += p;
        sums[point as usize].1 += 1.0;
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// One use of an edge by a face. `forward` when the face runs from the smaller to the larger point.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct EdgeUse {
    edge: (u32, u32),
    face: u32,
    forward: bool,
}

/// Welded faces while their shells are being sorted out.
struct Surface {
    faces: Vec<Vec<u32>>,
    edges: Vec<EdgeUse>,
    component_of_face: Vec<u32>,
    component_count: usize,
    flipped: Vec<bool>,
    status: Vec<Status>,
}

impl Surface {
    fn new(raw: &Csr<u32>, welding: &Welding, points: &[DVec3]) -> Self {
        let faces: Vec<Vec<u32>> = raw
            .rows()
            .map(|face| {
                let mut face: Vec<u32> = face.iter().map(|&v| welding.point_of_vertex[v as usize]).collect();
                face.dedup();
                while face.len() > 1 && face[0] == face[face.len() - 1] {
                    face.pop();
                }
                face
            })
            .collect();
        let edges = edge_uses(&faces);
        let mut sets = UnionFind::new(faces.len());
        for run in edges.chunk_by(|a, b| a.edge == b.edge) {
            for pair in run.windows(2) {
                sets.join(pair[0].face, pair[1].face);
            }
        }
        let mut component_of_face = vec![u32::MAX; faces.len()];
        let mut component_count = 0;
        for face in 0..faces.len() {
            let root = sets.find(face as u32) as usize;
            if component_of_face[root] == u32::MAX {
                component_of_face[root] = component_count;
                component_count += 1;
            }
            component_of_face[face] = component_of_face[root];
        }
        let mut surface = Self {
            flipped: vec![false; faces.len()],
            status: vec![Status::Closed; component_count as usize],
            component_count: component_count as usize,
            component_of_face,
            faces,
            edges,
        };
        surface.orient(points);
        surface
    }

    /// Turns faces so that neighbours agree; the larger area of a component keeps its winding.
    fn orient(&mut self, points: &[DVec3]) {
        let mut neighbours: Vec<(u32, (u32, bool))> = Vec::new();
        for run in self.edges.chunk_by(|a, b| a.edge == b.edge) {
            let component = self.component_of_face[run[0].face as usize] as usize;
            match run {
                [_] if self.status[component] == Status::Closed => self.status[component] = Status::Capped,
                [_] => {}
                [a, b] => {
                    let disagree = a.forward == b.forward;
                    neighbours.push((a.face, (b.face, disagree)));
                    neighbours.push((b.face, (a.face, disagree)));
                }
                _ => self.status[component] = Status::NonManifold,
            }
        }
        let neighbours = Csr::from_pairs(self.faces.len(), &neighbours);
        let mut seen = vec![false; self.faces.len()];
        let mut shell = Vec::new();
        for seed in 0..self.faces.len() {
            if seen[seed] {
                continue;
            }
            seen[seed] = true;
            shell.clear();
            shell.push(seed);
            let mut next = 0;
            let mut agrees = true;
            while let Some(&face) = shell.get(next) {
                next += 1;
                for &(other, disagree) in neighbours.row(face) {
                    let flipped = self.flipped[face] != disagree;
                    if !seen[other as usize] {
                        seen[other as usize] = true;
                        self.flipped[other as usize] = flipped;
                        shell.push(other as usize);
                    } else if self.flipped[other as usize] != flipped {
                        agrees = false;
                    }
                }
            }
            let component = self.component_of_face[seed] as usize;
            if !agrees && self.status[component] != Status::NonManifold {
                self.status[component] = Status::NotOrientable;
            }
            let area = |turned: bool| -> f64 {
                shell
                    .iter()
                    .filter(|&&face| self.flipped[face] == turned)
                    .map(|&face| face_area_vector(points, &self.faces[face]).length())
                    .sum()
            };
            if area(true) > area(false) {
                for &face in &shell {
                    self.flipped[face] = !self.flipped[face];
                }
            }
        }
    }

    /// Boundary edges against the winding of their faces, so that the caps close the surface.
    fn caps(&self) -> Vec<(u32, Vec<u32>)> {
        // By component and point: shells may share points of their rims.
        let mut following: HashMap<(u32, u32), Vec<u32>> = HashMap::new();
        let mut starts = Vec::new();
        for run in self.edges.chunk_by(|a, b| a.edge == b.edge).filter(|run| run.len() == 1) {
            let EdgeUse { edge: (low, high), face, forward } = run[0];
            let runs_forward = forward != self.flipped[face as usize];
            let (from, to) = if runs_forward { (high, low) } else { (low, high) };
            let component = self.component_of_face[face as usize];
            following.entry((component, from)).or_default().push(to);
            starts.push((component, from));
        }
        // Loops through points where two openings touch are split there: each loop visits a point once.
        let mut caps = Vec::new();
        let mut position_in_path: HashMap<u32, usize> = HashMap::new();
        for (component, start) in starts {
            let mut path: Vec<u32> = Vec::new();
            let mut point = start;
            while let Some(to) = following.get_mut(&(component, point)).and_then(Vec::pop) {
                position_in_path.insert(point, path.len());
                path.push(point);
                point = to;
                if let Some(&first) = position_in_path.get(&point) {
                    let ring: Vec<u32> = path.drain(first..).collect();
                    for p in &ring {
                        position_in_path.remove(p);
                    }
                    if ring.len() > 2 {
                        caps.push((component, ring));
                    }
                }
            }
            position_in_path.clear();
        }
        caps
    }

    fn into_topology(mut self, vertex_count: usize, welding: Welding, points: &[DVec3]) -> Topology {
        let mut given_faces = Csr::default();
        for face in self.faces.iter().filter(|face| face.len() > 2) {
            given_faces.push_row(face.iter().copied());
        }
        let caps = self.caps();
        let mut areas = vec![(0.0, 0.0); self.component_count];
        let mut volumes = vec![0.0; self.component_count];
        let mut components: Vec<Component> = Vec::new();
        let centroids = component_centroids(&self.faces, &self.component_of_face, self.component_count, points);
        for (face, &component) in self.faces.iter_mut().zip(&self.component_of_face).enumerate().map(|(i, (f, c))| {
            if self.flipped[i] {
                f.reverse();
            }
            (f, c)
        }) {
            areas[component as usize].0 += face_area_vector(points, face).length();
            volumes[component as usize] += face_volume(points, face, centroids[component as usize]);
        }
        for (component, ring) in &caps {
            areas[*component as usize].1 += face_area_vector(points, ring).length();
            volumes[*component as usize] += face_volume(points, ring, centroids[*component as usize]);
        }
        for component in 0..self.component_count {
            let (area, cap_area) = areas[component];
            let status = match self.status[component] {
                Status::Capped if cap_area > SHEET_CAP_SHARE * area => Status::Sheet,
                Status::Closed | Status::Capped if volumes[component].abs() <= FLAT_VOLUME * (area + cap_area).powf(1.5) => Status::Flat,
                status => status,
            };
            let sound = matches!(status, Status::Closed | Status::Capped);
            components.push(Component {
                status,
                rest_volume: if sound { volumes[component] } else { 0.0 },
                vertex_count: 0,
                face_count: 0,
                boundary_edge_count: 0,
                flipped_face_count: 0,
            });
        }
        let mut component_of_point = vec![NO_COMPONENT; welding.point_count];
        for (face, &component) in self.component_of_face.iter().enumerate() {
            let counted = &mut components[component as usize];
            counted.face_count += 1;
            counted.flipped_face_count += usize::from(self.flipped[face]);
            for &point in &self.faces[face] {
                component_of_point[point as usize] = component;
            }
        }
        for run in self.edges.chunk_by(|a, b| a.edge == b.edge).filter(|run| run.len() == 1) {
            components[self.component_of_face[run[0].face as usize] as usize].boundary_edge_count += 1;
        }
        for &point in &welding.point_of_vertex {
            if let Some(component) = components.get_mut(component_of_point[point as usize] as usize) {
                component.vertex_count += 1;
            }
        }
        let mut faces = Csr::default();
        let mut component_of_face = Vec::new();
        let all = self.component_of_face.iter().copied().zip(self.faces).chain(caps);
        for (component, face) in all.filter(|(component, face)| components[*component as usize].is_sound() && face.len() > 2) {
            faces.push_row(face);
            component_of_face.push(component);
        }
        let vertices: Vec<(u32, u32)> = welding.point_of_vertex.iter().enumerate().map(|(v, &p)| (p, v as u32)).collect();
        debug_assert_eq!(vertices.len(), vertex_count);
        Topology {
            vertices_of_point: Csr::from_pairs(welding.point_count, &vertices),
            point_of_vertex: welding.point_of_vertex,
            point_count: welding.point_count,
            faces: Arc::new(faces),
            component_of_face,
            given_faces: Arc::new(given_faces),
            component_of_point,
            components,
        }
    }
}

fn edge_uses(faces: &[Vec<u32>]) -> Vec<EdgeUse> {
    let mut edges = Vec::new();
    for (face, corners) in faces.iter().enumerate().filter(|(_, corners)| corners.len() > 2) {
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            edges.push(EdgeUse { edge: (a.min(b), a.max(b)), face: face as u32, forward: a < b });
        }
    }
    edges.sort_unstable();
    edges
}

/// Mean of the corners of each component: volumes are summed about it to keep their digits (MATH §1).
fn component_centroids(faces: &[Vec<u32>], component_of_face: &[u32], count: usize, points: &[DVec3]) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); count];
    for (face, &component) in faces.iter().zip(component_of_face) {
        let sum = &mut sums[component as usize];
        sum.0 += face.iter().map(|&p| points[p as usize]).sum::<DVec3>();
        sum.1 += face.len() as f64;
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { DVec3::ZERO }).collect()
}
