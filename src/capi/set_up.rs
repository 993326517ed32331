//! The set-up of the object behind `FetiFeti`: of everything, or of what has changed since the last one.

use std::borrow::Cow;

use super::changed::Changed;
use super::mortar_rows::{IsHeld, MortarRows};
use super::object::Object;
use super::tangential::{appended, gaps, TangentialRow};
use crate::embed::states::{states, States};
use crate::embed::{Embedded, GivenRows, Local, SetUp};
use crate::settings::MethodSettings;
use crate::Result;

/// The rows of mortars and of friction that follow those of the host.
type RowOwners = (MortarRows, Vec<TangentialRow>);

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
            solver.set_gaps(&self.present_gaps(&solver));
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
        let (rows, owners) = rows.unzip();
        if !changed.matrices {
            // After an error the solver has the old rows.
            let set = solver.set_rows(rows.unwrap_or_default());
            self.solver = Some(solver);
            set?;
            self.own(owners.unwrap_or_default());
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
                if let Some(owners) = owners {
                    self.own(owners);
                }
                Ok(Some(SetUp::Numbers))
            }
        }
    }

    /// All rows in the numbering of all unknowns: those of the host, of mortars, and of friction. Collective.
    fn all_rows(&self, held: IsHeld) -> Result<(GivenRows, RowOwners)> {
        let (mut rows, mut friction) = self.session.agree(self.given_rows())?;
        let mortars = self.add_mortar_rows((&mut rows, &mut friction), held)?;
        let (rows, tangential) = appended(rows, friction);
        Ok((rows, (mortars, tangential)))
    }

    fn own(&mut self, (mortars, tangential): RowOwners) {
        (self.mortar_rows, self.tangential) = (mortars, tangential);
    }

    /// The present right-hand sides of the rows of a solver. Clearances of mortars stay.
    fn present_gaps(&self, solver: &Embedded) -> Vec<f64> {
        let (host, placed) = (self.rows.len(), &self.mortar_rows.placed);
        let mut out: Vec<f64> = self.rows.iter().map(|row| row.gap).collect();
        out.extend(solver.gaps().skip(host).take(placed.len()));
        let slipped = |normal: usize| match self.rows.get(normal) {
            Some(row) => row.slipped,
            None => {
                let owner = &placed[normal - host];
                self.mortars[owner.mortar].slipped[owner.node as usize]
            }
        };
        out.extend(gaps(&self.tangential, slipped));
        out
    }

    /// Makes a solver. Collective.
    fn whole(&mut self) -> Result<Option<SetUp>> {
        self.work = [None, None, None];
        let mut torn = self.torn()?;
        let states = if self.mortars.is_empty() {
            States::default()
        } else {
            states(&self.session, &torn)
        };
        let held = |dof: u32| states.get(&dof).map(|s| !s.is_free());
        let owners;
        (torn.rows, owners) = self.all_rows(&held)?;
        self.own(owners);
        let settings = MethodSettings {
            prefix: format!("{}fetifeti_", self.prefix),
            keeps_analyses: true,
            ..MethodSettings::default()
        };
        self.solver = Some(Embedded::new(&self.session, &torn, self.bodies, settings)?);
        Ok(Some(SetUp::Whole))
    }
}
