//! Z_c of one subdomain as a matrix: copies of Ψ averaged inside the bodies.
//!
//! On one subdomain Z_c has a column for every coarse function of the neighbourhood, six hundred in space. The matrix
//! is built where it is needed and dropped afterwards. A [`Recipe`] says which rows of which subdomains it consists of.
//! Subdomains in the same surroundings have equal recipes, which are recognised by their
//! [signatures](Recipe::signature).

use std::collections::BTreeMap;

use mpi::traits::Communicator;

use super::interpolation::Functions;
use crate::feti::interface::sharing::DofSharing;
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::Problem;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use parallel::exchange::exchange_by_rank;
use parallel::parcels::Parcels;

/// The recipe of Z_c on one subdomain.
pub(crate) struct Recipe {
    /// Order of Γ.
    pub rows: usize,
    /// Global numbers of the columns, increasing.
    pub columns: Vec<u32>,
    contributions: Vec<Contribution>,
    /// (position in Γ, column) of the vertices at which the function of the vertex is one.
    vertices: Vec<(u32, u32)>,
}

/// The contribution of one subdomain to the columns of another one: rows of D Ψ, with D scaled to a sum of one over the
/// copies.
struct Contribution {
    /// The source subdomain.
    from: u64,
    /// Global numbers of its columns; later their places among the columns of the recipe.
    columns: Vec<u32>,
    /// (position in Γ of the target, row of the source, factor).
    rows: Vec<(u32, u32, f64)>,
    source: ColumnSource,
}

enum ColumnSource {
    /// Functions of a subdomain of this rank.
    Local(usize),
    /// Rows that another rank has sent, those of one contribution.
    Remote(Dense),
}

/// The recipes of every local subdomain; exchanges rows of Ψ between ranks.
pub(crate) fn recipes(
    problem: &Problem,
    sharing: &DofSharing,
    stiffness: &Stiffness,
    functions: &[Functions],
) -> Vec<Recipe> {
    let (comm, team) = (stiffness.comm(), &stiffness.team);
    let (space, locals, jump) = (&stiffness.space, &stiffness.locals, &stiffness.jump);
    let me = comm.rank() as usize;
    let global = |j: usize, p: usize| space.ghosts[space.of_subdomain[j][p] as usize];
    let columns = |j: usize| -> Vec<u32> {
        let of = functions[j].columns.iter();
        of.map(|&p| global(j, p)).collect()
    };
    let places: Vec<Vec<u32>> = team.map(locals.len(), |j| {
        let mut place = vec![u32::MAX; problem.local[j].k.n()];
        let interface = locals[j].gamma().interface.iter().zip(0..);
        interface.for_each(|(&i, p)| place[i as usize] = p);
        place
    });
    let candidate: Vec<Vec<bool>> = (0..locals.len())
        .map(|j| {
            jump.columns
                .of(j)
                .between_bodies(locals[j].gamma().n_gamma())
        })
        .collect();
    // (target, (local dof of the target, row, factor)) by subdomain.
    let given = team.map(locals.len(), |j| {
        let (sub, local) = (&problem.local[j], &locals[j]);
        let mut lists: BTreeMap<u32, Vec<(u32, u32, f64)>> = BTreeMap::new();
        for (i, &dof) in local.gamma().interface[..local.gamma().n_delta]
            .iter()
            .enumerate()
        {
            let copies = sharing.shared(sub.dofs[dof as usize]);
            let own = copies.iter().find(|c| c.subdomain as usize == sub.index);
            let Some(own) = own.filter(|_| !candidate[j][i]) else {
                continue;
            };
            let total: f64 = copies.iter().map(|c| c.weight).sum();
            for to in copies {
                let row = (to.local, i as u32, own.weight / total);
                lists.entry(to.subdomain).or_default().push(row);
            }
        }
        lists
    });
    // The numbers of the columns and then the local dofs of the rows; the entries, column after column.
    let mut numbers = Parcels::for_each_rank(comm);
    let mut values = Parcels::for_each_rank(comm);
    let mut received: Vec<Vec<Contribution>> = locals.iter().map(|_| Vec::new()).collect();
    for (j, lists) in given.into_iter().enumerate() {
        let from = problem.local[j].index as u64;
        for (to, mut rows) in lists {
            let rank = sharing.locations.rank(to);
            if rank == me {
                let at = jump.local_index(to);
                rows.iter_mut().for_each(|r| r.0 = places[at][r.0 as usize]);
                received[at].push(Contribution {
                    from,
                    columns: columns(j),
                    rows,
                    source: ColumnSource::Local(j),
                });
            } else {
                let columns = columns(j);
                let n = columns.len();
                let dofs = rows.iter().map(|row| row.0);
                let psi = &functions[j].psi;
                let entries = (0..n).flat_map(|c| rows.iter().map(move |row| (row, c)));
                let entries = entries.map(|(row, c)| row.2 * psi.get(row.1 as usize, c));
                values[rank].push((), entries);
                numbers[rank].push([to.into(), from, n as u64], columns.into_iter().chain(dofs));
            }
        }
    }
    let numbers = exchange_by_rank(comm, numbers);
    let values = exchange_by_rank(comm, values);
    let pairs = numbers.iter().flat_map(Parcels::iter);
    for (([to, from, n], numbers), ((), values)) in pairs.zip(values.iter().flat_map(Parcels::iter))
    {
        let j = jump.local_index(to as u32);
        let (columns, dofs) = numbers.split_at(n as usize);
        let row = |(&dof, r): (&u32, u32)| (places[j][dof as usize], r, 1.0);
        received[j].push(Contribution {
            from,
            columns: columns.to_vec(),
            rows: dofs.iter().zip(0..).map(row).collect(),
            source: ColumnSource::Remote(Dense {
                rows: dofs.len(),
                cols: columns.len(),
                data: values.to_vec(),
            }),
        });
    }
    let recipe = |(j, mut contributions): (usize, Vec<Contribution>)| {
        // Sorted, so that the order of additions does not depend on the ranks.
        contributions.sort_unstable_by_key(|c| c.from);
        let n_delta = locals[j].gamma().n_delta;
        let held = (0..jump.n_shared[j]).filter(|p| !candidate[j][n_delta + p]);
        let held: Vec<(u32, u32)> = held.map(|p| ((n_delta + p) as u32, global(j, p))).collect();
        Recipe::new(locals[j].gamma().n_gamma(), contributions, held)
    };
    received.into_iter().enumerate().map(recipe).collect()
}

impl Recipe {
    fn new(rows: usize, mut contributions: Vec<Contribution>, held: Vec<(u32, u32)>) -> Recipe {
        let theirs = contributions.iter().flat_map(|c| &c.columns).copied();
        let columns = distinct(theirs.chain(held.iter().map(|h| h.1)));
        let place = |g: &mut u32| {
            let at = columns.binary_search(g);
            *g = at.expect("every column was collected") as u32;
        };
        let theirs = contributions.iter_mut().flat_map(|c| &mut c.columns);
        theirs.for_each(place);
        let mut vertices = held;
        vertices.iter_mut().for_each(|(_, g)| place(g));
        Recipe {
            rows,
            columns,
            contributions,
            vertices,
        }
    }

    /// For each column, the rows in which it may be nonzero, one bit for each row.
    pub fn support(&self) -> Vec<Vec<u64>> {
        let words = self.rows.div_ceil(64);
        let mut out = vec![vec![0; words]; self.columns.len()];
        for contribution in &self.contributions {
            let mut rows = vec![0u64; words];
            for &(at, ..) in &contribution.rows {
                rows[at as usize / 64] |= 1 << (at % 64);
            }
            for &c in &contribution.columns {
                let all = out[c as usize].iter_mut().zip(&rows);
                all.for_each(|(w, r)| *w |= r);
            }
        }
        // Functions of the subdomain's own vertices have the same support in all vertices.
        let mut vertices = vec![0u64; words];
        for &(at, _) in &self.vertices {
            vertices[at as usize / 64] |= 1 << (at % 64);
        }
        for &(_, c) in &self.vertices {
            let all = out[c as usize].iter_mut().zip(&vertices);
            all.for_each(|(w, r)| *w |= r);
        }
        out
    }

    /// Z_c, n_Γ × columns: zero where bodies may touch.
    pub fn build(&self, functions: &[Functions]) -> Dense {
        let mut z = Dense::zeros(self.rows, self.columns.len());
        for contribution in &self.contributions {
            let source = match &contribution.source {
                ColumnSource::Local(j) => &functions[*j].psi,
                ColumnSource::Remote(values) => values,
            };
            for (k, &column) in contribution.columns.iter().enumerate() {
                let (z, values) = (z.col_mut(column as usize), source.col(k));
                for &(at, row, factor) in &contribution.rows {
                    z[at as usize] += factor * values[row as usize];
                }
            }
        }
        for &(at, column) in &self.vertices {
            z.set(at as usize, column as usize, 1.0);
        }
        z
    }

    /// A list of numbers that is the same for two subdomains only if Z_c is the same on both. `kind` identifies the
    /// functions of a subdomain.
    pub fn signature(&self, kind: impl Fn(usize) -> u64) -> Vec<u64> {
        let pair = |a: u32, b: u32| u64::from(a) << 32 | u64::from(b);
        let mut out = vec![self.rows as u64, self.columns.len() as u64];
        for c in &self.contributions {
            out.extend([c.columns.len() as u64, c.rows.len() as u64]);
            out.extend(c.columns.iter().map(|&c| u64::from(c)));
            for &(at, row, factor) in &c.rows {
                out.extend([pair(at, row), factor.to_bits()]);
            }
            match &c.source {
                ColumnSource::Local(j) => out.push(kind(*j)),
                ColumnSource::Remote(values) => out.extend(values.data.iter().map(|v| v.to_bits())),
            }
        }
        out.extend(self.vertices.iter().map(|&(at, c)| pair(at, c)));
        out
    }
}
