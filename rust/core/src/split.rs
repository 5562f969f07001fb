//! Parallel visits of pieces of arrays: one piece per patch, each of its own length, each written by one thread.

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
/// Pieces of one task: handing over costs about as much as a tenth of one.
const TASK: usize = 2;

/// Calls `visit(piece, arrays of that piece)` for each of `count` pieces; halves of many go to other threads.
pub(crate) fn for_each_piece<S: Split>(count: usize, arrays: S, visit: &(impl Fn(usize, S) + Sync)) {
    visit_from(0, count, arrays, visit, if count <= FEW { FEW } else { TASK });
}

fn visit_from<S: Split>(first: usize, count: usize, arrays: S, visit: &(impl Fn(usize, S) + Sync), task: usize) {
    match count {
        0 => {}
        1 => visit(first, arrays),
        _ => {
            let half = count / 2;
            let (early, late) = arrays.split(half);
            let early = || visit_from(first, half, early, visit, task);
            let late = || visit_from(first + half, count - half, late, visit, task);
            if count <= task {
                early();
                late();
            } else {
                rayon::join(early, late);
            }
        }
    }
}
