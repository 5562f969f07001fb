//! Flesh that is in one place twice: voxels in which solids pass through each other are there once for each of them.
//!
//! A *node* is a voxel of one sheet, and a *sheet* a set of shells that are one there. Shells without bones are of no sheet:
//! they take from whatever is about them.

/// Viewer of shells without bones, which see all sheets.
pub const EVERYTHING: u32 = 0;

/// Which nodes are of which sheet, and whom that concerns.
pub struct Sheets {
    /// Per node, the sheet it is of.
    pub sheet: Vec<u32>,
    /// Per node the next one in the same voxel.
    pub next_nodes: Vec<u32>,
    pub viewer_of_shell: Vec<u32>,
    pub sheet_count: usize,
    /// Viewers by sheets.
    pub is_seen: Vec<bool>,
    /// Bones by sheets.
    pub is_held: Vec<bool>,
}

impl Sheets {
    /// Whether points of a shell see a node.
    #[inline]
    pub fn is_seen(&self, node: u32, viewer: u32) -> bool {
        self.is_seen[viewer as usize * self.sheet_count + self.sheet[node as usize] as usize]
    }

    /// Whether a bone may hold a node.
    #[inline]
    pub fn is_held(&self, node: u32, bone: u32) -> bool {
        self.is_held[bone as usize * self.sheet_count + self.sheet[node as usize] as usize]
    }

    /// How points of a shell look at nodes.
    pub fn viewer(&self, shell: u32) -> u32 {
        self.viewer_of_shell.get(shell as usize).copied().unwrap_or(EVERYTHING)
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.sheet) + size_of_val(&*self.next_nodes)
    }
}
