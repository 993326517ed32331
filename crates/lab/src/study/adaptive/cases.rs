//! The cases: four problems with several coefficient fields, tied and in contact, in the format of scene files.

use std::path::{Path, PathBuf};

use super::fields::CoefficientField;
use base::Result;
use report::output;

/// The equations and the dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseEquations {
    /// −∇·(ρ∇u) = f in the plane.
    Scalar2d,
    /// Plane strain.
    Elastic2d,
    /// −∇·(ρ∇u) = f in space.
    Scalar3d,
    /// Elasticity in space.
    Elastic3d,
}

impl CaseEquations {
    /// All of them.
    pub const ALL: [CaseEquations; 4] = [
        CaseEquations::Scalar2d,
        CaseEquations::Elastic2d,
        CaseEquations::Scalar3d,
        CaseEquations::Elastic3d,
    ];

    fn dim(self) -> usize {
        match self {
            CaseEquations::Scalar2d | CaseEquations::Elastic2d => 2,
            CaseEquations::Scalar3d | CaseEquations::Elastic3d => 3,
        }
    }

    fn elastic(self) -> bool {
        matches!(self, CaseEquations::Elastic2d | CaseEquations::Elastic3d)
    }
}

/// One case.
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptiveCase {
    /// Its name, a word.
    pub name: String,
    /// A description.
    pub title: String,
    /// The scene; the coefficients are in the file NAME.txt beside it.
    pub text: String,
    /// The content of that file.
    pub coefficients: String,
    /// Number of bodies.
    pub bodies: usize,
}

impl AdaptiveCase {
    /// Writes the scene and its coefficients into `dir`; returns the scene file.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn write(&self, dir: &Path) -> Result<PathBuf> {
        let scene = dir.join(format!("{}.toml", self.name));
        output::write_text(&dir.join(format!("{}.txt", self.name)), &self.coefficients)?;
        output::write_text(&scene, &self.text)?;
        Ok(scene)
    }
}

/// Bodies, subdomains of a body and elements of a subdomain in one direction; bodies in contact have two rows.
#[derive(Debug, Clone, Copy)]
struct ProblemSize {
    bodies: usize,
    subdomains: usize,
    elements: usize,
}

/// The sizes of the meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meshes {
    /// The smallest possible meshes.
    Quick,
    /// Small enough for exact spectra.
    Small,
    /// Finer elements, for timing.
    Fine,
}

fn size(problem: CaseEquations, meshes: Meshes) -> ProblemSize {
    let [bodies, subdomains, elements] = match (problem, meshes) {
        (CaseEquations::Scalar2d | CaseEquations::Elastic2d, Meshes::Quick) => [2, 3, 3],
        (CaseEquations::Scalar2d | CaseEquations::Elastic2d, Meshes::Small) => [3, 4, 4],
        (CaseEquations::Scalar2d, Meshes::Fine) => [3, 4, 16],
        (CaseEquations::Elastic2d, Meshes::Fine) => [3, 4, 12],
        (_, Meshes::Quick) | (CaseEquations::Elastic3d, Meshes::Small) => [2, 2, 2],
        (CaseEquations::Scalar3d, Meshes::Small) => [2, 2, 3],
        (CaseEquations::Scalar3d, Meshes::Fine) => [2, 2, 8],
        (CaseEquations::Elastic3d, Meshes::Fine) => [2, 2, 4],
    };
    ProblemSize {
        bodies,
        subdomains,
        elements,
    }
}

/// The coefficient fields of tied bodies; the constant one is the control.
const TIED: [CoefficientField; 7] = [
    CoefficientField::Constant,
    CoefficientField::Subdomains(3.0),
    CoefficientField::Subdomains(6.0),
    CoefficientField::Elements(3.0),
    CoefficientField::Elements(6.0),
    CoefficientField::Channels,
    CoefficientField::Inclusions,
];

/// The coefficient fields of bodies in contact, in the plane.
const CONTACT: [CoefficientField; 6] = [
    CoefficientField::Constant,
    CoefficientField::Subdomains(3.0),
    CoefficientField::Subdomains(6.0),
    CoefficientField::Elements(3.0),
    CoefficientField::Channels,
    CoefficientField::Inclusions,
];

/// All cases; of the quick meshes a selection.
pub fn cases(meshes: Meshes) -> Vec<AdaptiveCase> {
    let mut out = Vec::new();
    for problem in CaseEquations::ALL {
        let tied = TIED.map(|field| (field, false));
        let contact = CONTACT.map(|field| (field, true));
        let fields = tied.into_iter().chain(contact);
        for (field, contact) in fields.filter(|f| problem.dim() == 2 || !f.1) {
            let name = name(problem, field, contact);
            if meshes != Meshes::Quick || QUICK.contains(&name.as_str()) {
                out.push(case(name, problem, field, contact, size(problem, meshes)));
            }
        }
    }
    out
}

/// The cases of the quick study.
const QUICK: [&str; 8] = [
    "scalar-2d-constant",
    "scalar-2d-subdomain-3",
    "scalar-2d-channels",
    "scalar-2d-contact-inclusions",
    "elastic-2d-element-3",
    "elastic-2d-contact-subdomain-3",
    "scalar-3d-inclusions",
    "elastic-3d-subdomain-6",
];

fn name(problem: CaseEquations, field: CoefficientField, contact: bool) -> String {
    let problem = match problem {
        CaseEquations::Scalar2d => "scalar-2d",
        CaseEquations::Elastic2d => "elastic-2d",
        CaseEquations::Scalar3d => "scalar-3d",
        CaseEquations::Elastic3d => "elastic-3d",
    };
    let contact = if contact { "contact-" } else { "" };
    format!("{problem}-{contact}{}", field.name())
}

fn case(
    name: String,
    problem: CaseEquations,
    field: CoefficientField,
    contact: bool,
    size: ProblemSize,
) -> AdaptiveCase {
    let dim = problem.dim();
    let mut bodies = [size.bodies, size.bodies, 1];
    if dim == 3 {
        bodies[2] = size.bodies;
    }
    if contact {
        bodies[1] = 2;
    }
    let across = |per_body: usize| -> [usize; 3] {
        std::array::from_fn(|k| if k < dim { bodies[k] * per_body } else { 1 })
    };
    let cells = field.cells(
        across(size.subdomains),
        across(size.subdomains * size.elements),
    );
    // Every combination of problem and field has random numbers of its own.
    let seed = name
        .bytes()
        .fold(1u64, |a, b| a.wrapping_mul(31).wrapping_add(u64::from(b)));
    let values = field.values(cells, seed);
    let list = |numbers: &[usize]| {
        let words: Vec<String> = numbers.iter().map(usize::to_string).collect();
        words.join(", ")
    };
    let (physics, key) = if problem.elastic() {
        ("elasticity", "young")
    } else {
        ("scalar", "rho")
    };
    let title = if contact {
        format!("{}, contact", field.title())
    } else {
        field.title()
    };
    let mut text = format!(
        "title = \"{name}\"\ndimension = {dim}\nphysics = \"{physics}\"\n\
         [grid]\nbodies = [{}]\nsubdomains = {}\nelements_per_subdomain = {}\n\
         {key} = {{ file = \"{name}.txt\", shape = [{}] }}\n",
        list(&bodies[..dim]),
        size.subdomains,
        size.elements,
        list(&cells[..dim]),
    );
    text += if contact {
        pressed(problem)
    } else {
        pulled(problem)
    };
    if contact {
        text += &format!("size = [1, {}]\n", 2.0 / size.bodies as f64);
        for i in 0..size.bodies {
            text += &format!("[[contact]]\nbodies = [\"b{i}_0\", \"b{i}_1\"]\n");
        }
    }
    AdaptiveCase {
        name,
        title,
        text,
        coefficients: lines(&values, cells[0]),
        bodies: bodies.iter().product(),
    }
}

/// Tied bodies: held on one side, under a load without symmetry.
fn pulled(problem: CaseEquations) -> &'static str {
    match problem {
        CaseEquations::Scalar2d => "dirichlet = [\"left\"]\nload = \"1 + x*y + sin(7*x + 5*y)\"\n",
        CaseEquations::Elastic2d => {
            "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\"]\n"
        }
        CaseEquations::Scalar3d => {
            "dirichlet = [\"left\"]\nload = \"1 + x*y + sin(7*x + 5*y - 3*z)\"\n"
        }
        CaseEquations::Elastic3d => {
            "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\", \"z - 0.3*x\"]\n"
        }
    }
}

/// Two rows of bodies in contact: the upper row is pressed onto the lower one on the left, where its load is heavier,
/// and lifted on the right.
fn pressed(problem: CaseEquations) -> &'static str {
    if problem.elastic() {
        "dirichlet = { bottom = 0, left = { x = 0 }, right = { x = 0 } }\n\
         load = [\"0.2*y\", \"if(x < 0.7, -2, 0.5)\"]\n"
    } else {
        "dirichlet = [\"bottom\"]\nload = \"if(x < 0.7, -2, 1)\"\n"
    }
}

/// The numbers as text, a line for each row of cells; read back they are the same.
fn lines(values: &[f64], columns: usize) -> String {
    let line = |row: &[f64]| {
        let words: Vec<String> = row.iter().map(|v| format!("{v:e}")).collect();
        words.join(" ") + "\n"
    };
    values.chunks(columns).map(line).collect()
}

#[cfg(test)]
#[path = "../../../tests/study/adaptive/cases.rs"]
mod tests;
