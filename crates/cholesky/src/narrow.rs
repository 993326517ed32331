//! The part of a team's pattern that one rank needs.
//!
//! A factorisation of many bodies is analysed as a whole. After that a rank works with the fronts that it has, and
//! knows of others what it exchanges with them: its memory grows with its part of the bodies, not with all of them.

use super::symbolic::{Front, Symbolic};
use super::team::{FactorTeam, FrontChain};
use base::linalg::sorted::distinct;

impl FactorTeam {
    /// This team with numbers for the dofs in `known` alone, in their order, and with the own fronts alone. `known`
    /// increases, and has all dofs in the rows of the own fronts.
    ///
    /// # Panics
    /// If it has not.
    pub fn narrowed(self, known: &[u32]) -> FactorTeam {
        let old = &*self.symbolic;
        let rows = distinct(self.own_rows.iter().chain(&self.ghost_rows).copied());
        let row = |p: u32| rows.binary_search(&p).expect("a row of an own front") as u32;
        let renumbered = |list: &[u32]| list.iter().map(|&p| row(p)).collect::<Vec<u32>>();
        // Fronts of other ranks that send something to an own one, and those that get something.
        let children = self.runs.iter().flat_map(|run| &run.children).map(|c| c.0);
        let children = distinct(children);
        let parents = self.runs.iter().filter(|run| run.parent.is_some());
        let parents = parents.filter_map(|run| old.fronts[self.last(run)].parent);
        let kept = distinct(
            self.own
                .iter()
                .copied()
                .chain(parents)
                .chain(children.clone()),
        );
        let number = |f: usize| kept.binary_search(&f).ok();
        let of = |f: usize| number(f).expect("a front that is kept");
        let own = distinct(self.own.iter().copied());
        let fronts = kept.iter().map(|&f| {
            let front = &old.fronts[f];
            let is_own = own.binary_search(&f).is_ok();
            let gives = is_own || children.binary_search(&f).is_ok();
            let (start, width) = if is_own {
                (row(front.start as u32) as usize, front.width())
            } else {
                (0, 0)
            };
            let list = |list: &[u32]| if gives { list.to_vec() } else { Vec::new() };
            Front {
                start,
                end: start + width,
                below: renumbered(&list(&front.below)),
                parent: front.parent.filter(|_| gives).and_then(number),
                into_parent: list(&front.into_parent),
                panel: front.panel,
            }
        });
        let dof = |p: &u32| {
            let at = known.binary_search(&old.interior[*p as usize]);
            at.expect("the dofs of own fronts are known") as u32
        };
        let interior = rows.iter().map(dof).collect();
        let fronts = fronts.collect();
        let symbolic = Symbolic::part(interior, known.len(), fronts, old.storage);
        let run = |run: &FrontChain| FrontChain {
            children: run.children.iter().map(|c| (of(c.0), c.1)).collect(),
            fronts: run.fronts.clone(),
            parent: run.parent,
        };
        FactorTeam {
            own: self.own.iter().map(|&f| of(f)).collect(),
            runs: self.runs.iter().map(run).collect(),
            places: known.iter().map(|&d| self.places[d as usize]).collect(),
            names: Some(known.to_vec()),
            own_rows: renumbered(&self.own_rows),
            ghost_rows: renumbered(&self.ghost_rows),
            symbolic: symbolic.into(),
            comm: self.comm,
        }
    }
}
