//! The sparsity of GᵀG and the order in which it is factored.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::blocks::ColumnBlocks;
use super::column_map::ColumnMap;
use super::gram::FEW;
use super::pattern::BlockPattern;
use super::rows::KernelRows;
use base::linalg::csr::Csr;
use base::linalg::sorted::distinct;
use cholesky::dissection::{part_of_dissection, Vertices};
use cholesky::symbolic::Symbolic;
use cholesky::team::FactorTeam;
use parallel::clock::{self, Phase};
use parallel::parcels::Parcels;

/// Where GᵀG has entries, and in which order it is factored.
pub struct GramPattern {
    /// The entries for all candidate rows, in the rows that this rank has in the factor and in those that it adds to.
    pub pattern: BlockPattern,
    /// The columns that this rank knows: those of pattern and team.
    pub known: Rc<ColumnMap>,
    /// The order and the ranks that share the factor, if there are many columns.
    team: Option<Rc<FactorTeam>>,
}

/// How ranks share the factors of a shape.
pub struct FactorSharing<'a> {
    /// The rank of each body; empty if that does not matter.
    pub home: &'a [u32],
    /// Rows from which this rank's contributions to products come; `None`: they come from anywhere.
    pub rows: Option<&'a KernelRows>,
    /// Columns that this rank has to know besides those of rows and fronts; `None`: it knows all.
    pub known: Option<Vec<u32>>,
}

impl FactorSharing<'_> {
    /// One factor, to which every rank may add anything.
    pub fn any() -> FactorSharing<'static> {
        FactorSharing {
            home: &[],
            rows: None,
            known: None,
        }
    }
}

impl GramPattern {
    /// The shape of matrices with entries for each body and those in its list, which increases and contains the body
    /// itself. `start` has the first column of each body. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        lists: &[Vec<u32>],
        start: &[usize],
        sharing: &FactorSharing<'_>,
    ) -> GramPattern {
        let whole = || (ColumnBlocks::of_bodies(lists, start), None);
        GramPattern::ordered(comm, lists, start, whole, sharing)
    }

    /// The shape of matrices with entries only in the blocks that `order` makes, with the positions of the bodies where
    /// they are known. `order` is not called if there are few columns. `lists` and `start` are those of
    /// [`GramPattern::new`]. Collective.
    pub fn ordered(
        comm: &SimpleCommunicator,
        lists: &[Vec<u32>],
        start: &[usize],
        order: impl FnOnce() -> (ColumnBlocks, Option<Vec<[f64; 3]>>),
        sharing: &FactorSharing<'_>,
    ) -> GramPattern {
        let r = *start.last().expect("there is an end");
        let team = || {
            let (blocks, at) = order();
            team(comm, lists, (&blocks, at), sharing)
        };
        let team: Option<FactorTeam> = (r > FEW).then(|| clock::timed(Phase::NaturalOrder, team));
        let whole = team.as_ref().filter(|team| team.is_shared());
        let (Some(whole), Some(rows)) = (whole, sharing.rows) else {
            return GramPattern {
                pattern: BlockPattern::new(lists, start, |_| true),
                known: ColumnMap::all(r).into(),
                team: team.map(Rc::new),
            };
        };
        let here = RankBodies::new(whole, rows, start);
        let Some(more) = &sharing.known else {
            let is_here = |b: usize| here.owned.contains(b) || here.touched.contains(b);
            return GramPattern {
                pattern: BlockPattern::new(lists, start, is_here),
                known: ColumnMap::all(r).into(),
                team: team.map(Rc::new),
            };
        };
        let bodies = here.known(whole, lists, more);
        let columns_of = |&b: &u32| start[b as usize] as u32..start[b as usize + 1] as u32;
        let names: Vec<u32> = bodies.iter().flat_map(columns_of).collect();
        let known = ColumnMap::some(whole, names.clone());
        let number = |b: &u32| bodies.binary_search(b).expect("a known body") as u32;
        let lists: Vec<Vec<u32>> = (bodies.iter())
            .map(|&b| here.list(b as usize, lists).map(number).collect())
            .collect();
        let mut starts = vec![0];
        for columns in bodies.iter().map(columns_of) {
            starts.push(starts[starts.len() - 1] + columns.len());
        }
        GramPattern {
            pattern: BlockPattern::new(&lists, &starts, |_| true),
            known: known.into(),
            team: team.map(|team| team.narrowed(&names).into()),
        }
    }

    /// The ranks that share factors of this shape, if there are many columns.
    pub fn team(&self) -> Option<&Rc<FactorTeam>> {
        self.team.as_ref()
    }

    /// Whether this rank has the row of a column in the factor; of few columns it has all.
    pub fn has(&self, column: usize) -> bool {
        let team = self.team.as_ref();
        team.is_none_or(|team| team.has(column as u32))
    }
}

/// The bodies in whose rows of the matrix a rank has entries.
struct RankBodies<'a> {
    start: &'a [usize],
    /// Bodies with a column that this rank has in the factor.
    owned: BodySet,
    /// Bodies that this rank's rows of G touch: it adds to blocks between them.
    touched: BodySet,
}

/// Bodies, increasing.
struct BodySet(Vec<u32>);

impl BodySet {
    fn contains(&self, body: usize) -> bool {
        self.0.binary_search(&(body as u32)).is_ok()
    }
}

impl<'a> RankBodies<'a> {
    fn new(team: &FactorTeam, rows: &KernelRows, start: &'a [usize]) -> RankBodies<'a> {
        let columns = distinct(rows.columns().iter().copied());
        let of = |columns: &mut dyn Iterator<Item = u32>| {
            BodySet(distinct(columns.map(|c| body_of(start, c))))
        };
        RankBodies {
            start,
            owned: of(&mut team.own_dofs()),
            touched: of(&mut columns.into_iter()),
        }
    }

    /// The bodies whose columns the rank has to know, as wholes, increasing: those of its rows of G and of the matrix,
    /// of its fronts and of `more`.
    fn known(&self, team: &FactorTeam, lists: &[Vec<u32>], more: &[u32]) -> Vec<u32> {
        let columns = team.dofs().chain(more.iter().copied());
        let of_columns = columns.map(|c| body_of(self.start, c));
        let met = self.owned.0.iter().flat_map(|&b| &lists[b as usize]);
        let met = met.chain(&self.touched.0).copied();
        distinct(of_columns.chain(met))
    }

    /// The bodies for which the rank has entries in the rows of a body, of those in `lists`. One that meets all others,
    /// such as a floor, has them all where its rows are; elsewhere it has those to which something is added.
    fn list<'b>(
        &'b self,
        body: usize,
        lists: &'b [Vec<u32>],
    ) -> impl Iterator<Item = &'b u32> + 'b {
        let owned = self.owned.contains(body);
        let touched = self.touched.contains(body);
        let list = lists[body].iter();
        list.filter(move |&&b| owned || (touched && self.touched.contains(b as usize)))
    }
}

/// The body of a column.
fn body_of(start: &[usize], column: u32) -> u32 {
    // Of bodies that start there it is the last one: the others have no columns.
    start.partition_point(|&s| s <= column as usize) as u32 - 1
}

/// The order of elimination, and who has which part. `bodies` has for each body those that it meets. Collective.
fn team(
    comm: &SimpleCommunicator,
    bodies: &[Vec<u32>],
    (blocks, at): (&ColumnBlocks, Option<Vec<[f64; 3]>>),
    sharing: &FactorSharing<'_>,
) -> FactorTeam {
    let graph = graph(&blocks.near);
    let floats = |b: &u32| !blocks.columns(*b).is_empty();
    // What meets more than half of all bodies comes last: no cut would separate it from anything.
    let body = |b: &u32| blocks.body[*b as usize] as usize;
    let everywhere = |b: &u32| 2 * bodies[body(b)].len() > bodies.len();
    let all = 0..blocks.n() as u32;
    let (last, rest): (Vec<u32>, Vec<u32>) = all.clone().filter(floats).partition(everywhere);
    let vertices = Vertices {
        sizes: all.clone().map(|b| blocks.columns(b).len()).collect(),
        at: at.map(|at| all.map(|b| at[body(&b)]).collect()),
    };
    let mut sets = dissected(comm, &graph, &rest, &vertices);
    sets.extend((!last.is_empty()).then_some(last));
    let r = blocks.columns(blocks.n() as u32 - 1).end;
    let symbolic = Symbolic::with_blocks(&graph, &sets, r, |b| blocks.columns(b));
    let mut home = Vec::new();
    if !sharing.home.is_empty() {
        for b in 0..blocks.n() as u32 {
            home.resize(blocks.columns(b).end, sharing.home[body(&b)]);
        }
    }
    FactorTeam::new(comm, symbolic, &home)
}

/// A graph, without numbers.
fn graph(lists: &[Vec<u32>]) -> Csr {
    let mut out = Csr {
        row_ptr: vec![0],
        ..Csr::default()
    };
    for list in lists {
        out.col.extend(list);
        out.row_ptr.push(out.col.len());
    }
    out.val = vec![0.0; out.col.len()];
    out
}

/// The nested dissection of these blocks, of which each rank makes a part. Collective.
fn dissected(
    comm: &SimpleCommunicator,
    graph: &Csr,
    blocks: &[u32],
    vertices: &Vertices,
) -> Vec<Vec<u32>> {
    let (rank, ranks) = (comm.rank() as usize, comm.size() as usize);
    let mut sets = Parcels::default();
    for set in part_of_dissection(graph, blocks, vertices, (rank, ranks)) {
        sets.push((), set);
    }
    let all = sets.gather_all(comm);
    let sets = all.iter().flat_map(Parcels::iter);
    sets.map(|((), set)| set.to_vec()).collect()
}
