//! Compressed rows: a list of lists in two arrays.

/// Rows of values; row `i` is `values[offsets[i]..offsets[i + 1]]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Csr<T> {
    offsets: Vec<u32>,
    values: Vec<T>,
}

impl<T> Default for Csr<T> {
    fn default() -> Self {
        Self { offsets: vec![0], values: Vec::new() }
    }
}

impl<T: Copy> Csr<T> {
    /// Rows gathered from (row, value) pairs; the pairs' order is kept within a row.
    pub fn from_pairs(row_count: usize, pairs: &[(u32, T)]) -> Self {
        let mut offsets = vec![0u32; row_count + 1];
        for &(row, _) in pairs {
            offsets[row as usize + 1] += 1;
        }
        for row in 0..row_count {
            offsets[row + 1] += offsets[row];
        }
        let mut next = offsets.clone();
        let mut order = vec![0u32; pairs.len()];
        for (index, &(row, _)) in pairs.iter().enumerate() {
            order[next[row as usize] as usize] = index as u32;
            next[row as usize] += 1;
        }
        Self { offsets, values: order.iter().map(|&i| pairs[i as usize].1).collect() }
    }

    /// Appends one row.
    pub fn push_row(&mut self, row: impl IntoIterator<Item = T>) {
        self.values.extend(row);
        self.offsets.push(self.values.len() as u32);
    }

    /// Values of one row.
    #[inline]
    pub fn row(&self, index: usize) -> &[T] {
        &self.values[self.offsets[index] as usize..self.offsets[index + 1] as usize]
    }

    /// Values of some rows.
    pub fn rows_mut(&mut self, rows: std::ops::Range<usize>) -> &mut [T] {
        &mut self.values[self.offsets[rows.start] as usize..self.offsets[rows.end] as usize]
    }

    /// Per row and one past the last: where it starts in `values`.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// All rows in order.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[T]> {
        self.offsets.windows(2).map(|w| &self.values[w[0] as usize..w[1] as usize])
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// True when there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All values, row after row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Gives back what values have not used.
    pub fn shrink_to_fit(&mut self) {
        self.values.shrink_to_fit();
    }

    /// Heap memory.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.offsets) + size_of_val(&*self.values)
    }
}
