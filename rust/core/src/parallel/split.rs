//! Parallel visits of pieces of arrays: one piece per patch, each of its own length, each written by one thread.

use std::sync::Mutex;

use crate::parallel::crew::{self, locked};

/// Arrays that can be cut between pieces.
pub(crate) trait Split: Sized + Send {
    /// Everything before piece `count`, and the rest.
    fn split(self, count: usize) -> (Self, Self);
}

/// Rows of different lengths; `offsets` has one entry per row and one past the last.
pub(crate) struct Ragged<'a, T> {
    pub values: &'a mut [T],
    offsets: &'a [u32],
}

impl<'a, T> Ragged<'a, T> {
    pub fn new(values: &'a mut [T], offsets: &'a [u32]) -> Self {
        Self { values, offsets }
    }
}

impl<T: Send> Split for Ragged<'_, T> {
    fn split(self, count: usize) -> (Self, Self) {
        let (values, rest) = self.values.split_at_mut((self.offsets[count] - self.offsets[0]) as usize);
        (Self { values, offsets: &self.offsets[..=count] }, Self { values: rest, offsets: &self.offsets[count..] })
    }
}

/// Rows of one length, the last one perhaps shorter.
pub(crate) struct Equal<'a, T> {
    pub values: &'a mut [T],
    length: usize,
}

impl<'a, T> Equal<'a, T> {
    pub fn new(values: &'a mut [T], length: usize) -> Self {
        Self { values, length }
    }

    pub fn count(&self) -> usize {
        self.values.len().div_ceil(self.length)
    }
}

impl<T: Send> Split for Equal<'_, T> {
    fn split(self, count: usize) -> (Self, Self) {
        let (values, rest) = self.values.split_at_mut((count * self.length).min(self.values.len()));
        (Self { values, ..self }, Self { values: rest, length: self.length })
    }
}

impl<T: Send> Split for &mut [T] {
    fn split(self, count: usize) -> (Self, Self) {
        self.split_at_mut(count)
    }
}

impl<T: Split> Split for [T; 3] {
    fn split(self, count: usize) -> (Self, Self) {
        let [a, b, c] = self.map(|part| part.split(count));
        ([a.0, b.0, c.0], [a.1, b.1, c.1])
    }
}

macro_rules! split_tuple {
    ($($name:ident),+) => {
        impl<$($name: Split),+> Split for ($($name,)+) {
            #[allow(non_snake_case, reason = "one name for a type and its value")]
            fn split(self, count: usize) -> (Self, Self) {
                let ($($name,)+) = self;
                $(let $name = $name.split(count);)+
                (($($name.0,)+), ($($name.1,)+))
            }
        }
    };
}
split_tuple!(A, B);
split_tuple!(A, B, C);
split_tuple!(A, B, C, D);
split_tuple!(A, B, C, D, E);

/// So few pieces are sooner done than another thread is woken.
pub(crate) const FEW: usize = 8;
/// Pieces that a thread takes at a time, at least.
const TASK: usize = 2;
/// Parts of all pieces, one for each of so many threads.
const PARTS: usize = 16;

/// Helpers that so many pieces are worth.
pub(crate) fn helpers_for(count: usize) -> usize {
    if count <= FEW { 0 } else { count / FEW }
}

/// Calls `visit(piece, arrays of that piece)` for each of `count` pieces, here and in the helpers at hand. A thread does the
/// same part of all pieces each time, which is in its cache, and then what others have left of theirs.
pub(crate) fn for_each_piece<S: Split>(count: usize, arrays: S, visit: &(impl Fn(usize, S) + Sync)) {
    let hands = crew::hands().min(PARTS).min(count / TASK);
    if hands <= 1 {
        return Run { first: 0, count, arrays }.visit(visit);
    }
    let parts: [_; PARTS] = [const { Mutex::new(None) }; PARTS];
    let mut left = Run { first: 0, count, arrays };
    for (number, part) in parts[..hands].iter().enumerate() {
        let count = left.count / (hands - number);
        let (own, others) = left.cut(count);
        *locked(part) = Some(own);
        left = others;
    }
    crew::share(&|number| {
        for turn in 0..hands {
            let part = &parts[(number + turn) % hands];
            while let Some(run) = next_run(part, turn == 0) {
                run.visit(visit);
            }
        }
    });
}

/// Some of what is left of a part: the first pieces for its own thread, the last ones for others.
fn next_run<S: Split>(part: &Mutex<Option<Run<S>>>, is_own: bool) -> Option<Run<S>> {
    let mut part = locked(part);
    let left = part.take()?;
    let count = (left.count / 4).max(TASK);
    if count >= left.count {
        return Some(left);
    }
    let (run, rest) = if is_own {
        left.cut(count)
    } else {
        let kept = left.count - count;
        let (rest, run) = left.cut(kept);
        (run, rest)
    };
    *part = Some(rest);
    Some(run)
}

/// Pieces that follow one another.
struct Run<S> {
    first: usize,
    count: usize,
    arrays: S,
}

impl<S: Split> Run<S> {
    fn cut(self, count: usize) -> (Self, Self) {
        let (arrays, rest) = self.arrays.split(count);
        (Self { count, arrays, ..self }, Self { first: self.first + count, count: self.count - count, arrays: rest })
    }

    fn visit(self, visit: &impl Fn(usize, S)) {
        let Self { first, count, mut arrays } = self;
        for piece in first..first + count {
            let (own, rest) = arrays.split(1);
            visit(piece, own);
            arrays = rest;
        }
    }
}
