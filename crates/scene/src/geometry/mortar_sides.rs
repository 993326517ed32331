//! Two sides that mortar integrals join, and the rows that follow, with nodes of bodies.

use std::collections::{BTreeSet, HashSet};
use std::sync::{Arc, OnceLock};

use crate::model::body::BodySpec;
use elements::form::Form;
use elements::mortar::{self, DualMortarRow, MortarSample, MortarSide};

/// The coupling of two sides whose nodes do not match.
#[derive(Debug, Clone, PartialEq)]
pub struct Mortar {
    /// Which of the two bodies of the interface carries the multipliers, 0 or 1.
    pub multipliers: usize,
    /// The area (in the plane the length) of the multiplier side that lies opposite the other side.
    pub area: f64,
    /// The surfaces, until rows are made of them.
    pub(crate) surfaces: Option<Box<Surfaces>>,
}

/// Two sides that face each other, the one with the multipliers first. The other one may be a rigid surface.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Surfaces {
    sides: [Arc<MortarSide>; 2],
    /// The node of its body for each node of a side.
    pub(super) nodes: [Vec<usize>; 2],
    samples: Vec<MortarSample>,
    /// The rows if no node is excluded, once they are known.
    whole: OnceLock<Vec<BodyRow>>,
    /// The rows of nodes that are held one by one, in the place of integrals.
    single: Option<Vec<BodyRow>>,
    /// Nodes that two sides of one body have in common, as at the tip of a crack: they carry no multiplier, since there
    /// is nothing opposite but themselves.
    common: HashSet<usize>,
}

impl Surfaces {
    /// Sides with the node of the body for each of their nodes. They may be `reach` apart.
    pub fn new([own, other]: [(Arc<MortarSide>, Vec<usize>); 2], reach: f64) -> Surfaces {
        Surfaces {
            samples: mortar::samples(&own.0, &other.0, reach),
            sides: [own.0, other.0],
            nodes: [own.1, other.1],
            whole: OnceLock::new(),
            single: None,
            common: HashSet::new(),
        }
    }

    /// These surfaces as two sides of one body, which may have nodes in common.
    pub fn of_one_body(mut self) -> Surfaces {
        let own: HashSet<usize> = self.nodes[0].iter().copied().collect();
        let both = self.nodes[1].iter().copied();
        self.common = both.filter(|node| own.contains(node)).collect();
        self.whole = OnceLock::new();
        self
    }

    /// Sides of which nodes of the first are held one by one, by these rows.
    pub fn single(
        [own, other]: [(Arc<MortarSide>, Vec<usize>); 2],
        rows: Vec<BodyRow>,
    ) -> Surfaces {
        Surfaces {
            samples: Vec::new(),
            sides: [own.0, other.0],
            nodes: [own.1, other.1],
            whole: OnceLock::new(),
            single: Some(rows),
            common: HashSet::new(),
        }
    }

    /// The nodes of the faces of both sides that lie opposite each other; of the side with the multipliers only those
    /// that are held where they are held one by one.
    pub fn facing(&self) -> [HashSet<usize>; 2] {
        let mut out = [HashSet::new(), HashSet::new()];
        let of_faces = self.samples.iter().map(|s| [s.face, s.other]);
        for faces in of_faces.collect::<BTreeSet<_>>() {
            for (k, face) in faces.into_iter().enumerate() {
                let nodes = &self.sides[k].faces()[face as usize].nodes;
                out[k].extend(nodes.iter().map(|&n| self.nodes[k][n as usize]));
            }
        }
        for row in self.single.iter().flatten() {
            out[0].insert(row.node);
            out[1].extend(row.other.iter().map(|t| t.0));
        }
        out
    }

    /// The rows of the nodes of the multiplier side for which `excluded` (called with the node of the body) does not
    /// hold. Nodes in rows are those of the bodies.
    pub fn rows(&self, form: &Form, excluded: &dyn Fn(usize) -> bool) -> Vec<BodyRow> {
        if let Some(rows) = &self.single {
            let rows = rows.iter().filter(|row| !excluded(row.node));
            return rows.cloned().collect();
        }
        let whole = self.whole.get_or_init(|| self.integrals(form, &|_| false));
        match whole.iter().any(|row| excluded(row.node)) {
            true => self.integrals(form, excluded),
            false => whole.clone(),
        }
    }

    /// The rows by mortar integrals.
    fn integrals(&self, form: &Form, excluded: &dyn Fn(usize) -> bool) -> Vec<BodyRow> {
        let [own, theirs] = [0, 1].map(|k| {
            move |list: Vec<(u32, f64)>| -> Vec<(usize, f64)> {
                let node = |(n, v): (u32, f64)| (self.nodes[k][n as usize], v);
                list.into_iter().map(node).collect()
            }
        });
        let around = |x: [f64; 3]| if form.is_axial() { form.around(x) } else { 1.0 };
        let left_out = |k: u32| {
            let node = self.nodes[0][k as usize];
            self.common.contains(&node) || excluded(node)
        };
        let [side, other] = [&self.sides[0], &self.sides[1]];
        let rows = mortar::rows(side, other, &self.samples, &left_out, &around);
        let in_bodies = |row: DualMortarRow| BodyRow {
            node: self.nodes[0][row.node as usize],
            own: own(row.own),
            other: theirs(row.other),
            area: row.area,
        };
        rows.into_iter().map(in_bodies).collect()
    }
}

/// A row with nodes of bodies: Σ own · u − Σ other · u°.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodyRow {
    pub node: usize,
    pub own: Vec<(usize, f64)>,
    pub other: Vec<(usize, f64)>,
    pub area: f64,
}

impl BodyRow {
    /// The gap of the undeformed bodies: how far the other side, whose nodes are at `theirs`, is along the normal `n`
    /// out of the multiplier side, in the sense of the row.
    pub fn distance(&self, own: &BodySpec, theirs: &dyn Fn(usize) -> [f64; 3], n: [f64; 3]) -> f64 {
        let places: [&dyn Fn(usize) -> [f64; 3]; 2] = [&|k| own.undeformed(k), theirs];
        let origin = own.undeformed(self.node);
        mortar::distance([&self.own, &self.other], places, origin, n)
    }
}
