//! The three scenes, mesh by mesh: a scalar problem in the plane and an elastic solid with known solutions, and a
//! contact problem.

/// One scene of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedErrorCase {
    /// −Δu = f in the plane, u known.
    Scalar,
    /// An elastic solid, u known.
    Solid,
    /// A floating elastic block on another one.
    Contact,
}

impl SpeedErrorCase {
    /// All of them.
    pub const ALL: [SpeedErrorCase; 3] = [
        SpeedErrorCase::Scalar,
        SpeedErrorCase::Solid,
        SpeedErrorCase::Contact,
    ];

    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            SpeedErrorCase::Scalar => "scalar2d",
            SpeedErrorCase::Solid => "elasticity3d",
            SpeedErrorCase::Contact => "contact",
        }
    }

    /// Title.
    pub fn title(self) -> &'static str {
        match self {
            SpeedErrorCase::Scalar => "Scalar problem in the plane, known solution",
            SpeedErrorCase::Solid => "Elastic solid, known solution",
            SpeedErrorCase::Contact => "Elastic block on a curved gap",
        }
    }

    /// Elements across a subdomain, mesh by mesh.
    pub fn meshes(self, quick: bool) -> &'static [usize] {
        match (self, quick) {
            (SpeedErrorCase::Scalar, true) => &[4, 8],
            (SpeedErrorCase::Scalar, false) => &[16, 32, 64, 128],
            (SpeedErrorCase::Solid, true) => &[2, 3],
            (SpeedErrorCase::Solid, false) => &[4, 6, 8, 12],
            (SpeedErrorCase::Contact, true) => &[4, 8],
            (SpeedErrorCase::Contact, false) => &[16, 32, 64],
        }
    }

    /// The scene with `n` elements across a subdomain.
    pub fn scene(self, n: usize) -> String {
        match self {
            SpeedErrorCase::Scalar => format!(
                "title = \"scalar2d, {n}\"\nexact = \"sin(pi*x)*sin(2*pi*y)\"\n\
                 [grid]\nbodies = [2, 2]\nsubdomains = [2, 2]\nelements_per_subdomain = {n}\n\
                 load = {{ value = \"5*pi^2*sin(pi*x)*sin(2*pi*y)\", quadrature = \"gauss\" }}\ndirichlet = \"all\"\n"
            ),
            SpeedErrorCase::Solid => {
                // u = a φ with φ = sin πx sin πy sin πz: f = μ 3π² φ a + (λ + μ) π² (φ a_i − Σ_{j≠i} a_j cos_i cos_j
                // sin_k).
                let s = ["x", "y", "z"].map(|v| format!("sin(pi*{v})"));
                let c = ["x", "y", "z"].map(|v| format!("cos(pi*{v})"));
                let a = [1.0, 0.5, -0.3];
                let (mu, lambda) = (1.0 / 2.6, 0.3 / (1.3 * 0.4));
                let phi = s.join("*");
                let force = |i: usize| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    let cross = |j: usize, k: usize| format!("({})*{}*{}*{}", a[j], c[i], c[j], s[k]);
                    format!(
                        "pi^2*({}*{phi} - {}*({} + {}))",
                        (3.0 * mu + lambda + mu) * a[i],
                        lambda + mu,
                        cross(j, k),
                        cross(k, j)
                    )
                };
                let list = |f: &dyn Fn(usize) -> String| {
                    [0, 1, 2].map(|i| format!("\"{}\"", f(i))).join(", ")
                };
                format!(
                    "title = \"elasticity3d, {n}\"\ndimension = 3\nphysics = \"elasticity\"\nexact = [{}]\n\
                     [grid]\nbodies = [2, 1, 1]\nsubdomains = [1, 2, 2]\n\
                     elements_per_subdomain = {n}\nyoung = 1\npoisson = 0.3\n\
                     load = {{ {}, quadrature = \"gauss\" }}\ndirichlet = \"all\"\n",
                    list(&|i| format!("({})*{phi}", a[i])),
                    [0, 1, 2]
                        .map(|i| format!("{} = \"{}\"", ["x", "y", "z"][i], force(i)))
                        .join(", ")
                )
            }
            SpeedErrorCase::Contact => {
                let body = |name: &str, y: usize, keys: &str| {
                    format!(
                        "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\nsize = [1, 1]\nsubdomains = [2, 2]\n\
                         elements_per_subdomain = {n}\n{keys}"
                    )
                };
                format!(
                    "title = \"contact, {n}\"\nphysics = \"elasticity\"\n{}{}\
                     [[contact]]\nbodies = [\"lower\", \"upper\"]\ngap = \"0.2*(x - 0.4)^2\"\n",
                    body("lower", 0, "dirichlet = [\"bottom\"]\n"),
                    body(
                        "upper",
                        1,
                        "dirichlet = { left = { x = 0 }, right = { x = 0 } }\nload = [0, \"-0.05*(1 + x)\"]\n"
                    )
                )
            }
        }
    }
}
