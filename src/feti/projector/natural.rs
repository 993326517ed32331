//! The natural coarse problem of the floating bodies and its projector.
//!
//! ```text
//!     G = Z B R,   e = Rᵀ g,   P = I − Q G (Gᵀ Q G)⁻¹ Gᵀ,   λ₀ = Q G (Gᵀ Q G)⁻¹ e      [Lee (2.11)]
//! ```
//!
//! A row of G is sparse: it has entries for the bodies at its node. It lives on the rank that owns the row. Gᵀ Q G is
//! sparse, too: bodies that touch have common entries. All ranks solve it together (`gtg`).

use std::cell::{OnceCell, RefCell};
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::blocks::{positions, ColumnBlocks};
use super::coarse_solver::InverseSide;
use super::column_map::ColumnMap;
use super::columns::KernelColumns;
use super::distributed::Distributed;
use super::gram::Gram;
use super::gram_matrix::GramMatrix;
use super::gram_pattern::{FactorSharing, GramPattern};
use super::graph::BodyGraph;
use super::gtg::Gtg;
use super::kernel_motion::KernelMotion;
use super::pattern::meeting;
use super::rounding::rounding_of_rows;
use super::rows::KernelRows;
use super::team_factor::TeamFactor;
use super::weights::{choose, spread};
use crate::feti::operators::preconditioner::DualPreconditioner;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::settings::ProjectorKind;
use crate::substructures::{Problem, Subdomain};
use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use parallel::exchange::any;
use petsc::{Options, Session, Vec as PetscVec};

/// Largest relative error that a vector may have, with Q = M⁻¹, after multiplication with Gᵀ Q G and its inverse. Where
/// stiff channels join bodies that only soft contact holds, Gᵀ M⁻¹ G is nearly singular and P is no longer a
/// projection.
const SOUND: f64 = 1e-10;

/// The part of the superlumped diagonal that is then added to M⁻¹ in Q. Motions that M⁻¹ does not see, because averages
/// of the bodies' motions are motions of the bodies, are seen by it, and the others hardly.
const MENDED: f64 = 1e-4;

/// G, Q G and the factored Gᵀ Q G; empty if no body floats.
pub struct NaturalCoarse {
    /// Number of kernel vectors of all bodies, r.
    pub r: usize,
    /// The weight Q that is in use (never `Auto`).
    pub projector: ProjectorKind,
    /// R on the interface of each local subdomain (n_Γ × defect of its body).
    pub kernels: Vec<Dense>,
    /// Which columns of R each body has.
    pub columns: KernelColumns,
    /// The columns that this rank knows. Those of the fields below are numbers.
    known: Rc<ColumnMap>,
    /// First column of R of each local subdomain's body.
    first_column: Vec<usize>,
    /// B R with all rows of B_gl, including those that do not hold. Rows of B_loc are left out, because kernels are
    /// continuous inside a body.
    pub all: KernelRows,
    /// Where GᵀG has entries.
    pub shape: Option<GramPattern>,
    /// Where GᵀQG has entries with Q = M⁻¹, and the graph that says so, once they are needed.
    wide: OnceCell<GramPattern>,
    graph: OnceCell<BodyGraph>,
    /// The largest ratio of the stiffnesses of bodies.
    pub(super) spread: f64,
    /// The way of distributed vectors to the shared factor of GᵀQG.
    way: RefCell<Option<Rc<TeamFactor>>>,
    /// The last choice of rows that was asked for, and their GᵀG.
    pub(super) last: RefCell<Option<(Vec<bool>, Rc<Gram>)>>,
    /// The numbers of the last GᵀG that was factored.
    pub(super) numbers: RefCell<GramMatrix>,
    /// Squared work of rows that may be rounding of the input, by column (`noise`).
    pub(super) noise: Vec<f64>,
    /// G on the owned rows.
    pub g: KernelRows,
    /// Q G where it differs from G.
    qg: Option<KernelRows>,
    /// Whether M⁻¹ alone was not enough for Q.
    mended: bool,
    /// (Gᵀ Q G)⁻¹, where a body floats.
    pub gtg: Option<Gtg>,
    /// The motions that are left free where more holds than the rows.
    pub(super) settled: Option<Vec<KernelMotion>>,
    prefix: String,
}

impl NaturalCoarse {
    /// Assembles G and Gᵀ Q G for the active rows; `varies` is the largest ratio of coefficients inside a body.
    /// Collective.
    pub fn new(
        problem: &Problem,
        stiffness: &Stiffness,
        preconditioner: &dyn DualPreconditioner,
        (wanted, varies): (ProjectorKind, f64),
        prefix: &str,
    ) -> Result<NaturalCoarse> {
        let comm = stiffness.comm();
        let space = &stiffness.space;
        let columns = KernelColumns::new(comm, problem.n_bodies, &space.owned);
        let r = columns.n();
        let kernels: Vec<Dense> = (stiffness.locals.iter().enumerate())
            .map(|(j, local)| space.kernel_on_interface(j, local))
            .collect();
        let mut natural = NaturalCoarse {
            r,
            columns,
            projector: ProjectorKind::Identity,
            kernels,
            known: ColumnMap::all(r).into(),
            first_column: vec![0; problem.local.len()],
            all: KernelRows::from_triplets(stiffness.jump.n_owned, Vec::new()),
            shape: None,
            wide: OnceCell::new(),
            graph: OnceCell::new(),
            spread: 1.0,
            way: RefCell::new(None),
            last: RefCell::new(None),
            numbers: RefCell::default(),
            noise: Vec::new(),
            g: KernelRows::from_triplets(stiffness.jump.n_owned, Vec::new()),
            qg: None,
            mended: false,
            gtg: None,
            settled: None,
            prefix: prefix.into(),
        };
        if r > 0 {
            natural.all = natural.all_rows(problem, stiffness);
            natural.spread = spread(comm, problem, stiffness);
            let (differ, switch) = ((natural.spread, varies), natural.slides(problem, stiffness));
            natural.projector = choose(preconditioner, wanted, differ, switch);
            natural.arrange(problem, stiffness)?;
            natural.renew(problem, stiffness, preconditioner)?;
            let auto = wanted == ProjectorKind::Auto;
            if auto && natural.mended {
                natural.projector = ProjectorKind::Diagonal;
                // Ranks that share a factor need not know all columns for that.
                if natural.team_of_all() {
                    natural.arrange(problem, stiffness)?;
                }
                natural.renew(problem, stiffness, preconditioner)?;
            }
        }
        Ok(natural)
    }

    /// Whether all ranks share one factor of many columns.
    fn team_of_all(&self) -> bool {
        let team = self.shape.as_ref().and_then(GramPattern::team);
        team.is_some_and(|team| team.is_shared())
    }

    /// Takes B R from rows of B_gl that were turned. The bodies that they join are those of before. Collective.
    pub(crate) fn turned(&mut self, problem: &Problem, stiffness: &Stiffness) {
        if self.r > 0 {
            self.all = self.all_rows(problem, stiffness).numbered(&self.known);
            self.last = RefCell::default();
            self.numbers = RefCell::default();
        }
    }

    /// Finds the sparsity of GᵀG, the order in which it is factored, and the columns that this rank has to know for the
    /// weight Q that is in use. Collective.
    fn arrange(&mut self, problem: &Problem, stiffness: &Stiffness) -> Result<()> {
        let comm = stiffness.comm();
        self.all = self.all.named(&self.known);
        let start = self.columns.start();
        let lists = meeting(comm, &self.all, &self.all, start);
        let order = || {
            let blocks = ColumnBlocks::of_rows(comm, &self.all, start);
            (blocks, positions(comm, problem))
        };
        // With Q = M⁻¹ rows reach far, and the solver of the user's choice has its own columns on each rank.
        let chosen = Options::new(&stiffness.session, &self.prefix).any()?;
        let all = chosen || self.projector == ProjectorKind::Preconditioner;
        let names = |body: usize| {
            let columns = self.columns.of(body);
            columns.start as u32..columns.end as u32
        };
        let of_bodies = problem.local.iter().flat_map(|sub| names(sub.body));
        let sharing = FactorSharing {
            known: (!all).then(|| distinct(of_bodies)),
            ..self.sharing()
        };
        let shape = GramPattern::ordered(comm, &lists, start, order, &sharing);
        drop(sharing);
        let first = |sub: &Subdomain| shape.known.numbers(names(sub.body)).start;
        self.first_column = problem.local.iter().map(first).collect();
        self.all = self.all.numbered(&shape.known);
        self.known = shape.known.clone();
        self.shape = Some(shape);
        // What is known of the last factor has other numbers.
        self.last = RefCell::default();
        self.numbers = RefCell::default();
        self.way = RefCell::default();
        let shape = self.shape.as_ref().expect("it was set");
        self.noise = rounding_of_rows(comm, problem, &stiffness.jump, (&self.all, shape));
        Ok(())
    }

    /// Assembles G, Q G and Gᵀ Q G for the rows that hold now. Collective.
    pub fn renew(
        &mut self,
        problem: &Problem,
        stiffness: &Stiffness,
        preconditioner: &dyn DualPreconditioner,
    ) -> Result<()> {
        self.weighted(problem, stiffness, preconditioner, 0.0)?;
        let weak = self.projector == ProjectorKind::Preconditioner && !self.is_sound()?;
        // An answer that is as bad with the diagonal has another reason.
        self.mended = weak;
        if weak {
            self.weighted(problem, stiffness, preconditioner, MENDED)
        } else {
            Ok(())
        }
    }

    /// Whether P is a projection to as many digits as there are: what is in its range stays there.
    pub(crate) fn is_exact(&self) -> bool {
        self.gtg.as_ref().is_some_and(Gtg::is_exact)
    }

    /// Whether P is a projection to more digits than an iteration needs.
    fn is_sound(&self) -> Result<bool> {
        let gtg = self.gtg.as_ref();
        let defect = gtg.map_or(Ok(0.0), |gtg| gtg.solver.defect())?;
        Ok(defect <= SOUND)
    }

    /// G, Q G and Gᵀ Q G with Q = M⁻¹ + `rest` times the superlumped diagonal, if Q is to be M⁻¹. Collective.
    fn weighted(
        &mut self,
        problem: &Problem,
        stiffness: &Stiffness,
        preconditioner: &dyn DualPreconditioner,
        rest: f64,
    ) -> Result<()> {
        if self.r == 0 {
            return Ok(());
        }
        let (session, comm) = (&stiffness.session, stiffness.comm());
        self.settled = None;
        let gram = self.gram(comm, &stiffness.jump.active);
        self.g = self.without_noise(self.assemble_g(stiffness), &gram);
        self.qg = match self.projector {
            ProjectorKind::Diagonal => {
                let mut qg = self.g.clone();
                let mut q = self.superlumped(problem, stiffness)?;
                stiffness.add_springs(&mut q);
                qg.scale_rows(&q);
                Some(qg)
            }
            ProjectorKind::Preconditioner => {
                let rigid = self.rigid_rows(problem, stiffness, rest)?;
                Some(self.probe(problem, stiffness, preconditioner, &rigid)?)
            }
            _ => None,
        };
        let (g, qg, start) = (&self.g, self.qg(), self.columns.start());
        let shape = match self.projector {
            // Q reaches the rows of neighbours.
            ProjectorKind::Preconditioner => {
                let graph = self.graph(problem, stiffness);
                self.wide
                    .get_or_init(|| GramPattern::new(comm, &graph.second(), start, &self.sharing()))
            }
            _ => self.shape.as_ref().expect("a body floats"),
        };
        let chosen = |gram: &Gram| {
            let here = shape.pattern.product_here(g, qg, |_| true);
            Distributed::new(
                session,
                (&shape.pattern, &here),
                [g, qg],
                (
                    &gram.dropped,
                    self.projector == ProjectorKind::Preconditioner,
                ),
                &self.prefix,
                |like, own| self.motions(problem, stiffness, like, own),
            )
        };
        let gtg = Gtg::new(
            session,
            (shape, gram),
            self.projector,
            [g, qg],
            &self.prefix,
            chosen,
        )?;
        let spread = if gtg.is_shared() {
            self.spread_for(session, shape)?
        } else {
            None
        };
        let gtg = self.gtg.insert(gtg);
        gtg.set_spread(spread);
        Ok(())
    }

    /// The way to the factor of this shape for the rows of G and Q G: the one that is known if it suffices.
    /// Collective.
    fn spread_for(&self, session: &Session, shape: &GramPattern) -> Result<Option<Rc<TeamFactor>>> {
        let Some(team) = shape.team().filter(|team| team.is_shared()) else {
            return Ok(None);
        };
        // With other Q the columns are always those of all candidate rows.
        let wide = self.qg.as_ref();
        let wide = wide.filter(|_| self.projector == ProjectorKind::Preconditioner);
        let mut known = self.way.borrow_mut();
        let suffices = |s: &Rc<TeamFactor>| s.fits(team) && wide.is_none_or(|qg| s.covers(qg));
        if any(session.comm(), !known.as_ref().is_some_and(suffices)) {
            let all = std::iter::once(&self.all).chain(wide);
            let of_rows = all.flat_map(|r| r.columns().iter().copied());
            let kernels = self.kernels.iter().zip(&self.first_column);
            let of_bodies = kernels.flat_map(|(k, &first)| first as u32..(first + k.cols) as u32);
            let columns = distinct(of_rows.chain(of_bodies));
            *known = Some(TeamFactor::new(session, team, &columns)?.into());
        }
        Ok(known.clone())
    }

    /// How ranks share the factors.
    fn sharing(&self) -> FactorSharing<'_> {
        FactorSharing {
            home: self.columns.home(),
            rows: Some(&self.all),
            known: None,
        }
    }

    /// The columns that this rank knows.
    pub fn known(&self) -> &Rc<ColumnMap> {
        &self.known
    }

    /// The graph of the bodies. Collective when it is first asked for.
    pub(crate) fn graph(&self, problem: &Problem, stiffness: &Stiffness) -> &BodyGraph {
        self.graph
            .get_or_init(|| BodyGraph::new(problem, stiffness))
    }

    /// G = Z B R for the rows that hold.
    fn assemble_g(&self, stiffness: &Stiffness) -> KernelRows {
        let mut g = self.all.clone();
        let held = stiffness
            .jump
            .active
            .iter()
            .map(|&on| f64::from(u8::from(on)));
        g.scale_rows(&held.collect::<Vec<f64>>());
        g
    }

    /// x ← (Gᵀ Q G)⁻¹ x for coefficients of all kernel vectors, the same on every rank. Collective.
    pub fn solve_gtg(&self, comm: &SimpleCommunicator, x: &mut [f64]) -> Result<()> {
        let Some(gtg) = &self.gtg else {
            return Ok(());
        };
        let mut known = self.known.part_of(x);
        gtg.solver.solve(&mut known, InverseSide::Plain)?;
        x.copy_from_slice(&self.known.whole(comm, &known));
        Ok(())
    }

    /// First column of R of local subdomain `j`'s body, as it is numbered here.
    pub(crate) fn first_column(&self, j: usize) -> usize {
        self.first_column[j]
    }

    /// Q G, which is G itself for Q = I.
    pub fn qg(&self) -> &KernelRows {
        self.qg.as_ref().unwrap_or(&self.g)
    }

    /// λ ← P λ = λ − Q G (Gᵀ Q G)⁻¹ Gᵀ λ. Collective.
    pub fn project(&self, comm: &SimpleCommunicator, lambda: &PetscVec) -> Result<()> {
        match &self.gtg {
            Some(gtg) => gtg.remove(comm, lambda, &self.g, self.qg(), InverseSide::Plain),
            None => Ok(()),
        }
    }

    /// r ← Pᵀ r = r − G (Gᵀ Q G)⁻ᵀ (Q G)ᵀ r. Collective.
    pub fn project_transpose(&self, comm: &SimpleCommunicator, residual: &PetscVec) -> Result<()> {
        match &self.gtg {
            Some(gtg) => gtg.remove(comm, residual, self.qg(), &self.g, InverseSide::Transposed),
            None => Ok(()),
        }
    }
}
