//! Makes subdomains, rows and problems. Their types may grow fields: what a caller does not say has a default.

use std::sync::Arc;

use base::linalg::csr::Csr;

use super::{
    Entity, EntityKind, FrictionNode, Idle, Law, Problem, Row, RowLabel, RowSource, Subdomain,
};

impl Problem {
    /// A problem with a body of each name and `n_subdomains` subdomains over all ranks, so far without a subdomain and
    /// without a row of this rank.
    pub fn new<N: Into<String>>(
        bodies: impl IntoIterator<Item = N>,
        n_subdomains: usize,
    ) -> Problem {
        let body_names: Vec<String> = bodies.into_iter().map(Into::into).collect();
        Problem {
            n_bodies: body_names.len(),
            n_subdomains,
            ragged: false,
            body_names,
            weak: Vec::new(),
            local: Vec::new(),
            rows: Vec::new(),
            friction: Vec::new(),
        }
    }

    /// This problem with these subdomains of this rank, in increasing order of their index.
    pub fn with_subdomains(mut self, local: impl IntoIterator<Item = Subdomain>) -> Problem {
        self.local = local.into_iter().collect();
        self
    }

    /// This problem with these rows of this rank. Each row is provided by exactly one rank.
    pub fn with_rows(mut self, rows: impl IntoIterator<Item = Row>) -> Problem {
        self.rows = rows.into_iter().collect();
        self
    }

    /// This problem with friction at these nodes of this rank, whose rows it has.
    pub fn with_friction(mut self, nodes: impl IntoIterator<Item = FrictionNode>) -> Problem {
        self.friction = nodes.into_iter().collect();
        self
    }
}

impl Subdomain {
    /// Subdomain `index` of a body: stiffness (n × n), load (length n), and the body dof of each local dof. ρ is 1, no
    /// dof is primal, and the kernel is found from the matrix.
    ///
    /// ```
    /// use fetifeti::problem::Csr;
    /// use fetifeti::Subdomain;
    ///
    /// let spring = Csr::from_triplets(2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)]);
    /// let sub = Subdomain::new(3, 1, spring, vec![0.0, 1.0], vec![10, 11])
    ///     .with_rho(vec![5.0; 2])
    ///     .with_primal(vec![0]);
    /// assert_eq!((sub.index, sub.body), (3, 1));
    /// assert_eq!(sub.k.n(), 2);
    /// ```
    ///
    /// # Panics
    /// If lengths differ.
    pub fn new(
        index: usize,
        body: usize,
        k: impl Into<Arc<Csr>>,
        f: Vec<f64>,
        dofs: Vec<u64>,
    ) -> Subdomain {
        let k = k.into();
        assert_eq!((f.len(), dofs.len()), (k.n(), k.n()));
        Subdomain {
            index,
            body,
            rho: vec![1.0; f.len()],
            primal: Vec::new(),
            entities: Vec::new(),
            near_kernel: None,
            own_kernel: Vec::new(),
            coordinates: None,
            idle: Vec::new(),
            k,
            f,
            dofs,
        }
    }

    /// This subdomain with the coefficient ρ > 0 at each local dof.
    pub fn with_rho(mut self, rho: Vec<f64>) -> Subdomain {
        self.rho = rho;
        self
    }

    /// This subdomain with these local dofs at its vertices, strictly increasing.
    pub fn with_primal(mut self, primal: Vec<u32>) -> Subdomain {
        self.primal = primal;
        self
    }

    /// This subdomain with the edges and faces that it shares with others of its body.
    pub fn with_entities(mut self, entities: Vec<Entity>) -> Subdomain {
        self.entities = entities;
        self
    }

    /// This subdomain with columns that span every kernel that its matrix could have, each of length n.
    pub fn with_near_kernel(mut self, columns: Vec<Vec<f64>>) -> Subdomain {
        self.near_kernel = Some(columns);
        self
    }

    /// This subdomain with the position of each local dof.
    pub fn with_coordinates(mut self, coordinates: Vec<[f64; 3]>) -> Subdomain {
        self.coordinates = Some(coordinates);
        self
    }

    /// This subdomain with its part of the motions of its body without energy.
    pub fn with_idle(mut self, idle: Vec<Idle>) -> Subdomain {
        self.idle = idle;
        self
    }
}

impl Entity {
    /// The entity of this kind and key with these local dofs. It is an edge or a face by itself.
    pub fn new(kind: EntityKind, key: u64, dofs: Vec<u32>) -> Entity {
        Entity {
            kind,
            key,
            dofs,
            whole: key,
        }
    }

    /// This entity as a component of an edge or face with this number.
    pub fn of_whole(mut self, whole: u64) -> Entity {
        self.whole = whole;
        self
    }
}

impl Row {
    /// The equation Σ coefficient · u(body dof) = `value`. It holds, its direction is exact, its block is 0.
    ///
    /// ```
    /// use fetifeti::problem::Law;
    /// use fetifeti::Row;
    ///
    /// // Two springs are tied: dof 0 of one and dof 1 of the other move together.
    /// let tie = Row::equality([(0, 1.0), (1, -1.0)], 0.0);
    /// // The end of the second may move by 0.1 until it meets a wall. The rows share no dof: their blocks differ.
    /// let wall = Row::inequality([(2, 1.0)], 0.1).in_block(1);
    /// assert_eq!((tie.law, wall.law), (Law::Tie, Law::Unilateral));
    /// assert_eq!(wall.gap, 0.1);
    /// ```
    pub fn equality(terms: impl Into<Vec<(u64, f64)>>, value: f64) -> Row {
        Row {
            terms: terms.into(),
            gap: value,
            law: Law::Tie,
            holds: true,
            block: 0,
            compliance: 0.0,
            rounding: 0.0,
            label: RowLabel::new(RowSource::Equation(0), [None; 2]),
        }
    }

    /// The inequality Σ coefficient · u(body dof) ≤ `gap`, which holds to begin with; otherwise as [`Row::equality`].
    pub fn inequality(terms: impl Into<Vec<(u64, f64)>>, gap: f64) -> Row {
        Row {
            law: Law::Unilateral,
            ..Row::equality(terms, gap)
        }
    }

    /// The tangential row Σ coefficient · u(body dof) = `slipped` of a node with friction, which sticks to begin with.
    /// `slipped` is where the sides stand without a slip in this load step. Its block is that of the normal row.
    pub fn tangential(terms: impl Into<Vec<(u64, f64)>>, slipped: f64) -> Row {
        Row {
            law: Law::Friction,
            ..Row::equality(terms, slipped)
        }
    }

    /// This row in a block. Rows that share a body dof carry the same number and are provided by the same rank.
    pub fn in_block(mut self, block: u64) -> Row {
        self.block = block;
        self
    }

    /// This row, which holds initially or does not.
    pub fn held(mut self, holds: bool) -> Row {
        self.holds = holds;
        self
    }

    /// This row with a compliance, a length per force.
    pub fn with_compliance(mut self, compliance: f64) -> Row {
        self.compliance = compliance;
        self
    }

    /// This row with a direction that may be off by so many radians.
    pub fn with_rounding(mut self, rounding: f64) -> Row {
        self.rounding = rounding;
        self
    }

    /// This row with its origin, which solutions return with it.
    pub fn with_label(mut self, label: RowLabel) -> Row {
        self.label = label;
        self
    }
}
