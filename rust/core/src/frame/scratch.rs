//! Room for one patch: one for each thread, so that it stays in its cache.

use std::cell::RefCell;

use crate::fields::patch_sums::{FieldRows, FieldSum};
use crate::numeric::block_rows::PATCH_POINTS;
use crate::numeric::lanes;
use crate::surface::sweeps::Buffer;
use crate::volume_losses::staged::ROWS;

/// Rows lie on cache lines; nothing in them is remembered.
#[repr(align(64))]
pub(super) struct Scratch {
    pub first: Buffer,
    pub second: Buffer,
    pub rows: [f64; ROWS * PATCH_POINTS],
    pub fields: FieldRows,
    pub sum: FieldSum,
}

pub(super) fn with_scratch<R>(visit: impl FnOnce(&mut Scratch) -> R) -> R {
    thread_local! {
        static SCRATCH: RefCell<Box<Scratch>> = RefCell::new(Box::new(Scratch {
            first: [lanes::ZERO; PATCH_POINTS],
            second: [lanes::ZERO; PATCH_POINTS],
            rows: [0.0; ROWS * PATCH_POINTS],
            fields: FieldRows::new(),
            sum: FieldSum::new(),
        }));
    }
    SCRATCH.with_borrow_mut(|scratch| visit(scratch))
}
