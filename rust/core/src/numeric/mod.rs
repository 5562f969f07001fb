//! Numbers by the hand: vectors in lanes, sparse rows, sets that grow together.

pub(crate) mod block_rows;
pub(crate) mod csr;
pub(crate) mod lanes;
pub(crate) mod nearness;
pub(crate) mod real;
pub(crate) mod union_find;
