//! The object behind `FetiFeti` of fetifeti.h: what the host has said so far, and the solver made of it.

use crate::embed::pieces::piece;
use crate::embed::torn::{spanned, unassembled};
use crate::embed::{Embedded, GivenRow, Grouping, Outcome, Torn};
use crate::feti::exchange::{gather_all, max_all};
use crate::feti::halo::Halo;
use crate::petsc::{Is, Mat, Options, Session, Vec as PetscVec};
use crate::sparse::Csr;
use crate::{Error, Result, Settings};
use std::collections::HashSet;

/// A subdomain matrix as it was handed over.
pub struct Given {
    /// Rows and columns as the host numbers them.
    pub k: Csr,
    /// Global number of each row; negative: none.
    pub dofs: Vec<i32>,
    /// The body; negative: not said.
    pub body: i32,
}

/// Positions of nodes.
pub struct Coordinates {
    /// 1, 2 or 3.
    pub dim: usize,
    /// Those of the nodes that this rank owns, node by node.
    pub of_node: Vec<f64>,
}

/// What a `FetiFeti` is.
pub struct Object {
    pub session: Session,
    pub prefix: String,
    /// (local, global) numbers of unknowns, where they were said.
    pub sizes: Option<(Option<usize>, Option<usize>)>,
    pub block_size: usize,
    pub subdomains: Vec<Given>,
    /// A vector of the host's layout, where a matrix or a null space has shown one.
    pub layout: Option<PetscVec>,
    pub near: Option<Vec<PetscVec>>,
    pub coordinates: Option<Coordinates>,
    pub held: Vec<i32>,
    pub held_values: Option<PetscVec>,
    pub primal: Vec<i32>,
    pub rows: Vec<GivenRow>,
    pub bodies: usize,
    pub view: bool,
    /// Whether something has changed on this rank since the last set-up.
    pub stale: bool,
    pub solver: Option<Embedded>,
    pub outcome: Option<Outcome>,
}

impl Object {
    pub fn new(session: Session) -> Object {
        Object {
            session,
            prefix: String::new(),
            sizes: None,
            block_size: 1,
            subdomains: Vec::new(),
            layout: None,
            near: None,
            coordinates: None,
            held: Vec::new(),
            held_values: None,
            primal: Vec::new(),
            rows: Vec::new(),
            bodies: 0,
            view: false,
            stale: true,
            solver: None,
            outcome: None,
        }
    }

    /// Reads the options of the object itself. Collective.
    pub fn set_from_options(&mut self) -> Result<()> {
        let options = self.options();
        let help = "bodies to group subdomains into that were given none; 0: one for every eight";
        self.bodies = options.usize("bodies", self.bodies, help)?;
        let help = "show the solver after set-up";
        self.view = options.bool("view", self.view, help)?;
        self.stale = true;
        Ok(())
    }

    fn options(&self) -> Options {
        Options::new(&self.session, &format!("{}fetifeti_", self.prefix))
    }

    /// Adds the local matrix of a MATIS; `numbers` has the unknown of each row of `a` that this rank owns, and `None` means the row's own number.
    /// Collective.
    pub fn add_matis(&mut self, a: &Mat, numbers: Option<Vec<i32>>, body: i32) -> Result<()> {
        let own = numbers.is_none();
        unassembled(a)?;
        let (k, dofs) = self.session.agree(a.local_part())?;
        let dofs = match numbers {
            None => dofs,
            Some(numbers) => self.renumbered(&a.right_vec()?, &dofs, &numbers)?,
        };
        if own {
            self.layout = Some(a.right_vec()?);
        }
        if self.block_size == 1 {
            self.block_size = a.block_size()?;
        }
        if let (true, None, Some(near)) = (own, &self.near, a.attached_near_null_space()?) {
            self.near = Some(spanned(&a.right_vec()?, near)?);
        }
        self.stale = true;
        if k.n() > 0 {
            self.subdomains.push(Given { k, dofs, body });
        }
        Ok(())
    }

    /// What `numbers`, by owned entries of vectors like `layout`, has for these entries; negative ones stay. Collective.
    fn renumbered(&self, layout: &PetscVec, dofs: &[i32], numbers: &[i32]) -> Result<Vec<i32>> {
        let n = layout.local_len();
        let wrong = (numbers.len() != n).then(|| {
            Error::input(format!(
                "rank {} gave {} numbers for the {n} rows of the matrix that it owns, expected as many",
                self.session.rank(),
                numbers.len()
            ))
        });
        self.session.agree(wrong.map_or(Ok(()), Err))?;
        let new = layout.duplicate()?;
        for (to, &number) in new.array_mut()?.iter_mut().zip(numbers) {
            *to = f64::from(number);
        }
        let ghosts: Vec<u32> = dofs.iter().map(|&d| d.max(0) as u32).collect();
        let mut values = vec![0.0; ghosts.len()];
        Halo::new(&self.session, layout, &ghosts)?.fetch(&new, &mut values)?;
        let pairs = dofs.iter().zip(values);
        Ok(pairs
            .map(|(&d, v)| if d < 0 { d } else { v as i32 })
            .collect())
    }

    /// Makes the solver, if there is none or something has changed. Collective.
    pub fn set_up(&mut self) -> Result<()> {
        let mut stale = [f64::from(u8::from(self.stale || self.solver.is_none()))];
        max_all(self.session.comm(), &mut stale);
        if stale[0] == 0.0 {
            return Ok(());
        }
        self.solver = None;
        self.outcome = None;
        let torn = self.torn()?;
        let grouping = match self.bodies {
            0 => Grouping::Auto,
            n => Grouping::Number(n),
        };
        let settings = Settings {
            prefix: format!("{}fetifeti_", self.prefix),
            ..Settings::default()
        };
        self.solver = Some(Embedded::new(&self.session, &torn, grouping, settings)?);
        self.stale = false;
        if self.view {
            self.print();
        }
        Ok(())
    }

    /// Shows the solver on the standard output of the first rank.
    pub fn print(&self) {
        if self.session.rank() == 0 {
            print!("{}", self.text());
        }
    }

    /// Everything that was said, in one piece. Collective.
    fn torn(&self) -> Result<Torn> {
        let session = &self.session;
        let layout = self.vector()?;
        let n_global = layout.global_len();
        let bs = self.block_size;
        if n_global % bs != 0 {
            return Err(Error::input(format!(
                "there are {n_global} unknowns in blocks of {bs}, expected a multiple"
            )));
        }
        session.agree(self.in_range(n_global))?;
        let pieces = self.subdomains.iter().filter_map(|s| {
            let body = u64::try_from(s.body).ok();
            piece(&s.k, &s.dofs, body)
        });
        let mut torn = Torn {
            n_global,
            block_size: bs,
            pieces: pieces.collect(),
            modes: match (&self.near, &self.coordinates) {
                (Some(near), _) => Some(near.clone()),
                (None, Some(c)) => Some(session.agree(rigid(&layout, bs, c))?),
                (None, None) => None,
            },
            layout,
            held: HashSet::new(),
            primal: HashSet::new(),
            rows: self.rows.clone(),
            named: None,
        };
        let (ghosts, halo) = torn.halo(session)?;
        torn.held = self.marked(&torn.layout, &self.held, &ghosts, &halo)?;
        torn.primal = self.marked(&torn.layout, &self.primal, &ghosts, &halo)?;
        Ok(torn)
    }

    /// A vector of the layout of right-hand sides. Collective.
    pub fn vector(&self) -> Result<PetscVec> {
        if let Some((local, global)) = self.sizes {
            return PetscVec::over_ranks(&self.session, local, global);
        }
        if let Some(layout) = &self.layout {
            return layout.duplicate();
        }
        let dofs = self.subdomains.iter().flat_map(|s| &s.dofs);
        let mut n = [dofs.max().map_or(0.0, |&d| f64::from(d) + 1.0)];
        max_all(self.session.comm(), &mut n);
        PetscVec::over_ranks(&self.session, None, Some(n[0] as usize))
    }

    fn in_range(&self, n: usize) -> Result<()> {
        let out = |dof: &&i32| **dof >= n as i32;
        for (s, sub) in self.subdomains.iter().enumerate() {
            if let Some(dof) = sub.dofs.iter().find(out) {
                return Err(Error::input(format!(
                    "subdomain {s} of rank {} has unknown {dof}, expected numbers below {n}",
                    self.session.rank()
                )));
            }
        }
        for (what, list) in [("held", &self.held), ("primal", &self.primal)] {
            if let Some(dof) = list.iter().find(|d| **d < 0 || **d >= n as i32) {
                return Err(Error::input(format!(
                    "unknown {dof} is to be {what}, expected numbers from 0 to below {n}"
                )));
            }
        }
        Ok(())
    }

    /// Those of `ghosts` that some rank lists. Collective.
    fn marked(
        &self,
        layout: &PetscVec,
        list: &[i32],
        ghosts: &[u32],
        halo: &Halo,
    ) -> Result<HashSet<u32>> {
        let marks = layout.duplicate()?;
        marks.set(0.0)?;
        let words: Vec<u64> = list.iter().map(|&d| d as u64).collect();
        let range = marks.ownership_range();
        {
            let mut entries = marks.array_mut()?;
            for dof in gather_all(self.session.comm(), &words).concat() {
                if range.contains(&(dof as usize)) {
                    entries[dof as usize - range.start] = 1.0;
                }
            }
        }
        let mut values = vec![0.0; ghosts.len()];
        halo.fetch(&marks, &mut values)?;
        let marked = ghosts.iter().zip(values).filter(|(_, v)| *v != 0.0);
        Ok(marked.map(|(&d, _)| d).collect())
    }

    /// x ← the solution for b. Collective.
    pub fn solve(&mut self, b: &PetscVec, x: &PetscVec) -> Result<()> {
        self.set_up()?;
        let solver = self.solver.as_ref().expect("set-up has made it");
        let layout = self.vector()?;
        let mut problem = Ok(());
        let held = self
            .held_values
            .as_ref()
            .map(|v| ("vector of held values", v));
        let vectors = [("right-hand side", b), ("solution", x)];
        for (name, v) in vectors.into_iter().chain(held) {
            let (found, wanted) = (v.ownership_range(), layout.ownership_range());
            if found != wanted && problem.is_ok() {
                problem = Err(Error::input(format!(
                    "the {name} has entries {found:?} on rank {}, expected {wanted:?}",
                    self.session.rank()
                )));
            }
        }
        self.session.agree(problem)?;
        self.outcome = None;
        let outcome = solver.solve_with_rows(b, self.held_values.as_ref(), x)?;
        self.outcome = Some(outcome);
        Ok(())
    }

    /// What the last solve did.
    ///
    /// # Errors
    /// There was none.
    pub fn outcome(&self) -> Result<&Outcome> {
        let none = || Error::input("nothing has been solved yet, expected FetiFetiSolve before");
        self.outcome.as_ref().ok_or_else(none)
    }

    /// The solver.
    ///
    /// # Errors
    /// There is none yet.
    pub fn solver(&self) -> Result<&Embedded> {
        let none = || Error::input("there is no solver yet, expected FetiFetiSetUp before");
        self.solver.as_ref().ok_or_else(none)
    }

    /// What FetiFetiView shows.
    pub fn text(&self) -> String {
        let Some(solver) = &self.solver else {
            return "FetiFeti Object: not set up\n".into();
        };
        let (solver, n) = (solver.solver(), solver.n_given_rows());
        let (known, problem) = (solver.facts(), solver.problem());
        let mut text = format!(
            "FetiFeti Object: {} MPI processes\n  bodies: {} ({} floating, kernels of dimension {}), subdomains: {}\n  \
             multipliers: {} inside bodies, {} between bodies, {n} of these for rows given ({} inequalities)\n  primal dofs: {}\n",
            self.session.size(),
            problem.n_bodies,
            known.floating_bodies,
            known.kernel_dimension,
            problem.n_subdomains,
            known.multipliers_local,
            known.multipliers_global,
            known.inequalities,
            known.primal
        );
        if let Some(o) = &self.outcome {
            text += &format!(
                "  last solve: {} after {} iterations, {} steps of the contact loop\n",
                o.reason, o.iterations, o.steps
            );
        }
        text
    }
}

/// A list of unknowns from an index set, or none.
pub fn indices(is: Option<&Is>) -> Result<Vec<i32>> {
    is.map_or(Ok(Vec::new()), Is::indices)
}

/// Translations and rotations where there are as many components as dimensions, one constant per component else.
fn rigid(layout: &PetscVec, bs: usize, c: &Coordinates) -> Result<Vec<PetscVec>> {
    let nodes = layout.local_len() / bs;
    if c.of_node.len() != nodes * c.dim {
        return Err(Error::input(format!(
            "{} coordinates were given for {nodes} nodes in {} dimensions, expected {}",
            c.of_node.len(),
            c.dim,
            nodes * c.dim
        )));
    }
    let pairs: &[(usize, usize)] = match (bs == c.dim, bs) {
        (true, 2) => &[(0, 1)],
        (true, 3) => &[(0, 1), (1, 2), (2, 0)],
        _ => &[],
    };
    let mut modes = Vec::new();
    for k in 0..bs + pairs.len() {
        let mode = layout.duplicate()?;
        mode.set(0.0)?;
        {
            let mut entries = mode.array_mut()?;
            for node in 0..nodes {
                if k < bs {
                    entries[node * bs + k] = 1.0;
                } else {
                    let (a, b) = pairs[k - bs];
                    entries[node * bs + a] = -c.of_node[node * c.dim + b];
                    entries[node * bs + b] = c.of_node[node * c.dim + a];
                }
            }
        }
        modes.push(mode);
    }
    Ok(modes)
}
