//! A core that follows its skin: each cell by the affine map that fits the skin around it best, each point by a blend of those.
//! So what moves affinely as far as its cells see keeps its core, and what volume lies above it is told by prisms [MATH §9].

use fearless_simd::{Level, Simd, dispatch};
use glam::{DMat3, DVec3};

use crate::cores::balls::Balls;
use crate::cores::cells::{Cells, cells};
use crate::cores::prisms::{polygon_prism, prisms};
use crate::cores::rest::RestSurface;
use crate::numeric::block_rows::PATCH_POINTS;
use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, Columns, V4, add_scaled, transform};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::surface::patches::{Patch, Patches};
use crate::surface::sweeps::Buffer;

/// Part of a cell's extent, and its ball's, that a direction without any counts as having: there its map shrinks to nothing.
const FLAT: f64 = 1e-6;

/// Part of a point that a cell of its patch has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    pub cell: u16,
    pub part: f32,
}

/// What the skin around a cell is like at rest.
#[derive(Debug, Clone, Copy)]
struct Cell {
    mean: V4,
    /// Inverse of the scatter about the mean, by its rows.
    inverse_scatter: [V4; 3],
    area: f64,
}

/// Everything about a body's core that does not change.
pub(crate) struct Core {
    cells: Vec<Cell>,
    component_of_cell: Vec<u32>,
    /// Per patch, cells that its points have a part in.
    pub cells_of_patch: Csr<u32>,
    /// Of each local point of all patches.
    shares: Csr<Share>,
    /// Per slot: at rest, and its core.
    rest: Vec<V4>,
    centres: Vec<V4>,
    /// Per slot, radius of the ball under it.
    pub radii: Vec<f32>,
    /// Per slot.
    pub areas: Vec<f64>,
}

/// What a frame needs to know of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Need {
    Nothing,
    /// Where its core is, for neighbours.
    Places,
    /// What lies above it, too.
    Volumes,
}

/// Room for one frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Room {
    /// Per patch.
    needs: Vec<Need>,
    /// Per cell, whether any of its points is moved.
    is_touched: Vec<bool>,
    sums: Vec<Columns>,
    maps: Vec<Columns>,
    centres: Vec<V4>,
    parts: Vec<f64>,
}

impl Room {
    /// Whether what moves concerns a patch.
    pub fn concerns(&self, patch: usize) -> bool {
        self.needs[patch] != Need::Nothing
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.needs)
            + size_of_val(&*self.sums)
            + size_of_val(&*self.maps)
            + size_of_val(&*self.centres)
            + size_of_val(&*self.parts)
    }
}

impl Core {
    pub fn new(rest: RestSurface, patches: &Patches) -> Self {
        let balls = Balls::new(&rest);
        let Cells { shares, balls: chosen } = cells(&rest, &balls);
        let mut cells_of_patch = Csr::default();
        let mut of_local = Csr::default();
        let mut own = Vec::new();
        for patch in &patches.list {
            let slots = &patches.local[patch.local.clone()];
            own.clear();
            own.extend(slots.iter().flat_map(|&slot| shares.row(slot as usize)).map(|share| share.0));
            own.sort_unstable();
            own.dedup();
            for &slot in slots {
                let place = |cell: u32| own.binary_search(&cell).unwrap_or(0) as u16;
                of_local.push_row(shares.row(slot as usize).iter().map(|&(cell, part)| Share { cell: place(cell), part: part as f32 }));
            }
            cells_of_patch.push_row(own.iter().copied());
        }
        let mut core = Self {
            cells: vec![Cell { mean: lanes::ZERO, inverse_scatter: [lanes::ZERO; 3], area: 0.0 }; chosen.len()],
            component_of_cell: chosen.iter().map(|cell| cell.0).collect(),
            cells_of_patch,
            shares: of_local,
            rest: rest.places.iter().map(|&p| lanes::from(p)).collect(),
            centres: balls.centres.iter().map(|&p| lanes::from(p)).collect(),
            radii: balls.radii.iter().map(|&radius| radius as f32).collect(),
            areas: rest.areas,
        };
        core.measure_cells(patches, chosen.iter().map(|cell| cell.1));
        core
    }

    /// Area, mean and scatter of each cell, by the same shares that frames use.
    fn measure_cells(&mut self, patches: &Patches, radii: impl Iterator<Item = f64>) {
        let mut sums = vec![(0.0, DVec3::ZERO); self.cells.len()];
        self.for_each_part(patches, |cell, slot, weight| {
            sums[cell].0 += weight;
            sums[cell].1 += lanes::to(self.rest[slot]) * weight;
        });
        let means: Vec<DVec3> = sums.iter().map(|(area, sum)| if *area > 0.0 { *sum / *area } else { DVec3::ZERO }).collect();
        let mut scatters = vec![DMat3::ZERO; self.cells.len()];
        self.for_each_part(patches, |cell, slot, weight| {
            let r = lanes::to(self.rest[slot]) - means[cell];
            scatters[cell] += DMat3::from_cols(r * r.x, r * r.y, r * r.z) * weight;
        });
        for ((cell, radius), ((mean, scatter), (area, _))) in
            self.cells.iter_mut().zip(radii).zip(means.into_iter().zip(scatters).zip(sums))
        {
            // In units of its size: squares of small meshes have no inverse.
            let size = scatter.x_axis.x + scatter.y_axis.y + scatter.z_axis.z + area * radius * radius;
            let inverse = (scatter * size.recip() + DMat3::from_diagonal(DVec3::splat(FLAT))).inverse() * size.recip();
            let rows = if inverse.is_finite() { inverse } else { DMat3::ZERO }.to_cols_array_2d();
            *cell = Cell { mean: lanes::from(mean), inverse_scatter: rows.map(|[x, y, z]| [x, y, z, 0.0]), area };
        }
    }

    /// Cell, slot and weight of every part of every point.
    fn for_each_part(&self, patches: &Patches, mut visit: impl FnMut(usize, usize, f64)) {
        for (index, patch) in patches.list.iter().enumerate() {
            let cells = self.cells_of_patch.row(index);
            for place in 0..patch.owned {
                let slot = patch.start + place;
                for share in self.shares_of(patch, place) {
                    visit(cells[usize::from(share.cell)] as usize, slot, f64::from(share.part) * self.areas[slot]);
                }
            }
        }
    }

    /// Of a local point of a patch.
    #[inline(always)]
    pub fn shares_of(&self, patch: &Patch, place: usize) -> &[Share] {
        self.shares.row(patch.local.start + place)
    }

    /// Volume that each cell has lost, per area of its points, by what it had `before` and `after`. In all, each component has
    /// lost what is `missing`: what its core itself has lost is little, and spread over the cells that are touched.
    pub fn densities(&self, room: &Room, before: &[f64], after: &[f64], mut missing: Vec<f64>, densities: &mut Vec<f64>) {
        let finite = |volume: f64, area: f64| Some(volume / area).filter(|density| density.is_finite()).unwrap_or(0.0);
        let mut areas = vec![0.0; missing.len()];
        densities.clear();
        for (cell, (before, after)) in before.iter().zip(after).enumerate() {
            let component = self.component_of_cell[cell] as usize;
            missing[component] -= before - after;
            areas[component] += if room.is_touched[cell] { self.cells[cell].area } else { 0.0 };
            densities.push(finite(before - after, self.cells[cell].area));
        }
        for (cell, density) in densities.iter_mut().enumerate().filter(|(cell, _)| room.is_touched[*cell]) {
            let component = self.component_of_cell[cell] as usize;
            *density += finite(missing[component], areas[component]);
        }
    }

    /// Begins a frame in which these slots are not where they would have been: volumes elsewhere do not change, and are not
    /// looked for.
    pub fn begin(&self, patches: &Patches, is_moved: impl Fn(usize) -> bool, room: &mut Room) {
        let is_touched = &mut room.is_touched;
        is_touched.clear();
        is_touched.resize(self.cells.len(), false);
        for (index, patch) in patches.list.iter().enumerate() {
            let cells = self.cells_of_patch.row(index);
            for local in (0..patch.owned).filter(|local| is_moved(patch.start + local)) {
                for share in self.shares_of(patch, local) {
                    is_touched[cells[usize::from(share.cell)] as usize] = true;
                }
            }
        }
        room.needs.clear();
        let mut is_near = is_touched.clone();
        for cells in self.cells_of_patch.rows() {
            let has_volume = cells.iter().any(|&cell| is_touched[cell as usize]);
            room.needs.push(if has_volume { Need::Volumes } else { Need::Nothing });
            cells.iter().filter(|_| has_volume).for_each(|&cell| is_near[cell as usize] = true);
        }
        for (need, cells) in room.needs.iter_mut().zip(self.cells_of_patch.rows()) {
            if *need == Need::Nothing && cells.iter().any(|&cell| is_near[cell as usize]) {
                *need = Need::Places;
            }
        }
    }

    /// Volume above each cell of a skin in `place`, per slot; and how much longer its map makes things.
    pub fn volumes(
        &self,
        patches: &Patches,
        place: impl Fn(usize) -> V4 + Sync,
        room: &mut Room,
        volumes: &mut Vec<f64>,
        lengthening: &mut Vec<f32>,
    ) {
        self.fit(patches, &place, room, lengthening);
        self.carry(patches, room);
        self.measure(patches, &place, room, volumes);
    }

    /// The maps of all cells that are asked for.
    fn fit(&self, patches: &Patches, place: &(impl Fn(usize) -> V4 + Sync), room: &mut Room, lengthening: &mut Vec<f32>) {
        let (level, needs) = (Level::new(), &room.needs);
        room.sums.resize(self.cells_of_patch.values().len(), [lanes::ZERO; 4]);
        let sums = Ragged::new(&mut room.sums, self.cells_of_patch.offsets());
        for_each_piece(patches.list.len(), sums, &|index, sums| {
            sums.values.fill([lanes::ZERO; 4]);
            if needs[index] != Need::Nothing {
                dispatch!(level, simd => self.fit_patch(simd, (patches, index), place, sums.values));
            }
        });
        room.maps.clear();
        room.maps.resize(self.cells.len(), [lanes::ZERO; 4]);
        for (&cell, sum) in self.cells_of_patch.values().iter().zip(&room.sums) {
            let map = &mut room.maps[cell as usize];
            *map = std::array::from_fn(|column| lanes::add(map[column], sum[column]));
        }
        lengthening.clear();
        for (map, cell) in room.maps.iter_mut().zip(&self.cells) {
            let [x, y, z, sum] = *map;
            let column = |row: V4| add_scaled(add_scaled(lanes::scale(x, row[0]), y, row[1]), z, row[2]);
            let [x, y, z] = cell.inverse_scatter.map(column);
            let mean = lanes::scale(sum, if cell.area > 0.0 { cell.area.recip() } else { 0.0 });
            let moved = transform(&[x, y, z, lanes::ZERO], cell.mean);
            *map = [x, y, z, lanes::sub(mean, moved)];
            let square: f64 = [x, y, z].iter().map(|v| lanes::sum(lanes::mul(*v, *v))).sum();
            lengthening.push((square / 3.0).sqrt() as f32);
        }
    }

    #[inline(always)]
    fn fit_patch<S: Simd>(&self, _: S, (patches, index): (&Patches, usize), place: &impl Fn(usize) -> V4, sums: &mut [Columns]) {
        let (patch, cells) = (&patches.list[index], self.cells_of_patch.row(index));
        for local in 0..patch.owned {
            let slot = patch.start + local;
            let (p, r) = (lanes::scale(place(slot), self.areas[slot]), self.rest[slot]);
            for share in self.shares_of(patch, local) {
                let [x, y, z, sum] = &mut sums[usize::from(share.cell)];
                let from_mean = lanes::sub(r, self.cells[cells[usize::from(share.cell)] as usize].mean);
                let weighted = lanes::scale(p, f64::from(share.part));
                *x = add_scaled(*x, weighted, from_mean[0]);
                *y = add_scaled(*y, weighted, from_mean[1]);
                *z = add_scaled(*z, weighted, from_mean[2]);
                *sum = lanes::add(*sum, weighted);
            }
        }
    }

    /// The core of every point that is asked for.
    fn carry(&self, patches: &Patches, room: &mut Room) {
        let (level, needs, maps) = (Level::new(), &room.needs, &room.maps);
        room.centres.resize(self.rest.len(), lanes::ZERO);
        for_each_piece(patches.list.len(), Ragged::new(&mut room.centres, &patches.slot_offsets), &|index, centres| {
            if needs[index] != Need::Nothing {
                dispatch!(level, simd => self.carry_patch(simd, (patches, index), maps, centres.values));
            }
        });
    }

    #[inline(always)]
    fn carry_patch<S: Simd>(&self, _: S, (patches, index): (&Patches, usize), maps: &[Columns], centres: &mut [V4]) {
        let (patch, cells) = (&patches.list[index], self.cells_of_patch.row(index));
        for (local, centre) in centres.iter_mut().enumerate().take(patch.owned) {
            let [mut x, mut y, mut z, mut t] = [lanes::ZERO; 4];
            let mut whole = 0.0;
            for share in self.shares_of(patch, local) {
                let (map, part) = (&maps[cells[usize::from(share.cell)] as usize], f64::from(share.part));
                whole += part;
                (x, y) = (add_scaled(x, map[0], part), add_scaled(y, map[1], part));
                (z, t) = (add_scaled(z, map[2], part), add_scaled(t, map[3], part));
            }
            // Parts in single precision do not sum to 1 exactly.
            let whole = if whole > 0.0 { whole.recip() } else { 0.0 };
            *centre = lanes::scale(transform(&[x, y, z, t], self.centres[patch.start + local]), whole);
        }
    }

    /// Prisms, summed by cells.
    fn measure(&self, patches: &Patches, place: &(impl Fn(usize) -> V4 + Sync), room: &mut Room, volumes: &mut Vec<f64>) {
        let (level, needs, centres) = (Level::new(), &room.needs, &room.centres);
        room.parts.resize(self.cells_of_patch.values().len(), 0.0);
        let parts = Ragged::new(&mut room.parts, self.cells_of_patch.offsets());
        for_each_piece(patches.list.len(), parts, &|index, parts| {
            parts.values.fill(0.0);
            if needs[index] == Need::Volumes {
                dispatch!(level, simd => self.measure_patch(simd, (patches, index), place, centres, parts.values));
            }
        });
        volumes.clear();
        volumes.resize(self.cells.len(), 0.0);
        for (&cell, part) in self.cells_of_patch.values().iter().zip(&room.parts) {
            volumes[cell as usize] += part;
        }
        for giant in &patches.giants {
            let owner = |slot: u32| patches.slot_offsets.partition_point(|&start| start <= slot) - 1;
            if giant.corners.iter().all(|&slot| needs[owner(slot)] == Need::Nothing) {
                continue;
            }
            let corner = |i: usize| (place(giant.corners[i] as usize), centres[giant.corners[i] as usize]);
            let part = polygon_prism(giant.corners.len(), corner) / giant.corners.len() as f64;
            for &slot in &giant.corners {
                let index = owner(slot);
                let patch = &patches.list[index];
                for share in self.shares_of(patch, slot as usize - patch.start) {
                    volumes[self.cells_of_patch.row(index)[usize::from(share.cell)] as usize] += f64::from(share.part) * part;
                }
            }
        }
    }

    #[inline(always)]
    fn measure_patch<S: Simd>(
        &self,
        simd: S,
        (patches, index): (&Patches, usize),
        place: &impl Fn(usize) -> V4,
        centres: &[V4],
        parts: &mut [f64],
    ) {
        let patch = &patches.list[index];
        let (mut p, mut m): (Buffer, Buffer) = ([lanes::ZERO; PATCH_POINTS], [lanes::ZERO; PATCH_POINTS]);
        let mut by_point = [0.0; PATCH_POINTS];
        for (local, &slot) in patches.local[patch.local.clone()].iter().enumerate() {
            (p[local], m[local]) = (place(slot as usize), centres[slot as usize]);
        }
        prisms(simd, patches, patch, &p, &m, &mut by_point);
        for (local, volume) in by_point.iter().enumerate().take(patch.local.len()) {
            for share in self.shares_of(patch, local) {
                parts[usize::from(share.cell)] += f64::from(share.part) * volume;
            }
        }
    }

    /// Rest place of a slot, armature space.
    #[inline(always)]
    pub fn rest(&self, slot: usize) -> V4 {
        self.rest[slot]
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.cells)
            + self.cells_of_patch.memory_bytes()
            + self.shares.memory_bytes()
            + size_of_val(&*self.rest)
            + size_of_val(&*self.centres)
            + size_of_val(&*self.radii)
            + size_of_val(&*self.areas)
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use proptest::prelude::*;

    use super::*;
    use crate::surface::topology::Topology;

    const SIDES: usize = 10;

    /// A closed tube of this radius along x, rings half a radius apart.
    fn tube(rings: usize, radius: f64) -> (RestSurface, Patches, Topology) {
        let at = |i: usize| {
            let angle = (i % SIDES) as f64 * std::f64::consts::TAU / SIDES as f64;
            DVec3::new((i / SIDES) as f64 * 0.5, angle.cos(), angle.sin()) * radius
        };
        let places: Vec<DVec3> = (0..rings * SIDES).map(at).collect();
        let next = |i: usize| i / SIDES * SIDES + (i + 1) % SIDES;
        let mut faces: Vec<Vec<i32>> =
            (0..(rings - 1) * SIDES).map(|i| [i, next(i), next(i) + SIDES, i + SIDES].map(|c| c as i32).to_vec()).collect();
        faces.push((0..SIDES as i32).rev().collect());
        faces.push(((rings - 1) * SIDES..rings * SIDES).map(|c| c as i32).collect());
        let mut offsets = vec![0];
        for face in &faces {
            offsets.push(offsets[offsets.len() - 1] + face.len() as i32);
        }
        let topology = Topology::new(&places, &offsets, &faces.concat(), 0.0).expect("a sound tube");
        let patches = Patches::new(&topology, &vec![0; faces.len()], &vec![0; places.len()], &places);
        let mut rest = RestSurface {
            places: vec![DVec3::ZERO; patches.slot_count()],
            areas: vec![0.0; patches.slot_count()],
            faces: Csr::default(),
            slots_of_component: Csr::default(),
        };
        for (point, &slot) in patches.slot_of_point.iter().enumerate() {
            rest.places[slot as usize] = places[point];
        }
        for face in topology.faces.rows() {
            let part = crate::surface::volume::face_area_vector(&places, face).length() / face.len() as f64;
            for &point in face {
                rest.areas[patches.slot_of_point[point as usize] as usize] += part;
            }
            rest.faces.push_row(face.iter().map(|&point| patches.slot_of_point[point as usize]));
        }
        let mut slots = patches.slot_of_point.clone();
        slots.sort_unstable();
        rest.slots_of_component.push_row(slots);
        (rest, patches, topology)
    }

    fn volumes(core: &Core, patches: &Patches, place: impl Fn(usize) -> DVec3 + Sync) -> Vec<f64> {
        let (mut room, mut volumes, mut lengthening) = (Room::default(), Vec::new(), Vec::new());
        core.begin(patches, |_| true, &mut room);
        core.volumes(patches, |slot| lanes::from(place(slot)), &mut room, &mut volumes, &mut lengthening);
        volumes
    }

    #[test]
    fn balls_fill_a_tube_and_shares_sum_to_1() {
        let (rest, patches, topology) = tube(41, 0.5);
        let places = rest.places.clone();
        let core = Core::new(rest, &patches);
        for (slot, place) in places.iter().enumerate().filter(|(slot, _)| core.areas[*slot] > 0.0 && (2.0..8.0).contains(&places[*slot].x))
        {
            assert!((core.radii[slot] - 0.5).abs() < 1e-3, "{}", core.radii[slot]);
            assert!(lanes::to(core.centres[slot]).distance(DVec3::X * place.x) < 1e-3);
        }
        for patch in &patches.list {
            for local in 0..patch.local.len() {
                let sum: f32 = core.shares_of(patch, local).iter().map(|share| share.part).sum();
                assert!((sum - 1.0).abs() < 1e-5, "{sum}");
            }
        }
        // Prisms fill what the core leaves.
        let (mut room, mut prisms, mut lengthening) = (Room::default(), Vec::new(), Vec::new());
        core.begin(&patches, |_| true, &mut room);
        core.volumes(&patches, |slot| lanes::from(places[slot]), &mut room, &mut prisms, &mut lengthening);
        let of_points =
            |of_slot: &dyn Fn(usize) -> DVec3| patches.slot_of_point.iter().map(|&slot| of_slot(slot as usize)).collect::<Vec<_>>();
        let [whole, inner] = [of_points(&|slot| places[slot]), of_points(&|slot| lanes::to(room.centres[slot]))]
            .map(|points| crate::surface::measures::volumes(&topology, &points)[0]);
        let sum: f64 = prisms.iter().sum();
        assert!((sum + inner - whole).abs() < 1e-6 * whole, "{sum} {inner} {whole}");
        assert!(inner < 0.03 * whole);
    }

    proptest! {
        #[test]
        fn what_moves_affinely_changes_by_its_determinant(columns in prop::array::uniform12(-2.0..2.0f64)) {
            let map = DAffine3::from_cols_array(&columns);
            let (rest, patches, _) = tube(15, 0.5);
            let largest: f64 = 7.0 * 0.5;
            let places = rest.places.clone();
            let core = Core::new(rest, &patches);
            let before = volumes(&core, &patches, |slot| places[slot]);
            let after = volumes(&core, &patches, |slot| map.transform_point3(places[slot]));
            for (before, after) in before.into_iter().zip(after) {
                prop_assert!((after - before * map.matrix3.determinant()).abs() <= 1e-10 * largest);
            }
        }
    }
}
