//! Disjoint sets of numbers, joined two at a time.

/// A partition of 0..n, at first into sets of one. Every set is known by its least member.
///
/// Source: Galler and Fisher (1964), with paths halved as they are walked.
pub(crate) struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n).collect() }
    }

    /// The least member of the set that i is in.
    pub fn least(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Makes one set of those that i and j are in.
    pub fn join(&mut self, i: usize, j: usize) {
        let (a, b) = (self.least(i), self.least(j));
        self.parent[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_known_by_their_least_member_whatever_the_order() {
        for pairs in [[(1, 2), (4, 5), (2, 5), (7, 6)], [(6, 7), (5, 2), (5, 4), (2, 1)]] {
            let mut sets = DisjointSets::new(8);
            pairs.into_iter().for_each(|(i, j)| sets.join(i, j));
            assert_eq!([0, 1, 2, 3, 4, 5, 6, 7].map(|i| sets.least(i)), [0, 1, 1, 3, 1, 1, 6, 6]);
        }
    }
}
