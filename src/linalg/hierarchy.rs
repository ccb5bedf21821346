//! Fine unknowns gathered into groups, at several levels: the coarse spaces of solvers.

use std::collections::HashMap;
use std::hash::Hash;

/// Which group each unknown belongs to.
///
/// With P the n × m matrix of ones where unknown i is of group I: P spreads a value a group over its unknowns, and Pᵀ W, for weights W,
/// gathers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Aggregation {
    group_of: Vec<u32>,
    n_groups: usize,
}

impl Aggregation {
    /// From the label of every unknown's group; groups are numbered in the order they first appear, so that none is empty.
    pub fn new<L: Eq + Hash>(labels: impl IntoIterator<Item = L>) -> Self {
        let mut numbers = HashMap::new();
        let number = |label| {
            let next = numbers.len() as u32;
            *numbers.entry(label).or_insert(next)
        };
        let group_of: Vec<u32> = labels.into_iter().map(number).collect();
        let n_groups = numbers.len();
        Self { group_of, n_groups }
    }

    /// All n unknowns in one group: the constants.
    pub fn whole(n: usize) -> Self {
        Self { group_of: vec![0; n], n_groups: usize::from(n > 0) }
    }

    pub fn n_unknowns(&self) -> usize {
        self.group_of.len()
    }

    pub fn n_groups(&self) -> usize {
        self.n_groups
    }

    /// The group of an unknown.
    pub fn group_of(&self, unknown: usize) -> usize {
        self.group_of[unknown] as usize
    }

    /// The groups of all unknowns, in order.
    pub fn groups(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.group_of.iter().map(|group| *group as usize)
    }

    /// The aggregation of *these groups* that `coarser`, of the same unknowns, makes; `None` where it cuts a group in two.
    pub fn onto(&self, coarser: &Aggregation) -> Option<Aggregation> {
        let mut parents = vec![None; self.n_groups];
        for (group, parent) in self.groups().zip(coarser.groups()) {
            if *parents[group].get_or_insert(parent) != parent {
                return None;
            }
        }
        Some(Aggregation::new(parents.into_iter().flatten()))
    }
}

/// Aggregations of the same unknowns, finest first, every level coarser than the one before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hierarchy(Vec<Aggregation>);

impl Hierarchy {
    /// Keeps of these, which come finest first, the ones that are coarser than the last kept and gather whole groups of it.
    pub fn new(levels: impl IntoIterator<Item = Aggregation>) -> Self {
        let mut kept: Vec<Aggregation> = Vec::new();
        for level in levels {
            let fits = match kept.last() {
                Some(last) => level.n_groups < last.n_groups && last.onto(&level).is_some(),
                None => level.n_groups < level.n_unknowns(),
            };
            if fits {
                kept.push(level);
            }
        }
        Self(kept)
    }

    /// Finest first; empty where nothing can be gathered.
    pub fn levels(&self) -> &[Aggregation] {
        &self.0
    }

    /// The finest level of at most so many groups.
    pub fn finest_within(&self, n_groups: usize) -> Option<&Aggregation> {
        self.0.iter().find(|level| level.n_groups <= n_groups)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_nest_or_are_left_out() {
        let fine = Aggregation::new([7, 7, 3, 3, 9, 9]);
        assert_eq!(fine.groups().collect::<Vec<_>>(), [0, 0, 1, 1, 2, 2]);
        let coarse = Aggregation::new([0, 0, 0, 0, 1, 1]);
        let across = Aggregation::new([0, 1, 1, 1, 1, 1]);
        assert_eq!(fine.onto(&coarse), Some(Aggregation::new([0, 0, 1])));
        assert_eq!(fine.onto(&across), None);
        let hierarchy = Hierarchy::new([fine.clone(), across, coarse.clone(), coarse.clone(), Aggregation::whole(6)]);
        assert_eq!(hierarchy.levels(), [fine, coarse.clone(), Aggregation::whole(6)]);
        assert_eq!(hierarchy.finest_within(2), Some(&coarse));
    }
}
