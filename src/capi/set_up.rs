//! The set-up of the object behind `FetiFeti`: of everything, or of what has changed since the last one.

use std::borrow::Cow;
use std::collections::HashMap;

use super::changed::Changed;
use super::mortar_rows::{IsHeld, MortarRows};
use super::object::Object;
use crate::embed::states::states;
use crate::embed::{Embedded, GivenRow, Local, SetUp};
use crate::settings::MethodSettings;
use crate::Result;

impl Object {
    /// Makes the solver if there is none; brings it up to date if the input has changed. Collective.
    pub fn set_up(&mut self) -> Result<()> {
        let mut changed = self.changed;
        changed.whole |= self.solver.is_none();
        let changed = changed.anywhere(&self.session);
        if changed == Changed::default() {
            return Ok(());
        }
        self.outcome = None;
        let session = self.session.clone();
        let mut work = self.work_done;
        let done = |done: &Option<SetUp>| *done;
        let made = work.count(&session, || self.bring_up(changed), done);
        self.work_done = work;
        let made = made?;
        self.changed = Changed::default();
        if self.view && made.is_some() {
            self.print();
        }
        Ok(())
    }

    /// The set-up that suffices for what has changed; `None` if none was needed. Collective.
    fn bring_up(&mut self, changed: Changed) -> Result<Option<SetUp>> {
        let solver = self.solver.take();
        let Some(mut solver) = solver.filter(|_| !changed.whole) else {
            return self.whole();
        };
        if !changed.matrices && !changed.rows {
            let mut gaps: Vec<f64> = self.rows.iter().map(|row| row.gap).collect();
            // Those of mortars come last and stay.
            gaps.extend(solver.gaps().skip(gaps.len()));
            solver.set_gaps(&gaps);
            self.solver = Some(solver);
            return Ok(None);
        }
        let rows = if changed.rows || changed.gaps {
            let made = self.all_rows(&|dof| solver.is_known(dof));
            match made {
                Ok(made) => Some(made),
                Err(error) => {
                    self.solver = Some(solver);
                    return Err(error);
                }
            }
        } else {
            None
        };
        let (rows, mortars) = rows.unzip();
        if !changed.matrices {
            // After an error the solver has the old rows.
            let set = solver.set_rows(rows.unwrap_or_default());
            self.solver = Some(solver);
            set?;
            self.mortar_rows = mortars.unwrap_or_default();
            return Ok(Some(SetUp::Rows));
        }
        let renewed = {
            let arrays = self.subdomains.iter();
            let bs = self.nodes();
            let arrays = arrays.flat_map(|s| s.locals(Cow::Borrowed(&s.dofs), bs));
            let locals: Vec<Local> = arrays.chain(self.stack.locals(bs)).collect();
            solver.renewed(&locals, rows)?
        };
        match renewed {
            None => self.whole(),
            Some(solver) => {
                self.solver = Some(solver);
                if let Some(mortars) = mortars {
                    self.mortar_rows = mortars;
                }
                Ok(Some(SetUp::Numbers))
            }
        }
    }

    /// All rows in the numbering of all unknowns; those of mortars come last. Collective.
    fn all_rows(&self, held: IsHeld) -> Result<(Vec<GivenRow>, MortarRows)> {
        let mut rows = self.session.agree(self.given_rows())?;
        let mortars = self.add_mortar_rows(&mut rows, held)?;
        Ok((rows, mortars))
    }

    /// Makes a solver. Collective.
    fn whole(&mut self) -> Result<Option<SetUp>> {
        self.work = [None, None, None];
        let mut torn = self.torn()?;
        let states = if self.mortars.is_empty() {
            HashMap::new()
        } else {
            states(&self.session, &torn)
        };
        let held = |dof: u32| states.get(&dof).map(|s| !s.is_free());
        (torn.rows, self.mortar_rows) = self.all_rows(&held)?;
        let settings = MethodSettings {
            prefix: format!("{}fetifeti_", self.prefix),
            keeps_analyses: true,
            ..MethodSettings::default()
        };
        self.solver = Some(Embedded::new(&self.session, &torn, self.bodies, settings)?);
        Ok(Some(SetUp::Whole))
    }
}
