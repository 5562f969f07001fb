//! Every way in which input can be refused: what was found, what is needed, what to do.

/// Refused input. Nothing was computed and nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages document the variants")]
pub enum Error {
    #[error("{what}: found {found} values, need {needed}: pass an array of that length")]
    Length { what: &'static str, found: usize, needed: usize },
    #[error("{what}: row {row} is not finite: remove NaN and infinity")]
    NotFinite { what: &'static str, row: usize },
    #[error("{what}: row {row} holds {found:e}, need numbers up to {LARGEST:e} in size: scale everything down")]
    TooLarge { what: &'static str, row: usize, found: f64 },
    #[error("{what}: all of it is within {found:e}, need a size of {SMALLEST:e} or more: scale it up")]
    TooSmall { what: &'static str, found: f64 },
    #[error(
        "bone {bone} takes the mesh as far as {reach:e}, need places up to {LARGEST:e}: lower the scale or the distance of the bone or the object"
    )]
    TooFar { bone: usize, reach: f64 },
    #[error("{what}: the result is beyond all numbers: bring what goes in to usual sizes")]
    Beyond { what: &'static str },
    #[error("{what}: entry {row} is {found}, need an index below {limit}")]
    Index { what: &'static str, row: usize, found: i64, limit: usize },
    #[error("{what}: entry {row} is smaller than the one before: need offsets that never fall, starting at 0")]
    Offsets { what: &'static str, row: usize },
    #[error("face {face} has {found} corners, need at least 3: remove loose edges from the face list")]
    Corners { face: usize, found: usize },
    #[error("mesh has {found} vertices but was bound with {bound}: bind again")]
    VertexCount { found: usize, bound: usize },
    #[error("pose has {found} bones but was bound with {bound}: bind again")]
    BoneCount { found: usize, bound: usize },
    #[error("bone {bone} is its own ancestor: need parents without a cycle")]
    Cycle { bone: usize },
    #[error("object_from_armature has no inverse (determinant {determinant:e}): give every axis of the objects a scale other than 0")]
    Singular { determinant: f64 },
    #[error("{what} is {found}, need {needed}")]
    Value { what: &'static str, found: f64, needed: &'static str },
    #[error("{one} and {other} are both given: need one of them")]
    Both { one: &'static str, other: &'static str },
    #[error("bone {bone} is named by two joints: keep one")]
    JointTwice { bone: usize },
    #[error("bone {bone} has no joint: need a bone of joint_bones, one that carries weight")]
    NoJoint { bone: usize },
    #[error("frame {frame}: {error}")]
    Frame { frame: usize, error: Box<Error> },
    #[error("component {component} is to gain {volume:e} but gamma lets nothing move its volume: widen gamma or turn the axes")]
    NothingToMove { component: usize, volume: f64 },
    #[error("{what}: found {found}, a spine needs at least 2: add a point")]
    SpinePoints { what: &'static str, found: usize },
    #[error("points: row {row} lies where the one before it lies: remove one of them, a spine needs points apart")]
    Coincident { row: usize },
    #[error("parameters: row {row} is not above the one before: need parameters that rise")]
    Parameters { row: usize },
    #[error("a NURBS curve of {found} points and order {order} has no span: add points, lower the order, or set Endpoint")]
    NoSpan { found: usize, order: usize },
    #[error("spine was not made from points: make its pose as it was made, from the posed curve")]
    NotPoseable,
    #[error("cannot trim to {start} … {end}: need a start below the end, both within {first} … {last}")]
    Trim { start: f64, end: f64, first: f64, last: f64 },
    #[error("posed spine has {found} stations, rest spine has {bound}: make it with as many points, or match by length")]
    StationCount { found: usize, bound: usize },
    #[error("no bone to give weights to: pass at least one that is not locked")]
    NoFreeBone,
    #[error("resolution {resolution} makes more voxels than fit into memory: need a lower one, or surfaces that are less folded up")]
    TooManyVoxels { resolution: usize },
    #[error("weights of {points} points on {bones} bones do not fit into memory: give weights to fewer meshes or bones at a time")]
    TooManyWeights { points: usize, bones: usize },
    #[error("cancelled: nothing was changed")]
    Cancelled,
}

/// Coordinates, lengths and elements of matrices are no larger: volumes, and squares of what leaves in single precision, are
/// numbers still.
pub const LARGEST: f64 = 1e15;
/// What has to have a size has at least this one: its inverse cubed is a number still.
pub(crate) const SMALLEST: f64 = 1e-30;

/// Result of a call that checks its input.
pub type Result<T> = std::result::Result<T, Error>;

/// Refuses arrays with rows that are not finite, or too large.
pub(crate) fn check_finite(what: &'static str, rows: &[glam::DVec3]) -> Result<()> {
    match rows.iter().position(|p| !p.abs().cmple(glam::DVec3::splat(LARGEST)).all()) {
        Some(row) => refuse(what, row, &rows[row].to_array()),
        None => Ok(()),
    }
}

/// Refuses rows in single precision that are not finite, or too large.
pub(crate) fn check_rows(what: &'static str, rows: &[[f32; 3]]) -> Result<()> {
    match rows.iter().position(|row| !row.iter().all(|x| f64::from(x.abs()) <= LARGEST)) {
        Some(row) => refuse(what, row, &rows[row].map(f64::from)),
        None => Ok(()),
    }
}

/// Refuses matrices that are not finite, or too large.
pub(crate) fn check_matrices(what: &'static str, matrices: &[glam::DMat4]) -> Result<()> {
    let is_sound = |m: &glam::DMat4| m.to_cols_array().iter().all(|x| x.abs() <= LARGEST);
    match matrices.iter().position(|m| !is_sound(m)) {
        Some(row) => refuse(what, row, &matrices[row].to_cols_array()),
        None => Ok(()),
    }
}

/// Refuses numbers that are not finite, or too large.
///
/// # Errors
/// Names `what` and the first row that is refused.
pub fn check_numbers(what: &'static str, numbers: &[f64]) -> Result<()> {
    match numbers.iter().position(|x| !(-LARGEST..=LARGEST).contains(x)) {
        Some(row) => refuse(what, row, &numbers[row..=row]),
        None => Ok(()),
    }
}

fn refuse(what: &'static str, row: usize, numbers: &[f64]) -> Result<()> {
    if numbers.iter().all(|x| x.is_finite()) {
        let found = numbers.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        return Err(Error::TooLarge { what, row, found });
    }
    Err(Error::NotFinite { what, row })
}

/// Refuses CSR offsets that do not start at 0, fall, or end elsewhere than at `end`.
pub(crate) fn check_offsets(what: &'static str, offsets: &[i32], end: usize) -> Result<()> {
    if offsets.first() != Some(&0) {
        return Err(Error::Offsets { what, row: 0 });
    }
    if let Some(row) = offsets.windows(2).position(|w| w[1] < w[0]) {
        return Err(Error::Offsets { what, row: row + 1 });
    }
    let last = offsets[offsets.len() - 1] as usize;
    if last == end { Ok(()) } else { Err(Error::Length { what, found: end, needed: last }) }
}

/// Refuses indices that are negative or not below `limit`.
pub(crate) fn check_indices(what: &'static str, indices: &[i32], limit: usize) -> Result<()> {
    match indices.iter().position(|&i| i < 0 || i as usize >= limit) {
        Some(row) => Err(Error::Index { what, row, found: i64::from(indices[row]), limit }),
        None => Ok(()),
    }
}
