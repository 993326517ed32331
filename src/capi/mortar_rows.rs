//! The rows of all mortars.

use petsc::PetscInt;
use std::collections::{HashMap, HashSet};

use super::mortar::HostMortar;
use super::mortar_results::MortarRowOwner;
use super::numbering::HostNumbering;
use super::object::Object;
use super::rows::RowOrigin;
use super::surface::HostSurface;
use super::tangential::{NodeFriction, Tangent};
use crate::embed::GivenRow;
use crate::Result;
use base::linalg::sorted::distinct;
use base::linalg::vec3::tangents;
use base::Fault;
use elements::mortar::{distance, rows, DualMortarRow};
use parallel::exchange::gather_all;

/// How many nodes of a mortar carry multipliers, and why others do not.
#[derive(Debug, Clone, Copy, Default)]
pub struct MultiplierCounts {
    pub carry: usize,
    pub held: usize,
    pub tied: usize,
}

/// The rows of all mortars.
#[derive(Default)]
pub struct MortarRows {
    /// The rows that this rank gives, in the order in which it gives them.
    pub placed: Vec<MortarRowOwner>,
    pub counts: Vec<MultiplierCounts>,
}

/// Unknowns by their global numbers: whether they are held, and which are tied so far.
struct ConstrainedUnknowns {
    held: HashMap<u32, bool>,
    tied: HashSet<u32>,
}

impl ConstrainedUnknowns {
    fn is_held(&self, dof: Option<u32>) -> bool {
        dof.is_none_or(|d| self.held[&d])
    }

    fn is_tied(&self, dof: Option<u32>) -> bool {
        dof.is_some_and(|d| self.tied.contains(&d))
    }
}

/// The numbers among all unknowns of each node of a surface; `None` where there is no unknown.
type NodeUnknowns = Vec<Vec<Option<u32>>>;

/// Whether an unknown is known; `None` if this rank's matrices do not have it.
pub type IsHeld<'a> = &'a dyn Fn(u32) -> Option<bool>;

/// Components of a normal below this one do not count.
const ALONG: f64 = 1e-12;

impl Object {
    /// Appends the rows of all mortars to `rows`, and their friction to `friction`. `held` says which unknowns of this
    /// rank's matrices are known. Collective.
    ///
    /// # Errors
    /// A surface with an unknown that no subdomain has, a mortar without rows; the same on all ranks.
    pub fn add_mortar_rows(
        &self,
        (rows, friction): (&mut Vec<GivenRow>, &mut Vec<NodeFriction>),
        held: IsHeld,
    ) -> Result<MortarRows> {
        let mut out = MortarRows::default();
        if self.mortars.is_empty() {
            return Ok(out);
        }
        let numbers: Result<Vec<NodeUnknowns>> =
            self.surfaces.iter().map(|s| self.numbers(s)).collect();
        let numbers = self.session.agree(numbers)?;
        let mut known = self.known(held, &numbers)?;
        out.counts = vec![MultiplierCounts::default(); self.mortars.len()];
        // Ties come first: nodes that they hold are not in contact.
        for inequality in [false, true] {
            let mortars = self.mortars.iter().enumerate();
            for (m, mortar) in mortars.filter(|(_, m)| m.law.is_inequality() == inequality) {
                let pair = MortarPair {
                    mortar,
                    sides: mortar.surfaces.map(|s| &self.surfaces[s]),
                    numbers: mortar.surfaces.map(|s| &numbers[s]),
                };
                let made = if inequality {
                    pair.contacts(&known)
                } else {
                    pair.ties(&known)
                };
                out.counts[m] = pair.counts(&known, &made);
                if made.is_empty() {
                    return Err(Fault::Wrong.error(format!(
                        "no node of surface {} can carry a multiplier of mortar {m}: {} are held and {} tied \
                         elsewhere, expected free ones opposite surface {}",
                        mortar.surfaces[0], out.counts[m].held, out.counts[m].tied, mortar.surfaces[1]
                    )));
                }
                for row in made {
                    let (component, node) = (row.component, row.node);
                    if !inequality {
                        known.tied.extend(pair.numbers[0][node as usize][component]);
                    }
                    if pair.sides[0].giver[node as usize] == self.session.rank() {
                        if !row.tangents.is_empty() {
                            friction.push(NodeFriction {
                                normal: rows.len(),
                                tangents: row.tangents,
                                slipped: mortar.slipped[node as usize],
                                law: mortar.contact,
                                area: row.area,
                            });
                        }
                        rows.push(row.row);
                        out.placed.push(MortarRowOwner {
                            mortar: m,
                            node,
                            component,
                            area: row.area,
                        });
                    }
                }
            }
        }
        Ok(out)
    }

    /// The numbers among all unknowns of the nodes of a surface.
    fn numbers(&self, surface: &HostSurface) -> Result<NodeUnknowns> {
        let number = |&dof: &PetscInt| {
            let Ok(dof) = u32::try_from(dof) else {
                return Ok(None);
            };
            self.number(surface.numbering, dof, "surface").map(Some)
        };
        let node = |dofs: &Vec<PetscInt>| dofs.iter().map(number).collect();
        surface.dofs.iter().map(node).collect()
    }

    /// The state of the unknowns of surfaces: whether they are held, and which are tied by pairs of the host.
    /// Collective.
    fn known(&self, held: IsHeld, numbers: &[NodeUnknowns]) -> Result<ConstrainedUnknowns> {
        let all = distinct(numbers.iter().flatten().flatten().filter_map(|d| *d));
        let mine = all.iter().filter_map(|&dof| Some([dof, held(dof)?.into()]));
        let mine: Vec<[u32; 2]> = mine.collect();
        let gathered = gather_all(self.session.comm(), &mine).concat();
        let held = gathered.iter().map(|&[dof, held]| (dof, held != 0));
        let held: HashMap<u32, bool> = held.collect();
        if let Some(dof) = all.iter().find(|d| !held.contains_key(d)) {
            let nodes = numbers.iter().zip(&self.surfaces).enumerate();
            let mut found = nodes.filter_map(|(s, (list, surface))| {
                let k = list.iter().position(|node| node.contains(&Some(*dof)))?;
                Some((s, surface.side.points()[k], surface.side.dim()))
            });
            let (s, x, dim) = found.next().expect("a surface has it");
            return Err(Fault::Wrong.error(format!(
                "the node at {:?} of surface {s} has unknown {dof} of all, which no subdomain has, \
                 expected unknowns of subdomains",
                &x[..dim]
            )));
        }
        // Pairs of the host that are tied.
        let mut mine = Vec::new();
        let pairs = self.rows.iter().filter(|r| r.origin == RowOrigin::Pairs);
        for row in pairs.filter(|r| !r.law.is_inequality()) {
            for &(whose, dof, _) in &row.terms {
                mine.push(self.number(whose, dof, "contact pair")?);
            }
        }
        let tied = gather_all(self.session.comm(), &mine).concat();
        Ok(ConstrainedUnknowns {
            held,
            tied: tied.into_iter().collect(),
        })
    }
}

impl Object {
    /// A line on a mortar: how many nodes carry multipliers and why others do not.
    pub fn mortar_text(&self, m: usize, counts: &MultiplierCounts) -> String {
        let Some(mortar) = self.mortars.get(m) else {
            return String::new();
        };
        let what = mortar.law;
        let ([a, b], n) = (mortar.surfaces, mortar.gaps.len());
        let MultiplierCounts { carry, held, tied } = counts;
        format!(
            "  mortar {m}: {what} of surfaces {a} and {b}, {carry} of {n} nodes carry multipliers \
             ({held} are held, {tied} tied elsewhere)\n"
        )
    }

    /// The number of an unknown among all.
    ///
    /// # Errors
    /// One that its matrix does not have.
    pub fn number(&self, whose: HostNumbering, dof: u32, what: &str) -> Result<u32> {
        let HostNumbering::Matrix(k) = whose else {
            return Ok(dof);
        };
        let n = self.size_of(k, &format!("{what}s name"))?;
        if dof as usize >= n {
            return Err(Fault::OutOfRange.error(format!(
                "a {what} of rank {} has unknown {dof} of matrix {k}, \
                 which has {n} by now, expected those of the present matrices",
                self.session.rank()
            )));
        }
        if self.stack.is_empty() {
            Ok(dof)
        } else {
            Ok(self.stack.number(k, dof))
        }
    }
}

/// A mortar with its surfaces, the one with the multipliers first.
struct MortarPair<'a> {
    mortar: &'a HostMortar,
    sides: [&'a HostSurface; 2],
    numbers: [&'a NodeUnknowns; 2],
}

/// A row at a node.
struct MortarRowData {
    row: GivenRow,
    component: usize,
    /// D_p.
    area: f64,
    node: u32,
    /// None without friction.
    tangents: Vec<Tangent>,
}

impl MortarPair<'_> {
    fn rows(&self, excluded: &dyn Fn(u32) -> bool) -> Vec<DualMortarRow> {
        let [own, other] = self.sides.map(|s| &s.side);
        let left_out = |k: u32| self.mortar.without[k as usize] || excluded(k);
        rows(own, other, &self.mortar.samples, &left_out, &|_| 1.0)
    }

    fn dof(&self, node: u32, component: usize) -> Option<u32> {
        self.numbers[0][node as usize][component]
    }

    /// The rows u = u° by component, with a gap where there is one component.
    fn ties(&self, known: &ConstrainedUnknowns) -> Vec<MortarRowData> {
        let mut out = Vec::new();
        let mut before: Vec<(Vec<bool>, Vec<DualMortarRow>)> = Vec::new();
        for c in 0..self.sides[0].components {
            let left_out = |k: u32| {
                let dof = self.dof(k, c);
                known.is_held(dof) || known.is_tied(dof)
            };
            let list: Vec<bool> = (0..self.mortar.gaps.len() as u32).map(left_out).collect();
            let same = before.iter().position(|b| b.0 == list);
            let which = same.unwrap_or_else(|| {
                let made = self.rows(&|k| list[k as usize]);
                before.push((list, made));
                before.len() - 1
            });
            let mut along = [0.0; 3];
            along[c] = 1.0;
            for row in &before[which].1 {
                let gap = self.mortar.gaps[row.node as usize];
                out.push(MortarRowData {
                    row: self.given(row, along, gap),
                    component: c,
                    area: row.area,
                    node: row.node,
                    tangents: Vec::new(),
                });
            }
        }
        out
    }

    /// The rows n · (u − u°) ≤ g; for scalars u − u° ≤ g.
    fn contacts(&self, known: &ConstrainedUnknowns) -> Vec<MortarRowData> {
        let [own, other] = self.sides.map(|s| &s.side);
        let components = self.sides[0].components;
        let normals = own.normals();
        let along = |k: u32| match components {
            1 => [1.0, 0.0, 0.0],
            _ => normals[k as usize],
        };
        let excluded = |k: u32| {
            let n = along(k);
            let mut moved = (0..components).filter(|&c| n[c].abs() > ALONG);
            let tied = (0..components).any(|c| known.is_tied(self.dof(k, c)));
            tied || moved.all(|c| known.is_held(self.dof(k, c)))
        };
        let one = |row: DualMortarRow| {
            let n = along(row.node);
            let apart = match components {
                // A distance says nothing about a difference of values.
                1 => 0.0,
                _ => {
                    let places: [&dyn Fn(u32) -> [f64; 3]; 2] =
                        [&|k| own.points()[k as usize], &|k| {
                            other.points()[k as usize]
                        }];
                    let origin = own.points()[row.node as usize];
                    distance([&row.own, &row.other], places, origin, n)
                }
            };
            let apart = if apart.abs() <= self.mortar.adjust {
                0.0
            } else {
                apart
            };
            let gap = apart + self.mortar.gaps[row.node as usize];
            let directions = match self.mortar.contact.has_friction() {
                true => tangents(n, components),
                false => Vec::new(),
            };
            let tangent = |direction| Tangent {
                terms: self.terms(&row, direction),
                direction,
            };
            MortarRowData {
                row: self.given(&row, n, gap),
                component: 0,
                area: row.area,
                node: row.node,
                tangents: directions.into_iter().map(tangent).collect(),
            }
        };
        self.rows(&excluded).into_iter().map(one).collect()
    }

    /// The row along a direction.
    fn given(&self, row: &DualMortarRow, along: [f64; 3], gap: f64) -> GivenRow {
        GivenRow {
            terms: self.terms(row, along),
            gap,
            law: self.mortar.law,
            compliance: self.mortar.contact.compliance(row.area),
        }
    }

    /// The terms of the row along a direction.
    fn terms(&self, row: &DualMortarRow, along: [f64; 3]) -> Vec<(u32, f64)> {
        let mut terms = Vec::new();
        let lists = [(&row.own, 1.0), (&row.other, -1.0)];
        for ((list, sign), numbers) in lists.into_iter().zip(self.numbers) {
            for &(node, v) in list {
                for (dof, n) in numbers[node as usize].iter().zip(along) {
                    if let (Some(dof), true) = (dof, n != 0.0) {
                        terms.push((*dof, sign * v * n));
                    }
                }
            }
        }
        terms
    }

    /// How many nodes carry multipliers; of the others those that are held or tied.
    fn counts(&self, known: &ConstrainedUnknowns, made: &[MortarRowData]) -> MultiplierCounts {
        let carry: HashSet<u32> = made.iter().map(|m| m.node).collect();
        let mut out = MultiplierCounts {
            carry: carry.len(),
            ..MultiplierCounts::default()
        };
        for (k, node) in (0..).zip(self.numbers[0]) {
            if carry.contains(&k) {
                continue;
            }
            if node.iter().any(|&d| known.is_tied(d)) {
                out.tied += 1;
            } else if node.iter().all(|&d| known.is_held(d)) {
                out.held += 1;
            }
        }
        out
    }
}
