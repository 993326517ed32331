//! Rigid obstacles that are surfaces of a mesh, against the obstacles with a formula.

use super::meshes::Model;
use crate::support::session::with_session;
use crate::support::surface_mesh::{floor, line};
use fetifeti::settings::MethodSettings;
use fetifeti::solution::SolvedRow;
use fetifeti::FetiFeti;
use scene::Scene;

/// The rows of a scene's solution, by place of their nodes.
fn solve(scene: &Scene) -> Vec<SolvedRow> {
    let problem = scene.substructures(&|_| true).expect("substructures");
    let mut rows = with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-12);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("a solution");
        assert!(solution.converged(), "{:?}", solution.status);
        solution.rows().to_vec()
    });
    let key = |r: &SolvedRow| r.label.point;
    rows.sort_by(|a, b| key(a).partial_cmp(&key(b)).expect("numbers"));
    rows
}

/// A block above the plane y = 0, with an obstacle that `more` describes.
fn block(dim: usize, order: usize, more: &str) -> String {
    let list = |v: [&str; 3]| format!("[{}]", v[..dim].join(", "));
    let held = if dim == 2 {
        "left = { x = 0 }"
    } else {
        "left = { x = 0 }, back = { z = 0 }"
    };
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\norder = {order}\n[[body]]\nname = \"block\"\norigin = {}\n\
         size = {}\nelements = {}\nsubdomains = {}\nyoung = 10\ndirichlet = {{ {held} }}\n\
         traction = {{ top = {} }}\n[[obstacle]]\nbody = \"block\"\nside = \"bottom\"\ngap = \"0.01*x^2\"\n{more}\n",
        list(["0", "0.02", "0"]),
        list(["2", "1", "2"]),
        list(["8", "3", "4"]),
        list(["2", "1", "1"]),
        list(["0.1", "\"-1.5 + x\"", "0"]),
    )
}

const MESH: &str = "surface = \"die\"\nmesh = \"m.msh\"";

/// A flat side, and a plane that is cut into a few faces: to rounding, in both orders.
#[test]
fn a_flat_surface_is_the_plane() {
    for (dim, order) in [(2, 1), (2, 2), (3, 1), (3, 2)] {
        let mesh = match dim {
            2 => line("die", &[[4.0, 0.0], [1.3, 0.0], [0.7, 0.0], [-1.0, 0.0]]),
            _ => floor("die"),
        };
        let model = Model::new(&format!("flat{dim}{order}"), &mesh);
        let normal = if dim == 2 { "[0, 1]" } else { "[0, 1, 0]" };
        let point = if dim == 2 { "[0, 0]" } else { "[0, 0, 0]" };
        let plane = format!("plane = {{ point = {point}, normal = {normal} }}");
        let known = solve(&model.scene(&block(dim, order, &plane)));
        let scene = model.scene(&block(dim, order, MESH));
        assert_eq!(scene.mortar_rows().count(), known.len());
        assert_eq!(scene.plan().obstacle_rows, known.len());
        let found = solve(&scene);
        let open = known.iter().filter(|r| !r.holds()).count();
        assert!(
            open > 2 && open + 2 < known.len(),
            "{open} of {}",
            known.len()
        );
        for (a, b) in found.iter().zip(&known) {
            assert_eq!(a.label.point, b.label.point);
            assert_eq!(a.holds(), b.holds(), "{dim}, {order}");
            let away = (a.multiplier - b.multiplier)
                .abs()
                .max((a.gap - b.gap).abs());
            assert!(
                away < 1e-9,
                "{dim}, {order}: {away:e} at {:?}",
                a.label.point
            );
            assert!((a.label.area - b.label.area).abs() < 1e-12);
        }
    }
}

/// A cylinder on a plane: the pressure below the centre and the force. The rows take normals of the cylinder's side,
/// those of the plane differ by the angle at the end of the contact.
#[test]
fn a_cylinder_on_a_flat_surface_is_hertzian() {
    let model = Model::new(
        "hertz",
        &line("die", &[[2.0, 0.0], [0.31, 0.0], [-2.0, 0.0]]),
    );
    let scene = |more: &str| {
        model.scene(&format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"cylinder\"\n\
             shape = {{ half_disc = {{ radius = 1, centre = [0, 1], focus = 0.05 }} }}\nelements = [32, 16]\n\
             dirichlet = {{ top = [0, -0.004] }}\n[[obstacle]]\nbody = \"cylinder\"\nside = \"bottom\"\n{more}\n"
        ))
    };
    let of = |rows: &[SolvedRow]| {
        let force: f64 = rows.iter().map(|r| r.multiplier * r.normal()[1]).sum();
        let pressure = rows
            .iter()
            .filter_map(SolvedRow::pressure)
            .fold(0.0, f64::max);
        [force, pressure]
    };
    let known = of(&solve(&scene(
        "plane = { point = [0, 0], normal = [0, 1] }",
    )));
    let found = of(&solve(&scene(&format!("{MESH}\ndistance = 0.1"))));
    for (a, b) in found.iter().zip(known) {
        assert!((a / b - 1.0).abs() < 5e-3, "{found:?}, not {known:?}");
    }
}

/// A block on a cylinder: the surface is a polygon, and the force converges as its segments shrink.
#[test]
fn a_faceted_cylinder_converges() {
    let round = "cylinder = { centre = [1, -1], radius = 1.1 }";
    let scene = |model: &Model, more: &str| {
        model.scene(&format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"block\"\norigin = [0, 0.1]\nsize = [2, 1]\n\
             elements = [40, 12]\nyoung = 10\ndirichlet = {{ top = [0, -0.05] }}\n[[obstacle]]\nbody = \"block\"\n\
             side = \"bottom\"\n{more}\n"
        ))
    };
    let force = |rows: &[SolvedRow]| {
        rows.iter()
            .map(|r| r.multiplier * r.normal()[1])
            .sum::<f64>()
    };
    let polygon = |n: usize| {
        // From right to left, from 20° to 160°; no corner lies below the middle of the block.
        let at = |k: usize| {
            let turn = (20.0 + 140.0 * k as f64 / n as f64).to_radians();
            [1.0 + 1.1 * turn.cos(), -1.0 + 1.1 * turn.sin()]
        };
        let points: Vec<[f64; 2]> = (0..=n).map(at).collect();
        line("die", &points)
    };
    let finest = Model::new("round", &polygon(801));
    let exact = force(&solve(&scene(&finest, MESH)));
    let errors = [11, 21, 41].map(|n| {
        let model = Model::new(&format!("round{n}"), &polygon(n));
        (force(&solve(&scene(&model, MESH))) / exact - 1.0).abs()
    });
    assert!(
        errors[2] < 1e-2 && errors[0] > 4.0 * errors[2],
        "{errors:?}"
    );
    // The formula takes the normals of the cylinder.
    let known = force(&solve(&scene(&finest, round)));
    assert!((exact / known - 1.0).abs() < 0.02, "{exact}, not {known}");
}

/// Uniaxial strain: the die closes a gap of 0.02 and presses. σ = E (1 − ν)/((1 + ν)(1 − 2ν)) · δ.
#[test]
fn a_surface_moves_over_the_load_steps() {
    let model = Model::new(
        "moves",
        &line("die", &[[4.0, 0.0], [0.3, 0.0], [-1.0, 0.0]]),
    );
    let text = |more: &str| {
        format!(
            "physics = \"elasticity\"\n[steps]\ncount = 4\n[[body]]\nname = \"block\"\norigin = [0, 0.02]\n\
             size = [2, 1]\nelements = [5, 3]\nyoung = 10\npoisson = 0.3\n\
             dirichlet = {{ left = {{ x = 0 }}, right = {{ x = 0 }}, top = 0 }}\n[[obstacle]]\nbody = \"block\"\n\
             side = \"bottom\"\n{more}\n"
        )
    };
    let steps = |more: &str| {
        let scene = model.scene(&text(more));
        let gaps = (0..4).map(|k| scene.gaps(&|_| true, k).expect("a step"));
        let gaps: Vec<Vec<f64>> = gaps.collect();
        (scene, gaps)
    };
    let ways = [
        format!("{MESH}\nmove = [0.5, 0.05]\nramp = \"t\""),
        "plane = { point = [0, 0], normal = [0, 1] }\nmove = [0.5, 0.05]\nramp = \"t\"".into(),
        format!("{MESH}\ngap = -0.05\nramp = \"t\""),
    ];
    for way in ways {
        let (scene, gaps) = steps(&way);
        for (k, of_step) in gaps.iter().enumerate() {
            let expected = 0.02 - 0.05 * (k + 1) as f64 / 4.0;
            assert_eq!(of_step.len(), 6);
            assert!(
                of_step.iter().all(|g| (g - expected).abs() < 1e-14),
                "{way}: {of_step:?}"
            );
        }
        let rows = solve(&scene);
        let sigma = 10.0 * 0.7 / (1.3 * 0.4) * 0.03;
        for row in rows {
            let p = row.pressure().expect("an area");
            assert!((p - sigma).abs() < 1e-10, "{way}: {p}, not {sigma}");
        }
    }
    // What counts as touching does.
    let (_, gaps) = steps(&format!("{MESH}\nadjust = 0.021"));
    assert!(gaps[3].iter().all(|g| *g == 0.0));
    let (_, gaps) = steps(&format!("{MESH}\nadjust = 0.019"));
    assert!(gaps[3].iter().all(|g| (g - 0.02).abs() < 1e-14));
}

/// Two sides of one body that go on smoothly have one row at their common node, not two.
#[test]
fn sides_that_go_on_share_a_node() {
    let n = 4;
    let mut mesh = super::meshes::squares(1, n, 1);
    // The bottom in two groups, and the die.
    let last = (n + 1) * (n + 1);
    mesh = mesh.replacen(
        "$PhysicalNames\n3\n",
        "$PhysicalNames\n6\n1 50 \"one\"\n1 51 \"two\"\n1 52 \"die\"\n",
        1,
    );
    mesh = mesh.replacen(
        &format!("$Nodes\n{last}\n"),
        &format!(
            "$Nodes\n{}\n{} 2 -0.1 0\n{} -1 -0.1 0\n",
            last + 2,
            last + 1,
            last + 2
        ),
        1,
    );
    let start = mesh.find("$Elements\n").expect("elements") + "$Elements\n".len();
    let end = start + mesh[start..].find('\n').expect("a count");
    let count: usize = mesh[start..end].parse().expect("a number");
    let mut more = format!("{}\n", count + 5);
    for (k, tag) in [(0, 50), (1, 50), (2, 51), (3, 51)] {
        more += &format!("{} 1 2 {tag} {tag} {} {}\n", 900 + k, k + 1, k + 2);
    }
    more += &format!("904 1 2 52 52 {} {}", last + 1, last + 2);
    mesh.replace_range(start..end, &more);
    let model = Model::new("two-sides", &mesh);
    let text = "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"b0\"\n\
        dirichlet = { left = { x = 0 } }\nload = [0, -1]\n[[obstacle]]\nbody = \"b0\"\nside = [\"one\", \"two\"]\n\
        surface = \"die\"\n";
    let scene = model.scene(text);
    assert_eq!(scene.mortar_rows().count(), n + 1);
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let rows = solve(&scene);
    let force: f64 = rows.iter().map(|r| r.multiplier).sum();
    let area: f64 = rows.iter().map(|r| r.label.area).sum();
    assert!(
        (force - 1.0).abs() < 1e-9 && (area - 1.0).abs() < 1e-12,
        "{force}, {area}"
    );
}

/// One sentence for each mistake.
#[test]
fn mistakes_get_a_sentence() {
    use crate::support::surface_mesh::gmsh;
    let with = |name: &str, mesh: &str| Model::new(&format!("bad-{name}"), mesh);
    let flat = [[3.0, 0.0], [1.0, 0.0], [-1.0, 0.0]];
    let die = with("die", &line("die", &flat));
    let of = |more: &str| block(2, 1, more);
    let up = [[-1.0, 0.0], [1.0, 0.0], [3.0, 0.0]];
    with("back", &line("die", &up)).refuses(
        &of(MESH),
        "the normals of the surface point away from the body (`reverse = true`",
    );
    assert_eq!(
        with("turned", &line("die", &up))
            .scene(&of(&format!("{MESH}\nreverse = true")))
            .mortar_rows()
            .count(),
        9
    );
    let points = flat.map(|[x, y]| [x, y, 0.0]);
    let mixed = gmsh(&points, &[("die", vec![vec![0, 1], vec![2, 1]])]);
    with("mixed", &mixed).refuses(
        &of(MESH),
        "the normals of the neighbours 1 and 2 of the surface `die`",
    );
    let dots = gmsh(
        &points,
        &[("die", vec![vec![0], vec![1]]), ("wall", vec![vec![0, 1]])],
    );
    let dots = with("dots", &dots);
    dots.refuses(
        &of(MESH),
        "has cells of dimension 0 where edges were expected",
    );
    dots.refuses(
        &of("surface = \"dye\"\nmesh = \"m.msh\""),
        "has no group `dye` (groups of edges are `wall`)",
    );
    let solid = with(
        "edges",
        &gmsh(&points, &[("die", vec![vec![0, 1], vec![1, 2]])]),
    );
    solid.refuses(
        &block(3, 1, MESH),
        "has cells of dimension 1 where faces were expected",
    );
    die.refuses(&of("surface = \"die\""), "in a scene without a mesh");
    die.refuses(&of("mesh = \"m.msh\""), "`mesh` without a `surface`");
    die.refuses(
        &of(&format!("{MESH}\nnodes = [0]")),
        "`points` or `nodes` beside a `surface`",
    );
    die.refuses(
        &of(&format!(
            "{MESH}\nplane = {{ point = [0, 0], normal = [0, 1] }}"
        )),
        "a `surface` beside a `plane`",
    );
    die.refuses(
        &of(&format!("{MESH}\ndistance = 0.01")),
        "do not face each other within `distance` = 0.01",
    );
    die.refuses(
        &of(MESH).replace("\"bottom\"", "\"top\""),
        "do not face each other",
    );
    // Far behind the surface, by more than its edges.
    let deep = of(MESH).replace("origin = [0, 0.02]", "origin = [0, -5]");
    die.refuses(&deep, "an overlap of an edge at most");
    with(
        "lifted",
        &gmsh(
            &[[3.0, 0.0, 1.0], [-1.0, 0.0, 1.0]],
            &[("die", vec![vec![0, 1]])],
        ),
    )
    .refuses(&of(MESH), "has a node at z = 1 where 0 was expected");
    // The side of a body is no rigid surface.
    let body = with("side", &super::meshes::squares(2, 3, 1));
    let text = "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"b0\"\n[[body]]\nname = \"b1\"\n\
        [[obstacle]]\nbody = \"b0\"\nside = \"left\"\nsurface = \"right\"\n";
    body.refuses(text, "the rigid surface `right` is a side of body `b1`");
    // A given value beyond the surface.
    let held = of(&format!("{MESH}\nmove = [0, 0.1]"))
        .replace("dirichlet = {", "dirichlet = { bottom = { y = 0.01 }, ");
    die.refuses(&held, "beyond its obstacle (n·u ≤");
}

/// A surface that lies deep inside the body is taken for a mistake, one that `adjust` closes is not.
#[test]
fn a_surface_inside_the_body_is_refused() {
    let at = |y: f64| line("die", &[[4.0, y], [1.3, y], [-1.0, y]]);
    let deep = Model::new("deep", &at(0.42));
    deep.refuses(
        &block(2, 1, MESH),
        "side `bottom` of `block` and the rigid surface `die` overlap by 0.4",
    );
    let adjusted = deep.scene(&block(2, 1, &format!("{MESH}\nadjust = 0.41")));
    assert!(adjusted.notes.is_empty(), "{:?}", adjusted.notes);
    // Less than that is said.
    let shallow = Model::new("shallow", &at(0.26)).scene(&block(2, 1, MESH));
    let names =
        "Side `bottom` of `block` and the rigid surface `die` overlap by 2.400e-1 to begin with";
    assert!(
        shallow.notes.len() == 1 && shallow.notes[0].starts_with(names),
        "{:?}",
        shallow.notes
    );
}
