//! *TRANSFORM, *EQUATION and the *MPC that are plain equations.

use super::base::DeckReader;
use super::params::Params;

use crate::cards::{squeeze, Card, DataLine};
use crate::deck_line::DeckLine;
use crate::model::{DeckEquation, Term, Transform};
use crate::numbers::clip;
use base::linalg::vec3::{cross, dot, minus, norm};
use base::Result;

/// The part of the length of a vector that counts as zero.
const NOTHING: f64 = 1e-10;

impl<'a> DeckReader<'a> {
    pub(super) fn transform(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let name = params.required("NSET")?;
        let cylindrical = match params.value("TYPE") {
            None | Some("R") => false,
            Some("C") => true,
            Some(other) => return params.error(format!("TYPE={} is neither R nor C", clip(other))),
        };
        params.done()?;
        let place = card.place;
        let t = self.deck.transforms.len() as u32;
        let transform = self.two_points(card, cylindrical)?;
        let Some(set) = self.nsets.get(name) else {
            return self.no_nset(card, name);
        };
        // In plane bodies the third direction stays the one across.
        if let (2, Some(&node)) = (self.deck.dim(), set.members.first()) {
            let axes = transform.frame(self.deck.mesh.points[node as usize]);
            if axes[2][2].abs() < 1.0 - NOTHING {
                let message = "the third axis must be that of z in plane and axisymmetric bodies";
                return self.error(card, message);
            }
        }
        let members = set.members.len();
        self.deck
            .node_transform
            .extend(set.members.iter().map(|&node| (node, t)));
        self.spend(members, place)?;
        self.deck.transforms.push(transform);
        Ok(())
    }

    /// The axes of the two points in the first line of a card.
    pub(super) fn two_points(&self, card: &Card, cylindrical: bool) -> Result<Transform> {
        let Some(row) = self.cards.rows(card).next() else {
            return self.error(card, "its line of two points is missing");
        };
        let a = row.vector(self.files, 0, "a coordinate")?;
        let b = row.vector(self.files, 3, "a coordinate")?;
        let (first, second) = if cylindrical {
            (minus(b, a), [0.0; 3])
        } else {
            (a, b)
        };
        let lengths = norm(first) * norm(second);
        if norm(first) == 0.0 || (!cylindrical && norm(cross(a, b)) <= NOTHING * lengths) {
            let message = "the two points define no axes";
            return Err(self.files.error(row.place, message));
        }
        Ok(Transform {
            cylindrical,
            a,
            b,
            place: card.place,
        })
    }

    /// Keeps the last system of each node.
    pub(super) fn order_transforms(&mut self) -> Result<()> {
        let of = &mut self.deck.node_transform;
        of.sort_unstable();
        of.reverse();
        of.dedup_by_key(|t| t.0);
        of.reverse();
        Ok(())
    }

    pub(super) fn equation(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        params.refuse(&["REMOVE", "REMOVEALL"], "equations stay for all steps")?;
        params.done()?;
        self.before_steps(card)?;
        let mut rows = self.cards.rows(card);
        while let Some(head) = rows.next() {
            let count = head.whole(self.files, 0, "the number of terms")?;
            head.at_most(self.files, 1, "the line of the number of terms")?;
            if count == 0 {
                return Err(self.files.error(head.place, "an equation needs terms"));
            }
            let mut terms: Vec<(Vec<u32>, u8, f64)> = Vec::new();
            while (terms.len() as u64) < count {
                let Some(row) = rows.next() else {
                    let message = format!(
                        "the equation has {count} terms, but only {} follow",
                        terms.len()
                    );
                    return Err(self.files.error(head.place, message));
                };
                for k in (0..row.fields.len()).step_by(3) {
                    let term = self.term(&row, k)?;
                    self.spend(term.0.len(), row.place)?;
                    terms.push(term);
                }
                if terms.len() as u64 > count {
                    let message = format!("the equation has {count} terms, but more follow");
                    return Err(self.files.error(row.place, message));
                }
            }
            self.expand(&terms, head.place)?;
        }
        Ok(())
    }

    /// The term that begins in field `k`: nodes, direction, factor.
    fn term(&mut self, row: &DataLine, k: usize) -> Result<(Vec<u32>, u8, f64)> {
        let nodes = self.target_nodes(row, k)?;
        let dof = row.whole(self.files, k + 1, "a direction")?;
        let factor = row.real(self.files, k + 2, "a factor")?;
        self.factor_digits.see(row.field(k + 2).as_bytes());
        self.deck.factor_resolution = self.factor_digits.resolution();
        if !(1..=self.deck.dim() as u64).contains(&dof) {
            let message = format!(
                "the direction of a term is 1 to {}, but it is {dof}",
                self.deck.dim()
            );
            return Err(self.files.error(row.place, message));
        }
        Ok((nodes, dof as u8 - 1, factor))
    }

    /// Adds the equations of terms of sets: one for each node of the sets, which are of one size.
    fn expand(&mut self, terms: &[(Vec<u32>, u8, f64)], place: DeckLine) -> Result<()> {
        if terms[0].2 == 0.0 {
            return Err(self.files.error(place, "the factor of the first term is 0"));
        }
        let count = terms.iter().map(|t| t.0.len()).max().unwrap_or(0);
        if terms.iter().any(|t| t.0.len() != 1 && t.0.len() != count) {
            let message = "the node sets of an equation differ in size";
            return Err(self.files.error(place, message));
        }
        self.spend(count.saturating_mul(terms.len()), place)?;
        for e in 0..count {
            let terms = terms.iter().map(|(nodes, dof, factor)| Term {
                node: nodes[e.min(nodes.len() - 1)],
                dof: *dof,
                factor: *factor,
            });
            self.deck.equations.push(DeckEquation {
                terms: terms.collect(),
                place,
            });
        }
        Ok(())
    }

    pub(super) fn mpc(&mut self, card: &'a Card) -> Result<()> {
        Params::new(card, self.files).done()?;
        self.before_steps(card)?;
        for row in self.cards.rows(card) {
            let name = squeeze(row.field(0));
            let wanted = match name.as_str() {
                "PIN" | "TIE" => 3,
                "LINEAR" => 4,
                _ => {
                    let message = format!(
                        "*MPC: constraints of type {} are no plain equations; write them as *EQUATION",
                        clip(&name)
                    );
                    return Err(self.files.error(row.place, message));
                }
            };
            if row.fields.len() != wanted {
                let message = format!(
                    "*MPC: constraints of type {name} have {} nodes or node sets, but {} stand here",
                    wanted - 1,
                    row.fields.len() - 1
                );
                return Err(self.files.error(row.place, message));
            }
            let nodes: Vec<Vec<u32>> = (1..wanted)
                .map(|k| self.target_nodes(&row, k))
                .collect::<Result<_>>()?;
            let of_all = nodes.iter().flatten();
            if of_all.clone().any(|&n| self.deck.frame(n).is_some()) {
                let message =
                    "*MPC: nodes with a *TRANSFORM are not supported here; write *EQUATION";
                return Err(self.files.error(row.place, message));
            }
            self.spend(of_all.count(), row.place)?;
            let count = nodes[0].len();
            if nodes.iter().any(|n| n.len() != 1 && n.len() != count) {
                let message = "*MPC: the node sets differ in size";
                return Err(self.files.error(row.place, message));
            }
            for e in 0..count {
                let at: Vec<u32> = nodes.iter().map(|n| n[e.min(n.len() - 1)]).collect();
                self.equal(&at, row.place)?;
            }
        }
        Ok(())
    }

    /// The displacement of the first node is that of the second, or that between the second and the third.
    fn equal(&mut self, nodes: &[u32], place: DeckLine) -> Result<()> {
        let at = |n: u32| self.deck.mesh.points[n as usize];
        let shares = match *nodes {
            [p, a, b] => {
                let (along, from) = (minus(at(b), at(a)), minus(at(p), at(a)));
                if dot(along, along) == 0.0 {
                    return Err(self.files.error(place, "*MPC: two nodes lie at one point"));
                }
                let s = dot(from, along) / dot(along, along);
                vec![1.0 - s, s]
            }
            _ => vec![1.0],
        };
        let dim = self.deck.dim();
        self.spend(dim * nodes.len(), place)?;
        for dof in 0..dim as u8 {
            let factors = std::iter::once(1.0).chain(shares.iter().map(|s| -s));
            let terms = nodes.iter().zip(factors);
            let terms = terms.map(|(&node, factor)| Term { node, dof, factor });
            self.deck.equations.push(DeckEquation {
                terms: terms.collect(),
                place,
            });
        }
        Ok(())
    }
}
