//! A = Z_cᵀ S̃ Z_c of every body, assembled from blocks of its subdomains. Subdomains in the same surroundings share a
//! block.

use std::collections::HashMap;
use std::sync::Arc;

use super::block as lifting_block;
use super::coarse_functions::Recipe;
use super::interpolation::Functions;
use super::stored::LiftingColumns;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::primal::matrix::Blocks;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::substructures::Problem;
use base::linalg::dense::{multiply, Dense};
use base::linalg::sorted::distinct;

/// Number of subdomains of a body whose blocks are added up before the sum is sent to the rank that factors A.
const GROUP: usize = 32;

/// Number of blocks Z_cᵀ S Z_c that are in memory at the same time.
const BLOCKS: usize = 32;

/// The sum of Z_cᵀ S Z_c over some subdomains of a body.
pub(crate) struct LiftingSum {
    /// The subdomains, by local number.
    members: Vec<usize>,
    /// Global columns, increasing.
    columns: Vec<u32>,
    /// The matrix; only its lower triangle is valid.
    a: Dense,
}

/// This rank's contributions to A.
pub(crate) struct LiftingSums {
    /// The sums of groups of subdomains of a body.
    pub sums: Vec<LiftingSum>,
    /// Σ n_Γ² · columns over the blocks that were made.
    pub products: f64,
    /// Z_c and S Z_c of every local subdomain, if they are to be stored. Subdomains in the same surroundings share
    /// them.
    pub kept: Vec<Arc<LiftingColumns>>,
}

impl LiftingSums {
    /// Computes and adds up the blocks of all local subdomains.
    pub fn new(
        problem: &Problem,
        stiffness: &Stiffness,
        functions: &[Functions],
        recipes: &[Recipe],
        keep: bool,
    ) -> LiftingSums {
        let (locals, team) = (&stiffness.locals, &stiffness.team);
        let mut groups: Vec<(usize, Vec<usize>)> = Vec::new();
        for (j, sub) in problem.local.iter().enumerate() {
            let group = groups.iter_mut().rev().find(|g| g.0 == sub.body);
            match group.filter(|g| g.1.len() < GROUP) {
                Some(group) => group.1.push(j),
                None => groups.push((sub.body, vec![j])),
            }
        }
        let each = team.map(groups.len(), |g| LiftingSum::over(&groups[g].1, recipes));
        let mut sums: Vec<LiftingSum> = each.into_iter().flatten().collect();
        let first = representatives(locals, functions, recipes);
        let kinds = distinct(first.clone());
        let products = |&j: &usize| {
            recipes[j].columns.len() as f64 * (locals[j].gamma().n_gamma() as f64).powi(2)
        };
        let total = kinds.iter().map(products).sum();
        let mut pairs: Vec<Arc<LiftingColumns>> = Vec::new();
        for some in kinds.chunks(BLOCKS) {
            let blocks = team.map(some.len(), |k| {
                let j = some[k];
                if !keep && !locals[j].is_implicit() {
                    return (
                        lifting_block::block(&locals[j], &recipes[j], functions),
                        None,
                    );
                }
                let (a, pair) = block(&locals[j], recipes[j].build(functions));
                (a, keep.then(|| Arc::new(pair)))
            });
            team.for_each(&mut sums, |_, sum| {
                for &j in &sum.members {
                    if let Ok(k) = some.binary_search(&first[j]) {
                        add(&mut sum.a, &sum.columns, &recipes[j].columns, &blocks[k].0);
                    }
                }
            });
            pairs.extend(blocks.into_iter().filter_map(|b| b.1));
        }
        let of = |j: &usize| pairs[kinds.binary_search(j).expect("a first one is a kind")].clone();
        LiftingSums {
            sums,
            products: total,
            kept: if keep {
                first.iter().map(of).collect()
            } else {
                Vec::new()
            },
        }
    }
}

/// For each local subdomain, the first one with the same Z_cᵀ S Z_c.
fn representatives(
    locals: &[ScaledSubdomain],
    functions: &[Functions],
    recipes: &[Recipe],
) -> Vec<usize> {
    let mut names: HashMap<Vec<u64>, u64> = HashMap::new();
    let mut name = |j: usize| {
        let mut key = vec![locals[j].name()];
        for &(p, c, w) in &functions[j].weights {
            key.extend([u64::from(p) << 32 | u64::from(c), w.to_bits()]);
        }
        let next = names.len() as u64;
        *names.entry(key).or_insert(next)
    };
    let names: Vec<u64> = (0..locals.len()).map(&mut name).collect();
    let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
    let first = |(j, recipe): (usize, &Recipe)| {
        let mut key = recipe.signature(|i| names[i]);
        key.extend([locals[j].name(), locals[j].factor.to_bits()]);
        *known.entry(key).or_insert(j)
    };
    recipes.iter().enumerate().map(first).collect()
}

/// Z_cᵀ S Z_c of one subdomain, and its factors Z_c and S Z_c.
fn block(local: &ScaledSubdomain, z: Dense) -> (Dense, LiftingColumns) {
    let mut y = Dense::zeros(z.rows, z.cols);
    local.apply(Operator::S, &z, &mut y);
    let mut a = Dense::zeros(z.cols, z.cols);
    multiply(a.view_mut(), false, 1.0, z.view().transpose(), y.view());
    (a, LiftingColumns { z, y })
}

/// Adds the lower triangle of `block`, whose columns are `theirs`, to that of `a`. Both lists of columns are in the
/// same order.
fn add(a: &mut Dense, columns: &[u32], theirs: &[u32], block: &Dense) {
    let place = |g: &u32| columns.binary_search(g).expect("it was collected");
    let at: Vec<usize> = theirs.iter().map(place).collect();
    for (q, &to) in at.iter().enumerate() {
        let target = a.col_mut(to);
        for (&i, v) in at[q..].iter().zip(&block.col(q)[q..]) {
            target[i] += v;
        }
    }
}

impl LiftingSum {
    /// Zero sums for `members`: one for all of them, or one for each if the columns of some do not meet those of
    /// others. In the latter case less data is sent.
    fn over(members: &[usize], recipes: &[Recipe]) -> Vec<LiftingSum> {
        let empty = |members: &[usize], columns: Vec<u32>| LiftingSum {
            members: members.to_vec(),
            a: Dense::zeros(columns.len(), columns.len()),
            columns,
        };
        let words = |n: usize| n * (n + 1) / 2;
        let each = members.iter().map(|&j| &recipes[j].columns);
        let columns = distinct(each.clone().flatten().copied());
        if words(columns.len()) < each.map(|c| words(c.len())).sum() {
            return vec![empty(members, columns)];
        }
        let alone = members.iter();
        alone
            .map(|j| empty(std::slice::from_ref(j), recipes[*j].columns.clone()))
            .collect()
    }

    /// Local number of a subdomain of the body.
    pub fn subdomain(&self) -> usize {
        self.members[0]
    }

    /// Adds the lower triangle by columns.
    pub fn give(&self, to: &mut Blocks) {
        let columns = (0..self.columns.len()).flat_map(|q| &self.a.col(q)[q..]);
        to.push(self.columns.iter().copied(), columns.copied());
    }
}
