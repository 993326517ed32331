//! The motions of one body: those that given values stop, those that rows see, and the others.

use std::sync::Arc;

use super::basis::{at, dual, less, orthonormal, without, NONE};
use super::words::driven;
use crate::assembly::zero_energy::{tidy, ZeroEnergyMode};
use crate::assembly::SubdomainMesh;
use crate::body::Body;
use base::linalg::csr::Csr;
use base::linalg::null_space::null_space;
use base::linalg::sorted::distinct;
use elements::cell;
use elements::element::strain_of;
use elements::form::Form;
use fetifeti::problem::Idle;
use mesh::Mesh;

/// Coordinates with six digits leave motions without energy strains of 1e-6. What may be the kernel of a body is given
/// to the method so small that these strains become this: far below what counts there as the end of rounding.
const ROUNDING: f64 = 1e-12;

/// The motions without energy of one body, beside the rigid ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodySlack {
    /// The body.
    pub body: usize,
    /// A basis of those that nothing sees, and the degree of freedom of each at which the others vanish and it is one.
    dual: Vec<(u32, ZeroEnergyMode)>,
    /// An orthonormal basis of the motions that nothing sees.
    pub idle: Vec<ZeroEnergyMode>,
    /// The motions that rows see beside rigid motions; zero where the springs are.
    pub seen: Vec<ZeroEnergyMode>,
    /// The words on each idle motion, for the message where a load drives it.
    what: Vec<Arc<str>>,
    /// The largest strain that cells see of the motions.
    strain: f64,
}

impl BodySlack {
    /// Sorts the motions of the mesh of body number `b`; `on_rows` are the degrees of freedom that rows see.
    pub fn new(
        form: &Form,
        (b, body): (usize, &Body),
        motions: Vec<ZeroEnergyMode>,
        on_rows: &[u32],
    ) -> BodySlack {
        let c = body.components;
        let rigid: Vec<usize> = form.rigid(body.mesh().dim()).collect();
        let rigid_at = |k: usize, dof: u32| rigid_value(body, k, dof);
        // Where values are given or springs of a foundation stand.
        let mut held: Vec<u32> = body.prescribed.iter().map(|p| p.0 as u32).collect();
        for (side, _) in &body.spec.springs {
            let nodes = body.mesh().side_nodes(*side).into_iter();
            held.extend(nodes.flat_map(|k| (c * k..c * (k + 1)).map(|d| d as u32)));
        }
        held.sort_unstable();
        held.dedup();
        let all = |j: usize| -> Vec<f64> {
            (0..rigid.len())
                .map(|k| f64::from(u8::from(j == k)))
                .collect()
        };
        // Combinations of rigid motions and others that vanish somewhere.
        let vanishing = |firsts: &[Vec<f64>], others: &[ZeroEnergyMode], dofs: &[u32]| {
            let (r, n) = (firsts.len(), firsts.len() + others.len());
            let mut rows = vec![vec![0.0; n]; dofs.len()];
            for (row, &dof) in rows.iter_mut().zip(dofs) {
                for (entry, first) in row.iter_mut().zip(firsts) {
                    let terms = first.iter().zip(&rigid).filter(|(f, _)| **f != 0.0);
                    *entry = terms.map(|(f, &k)| f * rigid_at(k, dof)).sum();
                }
            }
            for (j, motion) in others.iter().enumerate() {
                for &(dof, v) in motion {
                    if let Ok(i) = dofs.binary_search(&dof) {
                        rows[i][r + j] = v;
                    }
                }
            }
            null_space(rows, &[0..r, r..n], NONE)
        };
        let whole = |firsts: &[Vec<f64>], others: &[ZeroEnergyMode], x: &[f64]| -> ZeroEnergyMode {
            let r = firsts.len();
            let mut motion = ZeroEnergyMode::new();
            let mut turned = vec![0.0; rigid.len()];
            for (first, f) in firsts.iter().zip(x) {
                turned.iter_mut().zip(first).for_each(|(t, v)| *t += f * v);
            }
            if turned.iter().any(|t| *t != 0.0) {
                for dof in 0..(c * body.mesh().n_nodes()) as u32 {
                    let terms = turned.iter().zip(&rigid);
                    motion.push((dof, terms.map(|(t, &k)| t * rigid_at(k, dof)).sum()));
                }
            }
            for (other, f) in others.iter().zip(&x[r..]).filter(|(_, f)| **f != 0.0) {
                motion.extend(other.iter().map(|&(dof, v)| (dof, f * v)));
            }
            tidy(motion)
        };
        let units: Vec<Vec<f64>> = (0..rigid.len()).map(all).collect();
        let mut free_rigid = Vec::new();
        let mut free = Vec::new();
        for (at, x) in vanishing(&units, &motions, &held) {
            if at < units.len() {
                free_rigid.push(x[..units.len()].to_vec())
            } else {
                free.push(less(whole(&units, &motions, &x), &held))
            }
        }
        let mut is_seen = vec![true; free.len()];
        let mut idle = Vec::new();
        for (at, x) in vanishing(&free_rigid, &free, on_rows) {
            if at >= free_rigid.len() {
                is_seen[at - free_rigid.len()] = false;
                idle.push(less(less(whole(&free_rigid, &free, &x), &held), on_rows));
            }
        }
        idle.sort_by_key(Vec::len);
        let dual = dual(idle);
        let seen = free.into_iter().zip(is_seen).filter(|(_, seen)| *seen);
        let seen: Vec<ZeroEnergyMode> = seen.map(|(motion, _)| without(motion, &dual)).collect();
        let all = dual.iter().map(|(_, motion)| motion).chain(&seen);
        let strain = strain(form, body, all);
        let idle = orthonormal(&dual);
        let what = idle
            .iter()
            .map(|motion| driven(body, motion).into())
            .collect();
        BodySlack {
            body: b,
            dual,
            idle,
            seen,
            what,
            strain,
        }
    }

    /// The part of a subdomain in the idle motions: `nodes` are its nodes in the body.
    pub fn parts(&self, body: &Body, mesh: &SubdomainMesh, nodes: &[usize]) -> Vec<Idle> {
        let c = body.components;
        let part = |(number, motion): (u32, &ZeroEnergyMode)| {
            let what = self.what[number as usize].clone();
            let mut out = Idle::new(number, self.strain, what);
            for of_node in motion.chunk_by(|a, b| a.0 / c as u32 == b.0 / c as u32) {
                let node = of_node[0].0 as usize / c;
                let Ok(place) = nodes.binary_search(&node) else {
                    continue;
                };
                for i in 0..c {
                    if let Some(dof) = mesh.local_dof(c * place + i) {
                        let value = of_node.iter().find(|e| e.0 as usize == c * node + i);
                        out.dofs.push(dof);
                        out.values.push(value.map_or(0.0, |e| e.1));
                        out.shares.push(1.0 / body.mesh().multiplicity(node) as f64);
                    }
                }
            }
            (!out.dofs.is_empty()).then_some(out)
        };
        (0..).zip(&self.idle).filter_map(part).collect()
    }

    /// K with a spring for each idle motion, as stiff as K is there; `dofs` has the body dof of each local dof.
    pub fn held(&self, k: Arc<Csr>, body: &Body, dofs: &[u64]) -> Arc<Csr> {
        let place = |hold: u32| dofs.binary_search(&(body.first_dof + u64::from(hold))).ok();
        let held: Vec<usize> = self
            .dual
            .iter()
            .filter_map(|(hold, _)| place(*hold))
            .collect();
        if held.is_empty() {
            return k;
        }
        let mut k = Csr::clone(&k);
        for i in held {
            let own = k
                .row(i)
                .0
                .binary_search(&(i as u32))
                .expect("a diagonal entry");
            let at = k.row_ptr[i] + own;
            k.val[at] *= 2.0;
        }
        Arc::new(k)
    }

    /// Candidates for the kernel of K with its springs, made from the rigid motions.
    pub fn near_kernel(&self, rigid: Vec<Vec<f64>>, body: &Body, dofs: &[u64]) -> Vec<Vec<f64>> {
        let mut out = rigid;
        let place = |dof: u32| dofs.binary_search(&(body.first_dof + u64::from(dof))).ok();
        let first = match out.len() {
            6 | 3 => 0,
            _ => return out,
        };
        for (hold, motion) in &self.dual {
            let there: Vec<f64> = (0..out.len())
                .map(|k| rigid_value(body, first + k, *hold))
                .collect();
            for &(dof, v) in motion {
                if let Some(i) = place(dof) {
                    out.iter_mut().zip(&there).for_each(|(x, t)| x[i] -= t * v);
                }
            }
        }
        for motion in &self.seen {
            let mut column = vec![0.0; dofs.len()];
            for &(dof, v) in motion {
                if let Some(i) = place(dof) {
                    column[i] = v;
                }
            }
            out.push(column);
        }
        let scale = (ROUNDING / self.strain).min(1.0);
        out.iter_mut().flatten().for_each(|v| *v *= scale);
        out
    }
}

/// The largest strain that cells of a body see of some motions.
fn strain<'m>(form: &Form, body: &Body, motions: impl Iterator<Item = &'m ZeroEnergyMode>) -> f64 {
    let Mesh::Cells(mesh) = body.mesh() else {
        return 0.0;
    };
    let (c, rules) = (body.components, &body.spec.integration);
    let around = mesh.cells.around_nodes(mesh.points.len());
    let mut largest = 0.0_f64;
    for motion in motions {
        let cells = motion
            .iter()
            .flat_map(|e| around.at(e.0 as usize / c).iter().copied());
        for cell in distinct(cells) {
            let nodes = mesh.cells.nodes(cell as usize);
            let points: Vec<[f64; 3]> = nodes
                .iter()
                .map(|&k| body.spec.position(k as usize))
                .collect();
            let dofs = nodes
                .iter()
                .flat_map(|&k| (0..c as u32).map(move |d| c as u32 * k + d));
            let u: Vec<f64> = dofs.map(|dof| at(motion, dof)).collect();
            let (kind, rule) = (mesh.cells.kind(cell as usize), rules[cell as usize]);
            largest = largest.max(strain_of(form, kind, &points, rule, &u));
        }
    }
    largest
}

/// The displacement of rigid motion `k` of a body at a degree of freedom, as the body's kernel has it.
fn rigid_value(body: &Body, k: usize, dof: u32) -> f64 {
    let (node, component) = (
        dof as usize / body.components,
        dof as usize % body.components,
    );
    let [low, high] = body.bounds;
    let size = (0..3).fold(0.0_f64, |a, d| a.max(0.5 * (high[d] - low[d])));
    let point = body.spec.position(node);
    cell::rigid_motions(body.mesh().dim(), body.ball().0, size, point)[k][component]
}
