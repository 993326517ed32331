//! The three scenes, mesh by mesh, in the format of scene files.

use super::theory::{Elastic, HertzPair};

/// One of the three problems of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HertzCase {
    /// Half a cylinder on a rigid plane, plane strain.
    Cylinder,
    /// Two half cylinders of different materials, plane strain.
    TwoCylinders,
    /// A quarter of half a ball on a rigid plane.
    Sphere,
}

/// Radius of all bodies.
const RADIUS: f64 = 1.0;
/// Young's modulus and Poisson's ratio of the lower (or only) body.
const LOWER: [f64; 2] = [1.0, 0.3];
/// Young's modulus and Poisson's ratio of the upper one of two bodies.
const UPPER: [f64; 2] = [3.0, 0.2];

impl HertzCase {
    /// All of them.
    pub const ALL: [HertzCase; 3] = [
        HertzCase::Cylinder,
        HertzCase::TwoCylinders,
        HertzCase::Sphere,
    ];

    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            HertzCase::Cylinder => "cylinder",
            HertzCase::TwoCylinders => "two_cylinders",
            HertzCase::Sphere => "sphere",
        }
    }

    /// A description, for titles.
    pub fn title(self) -> &'static str {
        match self {
            HertzCase::Cylinder => "Elastic cylinder on a rigid plane",
            HertzCase::TwoCylinders => "Two elastic cylinders",
            HertzCase::Sphere => "Elastic sphere on a rigid plane",
        }
    }

    /// The parameters of Hertz's formulas.
    pub fn pair(self) -> HertzPair {
        let body = |[young, poisson]: [f64; 2]| Elastic {
            young,
            poisson,
            radius: RADIUS,
        };
        match self {
            HertzCase::Cylinder => HertzPair::new([body(LOWER), Elastic::PLANE], false),
            HertzCase::TwoCylinders => HertzPair::new([body(LOWER), body(UPPER)], false),
            HertzCase::Sphere => HertzPair::new([body(LOWER), Elastic::PLANE], true),
        }
    }

    /// The whole force over that of the modelled part: symmetry leaves a quarter of the ball.
    pub fn share(self) -> f64 {
        match self {
            HertzCase::Sphere => 4.0,
            _ => 1.0,
        }
    }

    /// The scene with `n` elements from the axis to the rim, and from the pole to the flat side.
    pub fn scene(self, n: usize) -> String {
        let [young, poisson] = LOWER;
        let head = format!("title = \"{}, {n} elements per radius\"\n", self.title());
        match self {
            HertzCase::Cylinder => format!(
                "{head}physics = \"elasticity\"\n\
                 [[body]]\nname = \"cylinder\"\n\
                 shape = {{ half_disc = {{ radius = {RADIUS}, centre = [0, {RADIUS}], focus = 0.05 }} }}\n\
                 elements = [{}, {n}]\nsubdomains = [4, 2]\nyoung = {young}\npoisson = {poisson}\n\
                 dirichlet = {{ top = [0, -0.004] }}\n\
                 [[obstacle]]\nbody = \"cylinder\"\nside = \"bottom\"\nplane = {{ point = [0, 0], normal = [0, 1] }}\n",
                2 * n
            ),
            HertzCase::TwoCylinders => {
                let [young2, poisson2] = UPPER;
                format!(
                    "{head}physics = \"elasticity\"\n\
                     [[body]]\nname = \"lower\"\n\
                     shape = {{ half_disc = {{ radius = {RADIUS}, \
                     centre = [0, -{RADIUS}], focus = 0.05, pole = \"top\" }} }}\n\
                     elements = [{0}, {n}]\nsubdomains = [4, 2]\nyoung = {young}\n\
                     poisson = {poisson}\ndirichlet = [\"bottom\"]\n\
                     [[body]]\nname = \"upper\"\n\
                     shape = {{ half_disc = {{ radius = {RADIUS}, centre = [0, {RADIUS}], focus = 0.05 }} }}\n\
                     elements = [{0}, {n}]\nsubdomains = [4, 2]\nyoung = {young2}\npoisson = {poisson2}\n\
                     dirichlet = {{ top = [0, -0.01] }}\n\
                     [[contact]]\nbodies = [\"lower\", \"upper\"]\nsides = [\"top\", \"bottom\"]\n",
                    2 * n
                )
            }
            HertzCase::Sphere => format!(
                "{head}dimension = 3\nphysics = \"elasticity\"\n\
                 [[body]]\nname = \"ball\"\n\
                 shape = {{ quarter_ball = {{ radius = {RADIUS}, \
                 centre = [0, {RADIUS}, 0], focus = 0.05, trim = 0.7 }} }}\n\
                 elements = [{n}, {n}, {n}]\nsubdomains = [{0}, {0}, {0}]\nyoung = {young}\npoisson = {poisson}\n\
                 dirichlet = {{ left = {{ x = 0 }}, back = {{ z = 0 }}, top = [0, -0.01, 0] }}\n\
                 [[obstacle]]\nbody = \"ball\"\nside = \"bottom\"\n\
                 plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n",
                (n / 8).max(2)
            ),
        }
    }
}
