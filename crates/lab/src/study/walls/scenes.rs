//! Random walls of bodies, in the format of scene files. The same numbers on every machine.

use std::fmt::Write as _;

/// A family of walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFamily {
    /// Name in tables.
    pub name: &'static str,
    /// Bodies in each direction; two or three directions.
    pub bodies: &'static [usize],
    /// Whether bodies are elastic.
    pub elastic: bool,
    /// Probability of a gap between neighbours.
    pub gaps: f64,
}

/// The families of the study.
pub const FAMILIES: [WallFamily; 6] = [
    WallFamily {
        name: "scalar-4x4",
        bodies: &[4, 4],
        elastic: false,
        gaps: 0.5,
    },
    WallFamily {
        name: "scalar-7x7",
        bodies: &[7, 7],
        elastic: false,
        gaps: 0.5,
    },
    WallFamily {
        name: "scalar-7x7-open",
        bodies: &[7, 7],
        elastic: false,
        gaps: 0.8,
    },
    WallFamily {
        name: "scalar-3x3x3",
        bodies: &[3, 3, 3],
        elastic: false,
        gaps: 0.5,
    },
    WallFamily {
        name: "elastic-4x4",
        bodies: &[4, 4],
        elastic: true,
        gaps: 0.5,
    },
    WallFamily {
        name: "elastic-3x3x3",
        bodies: &[3, 3, 3],
        elastic: true,
        gaps: 0.5,
    },
];

/// Coefficients of every second body; those of the others are 1.
pub const JUMPS: [f64; 4] = [1.0, 1e2, 1e4, 1e6];

/// Bounds of the gaps. Bodies have the size 1.
const GAP: [f64; 2] = [0.08, 0.3];

/// Steele's SplitMix64: short, and good enough for scenes.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [low, high).
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.next() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }
}

/// The scene of a seed.
pub fn scene(family: &WallFamily, jump: f64, seed: usize) -> String {
    // The same loads and gaps for every jump.
    let mut random = Random(seed as u64);
    let dim = family.bodies.len();
    let (physics, coefficient) = if family.elastic {
        ("physics = \"elasticity\"\n", "young")
    } else {
        ("", "rho")
    };
    let field = |random: &mut Random| {
        format!(
            "{:.3}*({:.3} + cos({:.3}*x + {:.3})*sin({:.3}*y + {:.3}*bi + {:.3}*bj))",
            random.between(1.0, 10.0),
            random.between(-0.5, 0.8),
            random.between(0.5, 3.0),
            random.between(0.0, 6.0),
            random.between(0.5, 3.0),
            random.between(0.0, 6.0),
            random.between(0.0, 6.0),
        )
    };
    let (load, dirichlet) = if family.elastic {
        // All sides are held in their normal direction, the lid presses: no body can leave.
        let load: Vec<String> = (0..dim)
            .map(|_| format!("\"0.01*{}\"", field(&mut random)))
            .collect();
        let sides = [
            "bottom = 0, top = { y = -0.3 }, left = { x = 0 }, right = { x = 0 }",
            ", front = { z = 0 }, back = { z = 0 }",
        ];
        (format!("[{}]", load.join(", ")), sides[..dim - 1].concat())
    } else {
        (
            format!("\"{}\"", field(&mut random)),
            "bottom = 0, right = 0".to_string(),
        )
    };
    let (bodies, elements) = (family.bodies, if dim == 2 { 4 } else { 2 });
    let mut text = format!(
        "title = \"{}, jump {jump:e}, scene {seed}\"\ndimension = {dim}\n{physics}\n[grid]\nbodies = {bodies:?}\n\
         size = {bodies:?}\nsubdomains = 2\nelements_per_subdomain = {elements}\n\
         {coefficient} = {{ checkerboard = [1, {jump:e}], by = \"body\" }}\nload = {load}\n\
         dirichlet = {{ {dirichlet} }}\n\n[interface]\ndefault = \"contact\"\n",
        family.name
    );
    for (one, other) in neighbours(bodies) {
        if random.between(0.0, 1.0) < family.gaps {
            let gap = random.between(GAP[0], GAP[1]);
            let names = [one, other].map(|at| {
                let at: Vec<String> = at.iter().map(usize::to_string).collect();
                format!("\"b{}\"", at.join("_"))
            });
            write!(
                text,
                "\n[[contact]]\nbodies = [{}]\ngap = {gap:.4}\n",
                names.join(", ")
            )
            .expect("strings can be written to");
        }
    }
    text
}

/// All pairs of neighbours in a grid of bodies, by their indices.
fn neighbours(bodies: &[usize]) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut all = vec![vec![]];
    for &n in bodies {
        let longer = |at: Vec<usize>| (0..n).map(move |i| [at.clone(), vec![i]].concat());
        all = all.into_iter().flat_map(longer).collect();
    }
    let next = |at: &Vec<usize>, d: usize| {
        let mut next = at.clone();
        next[d] += 1;
        (next[d] < bodies[d]).then(|| (at.clone(), next))
    };
    let of = |at: &Vec<usize>| (0..bodies.len()).filter_map(|d| next(at, d)).collect();
    all.iter().flat_map(|at| -> Vec<_> { of(at) }).collect()
}
