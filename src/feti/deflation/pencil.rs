//! The pencils of all bodies, side by side.
//!
//! ```text
//!     F_i = B_i S̃_i⁺ B_iᵀ,    M_i⁻¹ = the rows of body i of M⁻¹,    P_i = I − M_i⁻¹ G_i (G_iᵀ M_i⁻¹ G_i)⁺ G_iᵀ
//!     P_i M_i⁻¹ P_iᵀ F_i μ = θ μ
//! ```
//!
//! With v = S̃_i⁺ B_iᵀ μ this is B_iᵀ M⁻¹ B_i v = θ S̃_i v (docs/theory.md, section 12), v orthogonal to the kernel of
//! S̃_i. Rows between two bodies belong to both pencils. The bodies are coloured: no body is near two bodies of one
//! colour. A vector of multipliers holds all bodies of a colour. F is one product for all colours, M⁻¹ one product with
//! several columns.

use std::ops::Range;

use super::search::Pencils;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::graph::BodyGraph;
use crate::substructures::Problem;
use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use parallel::exchange::sum_all;
use petsc::Vec as PetscVec;

/// The pencils of all bodies. A vector holds the rows of one body after those of another, colour after colour.
pub struct Pencil<'a> {
    dual: &'a Dual,
    /// The bodies.
    pub bodies: Vec<u32>,
    /// Owned row behind each entry of a vector.
    pub rows: Vec<u32>,
    /// Entries of each body.
    pub parts: Vec<Range<usize>>,
    /// Colour of each local subdomain's body.
    colour: Vec<usize>,
    /// Entries of the bodies of each colour.
    colours: Vec<Range<usize>>,
    kernel: Option<Kernel>,
    /// A vector of multipliers of each colour, and its image.
    x: Vec<PetscVec>,
    y: Vec<PetscVec>,
}

/// G_i and M_i⁻¹ G_i, one column of every body at a time, and the factors of G_iᵀ M_i⁻¹ G_i.
struct Kernel {
    g: Vec<Vec<f64>>,
    mg: Vec<Vec<f64>>,
    factors: Vec<Semidefinite>,
}

impl<'a> Pencil<'a> {
    /// Prepares rows and projections. Collective.
    pub fn new(problem: &Problem, dual: &'a Dual, graph: &BodyGraph) -> Result<Pencil<'a>> {
        let all: Vec<u32> = (0..graph.n as u32).collect();
        let groups = graph.colours(&all);
        let bodies = groups.concat();
        let jump = &dual.stiffness.jump;
        let mut slot = vec![usize::MAX; graph.n];
        for (s, &b) in bodies.iter().enumerate() {
            slot[b as usize] = s;
        }
        let mut of_body: Vec<Vec<u32>> = vec![Vec::new(); bodies.len()];
        for row in 0..jump.n_owned {
            let terms = graph.terms.at(row).iter();
            for s in terms
                .map(|&b| slot[b as usize])
                .filter(|&s| s != usize::MAX)
            {
                of_body[s].push(row as u32);
            }
        }
        let mut parts = Vec::new();
        let mut rows = Vec::new();
        for list in of_body {
            let start = rows.len();
            rows.extend(list);
            parts.push(start..rows.len());
        }
        let mut of_colour = vec![0; graph.n];
        let mut colours = Vec::new();
        let mut first = 0;
        for (c, group) in groups.iter().enumerate() {
            group.iter().for_each(|&b| of_colour[b as usize] = c);
            let last = first + group.len();
            colours.push(parts[first].start..parts[last - 1].end);
            first = last;
        }
        let vectors = || {
            colours
                .iter()
                .map(|_| dual.multipliers())
                .collect::<Result<_>>()
        };
        let (x, y) = (vectors()?, vectors()?);
        let mut pencil = Pencil {
            dual,
            bodies,
            rows,
            parts,
            colour: problem.local.iter().map(|s| of_colour[s.body]).collect(),
            colours,
            kernel: None,
            x,
            y,
        };
        pencil.kernel = pencil.kernels()?;
        Ok(pencil)
    }

    fn kernels(&self) -> Result<Option<Kernel>> {
        let of = |b: &u32| self.dual.natural.columns.of(*b as usize);
        let most = self.bodies.iter().map(|b| of(b).len()).max().unwrap_or(0);
        if most == 0 {
            return Ok(None);
        }
        let mut g = vec![vec![0.0; self.n()]; most];
        for (part, body) in self.parts.iter().zip(&self.bodies) {
            let columns = of(body);
            for i in part.clone() {
                let natural = &self.dual.natural;
                for (c, value) in natural.g.row(self.rows[i] as usize) {
                    let c = natural.known().name(c as u32) as usize;
                    if columns.contains(&c) {
                        g[c - columns.start][i] = value;
                    }
                }
            }
        }
        let mut mg = Vec::new();
        for column in &g {
            mg.push(self.plain_m(column)?);
        }
        let mut sums = Vec::new();
        for (p, gp) in g.iter().enumerate() {
            for mq in &mg[..=p] {
                sums.extend(self.dots(gp, mq));
            }
        }
        sum_all(self.dual.comm(), &mut sums);
        let factor = |s: usize| {
            let mut a = Dense::zeros(most, most);
            let mut k = s;
            for p in 0..most {
                for q in 0..=p {
                    a.set(p, q, sums[k]);
                    a.set(q, p, sums[k]);
                    k += self.bodies.len();
                }
            }
            Semidefinite::new(&a)
        };
        let factors = (0..self.bodies.len()).map(factor).collect();
        Ok(Some(Kernel { g, mg, factors }))
    }

    fn scatter(&self, v: &[f64]) -> Result<()> {
        for (x, range) in self.x.iter().zip(&self.colours) {
            x.set(0.0)?;
            let mut x = x.array_mut()?;
            let entries = self.rows[range.clone()].iter().zip(&v[range.clone()]);
            entries.for_each(|(&r, v)| x[r as usize] = *v);
        }
        Ok(())
    }

    fn gather(&self) -> Result<Vec<f64>> {
        let mut out = Vec::with_capacity(self.rows.len());
        for (y, range) in self.y.iter().zip(&self.colours) {
            let y = y.array()?;
            out.extend(self.rows[range.clone()].iter().map(|&r| y[r as usize]));
        }
        Ok(out)
    }

    fn plain_m(&self, v: &[f64]) -> Result<Vec<f64>> {
        self.scatter(v)?;
        self.dual.m_many(&self.x, &self.y)?;
        self.gather()
    }

    /// v ← v − along (G_iᵀ M_i⁻¹ G_i)⁺ fromᵀ v.
    fn remove(&self, v: &mut [f64], kernel: &Kernel, from: &[Vec<f64>], along: &[Vec<f64>]) {
        let n = self.bodies.len();
        let mut sums: Vec<f64> = from.iter().flat_map(|c| self.dots(c, v)).collect();
        sum_all(self.dual.comm(), &mut sums);
        for s in 0..n {
            let mut c: Vec<f64> = (0..from.len()).map(|p| sums[p * n + s]).collect();
            kernel.factors[s].solve(&mut c);
            c.iter().enumerate().for_each(|(p, c)| sums[p * n + s] = -c);
        }
        for (p, column) in along.iter().enumerate() {
            self.add(&sums[p * n..(p + 1) * n], column, v);
        }
    }

    /// M_i⁻¹ G_i, column `p` of every body, as multipliers by colour. Collective.
    pub fn reaction(&self, p: usize) -> Result<&[PetscVec]> {
        let column = self.kernel.as_ref().map(|k| &k.mg[p]);
        self.scatter(column.expect("some body floats"))?;
        Ok(&self.x)
    }

    /// Colour of the body of local subdomain `j`.
    pub fn colour(&self, j: usize) -> usize {
        self.colour[j]
    }
}

impl Pencils for Pencil<'_> {
    fn parts(&self) -> &[Range<usize>] {
        &self.parts
    }

    fn row(&self, i: usize) -> u64 {
        self.dual.stiffness.jump.first as u64 + u64::from(self.rows[i])
    }

    fn f(&self, v: &[f64]) -> Result<Vec<f64>> {
        self.scatter(v)?;
        let stiffness = &self.dual.stiffness;
        stiffness.f_mult_coloured(&self.x, &self.y, &self.colour)?;
        self.gather()
    }

    fn m(&self, v: &[f64]) -> Result<Vec<f64>> {
        let mut z = self.plain_m(v)?;
        if let Some(k) = &self.kernel {
            self.remove(&mut z, k, &k.g, &k.mg);
        }
        Ok(z)
    }

    fn jump_part(&self, v: &mut Vec<f64>) -> Result<()> {
        if let Some(k) = &self.kernel {
            self.remove(v, k, &k.mg, &k.g);
        }
        Ok(())
    }

    fn sum(&self, values: &mut [f64]) {
        sum_all(self.dual.comm(), values);
    }
}
