//! Lee's experiment implemented a second time, without the scene, mesh and fem modules: substructures by hand.
#![allow(dead_code)]

use std::collections::BTreeMap;

use base::linalg::csr::Csr;
use fetifeti::problem::{RowLabel, RowSource};
use fetifeti::{Problem, Row, Subdomain};

/// N_b × N_b bodies of N_s × N_s subdomains of n × n bilinear elements on the unit square, held on its whole boundary.
#[derive(Clone, Copy)]
pub struct Grid {
    pub bodies: usize,
    pub subdomains: usize,
    pub elements: usize,
    /// Column (II): only face nodes with 1/3 ≤ t ≤ 2/3 are tied, cross points are not.
    pub middle_third: bool,
    /// ρ of a body at (i, j).
    pub rho: fn(usize, usize) -> f64,
}

impl Grid {
    pub fn lee(bodies: usize, subdomains: usize, elements: usize, middle_third: bool) -> Grid {
        Grid {
            bodies,
            subdomains,
            elements,
            middle_third,
            rho: |_, _| 1.0,
        }
    }

    fn per_body(&self) -> usize {
        self.subdomains * self.elements
    }

    fn per_side(&self) -> usize {
        self.bodies * self.per_body()
    }

    /// Number of body (bi, bj)'s node (x, y), x and y counted on the whole grid.
    fn dof(&self, body: (usize, usize), x: usize, y: usize) -> u64 {
        let n = self.per_side() + 1;
        let index = body.0 + body.1 * self.bodies;
        ((index * n + y) * n + x) as u64
    }

    fn free(&self, x: usize, y: usize) -> bool {
        let n = self.per_side();
        x > 0 && y > 0 && x < n && y < n
    }

    /// The load of Table 1 (docs/theory.md, section 14) at an element's midpoint.
    fn load(x: f64, y: f64) -> f64 {
        if x < 0.5 && y > 0.75 {
            -3.0
        } else if x > 0.5 && y < 0.25 {
            -1.0
        } else {
            0.0
        }
    }

    fn subdomain(&self, index: usize) -> Subdomain {
        let (ns, ne, nb) = (self.subdomains, self.elements, self.bodies);
        let (body, s) = (index / (ns * ns), index % (ns * ns));
        let b = (body % nb, body / nb);
        let (x0, y0) = (
            b.0 * self.per_body() + s % ns * ne,
            b.1 * self.per_body() + s / ns * ne,
        );
        let h = 1.0 / self.per_side() as f64;
        let rho = (self.rho)(b.0, b.1);
        let mut number = BTreeMap::new();
        for y in y0..=y0 + ne {
            for x in x0..=x0 + ne {
                if self.free(x, y) {
                    let next = number.len() as u32;
                    number.insert((y, x), next);
                }
            }
        }
        let n = number.len();
        let mut f = vec![0.0; n];
        let mut triplets = Vec::new();
        for ey in y0..y0 + ne {
            for ex in x0..x0 + ne {
                let corners = [(ey, ex), (ey, ex + 1), (ey + 1, ex), (ey + 1, ex + 1)];
                let value = Self::load((ex as f64 + 0.5) * h, (ey as f64 + 0.5) * h);
                for (a, ca) in corners.iter().enumerate() {
                    let Some(&i) = number.get(ca) else { continue };
                    f[i as usize] += value * h * h / 4.0;
                    for (c, cc) in corners.iter().enumerate() {
                        let Some(&j) = number.get(cc) else { continue };
                        // Bilinear square: 2/3 on the diagonal, −1/3 across it, −1/6 along an edge.
                        let entry = if a == c {
                            2.0 / 3.0
                        } else if a + c == 3 {
                            -1.0 / 3.0
                        } else {
                            -1.0 / 6.0
                        };
                        triplets.push((i, j, rho * entry));
                    }
                }
            }
        }
        let primal = number
            .iter()
            .filter(|((y, x), _)| x % ne == 0 && y % ne == 0)
            .map(|(_, &i)| i)
            .collect();
        let dofs = number.keys().map(|&(y, x)| self.dof(b, x, y)).collect();
        let place = |&(y, x): &(usize, usize)| [x as f64 * h, y as f64 * h, 0.0];
        Subdomain::new(index, body, Csr::from_triplets(n, &triplets), f, dofs)
            .with_rho(vec![rho; n])
            .with_primal(primal)
            .with_near_kernel(vec![vec![1.0; n]])
            .with_coordinates(number.keys().map(place).collect())
    }

    /// The substructures of one rank; `mine` says which subdomains it owns.
    pub fn substructures(&self, mine: impl Fn(usize) -> bool) -> Problem {
        let (nb, ns) = (self.bodies, self.subdomains);
        let n_subdomains = nb * nb * ns * ns;
        let mut rows = Vec::new();
        let (pb, n) = (self.per_body(), self.per_side());
        for y in 1..n {
            for x in 1..n {
                let around = |v: usize| -> Vec<usize> {
                    if v % pb == 0 {
                        vec![v / pb - 1, v / pb]
                    } else {
                        vec![v / pb]
                    }
                };
                let (bx, by) = (around(x), around(y));
                let bodies: Vec<(usize, usize)> = by
                    .iter()
                    .flat_map(|&j| bx.iter().map(move |&i| (i, j)))
                    .collect();
                if bodies.len() < 2 {
                    continue;
                }
                let along = if bx.len() == 2 { y } else { x } % pb;
                let outside = bodies.len() == 4 || 3 * along < pb || 3 * along > 2 * pb;
                let holds = !(self.middle_third && outside);
                let b = bodies[0];
                let sub = |v: usize, b: usize| {
                    ((v - b * pb).saturating_sub(1) / self.elements).min(ns - 1)
                };
                let lowest = (b.0 + b.1 * nb) * ns * ns + sub(x, b.0) + sub(y, b.1) * ns;
                if !mine(lowest) {
                    continue;
                }
                for i in 0..bodies.len() {
                    for j in i + 1..bodies.len() {
                        let [a, b] = [i, j].map(|k| self.dof(bodies[k], x, y));
                        let label = RowLabel::new(RowSource::Interface(0), [None; 2]);
                        let row = Row::equality([(a, 1.0), (b, -1.0)], 0.0).held(holds);
                        rows.push(row.in_block((y * (n + 1) + x) as u64).with_label(label));
                    }
                }
            }
        }
        let names = (0..nb * nb).map(|b| format!("b{}_{}", b % nb, b / nb));
        let here = (0..n_subdomains).filter(|&s| mine(s));
        Problem::new(names, n_subdomains)
            .with_subdomains(here.map(|s| self.subdomain(s)))
            .with_rows(rows)
    }
}
