//! The object behind `FetiFeti` of fetifeti.h: the host's input, and the solver made from it.

use super::changed::Changed;
use super::coordinates::{rigid, Coordinates};
use super::monitor::Monitor;
use super::mortar::HostMortar;
use super::mortar_results::AtNodes;
use super::mortar_rows::MortarRows;
use super::nested::HostVector as GivenVector;
use super::rows::HostRow;
use super::stack::{fits, HostMatrix, LocalMatrix, Stack, StackStates};
use super::surface::HostSurface;
use super::tangential::{FrictionCounts, TangentialRow};
use crate::embed::torn::{countable, marked, spanned};
use crate::embed::{Embedded, EmbeddedResult, GivenRows, SetUpWork, Torn};
use crate::{Error, Result};
use base::Fault;
use parallel::exchange::highest;
use parallel::halo::Halo;
use petsc::{AttachedNullSpace, Mat, Options, PetscInt, Session, Vec as PetscVec};
use std::collections::HashSet;

/// The data of a `FetiFeti`.
pub struct Object {
    pub session: Session,
    pub prefix: String,
    /// (local, global) numbers of unknowns, if given.
    pub sizes: Option<(Option<usize>, Option<usize>)>,
    /// The block size, if given.
    pub block_size: Option<usize>,
    /// Subdomains in the numbering of all unknowns.
    pub subdomains: Vec<HostMatrix>,
    /// Matrices that are numbered one after the other; then there are no other subdomains.
    pub stack: Stack,
    /// The data from the matrix of FetiFetiSetMatIS, besides its entries.
    pub matis: Option<StackStates>,
    /// The block size of a matrix that was added with numbers.
    pub block_size_of_added: usize,
    pub near: Option<AttachedNullSpace>,
    pub coordinates: Option<Coordinates>,
    pub held: Vec<PetscInt>,
    pub held_values: Option<PetscVec>,
    pub primal: Vec<PetscInt>,
    /// The rows that this rank gives, in their order.
    pub rows: Vec<HostRow>,
    pub surfaces: Vec<HostSurface>,
    /// The pairs of surfaces that mortar rows join.
    pub mortars: Vec<HostMortar>,
    /// Their rows, in the present solver.
    pub mortar_rows: MortarRows,
    /// Their results, of the last solve.
    pub at_nodes: AtNodes,
    /// The tangential rows of nodes with friction, in the present solver.
    pub tangential: Vec<TangentialRow>,
    /// The states of these nodes on all ranks, after the last solve.
    pub friction: FrictionCounts,
    /// Whether the slips of the last solve have been taken for those of a load step that has ended.
    pub carried: bool,
    pub bodies: usize,
    pub view: bool,
    /// Changes on this rank since the last set-up.
    pub changed: Changed,
    /// Work that set-ups have taken so far.
    pub work_done: SetUpWork,
    /// Called after each step of the contact loop.
    pub monitor: Option<Monitor>,
    pub solver: Option<Embedded>,
    pub outcome: Option<EmbeddedResult>,
    /// Plain copies of nested vectors: right-hand side, solution, held values.
    pub(super) work: [Option<PetscVec>; 3],
}

impl Object {
    pub fn new(session: Session) -> Object {
        Object {
            session,
            prefix: String::new(),
            sizes: None,
            block_size: None,
            subdomains: Vec::new(),
            stack: Stack::default(),
            matis: None,
            block_size_of_added: 1,
            near: None,
            coordinates: None,
            held: Vec::new(),
            held_values: None,
            primal: Vec::new(),
            rows: Vec::new(),
            surfaces: Vec::new(),
            mortars: Vec::new(),
            mortar_rows: MortarRows::default(),
            at_nodes: AtNodes::default(),
            tangential: Vec::new(),
            friction: FrictionCounts::default(),
            carried: false,
            bodies: 0,
            view: false,
            changed: Changed::default(),
            work_done: SetUpWork::default(),
            monitor: None,
            solver: None,
            outcome: None,
            work: [None, None, None],
        }
    }

    /// Reads the options of the object itself. Collective.
    pub fn set_from_options(&mut self) -> Result<()> {
        let options = self.options();
        let help = "bodies to group subdomains into that were given none; 0: one for every connected piece";
        self.bodies = options.usize("bodies", self.bodies, help)?;
        let help = "show the solver after set-up";
        self.view = options.bool("view", self.view, help)?;
        self.changed.whole = true;
        Ok(())
    }

    fn options(&self) -> Options {
        Options::new(&self.session, &format!("{}fetifeti_", self.prefix))
    }

    /// Replaces all subdomains by the local matrices of a MATIS of all unknowns. Collective.
    pub fn set_matis(&mut self, a: &Mat, body: PetscInt) -> Result<()> {
        let local = LocalMatrix::of(&self.session, a, body)?;
        self.stack.clear();
        self.subdomains.clear();
        self.push(local.given);
        self.matis = Some(local.told);
        Ok(())
    }

    /// Appends the unknowns of a MATIS after those of the previous matrices. Collective.
    pub fn stack_matis(&mut self, a: &Mat, body: PetscInt) -> Result<()> {
        let others = !self.subdomains.is_empty() || self.matis.is_some();
        let others = others.then(|| self.mixed()).map_or(Ok(()), Err);
        self.session.agree(others)?;
        let local = LocalMatrix::of(&self.session, a, body)?;
        self.stack.push(&self.session, local);
        self.changed.whole = true;
        Ok(())
    }

    /// Adds the local matrices of a MATIS; `numbers` has the unknown of each row that this rank owns. Collective.
    pub fn add_matis(&mut self, a: &Mat, numbers: &[PetscInt], body: PetscInt) -> Result<()> {
        if !self.stack.is_empty() {
            return Err(self.mixed());
        }
        let LocalMatrix { mut given, told } = LocalMatrix::of(&self.session, a, body)?;
        given.dofs = self.renumbered(&told.layout, &given.dofs, numbers)?;
        if self.block_size_of_added == 1 {
            self.block_size_of_added = told.block_size;
        }
        self.push(given);
        Ok(())
    }

    /// Adds a subdomain in the numbering of all unknowns.
    pub fn push(&mut self, given: HostMatrix) {
        self.subdomains.push(given);
        self.changed.whole = true;
    }

    /// The error if subdomains are numbered in two ways.
    pub fn mixed(&self) -> Error {
        Fault::WrongState.error(
            "some matrices were added without numbers, which follows their order, \
             and other subdomains with numbers of unknowns, expected one way for all of a FetiFeti",
        )
    }

    /// Maps each owned entry in `dofs` to its number in `numbers`, which has one for every owned entry of vectors like
    /// `layout`. Negative entries stay. Collective.
    fn renumbered(
        &self,
        layout: &PetscVec,
        dofs: &[PetscInt],
        numbers: &[PetscInt],
    ) -> Result<Vec<PetscInt>> {
        let n = layout.local_len();
        let wrong = (numbers.len() != n).then(|| {
            Fault::Sizes.error(format!(
                "rank {} gave {} numbers for the {n} rows of the matrix that it owns, expected as many",
                self.session.rank(),
                numbers.len()
            ))
        });
        self.session.agree(wrong.map_or(Ok(()), Err))?;
        let new = layout.duplicate()?;
        for (to, &number) in new.array_mut()?.iter_mut().zip(numbers) {
            *to = number as f64;
        }
        let ghosts: Vec<u32> = dofs.iter().map(|&d| d.max(0) as u32).collect();
        let mut values = vec![0.0; ghosts.len()];
        Halo::new(&self.session, layout, &ghosts)?.fetch(&new, &mut values)?;
        let pairs = dofs.iter().zip(values);
        Ok(pairs
            .map(|(&d, v)| if d < 0 { d } else { v as PetscInt })
            .collect())
    }

    /// The whole input as a torn operator. Collective.
    pub(super) fn torn(&self) -> Result<Torn> {
        let session = &self.session;
        let layout = self.vector()?;
        let n_global = layout.global_len();
        countable(n_global)?;
        let bs = self.nodes();
        if n_global % bs != 0 {
            return Err(Fault::Sizes.error(format!(
                "there are {n_global} unknowns in blocks of {bs}, expected a multiple"
            )));
        }
        session.agree(self.in_range(n_global))?;
        let numbered = self.subdomains.iter();
        let numbered = numbered.flat_map(|s| s.pieces(&s.dofs, bs));
        let mut torn = Torn {
            n_global,
            block_size: bs,
            pieces: numbered.chain(self.stack.pieces(bs)).collect(),
            modes: self.modes(&layout)?,
            layout,
            held: HashSet::new(),
            primal: HashSet::new(),
            rows: GivenRows::default(),
            named: None,
        };
        let (ghosts, halo) = torn.halo(session)?;
        torn.held = marked(session, &torn.layout, &self.held, (&ghosts, &halo))?;
        torn.primal = marked(session, &torn.layout, &self.primal, (&ghosts, &halo))?;
        Ok(torn)
    }

    /// Number of unknowns of a node.
    pub(super) fn nodes(&self) -> usize {
        let of_matrices = match &self.matis {
            _ if !self.stack.is_empty() => self.stack.block_size(),
            Some(told) => told.block_size,
            None => self.block_size_of_added,
        };
        self.block_size.unwrap_or(of_matrices)
    }

    /// Motions without energy: the given ones, else those of the matrices, else those from the coordinates of the
    /// nodes. Collective.
    fn modes(&self, layout: &PetscVec) -> Result<Option<Vec<PetscVec>>> {
        if let Some(near) = &self.near {
            let mut vectors = Vec::new();
            for v in &near.vectors {
                let given = self.checked(v, "the near-null space", layout);
                vectors.push(self.session.agree(given)?.plain(|| layout.duplicate())?);
            }
            let constants = near.constants;
            return Ok(Some(spanned(
                layout,
                AttachedNullSpace { constants, vectors },
            )?));
        }
        let of_matrices = match &self.matis {
            _ if !self.stack.is_empty() => self.stack.modes(layout)?,
            Some(told) if told.layout.global_len() == layout.global_len() => told.modes.clone(),
            _ => None,
        };
        match (of_matrices, &self.coordinates) {
            (Some(modes), _) => Ok(Some(modes)),
            (None, Some(c)) => {
                let modes = rigid(layout, self.nodes(), c);
                Ok(Some(self.session.agree(modes)?))
            }
            (None, None) => Ok(None),
        }
    }

    pub(super) fn checked(
        &self,
        v: &PetscVec,
        what: &str,
        layout: &PetscVec,
    ) -> Result<GivenVector> {
        GivenVector::new(&self.session, v, what, layout, &self.stack)
    }

    /// A vector with the layout of right-hand sides. Collective.
    pub fn vector(&self) -> Result<PetscVec> {
        let stacked = if self.stack.is_empty() {
            None
        } else {
            Some(self.stack.vector(&self.session)?)
        };
        if let Some((local, global)) = self.sizes {
            let said = PetscVec::over_ranks(&self.session, local, global)?;
            if let Some(layout) = &stacked {
                let what = "the layout of FetiFetiSetSizes";
                self.session
                    .agree(fits(&self.session, &said, layout, what))?;
            }
            return Ok(said);
        }
        if let Some(layout) = stacked {
            return Ok(layout);
        }
        if let Some(told) = &self.matis {
            return told.layout.duplicate();
        }
        let dofs = self.subdomains.iter().flat_map(|s| &s.dofs);
        let n = dofs.max().map_or(0.0, |&d| d as f64 + 1.0);
        let n = highest(self.session.comm(), n);
        PetscVec::over_ranks(&self.session, None, Some(n as usize))
    }

    fn in_range(&self, n: usize) -> Result<()> {
        let out = |dof: &&PetscInt| **dof >= n as PetscInt;
        for (s, sub) in self.subdomains.iter().enumerate() {
            if let Some(dof) = sub.dofs.iter().find(out) {
                return Err(Fault::OutOfRange.error(format!(
                    "subdomain {s} of rank {} has unknown {dof}, expected numbers below {n}",
                    self.session.rank()
                )));
            }
        }
        for (what, list) in [("held", &self.held), ("primal", &self.primal)] {
            if let Some(dof) = list.iter().find(|d| **d < 0 || **d >= n as PetscInt) {
                return Err(Fault::OutOfRange.error(format!(
                    "unknown {dof} is to be {what}, expected numbers from 0 to below {n}"
                )));
            }
        }
        Ok(())
    }
}
