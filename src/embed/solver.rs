//! The solver of a torn operator: substructures out of it, and global vectors in and out.

use std::cell::{Ref, RefCell};
use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::bodies::{bodies, Grouping};
use super::classes::{classes, in_space, Class};
use super::contact::Contact;
use super::hold::{Motions, Shape};
use super::kernels::{self, Columns};
use super::parts::{parts, Part};
use super::rows::{body_dof, rows};
use super::sharing::{gather_per_subdomain, Sharers};
use super::states::{states, State};
use super::torn::Torn;
use crate::contact::State as ContactState;
use crate::feti::halo::Halo;
use crate::feti::kkt::Kkt;
use crate::feti::{FetiFeti, Settings, Solution};
use crate::petsc::{Session, Vec as PetscVec};
use crate::substructures::{Entity, EntityKind, Subdomain, Substructures};
use crate::{Error, Result};

/// A subdomain's share in global vectors.
struct Share {
    /// Place of each local dof among the ghosts.
    ghost: Vec<u32>,
    /// Part of the load that each copy gets, and of the solution that it gives; copies add up to one.
    weight: Vec<f64>,
    /// (local dof, ghost, value) of the columns of known dofs.
    known: Vec<(u32, u32, f64)>,
}

/// A dof that its own row determines.
struct Fixed {
    ghost: u32,
    dof: u32,
    /// The row's diagonal over all copies; 0 for an empty row.
    diagonal: f64,
    /// This rank's part of the value.
    weight: f64,
    /// Held by the host, whatever the row says.
    held: bool,
}

/// What one solve did.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Iterations.
    pub iterations: usize,
    /// Whether the tolerance was reached.
    pub converged: bool,
    /// Why it stopped, by PETSc's name.
    pub reason: String,
    /// (largest, smallest) eigenvalue of the preconditioned operator as the iteration saw them.
    pub spectrum: Option<(f64, f64)>,
    /// How well the optimality conditions hold.
    pub kkt: Kkt,
    /// Steps of the contact loop.
    pub steps: usize,
}

/// FETI-FETI for a torn operator.
pub struct Embedded {
    session: Session,
    halo: Halo,
    n_ghosts: usize,
    shares: Vec<Share>,
    fixed: Vec<Fixed>,
    /// Monitors look into it while it solves.
    solver: RefCell<FetiFeti>,
    /// Known dofs of the present load, by ghost.
    values: RefCell<HashMap<u32, f64>>,
    contact: Contact,
    /// Rows that tie bodies; those of the host come after them.
    n_ties: usize,
    /// Where the next contact loop starts, and the multipliers of the rows that this rank gave.
    reached: RefCell<Option<(ContactState, Vec<f64>)>>,
}

impl Embedded {
    /// Finds substructures and sets the solver up. Collective.
    ///
    /// # Errors
    /// What the operator must not be (unsymmetric, indefinite, empty rows among others), and PETSc's own.
    pub fn new(
        session: &Session,
        torn: &Torn,
        grouping: Grouping,
        settings: Settings,
    ) -> Result<Embedded> {
        let primal = settings.clone().with_options(session)?.primal;
        let (ghosts, halo) = torn.halo(session)?;
        let states = states(session, torn);
        let parts = session.agree(parts(torn, &states))?;
        let sharers = Sharers::new(session, &parts);
        let modes = torn.modes.as_deref();
        let mut modes = kernels::modes(session, modes, &halo, &ghosts, &parts)?;
        let motions = Motions::new(torn, &parts, modes.as_deref());
        let bonds = motions.bonds(session, torn, &parts, &sharers);
        let named: Vec<u64> = parts.iter().map(|p| p.body.map_or(0, |b| b + 1)).collect();
        let named: Vec<Option<u64>> = gather_per_subdomain(session, &named)
            .iter()
            .map(|&b| b.checked_sub(1))
            .collect();
        let body_of = bodies(&named, &bonds, grouping)?;
        let n_bodies = body_of.iter().max().map_or(0, |b| b + 1);
        if n_bodies == 0 {
            return Err(Error::input(
                "every row of the operator has its diagonal only, expected unknowns that are coupled",
            ));
        }
        let mine = &body_of[sharers.first..sharers.first + parts.len()];
        if let Some(columns) = &mut modes {
            kernels::over_bodies(session, mine, n_bodies, columns);
        }
        let classes = classes(session, torn, &parts, &sharers);
        let shape = Shape {
            space: in_space(session, &classes),
            body_of,
            primal,
        };
        let (averaged, mut nodes) =
            motions.missing(session, torn, &parts, &sharers, &classes, &shape);
        for (part, nodes) in parts.iter().zip(&mut nodes) {
            let wanted = |i: &u32| torn.primal.contains(&part.dofs[*i as usize]);
            nodes.extend((0..part.dofs.len() as u32).filter(wanted));
        }
        let mine = &shape.body_of[sharers.first..sharers.first + parts.len()];
        let contact = Contact::new(session, torn, &parts, &states, mine)?;
        let (n, body_of) = (torn.n_global, &shape.body_of);
        let mut rows = rows(session, n, &parts, &sharers, body_of, &contact);
        let n_ties = rows.len();
        rows.extend(contact.rows());
        let problem = Substructures {
            n_bodies,
            n_subdomains: sharers.n_subdomains,
            body_names: (0..n_bodies).map(|b| b.to_string()).collect(),
            local: (0..parts.len())
                .map(|j| {
                    let columns = modes.as_ref().map(|m| m[j].clone());
                    subdomain(torn, &sharers, j, &parts[j], columns, &classes[j], &shape)
                        .constrained(&averaged, &nodes[j])
                        .subdomain
                })
                .collect(),
            rows,
        };
        let shares = shares(&parts, &states, &ghosts);
        let fixed = fixed(torn, &states, &ghosts);
        let solver = FetiFeti::new(session, problem, settings)?;
        Ok(Embedded {
            session: session.clone(),
            halo,
            n_ghosts: ghosts.len(),
            shares,
            fixed,
            solver: RefCell::new(solver),
            values: RefCell::default(),
            contact,
            n_ties,
            reached: RefCell::default(),
        })
    }

    /// x ← the solution for the right-hand side b. `enough` is asked whenever x satisfies the tolerance of the multipliers' equations: by which
    /// factor the residual should fall further, or `None`. Collective.
    ///
    /// # Errors
    /// A load that nothing balances or that acts on an empty row; PETSc's own, and what `enough` returns.
    pub fn solve(
        &self,
        b: &PetscVec,
        x: &PetscVec,
        enough: &dyn Fn(&PetscVec) -> Result<Option<f64>>,
    ) -> Result<Outcome> {
        self.load(b, None)?;
        let solution = self.solver().solve_until(&|u| {
            self.put_together(u, x)?;
            enough(x)
        })?;
        self.put_together(&solution.u, x)?;
        Ok(outcome(&solution))
    }

    /// x ← the solution for the right-hand side b with the rows that the host gave; `held` has the values of the dofs that it holds, zero where
    /// there is none. A contact loop starts from where the last one ended. Collective.
    ///
    /// # Errors
    /// As [`Embedded::solve`], and rows that contradict each other.
    pub fn solve_with_rows(
        &self,
        b: &PetscVec,
        held: Option<&PetscVec>,
        x: &PetscVec,
    ) -> Result<Outcome> {
        self.load(b, held)?;
        let start = self.reached.take().map(|(state, _)| state);
        let start = start.filter(|_| self.contact.has_inequalities());
        let solution = self
            .solver()
            .solve_from(start.as_ref(), &mut |_, _| Ok(()))?;
        self.put_together(&solution.u, x)?;
        let multipliers = self.of_given_rows(&solution.lambda);
        self.reached
            .replace(Some((ContactState::warm(&solution), multipliers)));
        Ok(outcome(&solution))
    }

    /// Rows of the host over all ranks.
    pub fn n_given_rows(&self) -> usize {
        self.contact.n_global()
    }

    /// The multipliers of the rows that this rank gave, in its order, after [`Embedded::solve_with_rows`].
    pub fn multipliers(&self) -> Option<Vec<f64>> {
        self.reached.borrow().as_ref().map(|(_, l)| l.clone())
    }

    /// What belongs to the rows of the host, from a vector of this rank's multipliers. Collective.
    fn of_given_rows(&self, owned: &[f64]) -> Vec<f64> {
        let solver = self.solver();
        let dual = solver.dual();
        let jump = &dual.stiffness.jump;
        let mut mine = vec![0.0; solver.problem().rows.len() - self.n_ties];
        for (k, &r) in jump.order.iter().enumerate() {
            if r >= self.n_ties {
                mine[r - self.n_ties] = owned[jump.n_owned_local + k];
            }
        }
        self.contact.back(&self.session, &mine)
    }

    /// Hands loads and gaps to the solver. Collective.
    fn load(&self, b: &PetscVec, held: Option<&PetscVec>) -> Result<()> {
        let mut load = vec![0.0; self.n_ghosts];
        self.halo.fetch(b, &mut load)?;
        let mut given = vec![0.0; self.n_ghosts];
        if let Some(held) = held {
            self.halo.fetch(held, &mut given)?;
        }
        let values = self.session.agree(self.known(&load, &given))?;
        let loads = self.shares.iter().map(|share| {
            let terms = share.ghost.iter().zip(&share.weight);
            let mut f: Vec<f64> = terms.map(|(&g, w)| w * load[g as usize]).collect();
            for &(i, g, v) in &share.known {
                f[i as usize] -= v * values.get(&g).copied().unwrap_or(0.0);
            }
            f
        });
        let loads = loads.collect();
        let mut gaps = vec![0.0; self.n_ties];
        let by_dof = |fixed: &Fixed| (fixed.dof, values[&fixed.ghost]);
        let known = self.fixed.iter().map(by_dof).collect();
        gaps.extend(self.contact.gaps(&self.session, &known));
        self.solver.borrow_mut().set_loads(loads, &gaps);
        self.values.replace(values);
        Ok(())
    }

    /// x ← what the running iteration has reached, for monitors; `false` where none is running. Collective.
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

    /// Values of the known dofs, by ghost.
    fn known(&self, load: &[f64], given: &[f64]) -> Result<HashMap<u32, f64>> {
        let mut values = HashMap::new();
        for fixed in &self.fixed {
            if fixed.held {
                values.insert(fixed.ghost, given[fixed.ghost as usize]);
                continue;
            }
            let b = load[fixed.ghost as usize];
            if fixed.diagonal == 0.0 && b != 0.0 {
                return Err(Error::input(format!(
                    "row {} of the operator is empty but the right-hand side has {b} there, expected zero",
                    fixed.dof
                )));
            }
            let value = if fixed.diagonal == 0.0 {
                0.0
            } else {
                b / fixed.diagonal
            };
            values.insert(fixed.ghost, value);
        }
        Ok(values)
    }

    /// x from displacements of the subdomains; where bodies still differ by what the tolerance allows, the stiffer copy counts for more.
    fn put_together(&self, u: &[Vec<f64>], x: &PetscVec) -> Result<()> {
        let values = self.values.borrow();
        let mut ghost = vec![0.0; self.n_ghosts];
        for (share, u) in self.shares.iter().zip(u) {
            for ((&g, w), u) in share.ghost.iter().zip(&share.weight).zip(u) {
                ghost[g as usize] += w * u;
            }
        }
        for fixed in &self.fixed {
            ghost[fixed.ghost as usize] += fixed.weight * values[&fixed.ghost];
        }
        self.halo.sum(&ghost, x)
    }
}

fn outcome(solution: &Solution) -> Outcome {
    let estimate = solution.estimate.as_ref();
    Outcome {
        iterations: solution.iterations,
        converged: solution.converged,
        reason: solution.reason.clone(),
        spectrum: estimate.map(|s| (s.lambda_max, s.lambda_min)),
        kkt: solution.kkt,
        steps: solution.steps.len(),
    }
}

/// A subdomain on its way, and the pieces of its interface that are not vertices.
struct Draft<'a> {
    subdomain: Subdomain,
    classes: &'a [Class],
}

fn subdomain<'a>(
    torn: &Torn,
    sharers: &Sharers,
    j: usize,
    part: &Part,
    near_kernel: Option<Columns>,
    classes: &'a [Class],
    shape: &Shape,
) -> Draft<'a> {
    let index = sharers.first + j;
    let body = shape.body_of[index];
    let vertices = classes.iter().filter(|c| c.is_vertex());
    let primal: BTreeSet<u32> = vertices.flat_map(|c| c.dofs.clone()).collect();
    let others = classes.iter().filter(|c| !c.is_vertex());
    let entity = |c: &Class| Entity {
        kind: c.kind(shape.space),
        key: body_dof(torn.n_global, body, c.root),
        dofs: c.dofs.clone(),
    };
    Draft {
        subdomain: Subdomain {
            index,
            body,
            f: vec![0.0; part.dofs.len()],
            dofs: part
                .dofs
                .iter()
                .map(|&dof| body_dof(torn.n_global, body, dof))
                .collect(),
            rho: (0..part.k.n()).map(|i| part.k.get(i, i)).collect(),
            k: part.k.clone(),
            primal: primal.into_iter().collect(),
            entities: others.map(entity).collect(),
            near_kernel,
            coordinates: None,
        },
        classes,
    }
}

impl Draft<'_> {
    /// With the constraints that were missing: faces that count as edges, and nodes.
    fn constrained(mut self, averaged: &BTreeSet<(u32, u32)>, nodes: &BTreeSet<u32>) -> Self {
        let sub = &mut self.subdomain;
        let others = self.classes.iter().filter(|c| !c.is_vertex());
        for (entity, class) in sub.entities.iter_mut().zip(others) {
            if let [a, b] = class.sharers[..] {
                if averaged.contains(&(a, b)) {
                    entity.kind = EntityKind::Edge;
                }
            }
        }
        let all: BTreeSet<u32> = sub.primal.iter().chain(nodes).copied().collect();
        sub.primal = all.into_iter().collect();
        self
    }
}

fn shares(parts: &[Part], states: &HashMap<u32, State>, ghosts: &[u32]) -> Vec<Share> {
    let place = |dof: &u32| ghosts.binary_search(dof).expect("a part's dof is a ghost") as u32;
    let share = |part: &Part| Share {
        ghost: part.dofs.iter().map(place).collect(),
        weight: (0..part.k.n())
            .map(|i| part.k.get(i, i) / states[&part.dofs[i]].diagonal())
            .collect(),
        known: part
            .known
            .iter()
            .map(|(i, dof, v)| (*i, place(dof), *v))
            .collect(),
    };
    parts.iter().map(share).collect()
}

fn fixed(torn: &Torn, states: &HashMap<u32, State>, ghosts: &[u32]) -> Vec<Fixed> {
    let mut found: BTreeMap<u32, f64> = BTreeMap::new();
    for piece in &torn.pieces {
        for (i, &dof) in piece.dofs.iter().enumerate() {
            if !states[&dof].is_free() {
                *found.entry(dof).or_default() += piece.k.get(i, i);
            }
        }
    }
    let place = |dof: u32| {
        ghosts
            .binary_search(&dof)
            .expect("a piece's dof is a ghost") as u32
    };
    let one = |(dof, mine): (u32, f64)| {
        let diagonal = states[&dof].diagonal();
        Fixed {
            ghost: place(dof),
            dof,
            diagonal,
            weight: if diagonal == 0.0 {
                0.0
            } else {
                mine / diagonal
            },
            held: torn.held.contains(&dof),
        }
    };
    found.into_iter().map(one).collect()
}
