//! Joints between the bodies of a deck: ties, contact pairs, surface interactions.

use super::deck_line::DeckLine;

/// A surface that a tie or a contact pair names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SurfaceName {
    /// Its name, in capitals.
    pub name: String,
    /// Whether it consists of nodes rather than of sides of cells.
    pub nodes: bool,
    /// The group in [`MeshFile::groups`](mesh::MeshFile::groups).
    pub group: u32,
}

/// A *TIE.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Its name, in capitals; empty if it has none.
    pub name: String,
    /// The dependent surface.
    pub slave: SurfaceName,
    /// The surface to which it is tied, of sides.
    pub master: SurfaceName,
    /// How far nodes of the slave may be from the master to be tied; `None`: 2.5 % of the size of an element.
    pub tolerance: Option<f64>,
    /// Whether tied nodes are moved onto the master before.
    pub adjust: bool,
    /// Where it stands.
    pub place: DeckLine,
}

/// Which nodes of the slave a contact pair moves onto the master before the first step.
#[derive(Debug, Clone, PartialEq)]
pub enum Adjust {
    /// None.
    No,
    /// The nodes whose gap is at most that number, and those that penetrate.
    Within(f64),
    /// The nodes of this list, by increasing places.
    Nodes(Vec<u32>),
}

/// How a contact pair is discretised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactKind {
    /// The nodes of the slave against the sides of the master.
    NodeToSurface,
    /// The sides of the slave, at points of integration, against the sides of the master.
    SurfaceToSurface,
    /// The sides of the slave, at points of integration, against the sides of the master, with multipliers instead of
    /// springs (MORTAR, LINMORTAR, PGLINMORTAR).
    Mortar,
    /// The nodes of the slave without mass (MASSLESS).
    Massless,
}

/// One line of a *CONTACT PAIR.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPair {
    /// The dependent surface.
    pub slave: SurfaceName,
    /// The independent surface, of sides.
    pub master: SurfaceName,
    /// Its interaction, as a place in [`Deck::interactions`](super::Deck::interactions).
    pub interaction: u32,
    /// How it is discretised in CalculiX.
    pub kind: ContactKind,
    /// Whether nodes keep the sides that they meet at first.
    pub small_sliding: bool,
    /// Which nodes are moved before.
    pub adjust: Adjust,
    /// The gap that replaces the geometric one (*CLEARANCE); negative for an overclosure.
    pub clearance: Option<f64>,
    /// Where it stands.
    pub place: DeckLine,
}

/// The pressure of contact as a function of the overclosure.
#[derive(Debug, Clone, PartialEq)]
pub enum Overclosure {
    /// Hard contact.
    Hard,
    /// Linear in the overclosure.
    Linear {
        /// Pressure by overclosure.
        slope: f64,
    },
    /// Exponential.
    Exponential {
        /// The gap at which the pressure is 1 % of `p0`.
        c0: f64,
        /// The pressure at gap 0.
        p0: f64,
    },
    /// Pairs of pressure and overclosure, linear between them.
    Tabular(Vec<(f64, f64)>),
    /// A spring in both directions: the surfaces are tied.
    Tied {
        /// Pressure by overclosure.
        slope: Option<f64>,
    },
}

/// A *SURFACE INTERACTION, or the law of a *GAP.
#[derive(Debug, Clone, PartialEq)]
pub struct Interaction {
    /// Its name, in capitals.
    pub name: String,
    /// Its *SURFACE BEHAVIOR; hard contact if it has none.
    pub overclosure: Overclosure,
    /// Where it stands.
    pub place: DeckLine,
}

/// A *FRICTION: the shear stress grows with the slip up to the coefficient times the pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coulomb's coefficient, positive.
    pub coefficient: f64,
    /// Shear stress by slip where surfaces stick; `None`: they do not slip there.
    pub stick_slope: Option<f64>,
    /// The shear stress that it cannot exceed.
    pub limit: Option<f64>,
}
