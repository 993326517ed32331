//! The solver for a torn operator: makes the substructures, and maps global vectors to and from subdomains.

use std::cell::{Ref, RefCell};
use std::collections::HashSet;

use super::averaging;
use super::bodies::{by_most_dofs, named_groups, Bodies};
use super::classes::{classes, in_space};
use super::contact::HostContact;
use super::frame::TornFrame;
use super::kernels;
use super::motions::NearKernels;
use super::partition::{partition, whole_pieces, MOST};
use super::parts::parts;
use super::rigid_constraints::ConstraintContext;
use super::rows::rows;
use super::shares::{KnownDofValues, Shares};
use super::sharing::Sharers;
use super::states::states;
use super::subdomains::{subdomain, SubdomainProperties};
use super::torn::{GivenRows, Torn};
use super::touched::RankProblem;
use crate::contact::{Observer, State as ContactState};
use crate::feti::Kkt;
use crate::feti::MethodSettings;
use crate::status::Status;
use crate::substructures::{Law, Problem, SolvedRow};
use crate::{Error, FetiFeti, Result, Solution};
use parallel::halo::Halo;
use petsc::{Event, Session, Vec as PetscVec};

/// The result of a solve.
#[derive(Debug, Clone)]
pub struct EmbeddedResult {
    /// Iterations.
    pub iterations: usize,
    /// Why it stopped.
    pub status: Status,
    /// (largest, smallest) eigenvalue of the preconditioned operator, as the iteration estimated them.
    pub spectrum: Option<(f64, f64)>,
    /// Residuals of the optimality conditions.
    pub kkt: Kkt,
    /// Steps of the contact loop.
    pub steps: usize,
}

/// The results of the rows that a rank gave, in their order; 0 for rows without unknowns.
#[derive(Debug, Clone, Default)]
pub struct GivenResults {
    /// Multipliers.
    pub multipliers: Vec<f64>,
    /// c − B u, what remains of the gaps.
    pub gaps: Vec<f64>,
    /// Whether they hold.
    pub holds: Vec<bool>,
}

/// FETI-FETI for a torn operator.
pub struct Embedded {
    pub(super) session: Session,
    pub(super) halo: Halo,
    pub(super) frame: TornFrame,
    pub(super) shares: Shares,
    /// The solver; monitors borrow it during a solve.
    pub(super) solver: RefCell<FetiFeti>,
    /// Known dofs of the present load, by ghost.
    pub(super) values: RefCell<KnownDofValues>,
    pub(super) contact: HostContact,
    /// The rows that this rank gave.
    pub(super) given: GivenRows,
    /// Number of rows that tie bodies; the host's rows come after them.
    pub(super) n_ties: usize,
    /// Where the last contact loop ended.
    pub(super) reached: RefCell<Option<ContactEnd>>,
}

/// The end of a contact loop, from which the next one starts.
pub(super) struct ContactEnd {
    pub state: ContactState,
    /// Multipliers inside bodies.
    pub inside: Vec<f64>,
    /// Multipliers of the rows that tie bodies.
    pub ties: Vec<f64>,
    /// Results of the rows that this rank gave.
    pub given: GivenResults,
}

impl Embedded {
    /// Finds substructures and sets the solver up. Where the host names no bodies, the subdomains are grouped into
    /// `wanted` of them; 0: one for every connected piece that is not too large ([`whole_pieces`]). Collective.
    ///
    /// # Errors
    /// An operator that is not admissible (unsymmetric, indefinite, with empty rows among others), and PETSc's own.
    pub fn new(
        session: &Session,
        torn: &Torn,
        wanted: usize,
        settings: MethodSettings,
    ) -> Result<Embedded> {
        let asked = settings.clone().with_options(session)?;
        if asked.stops_early {
            return Err(Error::input(format!(
                "option -{}rtol is \"auto\", expected ksp_rtol: matrices have no discretisation error",
                settings.prefix
            )));
        }
        let event = Event::register(session, "FetiFetiTear")?.scope()?;
        let (ghosts, halo) = torn.halo(session)?;
        let states = states(session, torn);
        let (mut parts, rows_of_pieces) = session.agree(parts(torn, &states))?;
        if let Some(numbers) = &torn.named {
            by_most_dofs(session, numbers, &halo, &ghosts, &mut parts)?;
        }
        let sharers = Sharers::new(session, &parts);
        let modes = torn.modes.as_deref();
        let modes = kernels::modes(modes, &halo, &ghosts, &parts)?;
        let (motions, mut modes) = NearKernels::new(session, torn, &parts, &sharers, modes)?;
        let named = named_groups(session, sharers.first, &parts)?;
        let bonds = motions.bonds(session, &parts, &sharers, named.as_deref());
        let n = sharers.n_subdomains;
        let group = match named {
            Some(group) => group,
            None => {
                let prefix = &settings.prefix;
                let all = match wanted {
                    0 => whole_pieces(session, prefix, n, &bonds, MOST)?,
                    wanted => partition(session, prefix, n, &bonds, wanted.min(n))?,
                };
                all[sharers.first..sharers.first + parts.len()].to_vec()
            }
        };
        let bodies = Bodies::new(session, &sharers, &group, &bonds);
        let n_bodies = bodies.n;
        if n_bodies == 0 {
            return Err(Error::input(
                "every row of the operator has its diagonal only, expected unknowns that are coupled",
            ));
        }
        if let Some(columns) = &mut modes {
            kernels::over_bodies(session, &bodies.mine, columns);
        }
        let classes = classes(session, torn, &parts, &sharers);
        let space = in_space(session, &classes);
        let kind = (space, torn.block_size, motions.most());
        let shape = ConstraintContext {
            space,
            bodies,
            primal: averaging::constraints(session, &asked, kind, sharers.first, &classes)?,
        };
        let (averaged, mut nodes) =
            motions.missing(session, torn, &parts, &sharers, &classes, &shape);
        motions.hold_alone(torn, &parts, &sharers, &classes, &shape, &mut nodes);
        for (part, nodes) in parts.iter().zip(&mut nodes) {
            let wanted = |i: &u32| torn.primal.contains(&part.dofs[*i as usize]);
            nodes.extend((0..part.dofs.len() as u32).filter(wanted));
        }
        let known = states.iter().filter(|(_, s)| !s.is_free());
        let known: HashSet<u32> = known.map(|(dof, _)| *dof).collect();
        let here = RankProblem {
            layout: &torn.layout,
            ghosts: &ghosts,
            halo: &halo,
            known: &known,
            parts: &parts,
            body_of: &shape.bodies.mine,
        };
        let contact = HostContact::new(session, &torn.rows, &here)?;
        let (n, bodies) = (torn.n_global, &shape.bodies);
        let mut rows = rows(session, n, &parts, &sharers, bodies, &contact);
        let n_ties = rows.len();
        rows.extend(contact.rows());
        let columns = |j: usize| {
            let known = modes
                .as_ref()
                .filter(|_| !motions.is_loose(sharers.first + j));
            known.map(|m| m[j].clone())
        };
        let shares = Shares::new(session, torn, &parts, &states, (&ghosts, &halo))?;
        let kernels = parts.iter().zip(motions.bases()).map(|(part, basis)| {
            (
                basis.clone(),
                TornFrame::cancelled(&part.k, &part.k.val, basis),
            )
        });
        let kernels = kernels.collect();
        let local = parts.iter_mut().enumerate().map(|(j, part)| {
            let known = SubdomainProperties {
                index: sharers.first + j,
                near_kernel: columns(j),
                own_kernel: motions.own_kernel(j),
                classes: &classes[j],
                averaged: &averaged,
                nodes: &nodes[j],
            };
            subdomain(torn.n_global, part, &shape, known)
        });
        let names = (0..n_bodies).map(|b| b.to_string());
        let mut problem = Problem::new(names, sharers.n_subdomains)
            .with_subdomains(local)
            .with_rows(rows)
            .with_friction(contact.friction_behind(n_ties));
        // Nothing is known of a mesh: weights follow the stiffness of each copy.
        problem.ragged = true;
        let settings = settings
            .primal(shape.primal)
            .averages(shape.primal.averages);
        // The solver has their loads.
        parts.iter_mut().for_each(|p| p.known = Vec::new());
        drop(event);
        let solver = FetiFeti::new(session, problem, settings)?;
        Ok(Embedded {
            session: session.clone(),
            halo,
            frame: TornFrame {
                n_global: torn.n_global,
                block_size: torn.block_size,
                layout: torn.layout.clone(),
                ghosts,
                known,
                rows: rows_of_pieces,
                parts,
                sharers,
                bodies: shape.bodies,
                motions: kernels,
            },
            shares,
            solver: RefCell::new(solver),
            values: RefCell::default(),
            contact,
            given: torn.rows.clone(),
            n_ties,
            reached: RefCell::default(),
        })
    }

    /// Solves for the right-hand side b with the rows that the host gave. `held` has the values of the dofs that the
    /// host holds, and zero elsewhere. A contact loop starts from the result of the last one; `observe` is called after
    /// each of its steps. Collective.
    ///
    /// # Errors
    /// As [`Embedded::solve`]; also rows that contradict each other, and those of `observe`.
    pub fn solve_with_rows(
        &self,
        b: &PetscVec,
        held: Option<&PetscVec>,
        x: &PetscVec,
        observe: &mut Observer,
    ) -> Result<EmbeddedResult> {
        self.load(b, held)?;
        let start = self.reached.take().map(|reached| reached.state);
        let start = start.filter(|_| self.contact.inequalities);
        let solution = self.solver().observed(start.as_ref(), observe)?;
        self.put_together(&solution.u, x)?;
        let ties = solution.rows()[..self.n_ties].iter();
        self.reached.replace(Some(ContactEnd {
            state: solution.warm_start(),
            inside: solution.inside_bodies().to_vec(),
            ties: ties.map(|row| row.multiplier).collect(),
            given: self.of_given_rows(&solution),
        }));
        Ok(outcome(&solution))
    }

    /// Number of the host's rows over all ranks.
    pub fn n_given_rows(&self) -> usize {
        self.contact.n_global
    }

    /// After [`Embedded::solve_with_rows`]: the results of the rows that this rank gave.
    pub fn given(&self) -> Option<GivenResults> {
        self.reached
            .borrow()
            .as_ref()
            .map(|reached| reached.given.clone())
    }

    /// The results of the host's rows, on the ranks that gave them. Collective.
    fn of_given_rows(&self, solution: &Solution) -> GivenResults {
        let mut others = solution.rows()[self.n_ties..].iter();
        let mut tangential = solution.tangential_rows().iter();
        let row = |law: Law| match law.is_friction() {
            true => tangential.next(),
            false => others.next(),
        };
        let rows: Option<Vec<&SolvedRow>> = self.contact.laws().map(row).collect();
        let rows = rows.expect("a solution has all rows");
        let back = |value: fn(&SolvedRow) -> f64| {
            let values = rows.iter().map(|row| value(row));
            self.contact.back(&self.session, values)
        };
        let holds = back(|r| f64::from(u8::from(r.holds())));
        GivenResults {
            multipliers: back(|r| r.multiplier),
            gaps: back(|r| r.gap),
            holds: holds.into_iter().map(|v| v > 0.0).collect(),
        }
    }

    /// Passes loads and gaps to the solver. Collective.
    pub(super) fn load(&self, b: &PetscVec, held: Option<&PetscVec>) -> Result<()> {
        let mut load = vec![0.0; self.frame.ghosts.len()];
        self.halo.fetch(b, &mut load)?;
        let mut given = vec![0.0; self.frame.ghosts.len()];
        if let Some(held) = held {
            self.halo.fetch(held, &mut given)?;
        }
        let finite = self.shares.finite(&load);
        let values = finite.and_then(|()| self.shares.known(&load, &given));
        let values = self.session.agree(values)?;
        let loads = self.shares.loads(&load, &values);
        let mut gaps = vec![0.0; self.n_ties];
        let known = self.shares.by_dof(&values);
        gaps.extend(self.contact.gaps(&self.session, &known));
        self.solver.borrow_mut().set_loads(loads, &gaps);
        self.values.replace(values);
        Ok(())
    }

    /// x ← the current iterate, for monitors; returns `false` if no iteration is running. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn current(&self, x: &PetscVec) -> Result<bool> {
        let Some(u) = self.solver().current()? else {
            return Ok(false);
        };
        self.put_together(&u, x)?;
        Ok(true)
    }

    /// The solver.
    pub fn solver(&self) -> Ref<'_, FetiFeti> {
        self.solver.borrow()
    }

    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// x ← the solution assembled from the displacements of the subdomains. Within the tolerance, copies in different
    /// bodies may differ; the average weights them by stiffness.
    pub(super) fn put_together(&self, u: &[Vec<f64>], x: &PetscVec) -> Result<()> {
        let ghost = self.shares.together(u, &self.values.borrow());
        self.halo.sum(&ghost, x)
    }
}

fn outcome(solution: &Solution) -> EmbeddedResult {
    let estimate = solution.estimate.as_ref();
    EmbeddedResult {
        iterations: solution.iterations,
        status: solution.status.clone(),
        spectrum: estimate.map(|s| (s.lambda_max, s.lambda_min)),
        kkt: solution.kkt,
        steps: solution.steps.len(),
    }
}
