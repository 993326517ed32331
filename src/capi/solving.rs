//! The solve of the object behind `FetiFeti`, and its results.

use super::mortar_results::at_nodes;
use super::nested::HostVector;
use super::object::Object;
use super::tangential::{self, FrictionCounts};
use crate::contact::{State, Step};
use crate::embed::{Embedded, EmbeddedResult};
use crate::Result;
use base::Fault;
use petsc::Vec as PetscVec;

impl Object {
    /// x ← the solution for b. Collective.
    pub fn solve(&mut self, b: &PetscVec, x: &PetscVec) -> Result<()> {
        self.set_up()?;
        let layout = self.vector()?;
        let checked = self.session.agree(self.vectors(b, x, &layout))?;
        let mut plain = Vec::new();
        for (given, work) in checked.iter().zip(&mut self.work) {
            let make = || match work {
                Some(work) => Ok(work.clone()),
                None => Ok(work.insert(layout.duplicate()?).clone()),
            };
            plain.push(given.plain(make)?);
        }
        self.outcome = None;
        let solver = self.solver.as_ref().expect("set-up has made it");
        let (monitor, session) = (self.monitor, &self.session);
        let mut count = 0;
        let mut observe = |step: &Step, _: &State| {
            count += 1;
            monitor.map_or(Ok(()), |m| m.call(session, count - 1, step))
        };
        let outcome = solver.solve_with_rows(&plain[0], plain.get(2), &plain[1], &mut observe)?;
        checked[1].take(&plain[1])?;
        let given = solver.given().unwrap_or_default();
        let at_rows = tangential::results(&self.tangential, &given);
        self.friction = FrictionCounts::of(&self.session, &self.tangential, &at_rows);
        let (of_host, of_mortars) = at_rows.split_at(self.rows.len());
        for (row, result) in self.rows.iter_mut().zip(of_host) {
            row.solved = *result;
        }
        let placed = &self.mortar_rows.placed;
        self.at_nodes = at_nodes(&self.session, placed, (&given, of_host.len()), of_mortars);
        self.carried = false;
        self.outcome = Some(outcome);
        Ok(())
    }

    /// Right-hand side, solution, and the held values if there are any.
    fn vectors(&self, b: &PetscVec, x: &PetscVec, layout: &PetscVec) -> Result<Vec<HostVector>> {
        let named = [("the right-hand side", b), ("the solution", x)];
        let held = self
            .held_values
            .iter()
            .map(|v| ("the vector of held values", v));
        let all = named.into_iter().chain(held);
        all.map(|(name, v)| self.checked(v, name, layout)).collect()
    }

    /// The result of the last solve.
    ///
    /// # Errors
    /// There was no solve.
    pub fn outcome(&self) -> Result<&EmbeddedResult> {
        let none = || {
            Fault::WrongState.error("nothing has been solved yet, expected FetiFetiSolve before")
        };
        self.outcome.as_ref().ok_or_else(none)
    }

    /// The solver.
    ///
    /// # Errors
    /// There is no solver yet.
    pub fn solver(&self) -> Result<&Embedded> {
        let none =
            || Fault::WrongState.error("there is no solver yet, expected FetiFetiSetUp before");
        self.solver.as_ref().ok_or_else(none)
    }

    /// The text that FetiFetiView shows.
    pub fn text(&self) -> String {
        let Some(solver) = &self.solver else {
            return "FetiFeti Object: not set up\n".into();
        };
        let (solver, n) = (solver.solver(), solver.n_given_rows());
        let (known, problem) = (solver.facts(), solver.problem());
        let mut text = format!(
            "FetiFeti Object: {} MPI processes\n  bodies: {} ({} floating, kernels of dimension {}), subdomains: {}\
             \n  multipliers: {} inside bodies, {} between bodies, {n} of these for rows given ({} inequalities)\
             \n  primal dofs: {}\n  scaling: {}\n",
            self.session.size(),
            problem.n_bodies,
            known.floating_bodies,
            known.kernel_dimension,
            problem.n_subdomains,
            known.multipliers_local,
            known.multipliers_global,
            known.inequalities,
            known.primal,
            known.scaling.name()
        );
        text += &format!("  {}\n", self.work_done.lines());
        for (m, counts) in self.mortar_rows.counts.iter().enumerate() {
            text += &self.mortar_text(m, counts);
        }
        if let Some(o) = &self.outcome {
            text += &format!(
                "  last solve: {} after {} iterations, {} steps of the contact loop\n",
                o.status, o.iterations, o.steps
            );
            text.extend(self.friction.line());
        }
        text
    }

    /// Prints the solver to the standard output of the first rank.
    pub fn print(&self) {
        if self.session.rank() == 0 {
            print!("{}", self.text());
        }
    }
}
