//! Which methods share a panel: all of them while they are few, else those that rest on the same.

use crate::study::{Family, SolverRun};

/// More methods than this are told apart by nobody.
const TOGETHER: usize = 8;

/// Methods that share a panel, by their places in the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Empty where all methods are in it.
    pub title: &'static str,
    pub members: Vec<usize>,
}

/// All groups that have members, in the order of [`Family`].
pub fn groups<'a>(runs: impl IntoIterator<Item = &'a SolverRun>) -> Vec<Group> {
    let families: Vec<Family> = runs.into_iter().map(|run| run.family).collect();
    if families.len() <= TOGETHER {
        return vec![Group { title: "", members: (0..families.len()).collect() }];
    }
    let of = |family: Family| Group {
        title: match family {
            Family::Direct => "Direct",
            Family::Stationary => "Stationary",
            Family::Krylov => "Krylov",
            Family::Accelerated => "Accelerated",
        },
        members: (0..families.len()).filter(|i| families[*i] == family).collect(),
    };
    let all = [Family::Direct, Family::Stationary, Family::Krylov, Family::Accelerated].map(of);
    all.into_iter().filter(|group| !group.members.is_empty()).collect()
}
