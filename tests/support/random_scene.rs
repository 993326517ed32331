//! Random contact scenes from a seed: grids of 2 to 6 bodies with all kinds of contact that a scene can describe.
//!
//! Bodies of higher number lie above those of lower number unless a contact reverses the order, and most scenes push
//! downwards onto a held body, so that most have a solution. The reference decides which do.

use super::assembled::{Assembled, Reference};
use super::qp::Outcome;
use super::rng::Rng;
use elements::q1::Quadrature;
use mesh::BoxMesh;
use scene::{
    BodySpec, By, ByDefault, ContactSpec, Expr, Extent, Field, Load, ObstacleSpec, PairSelector,
    Profile, Region, Scene, SceneSpec, TieSpec,
};

/// A scene and its outcome.
pub struct Case {
    pub seed: u64,
    pub scene: Scene,
    pub problem: Assembled,
    pub fate: Fate,
}

pub enum Fate {
    Solvable(Reference),
    /// A body can be pushed away without bound: the motion, by unknown.
    Unbounded(Vec<f64>),
    /// Rows that contradict each other.
    Infeasible,
}

/// The scene of a seed with its outcome; an error where the scene itself is refused (for example for prescribed values
/// that contradict a tie).
pub fn case(seed: u64) -> Result<Case, String> {
    let scene = Scene::new(spec(seed)).map_err(|e| e.to_string())?;
    let problem = Assembled::of_scene(&scene);
    let fate = match problem.outcome() {
        Outcome::Solved(solved) => Fate::Solvable(problem.reference(solved)),
        Outcome::Unbounded(z) => Fate::Unbounded(z),
        Outcome::Infeasible(_) => Fate::Infeasible,
    };
    Ok(Case {
        seed,
        scene,
        problem,
        fate,
    })
}

/// Cases by outcome, from successive seeds.
#[derive(Default)]
pub struct Collection {
    pub solvable: Vec<Case>,
    pub unbounded: Vec<Case>,
    pub infeasible: Vec<Case>,
    /// Scenes that were refused, with the reason.
    pub refused: Vec<(u64, String)>,
}

impl Collection {
    /// The first `count` solvable cases from `first_seed` on, and the unsolvable and refused ones among them. Scenes
    /// without an inequality are left out.
    pub fn new(first_seed: u64, count: usize) -> Collection {
        let mut out = Collection::default();
        for seed in first_seed.. {
            if out.solvable.len() == count {
                break;
            }
            match case(seed) {
                Ok(case) if case.problem.qp.below.is_empty() => {}
                Ok(case) => match case.fate {
                    Fate::Solvable(_) => out.solvable.push(case),
                    Fate::Unbounded(_) => out.unbounded.push(case),
                    Fate::Infeasible => out.infeasible.push(case),
                },
                Err(why) => out.refused.push((seed, why)),
            }
        }
        out
    }

    /// The fraction of scenes without a solution.
    pub fn rejected(&self) -> f64 {
        let no = self.unbounded.len() + self.infeasible.len() + self.refused.len();
        no as f64 / (no + self.solvable.len()) as f64
    }
}

fn expression(text: &str) -> Expr {
    Expr::parse(text).expect("the generator writes expressions that can be read")
}

/// A number with few digits in [low, high], for readable messages.
fn number(rng: &mut Rng, low: f64, high: f64) -> f64 {
    (rng.uniform(low, high) * 1e3).round() / 1e3
}

/// Elements and subdomains in one direction: 1 to 3 subdomains, 2 to 6 elements.
fn cut(rng: &mut Rng, subdomains: usize) -> usize {
    match subdomains {
        1 => rng.between(2, 6),
        2 => 2 * rng.between(1, 3),
        _ => 3 * rng.between(1, 2),
    }
}

/// The scene of a seed.
pub fn spec(seed: u64) -> SceneSpec {
    let rng = &mut Rng::new(seed);
    let shapes = [
        [2, 1],
        [1, 2],
        [3, 1],
        [1, 3],
        [4, 1],
        [2, 2],
        [2, 2],
        [5, 1],
        [6, 1],
        [1, 6],
        [3, 2],
        [2, 3],
    ];
    let shape = *rng.pick(&shapes);
    let mut spec = SceneSpec::tied(format!("random scene {seed}"), bodies(rng, shape));
    spec.default = *rng.pick(&[ByDefault::Contact, ByDefault::Contact, ByDefault::Free]);
    if rng.one_in(8) {
        spec.default = ByDefault::Tied;
    }
    // Whether contacts follow the order of the bodies.
    let upwards = !rng.one_in(6);
    let tame = !rng.one_in(3);
    for j in 0..shape[1] {
        for i in 0..shape[0] {
            for [a, b] in [[i + 1, j], [i, j + 1]] {
                if a < shape[0] && b < shape[1] {
                    let [low, high] = [i + j * shape[0], a + b * shape[0]];
                    face(rng, &mut spec, [low, high], upwards, tame);
                }
            }
        }
    }
    if rng.one_in(12) {
        spec.contacts.push(ContactSpec {
            sides: None,
            pair: PairSelector::All,
            extent: Extent::All,
            gap: Profile::constant(number(rng, 0.0, 0.1)),
            distance: None,
            multipliers: None,
            adjust: 0.0,
            adjusted: Vec::new(),
            opposed: None,
            law: Default::default(),
            ramp: None,
            location: base::Location::default(),
        });
    }
    obstacles(rng, &mut spec, tame);
    spec
}

/// The grid of bodies. All bodies of a column have the same width and elements, so that nodes match.
fn bodies(rng: &mut Rng, shape: [usize; 2]) -> Vec<BodySpec> {
    let direction = |rng: &mut Rng, count: usize| -> Vec<(f64, f64, usize, usize)> {
        let mut at = number(rng, -1.0, 1.0);
        (0..count)
            .map(|_| {
                let size = *rng.pick(&[1.0, 1.0, 0.5, 0.75, 2.0]);
                let subdomains = rng.between(1, 3);
                let elements = cut(rng, subdomains);
                at += size;
                (at - size, size, elements, subdomains)
            })
            .collect()
    };
    let (columns, rows) = (direction(rng, shape[0]), direction(rng, shape[1]));
    let jumps = rng.one_in(2);
    let down = !rng.one_in(6);
    let held = rng.between(0, 3);
    // Bodies that no load presses together touch without force, or need not touch at all.
    let quiet = rng.one_in(12);
    let mut out = Vec::new();
    for (j, row) in rows.iter().enumerate() {
        for (i, column) in columns.iter().enumerate() {
            let mesh = BoxMesh::plane(
                [column.0, row.0],
                [column.1, row.1],
                [column.2, row.2],
                [column.3, row.3],
            );
            let mut body = BodySpec::new(format!("b{i}_{j}"), mesh);
            body.place = [i, j, 0];
            body.rho = rho(rng, jumps);
            if !quiet || out.is_empty() {
                body.load = load(rng, &mesh, down);
            }
            // The lowest body is held, and so are a few others.
            let mut sides = Vec::new();
            if out.is_empty() && held > 0 {
                sides.push(*rng.pick(&[0, 2]));
            } else if rng.one_in(if quiet { 2 } else { 6 }) {
                sides.push(rng.below(4));
            }
            for side in sides {
                body.dirichlet[side][0] = Some(match rng.below(4) {
                    0 => Field::constant(number(rng, -0.2, 0.2)),
                    1 => Field::Expression(expression("0.1*sin(3*x + 2*y)")),
                    _ => Field::constant(0.0),
                });
            }
            out.push(body);
        }
    }
    out
}

/// 1, or far from 1: jumps up to 10⁴ between bodies, up to 100 inside them.
fn rho(rng: &mut Rng, jumps: bool) -> Field {
    if !jumps {
        return Field::constant(1.0);
    }
    let size = 10f64.powi(rng.between(0, 4) as i32);
    match rng.below(6) {
        0 => Field::Checkerboard {
            values: [size, size.max(10.0) / 10.0],
            by: By::Subdomain,
        },
        1 => Field::Expression(expression(&format!("{size}*(1 + 0.5*sin(4*x)*cos(3*y))"))),
        _ => Field::constant(size),
    }
}

/// A load: mostly downwards, or of mean value about zero.
fn load(rng: &mut Rng, mesh: &BoxMesh, down: bool) -> Load {
    let [x, y, _] = mesh.origin;
    let [w, h, _] = mesh.size;
    let mean = if down {
        -number(rng, 0.2, 2.0)
    } else {
        number(rng, -1.0, 1.0)
    };
    let swing = number(rng, 0.0, 6.0);
    let wave = |along: &str, from: f64, size: f64| {
        let text = format!("{mean} + {swing}*cos(6.283185307179586*({along} - ({from}))/{size})");
        Field::Expression(expression(&text))
    };
    let field = match rng.below(6) {
        0 | 1 => wave("y", y, h),
        2 => wave("x", x, w),
        3 => Field::Regions {
            list: vec![Region {
                x: None,
                y: Some([y, y + h / 2.0]),
                z: None,
                value: Expr::constant(2.0 * mean),
            }],
            otherwise: Expr::constant(0.0),
        },
        4 if !rng.one_in(3) => Field::constant(mean),
        4 => Field::constant(0.0),
        _ => Field::Expression(expression(&format!("{mean} + 0.5*sin(5*x + 7*y)"))),
    };
    Load {
        fields: vec![field],
        quadrature: *rng.pick(&[Quadrature::Midpoint, Quadrature::Gauss]),
    }
}

fn range(low: f64, high: f64) -> Extent {
    Extent::Range([[low, high], [0.0, 1.0]])
}

/// A gap: zero, of one sign, a table or an expression of either sign. `tame`: never negative on a whole face.
fn gap(rng: &mut Rng, tame: bool) -> Profile {
    let size = number(rng, 0.0, if tame { 0.2 } else { 0.8 });
    match rng.below(8) {
        0..=2 => Profile::constant(0.0),
        3 => Profile::constant(size),
        4 if tame => Profile::constant(size / 10.0),
        4 => Profile::constant(-size),
        5 => Profile::Table(vec![[0.2, size], [0.6, -0.1 * size], [0.9, 0.5 * size]]),
        6 => Profile::Expression(expression(&format!("{size}*abs(sin(3*x + 2*y))"))),
        _ => Profile::Expression(expression(&format!("{size}*sin(2*x + 5*y)"))),
    }
}

/// The entries for two bodies on their common face.
fn face(rng: &mut Rng, spec: &mut SceneSpec, pair: [usize; 2], upwards: bool, tame: bool) {
    let names = pair.map(|k| spec.bodies[k].name.clone());
    let (low, high) = (range(0.0, 0.4), range(0.4, 1.0));
    let tie = |spec: &mut SceneSpec, extent: Extent| {
        let [a, b] = names.clone();
        spec.ties.push(TieSpec {
            pair: PairSelector::Named(a, b),
            sides: None,
            extent,
            multipliers: None,
            adjust: 0.0,
            location: base::Location::default(),
        });
    };
    let turned = !upwards && rng.one_in(2);
    let contact = |rng: &mut Rng, spec: &mut SceneSpec, extent: Extent| {
        let [a, b] = names.clone();
        spec.contacts.push(ContactSpec {
            sides: None,
            pair: if turned {
                PairSelector::Named(b, a)
            } else {
                PairSelector::Named(a, b)
            },
            extent,
            gap: gap(rng, tame),
            distance: None,
            multipliers: None,
            adjust: 0.0,
            adjusted: Vec::new(),
            opposed: None,
            law: Default::default(),
            ramp: None,
            location: base::Location::default(),
        });
    };
    match rng.below(12) {
        0 => tie(spec, Extent::All),
        1 => tie(spec, low),
        // Tied and unilateral side by side.
        2 => {
            tie(spec, low);
            contact(rng, spec, high);
        }
        3 => contact(rng, spec, high),
        // Two gaps on one face; both hold where they meet.
        4 => {
            contact(rng, spec, low);
            contact(rng, spec, high);
        }
        5 | 6 => {} // whatever the default says
        7 => contact(rng, spec, Extent::Points(vec![[0.0, 0.0], [1.0, 0.0]])),
        _ => contact(rng, spec, Extent::All),
    }
}

/// Obstacles beside some bodies: a floor below, now and then a ceiling.
fn obstacles(rng: &mut Rng, spec: &mut SceneSpec, tame: bool) {
    for k in 0..spec.bodies.len() {
        if !rng.one_in(5) {
            continue;
        }
        let both = rng.one_in(4);
        let floor = number(rng, -0.6, if tame { -0.2 } else { 0.3 });
        let ceiling = number(rng, if tame { 0.3 } else { -0.3 }, 0.6);
        let profile = |rng: &mut Rng, value: f64| match rng.below(3) {
            0 => Profile::Expression(expression(&format!("{value} + 0.05*sin(4*x + 3*y)"))),
            1 => Profile::Table(vec![[0.0, value], [1.0, value - 0.05]]),
            _ => Profile::constant(value),
        };
        let below = Some(profile(rng, floor)).filter(|_| both || !rng.one_in(4));
        let above = (both || below.is_none()).then(|| profile(rng, ceiling));
        spec.obstacles.push(ObstacleSpec {
            body: Some(spec.bodies[k].name.clone()),
            sides: if rng.one_in(4) {
                vec![0, 1, 2, 3]
            } else {
                vec![rng.below(4)]
            },
            extent: if rng.one_in(3) {
                range(0.25, 0.8)
            } else {
                Extent::All
            },
            below,
            above,
            rigid: None,
            surface: None,
            motion: [0.0; 3],
            distance: None,
            adjust: 0.0,
            area: None,
            gap: Profile::constant(0.0),
            law: Default::default(),
            ramp: None,
            location: base::Location::default(),
        });
    }
}
