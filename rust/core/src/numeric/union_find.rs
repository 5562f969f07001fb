//! Disjoint sets; the smallest member names its set, so that results do not depend on the order of joining.

pub(crate) struct UnionFind(Vec<u32>);

impl UnionFind {
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub fn find(&mut self, member: u32) -> u32 {
        let mut root = member;
        while self.0[root as usize] != root {
            root = self.0[root as usize];
        }
        let mut next = member;
        while next != root {
            next = std::mem::replace(&mut self.0[next as usize], root);
        }
        root
    }

    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
