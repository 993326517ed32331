//! The treatment of each keyword of Abaqus and CalculiX: read, ignored with a reason, refused with a reason.
//!
//! Keywords that change the answer are refused unless they are read; those that are not in this table are unknown, and
//! refused as such.

use super::cards::squeeze;
use std::collections::HashMap;
use std::sync::OnceLock;

/// The treatment of a keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeywordTreatment {
    /// It is read.
    Read,
    /// It changes no displacement; why.
    Ignored(&'static str),
    /// It changes the answer; why it is not supported.
    Refused(&'static str),
    /// It changes the mesh; why it is not supported.
    RefusedMesh(&'static str),
    /// It belongs to a material, and is refused if cells have this material.
    InMaterial(&'static str),
}

use KeywordTreatment::{Ignored, InMaterial, Read, Refused, RefusedMesh};

const OUTPUT: KeywordTreatment = Ignored("it asks for output that is not written here");
const HEAT: KeywordTreatment = Refused("it is a problem of heat, and only elasticity is solved");
const HEAT_ONLY: KeywordTreatment = Ignored("it is for problems of heat");
const FLUID: KeywordTreatment = Refused("it is a problem of fluids, and only elasticity is solved");
const FLUID_ONLY: KeywordTreatment = Ignored("it is for fluids");
const WAVES: KeywordTreatment =
    Refused("it depends on time or frequency, and only static steps are solved");
const ELECTRIC: KeywordTreatment =
    Refused("it is a problem of electromagnetism, and only elasticity is solved");
const DESIGN: KeywordTreatment =
    Refused("it asks for sensitivities or another design, and only the displacement is solved for");
const SLENDER: KeywordTreatment = Refused("beams, shells, membranes and trusses are not supported");
const DISCRETE: KeywordTreatment = Refused("springs, dashpots and point masses are not supported");
const COUPLED: KeywordTreatment =
    Refused("rigid and averaged couplings of nodes are not supported; write them as *EQUATION");
const NONLINEAR: KeywordTreatment = InMaterial("only linear elasticity is supported");
const CHANGES: KeywordTreatment = Refused("the model may not change between steps");
const GENERATED: KeywordTreatment =
    RefusedMesh("nodes and elements must be written out; generating them is not supported");

/// The verdict on every keyword that is known.
pub const KEYWORDS: &[(&str, KeywordTreatment)] = &[
    ("ACOUSTIC FLOW VELOCITY", WAVES),
    ("AMPLITUDE", Read),
    ("ASSEMBLY", Read),
    ("BASE MOTION", WAVES),
    ("BEAM GENERAL SECTION", SLENDER),
    ("BEAM SECTION", SLENDER),
    ("BOUNDARY", Read),
    ("BOUNDARYF", FLUID),
    (
        "BUCKLE",
        Refused("only static steps are solved, no buckling loads"),
    ),
    ("CFD", FLUID),
    ("CFLUX", HEAT),
    ("CHANGE CONTACT TYPE", CHANGES),
    ("CHANGE FRICTION", Read),
    ("CHANGE MATERIAL", CHANGES),
    ("CHANGE PLASTIC", CHANGES),
    ("CHANGE SOLID SECTION", CHANGES),
    ("CHANGE SURFACE BEHAVIOR", CHANGES),
    ("CLEARANCE", Read),
    ("CLOAD", Read),
    ("COMPLEX FREQUENCY", WAVES),
    ("CONDUCTIVITY", HEAT_ONLY),
    ("CONNECTOR SECTION", DISCRETE),
    ("CONSTRAINT", DESIGN),
    (
        "CONTACT",
        Refused(
            "contact of everything with everything is not supported; name pairs with *CONTACT PAIR",
        ),
    ),
    (
        "CONTACT CONTROLS",
        Ignored("it steers iterations that are not used here"),
    ),
    (
        "CONTACT DAMPING",
        Ignored("damping does nothing in static steps"),
    ),
    ("CONTACT FILE", OUTPUT),
    ("CONTACT OUTPUT", OUTPUT),
    ("CONTACT PAIR", Read),
    ("CONTACT PRINT", OUTPUT),
    (
        "CONTROLS",
        Ignored("it steers iterations that are not used here"),
    ),
    ("CORRELATION LENGTH", DESIGN),
    ("COUPLED TEMPERATURE-DISPLACEMENT", HEAT),
    ("COUPLING", COUPLED),
    ("CRACK PROPAGATION", Refused("cracks do not grow here")),
    ("CREEP", NONLINEAR),
    ("CYCLIC HARDENING", NONLINEAR),
    (
        "CYCLIC SYMMETRY MODEL",
        Refused("cyclic symmetry is not supported; model the whole, or a part with *TRANSFORM"),
    ),
    ("DAMAGE EVOLUTION", NONLINEAR),
    ("DAMAGE INITIATION", NONLINEAR),
    ("DAMPING", Ignored("damping does nothing in static steps")),
    ("DASHPOT", DISCRETE),
    ("DEFORMATION PLASTICITY", NONLINEAR),
    ("DENSITY", Read),
    ("DEPVAR", NONLINEAR),
    ("DESIGN RESPONSE", DESIGN),
    ("DESIGN VARIABLES", DESIGN),
    ("DFLUX", HEAT),
    ("DISTRIBUTING", COUPLED),
    ("DISTRIBUTING COUPLING", COUPLED),
    (
        "DISTRIBUTION",
        Ignored("isotropic materials have no directions"),
    ),
    (
        "DISTRIBUTION TABLE",
        Ignored("isotropic materials have no directions"),
    ),
    ("DLOAD", Read),
    ("DSLOAD", Read),
    ("DYNAMIC", WAVES),
    ("EL FILE", Read),
    ("EL PRINT", OUTPUT),
    ("ELASTIC", Read),
    ("ELCOPY", GENERATED),
    (
        "ELECTRICAL CONDUCTIVITY",
        Ignored("it is for problems of electromagnetism"),
    ),
    ("ELECTROMAGNETICS", ELECTRIC),
    ("ELEMENT", Read),
    ("ELEMENT OUTPUT", Read),
    ("ELGEN", GENERATED),
    ("ELSET", Read),
    ("EMBEDDED ELEMENT", COUPLED),
    ("END ASSEMBLY", Read),
    ("END INSTANCE", Read),
    ("END PART", Read),
    ("END STEP", Read),
    ("ENERGY OUTPUT", OUTPUT),
    ("EQUATION", Read),
    ("EQUATIONF", FLUID),
    ("EXPANSION", Read),
    ("FACE PRINT", OUTPUT),
    ("FEASIBLE DIRECTION", DESIGN),
    ("FILM", HEAT),
    ("FILTER", DESIGN),
    ("FLUID CONSTANTS", FLUID_ONLY),
    ("FLUID SECTION", FLUID),
    ("FLUID SECTIONS", FLUID),
    ("FREQUENCY", WAVES),
    ("FRICTION", Read),
    ("GAP", Read),
    ("GAP CONDUCTANCE", HEAT_ONLY),
    ("GAP HEAT GENERATION", HEAT_ONLY),
    ("GEOMETRIC CONSTRAINT", DESIGN),
    ("GEOMETRIC TOLERANCE", DESIGN),
    (
        "GREEN",
        Refused("only static steps are solved, no Green functions"),
    ),
    ("HCF", WAVES),
    ("HEADING", Ignored("it is a title")),
    ("HEAT TRANSFER", HEAT),
    ("HYPERELASTIC", NONLINEAR),
    ("HYPERFOAM", NONLINEAR),
    (
        "IMPORT",
        Refused("states of other computations are not read"),
    ),
    (
        "IMPERFECTION",
        Refused("shapes of other computations are not read"),
    ),
    ("INCLUDE", Read),
    ("INITIAL CONDITIONS", Read),
    ("INITIAL MESH", DESIGN),
    (
        "INITIAL STRAIN INCREASE",
        Refused("initial strains are not supported"),
    ),
    ("INSTANCE", Read),
    ("KINEMATIC", COUPLED),
    ("KINEMATIC COUPLING", COUPLED),
    (
        "MAGNETIC PERMEABILITY",
        Ignored("it is for problems of electromagnetism"),
    ),
    ("MASS", DISCRETE),
    ("MASS FLOW", HEAT),
    ("MATERIAL", Read),
    (
        "MATRIX ASSEMBLE",
        Refused("matrices of other computations are not read"),
    ),
    ("MEMBRANE", SLENDER),
    ("MEMBRANE SECTION", SLENDER),
    ("MODAL DAMPING", WAVES),
    ("MODAL DYNAMIC", WAVES),
    ("MODEL CHANGE", CHANGES),
    ("MOHR COULOMB", NONLINEAR),
    ("MOHR COULOMB HARDENING", NONLINEAR),
    ("MONITOR", OUTPUT),
    ("MPC", Read),
    ("NCOPY", GENERATED),
    ("NETWORK MPC", FLUID),
    ("NFILL", GENERATED),
    ("NGEN", GENERATED),
    ("NMAP", GENERATED),
    (
        "NO ANALYSIS",
        Refused("it asks for no solution; remove it, or read the deck as a mesh only"),
    ),
    (
        "NODAL THICKNESS",
        Refused("the thickness is constant in a section"),
    ),
    ("NODE", Read),
    ("NODE FILE", Read),
    ("NODE OUTPUT", Read),
    ("NODE PRINT", Read),
    ("NO COMPRESSION", NONLINEAR),
    ("NO TENSION", NONLINEAR),
    ("NORMAL", Ignored("normals are for beams and shells")),
    ("NSET", Read),
    ("OBJECTIVE", DESIGN),
    ("ORIENTATION", Read),
    ("OUTPUT", OUTPUT),
    (
        "PARAMETER",
        RefusedMesh("parameters are not supported; write the numbers out"),
    ),
    ("PART", Read),
    (
        "PHYSICAL CONSTANTS",
        Ignored("it is for radiation, gravitation between bodies and fluids"),
    ),
    ("PLASTIC", NONLINEAR),
    (
        "PRE-TENSION SECTION",
        Refused("bolts with pre-tension are not supported"),
    ),
    ("PREPRINT", OUTPUT),
    ("PRINT", OUTPUT),
    ("RADIATE", HEAT),
    ("RANDOM FIELD", DESIGN),
    ("RATE DEPENDENT", NONLINEAR),
    ("REFINE MESH", Refused("the mesh is not refined")),
    ("RESTART", Read),
    (
        "RETAINED NODAL DOFS",
        Refused("substructures are not condensed"),
    ),
    ("RIGID BODY", COUPLED),
    ("ROBUST DESIGN", DESIGN),
    (
        "SECTION CONTROLS",
        Refused("elements with controls of their own are not supported"),
    ),
    ("SECTION PRINT", OUTPUT),
    (
        "SELECT CYCLIC SYMMETRY MODES",
        Refused("cyclic symmetry is not supported"),
    ),
    ("SENSITIVITY", DESIGN),
    ("SHELL GENERAL SECTION", SLENDER),
    ("SHELL SECTION", SLENDER),
    ("SOLID SECTION", Read),
    ("SPECIFIC GAS CONSTANT", FLUID_ONLY),
    ("SPECIFIC HEAT", HEAT_ONLY),
    ("SPRING", DISCRETE),
    ("STATIC", Read),
    ("STEADY STATE DYNAMICS", WAVES),
    ("STEP", Read),
    (
        "SUBMODEL",
        Refused("results of other computations are not read"),
    ),
    (
        "SUBSTRUCTURE GENERATE",
        Refused("substructures are not condensed"),
    ),
    (
        "SUBSTRUCTURE MATRIX OUTPUT",
        Refused("substructures are not condensed"),
    ),
    ("SURFACE", Read),
    ("SURFACE BEHAVIOR", Read),
    ("SURFACE INTERACTION", Read),
    ("SURFACE SECTION", SLENDER),
    ("SYSTEM", Read),
    ("TEMPERATURE", Read),
    ("TIE", Read),
    (
        "TIME POINTS",
        Ignored("results are written at the end of each step"),
    ),
    ("TRANSFORM", Read),
    ("TRANSFORMF", FLUID),
    ("UNCOUPLED TEMPERATURE-DISPLACEMENT", HEAT),
    ("USE REFINED MESH", Refused("the mesh is not refined")),
    (
        "USER ELEMENT",
        Refused("elements of users are not supported"),
    ),
    ("USER MATERIAL", NONLINEAR),
    (
        "USER SECTION",
        Refused("elements of users are not supported"),
    ),
    ("VALUES AT INFINITY", FLUID),
    ("VIEWFACTOR", HEAT),
    ("VISCO", Refused("creep is not supported; write *STATIC")),
    ("VISCOELASTIC", NONLINEAR),
];

/// The keyword as it is written, with blanks, and what becomes of it; `squeezed` has no blanks.
pub(super) fn verdict(squeezed: &str) -> Option<(&'static str, KeywordTreatment)> {
    static BY_NAME: OnceLock<HashMap<String, usize>> = OnceLock::new();
    let by_name = BY_NAME.get_or_init(|| {
        let names = KEYWORDS.iter().map(|(name, _)| squeeze(name));
        names.zip(0..).collect()
    });
    by_name.get(squeezed).map(|&k| KEYWORDS[k])
}

#[cfg(test)]
#[path = "../tests/keywords.rs"]
mod tests;
