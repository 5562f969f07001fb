//! Whose volume is it: what each joint's turn takes from each shell [MATH §3].

pub(crate) mod closed_form;
pub(crate) mod hung;
pub(crate) mod job;
pub(crate) mod plan;
pub(crate) mod staged;
