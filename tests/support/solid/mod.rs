//! Grids of equal box bodies in 2D and 3D, scalar and elastic, implemented without the scene, mesh and fem modules.

pub mod assembled;
mod element;

use std::collections::BTreeMap;

use base::linalg::csr::Csr;
use fetifeti::problem::{Entity, EntityKind, RowLabel, RowSource};
use fetifeti::{Problem, Row, Subdomain};

/// The material of the bodies.
#[derive(Clone, Copy, PartialEq)]
pub enum Physics {
    /// −Δu.
    Scalar,
    /// Linear elasticity with E = 1, plane strain in 2D.
    Elastic { nu: f64 },
}

/// The rows between bodies.
#[derive(Clone, Copy, PartialEq)]
pub enum Rows {
    /// All components, all pairs of bodies at a node.
    Tied,
    /// Rows as for `Tied`, of which only those normal to the face of exactly two bodies hold. The other rows are
    /// candidates all the same, so that whole nodes belong to Γ and are not in Z_c.
    NormalsByNode,
    /// One row for each pair of faces and node, in the normal direction.
    Normals,
}

/// The support of the unit square or cube.
#[derive(Clone, Copy, PartialEq)]
pub enum Held {
    /// All components on the whole boundary.
    AllRound,
    /// All components where x = 0.
    Left,
    /// Only the first component where x = 0.
    Rolling,
}

/// Stiffness as a function of the body's place and the subdomain's place in it.
pub type Stiffness = fn([usize; 3], [usize; 3]) -> f64;

/// N_b bodies of N_s subdomains of N_e elements in every direction on the unit square or cube.
#[derive(Clone, Copy)]
pub struct Solid {
    pub dim: usize,
    pub bodies: usize,
    pub subdomains: usize,
    pub elements: usize,
    pub physics: Physics,
    pub rows: Rows,
    pub held: Held,
    /// Stiffness of a body and of a subdomain in it, by place; 1 if `None`.
    pub stiffness: Option<Stiffness>,
    /// Further factor of the stiffness of an element, by its place on the whole grid; 1 if `None`.
    pub by_element: Option<fn([usize; 3]) -> f64>,
    /// Whether the edges of squares in 2D are entities; those of cubes always are.
    pub plane_edges: bool,
}

impl Solid {
    pub fn new(dim: usize, sizes: [usize; 3], physics: Physics, rows: Rows) -> Solid {
        let [bodies, subdomains, elements] = sizes;
        Solid {
            dim,
            bodies,
            subdomains,
            elements,
            physics,
            rows,
            held: Held::AllRound,
            stiffness: None,
            by_element: None,
            plane_edges: false,
        }
    }

    /// Components of the field.
    pub fn components(&self) -> usize {
        match self.physics {
            Physics::Scalar => 1,
            Physics::Elastic { .. } => self.dim,
        }
    }

    fn per_body(&self) -> usize {
        self.subdomains * self.elements
    }

    fn per_side(&self) -> usize {
        self.bodies * self.per_body()
    }

    pub fn n_bodies(&self) -> usize {
        self.bodies.pow(self.dim as u32)
    }

    pub fn n_subdomains(&self) -> usize {
        self.n_bodies() * self.subdomains.pow(self.dim as u32)
    }

    /// The place of number `i` in a grid of n in every direction; third entry 0 in 2D.
    fn place(&self, i: usize, n: usize) -> [usize; 3] {
        let z = if self.dim == 3 { i / (n * n) } else { 0 };
        [i % n, i / n % n, z]
    }

    fn number(place: [usize; 3], n: usize) -> usize {
        place[0] + n * (place[1] + n * place[2])
    }

    /// Number of body `b`'s node at `x` (counted on the whole grid), component `c`.
    fn dof(&self, b: usize, x: [usize; 3], c: usize) -> u64 {
        let n = self.per_side() + 1;
        let nodes = n.pow(self.dim as u32);
        ((b * nodes + Self::number(x, n)) * self.components() + c) as u64
    }

    /// The component and place of a body dof.
    pub fn where_is(&self, dof: u64) -> ([usize; 3], usize) {
        let n = self.per_side() + 1;
        let (node, c) = (
            dof as usize / self.components(),
            dof as usize % self.components(),
        );
        (self.place(node % n.pow(self.dim as u32), n), c)
    }

    fn free(&self, x: [usize; 3], component: usize) -> bool {
        let n = self.per_side();
        match self.held {
            Held::AllRound => x[..self.dim].iter().all(|&x| x > 0 && x < n),
            Held::Left => x[0] > 0,
            Held::Rolling => x[0] > 0 || component > 0,
        }
    }

    pub fn subdomain(&self, index: usize) -> Subdomain {
        let (dim, ns, ne, comps) = (self.dim, self.subdomains, self.elements, self.components());
        let per_body = ns.pow(dim as u32);
        let (body, s) = (index / per_body, index % per_body);
        let (b, place) = (self.place(body, self.bodies), self.place(s, ns));
        let mut low = [0; 3];
        (0..dim).for_each(|d| low[d] = b[d] * self.per_body() + place[d] * ne);
        let node = |i: usize, n: usize| {
            let mut x = self.place(i, n);
            (0..dim).for_each(|d| x[d] += low[d]);
            x
        };

        let mut number = BTreeMap::new();
        let mut nodes = Vec::new();
        for i in 0..(ne + 1).pow(dim as u32) {
            let x = node(i, ne + 1);
            for c in (0..comps).filter(|&c| self.free(x, c)) {
                number.insert((x, c), nodes.len() as u32);
                nodes.push((x, c));
            }
        }
        let n = nodes.len();
        let h = 1.0 / self.per_side() as f64;
        let stiffness = self.stiffness.map_or(1.0, |of| of(b, place));
        let k = element::stiffness(dim, h, self.physics);
        let mut triplets = Vec::new();
        let mut rho = vec![0.0f64; n];
        for e in 0..ne.pow(dim as u32) {
            let corner = node(e, ne);
            let stiffness = stiffness * self.by_element.map_or(1.0, |of| of(corner));
            let local: Vec<Option<&u32>> = (0..1 << dim)
                .flat_map(|a| (0..comps).map(move |c| (a, c)))
                .map(|(a, c)| {
                    let mut x = corner;
                    (0..dim).for_each(|d| x[d] += a >> d & 1);
                    number.get(&(x, c))
                })
                .collect();
            for &&i in local.iter().flatten() {
                rho[i as usize] = rho[i as usize].max(stiffness);
            }
            for (i, row) in local.iter().zip(&k) {
                for (j, v) in local.iter().zip(row) {
                    if let (Some(&i), Some(&j)) = (i, j) {
                        triplets.push((i, j, stiffness * v));
                    }
                }
            }
        }

        // Vertices, edges and faces, by the number of directions in which a node is at an end of the box.
        let mut primal = Vec::new();
        let mut entities: BTreeMap<(Vec<usize>, usize), Entity> = BTreeMap::new();
        for (i, (x, c)) in nodes.iter().enumerate() {
            let side: Vec<usize> = (0..dim)
                .map(|d| match x[d] - low[d] {
                    0 => 0,
                    at if at == ne => 2,
                    _ => 1,
                })
                .collect();
            let ends = side.iter().filter(|&&s| s != 1).count();
            let kind = match (dim, ends) {
                (_, ends) if ends == dim => {
                    primal.push(i as u32);
                    continue;
                }
                (3, 2) => EntityKind::Edge,
                (2, 1) if self.plane_edges => EntityKind::Edge,
                (3, 1) => EntityKind::Face,
                _ => continue,
            };
            let whole = side.iter().fold(0, |sum, &s| 3 * sum + s as u64);
            let new = Entity::new(kind, self.dof(body, *x, *c), Vec::new());
            let entity = entities.entry((side, *c)).or_insert(new.of_whole(whole));
            entity.dofs.push(i as u32);
        }
        let at = |x: [usize; 3]| [0, 1, 2].map(|d| if d < dim { x[d] as f64 * h } else { 0.0 });
        let k = Csr::from_triplets(n, &triplets);
        let f = nodes.iter().map(|&(x, c)| self.load(body, x, c)).collect();
        let dofs = nodes.iter().map(|&(x, c)| self.dof(body, x, c)).collect();
        Subdomain::new(index, body, k, f, dofs)
            .with_rho(rho)
            .with_primal(primal)
            .with_entities(entities.into_values().collect())
            .with_near_kernel(self.motions(b, &nodes))
            .with_coordinates(nodes.iter().map(|&(x, _)| at(x)).collect())
    }

    /// A load without a pattern; the loads of the copies of a dof add up.
    fn load(&self, body: usize, x: [usize; 3], c: usize) -> f64 {
        let t = (self.dof(body, x, c) + 1) as f64 * 0.618_033_988_749_894_9;
        (2.0 * t.fract() - 1.0) / self.per_side() as f64
    }

    /// Constants; translations and rotations about the body's centre.
    fn motions(&self, b: [usize; 3], nodes: &[([usize; 3], usize)]) -> Vec<Vec<f64>> {
        if self.physics == Physics::Scalar {
            return vec![vec![1.0; nodes.len()]];
        }
        let size = self.per_body() as f64;
        let from_centre = |x: [usize; 3], d: usize| x[d] as f64 / size - b[d] as f64 - 0.5;
        let translations = (0..self.dim).map(|d| {
            let value = |&(_, c): &([usize; 3], usize)| f64::from(u8::from(c == d));
            nodes.iter().map(value).collect()
        });
        let planes: &[(usize, usize)] = &[(0, 1), (0, 2), (1, 2)];
        let planes = planes.iter().take(if self.dim == 3 { 3 } else { 1 });
        let rotations = planes.map(|&(p, q)| {
            let value = |&(x, c): &([usize; 3], usize)| {
                if c == p {
                    -from_centre(x, q)
                } else if c == q {
                    from_centre(x, p)
                } else {
                    0.0
                }
            };
            nodes.iter().map(value).collect()
        });
        translations.chain(rotations).collect()
    }

    /// The rows between the bodies at node `x`: (lower body, other body, component, whether it holds).
    fn pairs(&self, x: [usize; 3]) -> Vec<(usize, usize, usize, bool)> {
        let pb = self.per_body();
        let around = |x: usize| -> Vec<usize> {
            let last = self.bodies - 1;
            let right = (x / pb).min(last);
            if x % pb == 0 && x > 0 && x / pb <= last {
                vec![right - 1, right]
            } else {
                vec![right]
            }
        };
        let mut bodies = vec![[0; 3]];
        for d in 0..self.dim {
            bodies = around(x[d])
                .into_iter()
                .flat_map(|v| {
                    bodies.iter().map(move |b| {
                        let mut b = *b;
                        b[d] = v;
                        b
                    })
                })
                .collect();
        }
        let mut out = Vec::new();
        for (i, a) in bodies.iter().enumerate() {
            for b in &bodies[i + 1..] {
                let apart: Vec<usize> = (0..self.dim).filter(|&d| a[d] != b[d]).collect();
                let components: Vec<usize> = match self.rows {
                    Rows::Tied | Rows::NormalsByNode => (0..self.components()).collect(),
                    Rows::Normals if apart.len() == 1 => apart.clone(),
                    Rows::Normals => continue,
                };
                let free = components.into_iter().filter(|&c| self.free(x, c));
                let number = |p: &[usize; 3]| Self::number(*p, self.bodies);
                let normal = |c| bodies.len() == 2 && apart == [c];
                let holds = |c| self.rows != Rows::NormalsByNode || normal(c);
                out.extend(free.map(|c| (number(a), number(b), c, holds(c))));
            }
        }
        out
    }

    /// The substructures of one rank; `mine` says which subdomains it owns. The owner of a body's subdomain 0 provides
    /// its rows.
    pub fn substructures(&self, mine: impl Fn(usize) -> bool) -> Problem {
        let n = self.per_side() + 1;
        let per_body = self.subdomains.pow(self.dim as u32);
        let mut rows = Vec::new();
        for i in 0..n.pow(self.dim as u32) {
            let x = self.place(i, n);
            let pairs = self.pairs(x);
            for (a, b, c, holds) in pairs.iter().copied() {
                let home = pairs.iter().filter(|p| p.2 == c).map(|p| p.0).min();
                if mine(home.expect("the pair itself") * per_body) {
                    let terms = [(self.dof(a, x, c), 1.0), (self.dof(b, x, c), -1.0)];
                    let block = (i * self.components() + c) as u64;
                    let label = RowLabel::new(RowSource::Interface(0), [None; 2]);
                    let row = Row::equality(terms, 0.0).held(holds);
                    rows.push(row.in_block(block).with_label(label));
                }
            }
        }
        let names = (0..self.n_bodies()).map(|b| format!("b{b}"));
        let here = (0..self.n_subdomains()).filter(|&s| mine(s));
        Problem::new(names, self.n_subdomains())
            .with_subdomains(here.map(|s| self.subdomain(s)))
            .with_rows(rows)
    }
}
