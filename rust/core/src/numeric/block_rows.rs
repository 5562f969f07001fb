//! Rows of numbers, one per point of a patch, eight at a time: blocks of nothing but zeros are left out.

use std::iter::Zip;

use crate::numeric::csr::Csr;

/// Points side by side: slots of a patch are padded to a multiple of this.
pub(crate) const LANES: usize = 8;
/// Most points of one patch: a face names its corners by one byte.
pub(crate) const PATCH_POINTS: usize = 256;

pub(crate) type Block<T> = [T; LANES];

const _: () = assert!(PATCH_POINTS == LANES * u32::BITS as usize, "one bit for each block of a patch");

/// Which blocks of a row are there, in order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Present(u32);

impl Present {
    /// The first so many.
    pub fn first(count: usize) -> Self {
        Self(u32::MAX.checked_shr(u32::BITS - count as u32).unwrap_or(0))
    }

    /// What is kept for each of the blocks, with the block's number.
    #[inline(always)]
    pub fn numbered<I: IntoIterator>(self, kept: I) -> Zip<Numbers, I::IntoIter> {
        Numbers(self.0).zip(kept)
    }

    /// How many there are before block `number`; `None` where that one is left out.
    pub fn rank(self, number: usize) -> Option<usize> {
        let bit = 1 << number;
        (self.0 & bit != 0).then(|| (self.0 & (bit - 1)).count_ones() as usize)
    }
}

/// Numbers of the blocks that are there.
#[derive(Debug, Clone)]
pub(crate) struct Numbers(u32);

impl Iterator for Numbers {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let number = self.0.trailing_zeros();
        self.0 &= self.0.wrapping_sub(1);
        (number < u32::BITS).then_some(number as usize)
    }
}

/// Rows of numbers, one per point of a patch, without their blocks of zeros.
#[derive(Debug, Clone)]
pub(crate) struct BlockRows<T> {
    present: Vec<Present>,
    blocks: Csr<Block<T>>,
}

impl<T> Default for BlockRows<T> {
    fn default() -> Self {
        Self { present: Vec::new(), blocks: Csr::default() }
    }
}

impl<T: Copy + Default + PartialEq> BlockRows<T> {
    /// Appends a row of at most as many numbers as a patch has points.
    pub fn push_row(&mut self, row: &[T]) {
        let mut present = Present::default();
        let filled = row.chunks(LANES).enumerate().filter(|(_, numbers)| numbers.iter().any(|&n| n != T::default()));
        self.blocks.push_row(filled.map(|(number, numbers)| {
            present.0 |= 1 << number;
            let mut block = [T::default(); LANES];
            block[..numbers.len()].copy_from_slice(numbers);
            block
        }));
        self.present.push(present);
    }

    /// Blocks of one row.
    #[inline(always)]
    pub fn row(&self, index: usize) -> (Present, &[Block<T>]) {
        (self.present[index], self.blocks.row(index))
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.present.len()
    }

    /// Blocks of all rows.
    pub fn block_count(&self) -> usize {
        self.blocks.values().len()
    }

    pub fn shrink_to_fit(&mut self) {
        self.blocks.shrink_to_fit();
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.present) + self.blocks.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn rows_come_back(rows in prop::collection::vec(prop::collection::vec(prop_oneof![4 => Just(0u8), 1 => 1..9u8], 0..=PATCH_POINTS), 0..5)) {
            let mut made = BlockRows::default();
            for row in &rows {
                made.push_row(row);
            }
            prop_assert_eq!(made.len(), rows.len());
            for (index, row) in rows.iter().enumerate() {
                let (present, blocks) = made.row(index);
                let mut back = [0; PATCH_POINTS];
                for (place, (number, block)) in present.numbered(blocks).enumerate() {
                    prop_assert_ne!(block, &[0; LANES]);
                    prop_assert_eq!(present.rank(number), Some(place));
                    back.as_chunks_mut().0[number] = *block;
                }
                prop_assert_eq!(&back[..row.len()], &row[..]);
                prop_assert_eq!(Numbers(present.0).count(), blocks.len());
            }
        }
    }

    #[test]
    fn the_first_blocks() {
        for count in 0..=u32::BITS as usize {
            assert!(Numbers(Present::first(count).0).eq(0..count));
        }
    }
}
