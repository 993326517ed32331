//! The interface between problems and the method: subdomain matrices, and the rows of B_gl that connect bodies.
//!
//! A scene and a MATIS matrix each become a [`Problem`]; the method does not know where the matrices come from. All
//! data are distributed: a rank holds its own subdomains and provides its own rows.

mod build;
mod friction;
pub mod idle;
mod law;
pub mod merged;
mod rows;

pub use friction::{FrictionBound, FrictionNode};
pub use idle::Idle;
pub use law::{Law, RowState, SentLaw};
pub use rows::{BodyNode, Row, RowLabel, RowSource, SolvedRow};

use std::sync::Arc;

use base::linalg::csr::Csr;
use base::Location;

/// One subdomain Ω_ij with its Dirichlet degrees of freedom eliminated.
///
/// n is the number of its free degrees of freedom; "local dof" is an index in 0..n.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Subdomain {
    /// Global index of the subdomain, unique over all bodies and ranks, in 0..n_subdomains.
    pub index: usize,
    /// The body it belongs to.
    pub body: usize,
    /// Stiffness K^(ij), n × n, symmetric positive semidefinite. Subdomains that are alike may share one.
    pub k: Arc<Csr>,
    /// Load f^(ij), length n.
    pub f: Vec<f64>,
    /// Body dof of each local dof, length n. Two subdomains of one body share a degree of freedom exactly when
    /// both list the same number here; numbers of different bodies never coincide. Holes are allowed.
    pub dofs: Vec<u64>,
    /// Coefficient ρ of this subdomain at each local dof, length n, > 0: the weight of ρ-scaling.
    pub rho: Vec<f64>,
    /// Local dofs at subdomain vertices (strictly increasing). Continuity inside the body is primal at the vertices
    /// that subdomains share. Corners of the body are listed too, as they matter where bodies meet.
    pub primal: Vec<u32>,
    /// Edges and faces that this subdomain shares with others of its body, for primal averages; see [`Entity`]. May be
    /// empty.
    pub entities: Vec<Entity>,
    /// Columns that span every kernel that this subdomain's matrix could have without boundary conditions (constants;
    /// rigid body modes about the body's own centre), with entries of order one, each of length n. `None`: nothing is
    /// known, and kernels are found from the matrices alone.
    pub near_kernel: Option<Vec<Vec<f64>>>,
    /// Where `near_kernel` is not known: a basis of the kernel of K, entries of order one, or nothing.
    pub(crate) own_kernel: Vec<Vec<f64>>,
    /// Position of each local dof, if known: used for nested dissection. Length n.
    pub coordinates: Option<Vec<[f64; 3]>>,
    /// Its part of the motions of its body without energy that K holds all the same; mostly none, see [`Idle`].
    pub idle: Vec<Idle>,
}

/// The kind of an [`Entity`], by which constraints are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EntityKind {
    /// An open edge: without the vertices at its ends.
    Edge,
    /// An open face: without its edges and vertices.
    Face,
}

/// An edge or a face of a subdomain, for one component of the field. The average over its dofs may become a primal
/// constraint of the body.
///
/// Every subdomain of the body that holds the dofs lists the entity with the same key, and its dofs in the same order
/// of body dof. A face that contains an edge or vertex of another kind has been cut there. Edges where the face between
/// two subdomains meets the surface of their body are entities too, without held dofs. Entities of a subdomain have no
/// dof in common. An entity that only one subdomain lists constrains nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Entity {
    /// Edge or face.
    pub kind: EntityKind,
    /// Unique over bodies, entities and components; any number.
    pub key: u64,
    /// Local dofs; not empty.
    pub dofs: Vec<u32>,
    /// The components of one edge or face have this number in common, which no other edge or face of the subdomain has.
    /// All subdomains divide their entities in the same way.
    pub whole: u64,
}

/// Everything the method needs to know about a problem; each rank holds its own part.
///
/// Two springs in a row, each a body of one subdomain. The first is fixed at its left end, which is eliminated; the
/// second floats. One row ties the first's right end to the second's left end. The other lets the second's right end
/// press against a wall at a distance of 0.1.
///
/// ```
/// use fetifeti::problem::{BodyNode, Csr, RowLabel, RowSource};
/// use fetifeti::{Problem, Row, Subdomain};
///
/// let fixed = Csr::from_triplets(1, &[(0, 0, 1.0)]);
/// let free = Csr::from_triplets(2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)]);
/// let end = BodyNode { body: 1, node: 1 };
/// let problem = Problem::new(["fixed", "free"], 2)
///     .with_subdomains([
///         Subdomain::new(0, 0, fixed, vec![0.0], vec![0]),
///         Subdomain::new(1, 1, free, vec![0.0, 1.0], vec![1, 2]),
///     ])
///     .with_rows([
///         Row::equality([(0, 1.0), (1, -1.0)], 0.0),
///         Row::inequality([(2, 1.0)], 0.1)
///             .in_block(1)          // rows that share a dof have the same block; these two share none
///             .with_label(RowLabel::new(RowSource::Obstacle(0), [Some(end), None])),
///     ]);
/// // A floating body's matrix has a kernel: here the translation.
/// let mut force = [0.0; 2];
/// problem.local[1].k.mul(&[1.0, 1.0], &mut force);
/// assert_eq!(force, [0.0, 0.0]);
/// ```
///
/// [`FetiFeti`](crate::FetiFeti) takes it from here.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Problem {
    /// Number of bodies over all ranks.
    pub n_bodies: usize,
    /// Number of subdomains over all ranks.
    pub n_subdomains: usize,
    /// Whether a body in space is a mesh of cells without a regular structure, the same on all ranks. The subdomains
    /// that share a node then differ in how many cells they have there, and so in how much they resist; the method
    /// chooses its weights accordingly ([`MethodSettings::scaling`](crate::settings::MethodSettings::scaling)).
    pub ragged: bool,
    /// Name of every body, for messages; length n_bodies.
    pub body_names: Vec<String>,
    /// For messages: bodies, increasing, whose cells leave motions without energy that are not rigid, each with what is
    /// to be said of it.
    pub weak: Vec<(usize, String)>,
    /// This rank's subdomains, in increasing order of `index`.
    pub local: Vec<Subdomain>,
    /// The rows that this rank provides. Each row of the problem is provided by exactly one rank.
    pub rows: Vec<Row>,
    /// The nodes with friction among these rows.
    pub friction: Vec<FrictionNode>,
}

impl Problem {
    /// These bodies as the place of an error.
    pub(crate) fn location(&self, bodies: &[u32]) -> Location {
        let names = bodies.iter().map(|&b| &self.body_names[b as usize]);
        names.fold(Location::default(), |place, name| place.with_body(name))
    }

    /// A remark on the cells of the first of some bodies with motions without energy, to be put behind a sentence;
    /// empty if there is none.
    pub(crate) fn weakness(&self, bodies: &[u32]) -> String {
        let of = |(b, text): &(usize, String)| {
            bodies.contains(&(*b as u32)).then(|| format!("; {text}"))
        };
        self.weak.iter().find_map(of).unwrap_or_default()
    }

    /// Replaces this rank's rows, and the nodes with friction among them. Returns those that were there.
    pub(crate) fn replace_rows(
        &mut self,
        rows: Vec<Row>,
        friction: Vec<FrictionNode>,
    ) -> (Vec<Row>, Vec<FrictionNode>) {
        (
            std::mem::replace(&mut self.rows, rows),
            std::mem::replace(&mut self.friction, friction),
        )
    }

    /// The loads on one subdomain, Σ|f|, the largest of this rank's.
    pub(crate) fn largest_load(&self) -> f64 {
        self.local.iter().map(Subdomain::load).fold(0.0, f64::max)
    }
}

impl Subdomain {
    /// Σ|f|.
    pub(crate) fn load(&self) -> f64 {
        self.f.iter().map(|f| f.abs()).sum()
    }
}
