//! Changes between solves: loads, rows, numbers in matrices, and where the contact loop starts.

use super::FetiFeti;
use crate::contact;
use crate::feti::Numbers;
use crate::substructures::{FrictionNode, Row};
use crate::Result;

impl FetiFeti {
    /// Replaces the loads (one vector per local subdomain) and the right-hand sides c of the rows, which are in the
    /// order in which this rank provides them. Nothing is factored again.
    ///
    /// # Panics
    /// If a length differs from the present one, or a tie between merged bodies gets a gap.
    pub fn set_loads(&mut self, loads: Vec<Vec<f64>>, gaps: &[f64]) {
        match &mut self.merged {
            None => self.method.set_loads(loads, gaps),
            Some(merged) => {
                let gaps = merged.load(&loads, gaps);
                self.method.set_loads(loads, &gaps);
            }
        }
    }

    /// Replaces the rows between bodies that this rank provides, and the nodes with friction among them. Subdomains
    /// whose interface stays the same stay factored; jump operator, coarse problems and preconditioner are set up anew.
    /// Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::new`]; the solver then still has the old rows and works with them.
    pub fn set_rows(&mut self, rows: Vec<Row>, friction: Vec<FrictionNode>) -> Result<()> {
        let _staged = self.setup_stage.scope()?;
        let Some(merged) = &mut self.merged else {
            return self.method.set_rows(rows, friction);
        };
        let new = self
            .method
            .session
            .agree(merged.with_rows(rows, friction))?;
        let (rows, friction) = new.of_method();
        self.method.set_rows(rows, friction)?;
        merged.take(new);
        Ok(())
    }

    /// The solver with other numbers in all matrices, one for each local subdomain, and with other rows between bodies,
    /// and nodes with friction among them, if there are some. Patterns are not analysed again if
    /// [`MethodSettings::keeps_analyses`](crate::settings::MethodSettings::keeps_analyses) was set. `None` if a
    /// subdomain has motions without energy that it did not have: a new solver is to be made, with primal dofs for
    /// them. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::new`].
    ///
    /// # Panics
    /// If a length differs from the present one.
    pub fn renewed(
        self,
        numbers: Vec<Numbers>,
        rows: Option<(Vec<Row>, Vec<FrictionNode>)>,
    ) -> Result<Option<FetiFeti>> {
        let FetiFeti {
            method,
            settings,
            setup_stage,
            solve_stage,
            idle,
            mut merged,
        } = self;
        let staged = setup_stage.scope()?;
        let rows = match (rows, &mut merged) {
            (Some((rows, friction)), Some(merged)) => {
                let new = method.session.agree(merged.with_rows(rows, friction))?;
                let left = new.of_method();
                merged.take(new);
                Some(left)
            }
            (rows, _) => rows,
        };
        let renewed = method.renewed(numbers, rows)?;
        drop(staged);
        if let (Some(merged), Some(method)) = (&mut merged, &renewed) {
            merged.renew(&method.problem.local);
        }
        Ok(renewed.map(|method| FetiFeti {
            merged,
            method,
            settings,
            setup_stage,
            solve_stage,
            idle,
        }))
    }

    /// The start of the contact loop with the multipliers inside bodies of an earlier solution, and a multiplier and a
    /// state for each row that this rank provides.
    pub fn start(&self, inside: &[f64], rows: &[(f64, bool)]) -> contact::State {
        let dual = self.dual();
        let jump = &dual.stiffness.jump;
        let rows: Vec<(f64, bool)> = match &self.merged {
            Some(merged) => merged.of_method(rows.iter().copied()).collect(),
            None => rows.to_vec(),
        };
        let between = jump.rows_between_bodies();
        let mut lambda = inside.to_vec();
        lambda.resize(between.start, 0.0);
        let mut active = vec![true; between.start];
        for i in between {
            let (multiplier, holds) = rows[jump.given(i)];
            let holds = if jump.law[i].is_decided() {
                holds
            } else {
                jump.initial[i]
            };
            lambda.push(multiplier);
            active.push(holds);
        }
        jump.release(&active, &mut lambda);
        contact::State::warm(lambda, &active)
    }
}
