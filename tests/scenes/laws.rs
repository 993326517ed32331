//! Bodies whose law is not isotropic, beside closed forms.

use crate::support::answer::solve;
use crate::support::scene_message::check;

/// Fibres along the first axis.
const FIBRES: &str = "transverse = { young = [140, 10], poisson = [0.3, 0.4], shear = 5 }";

/// The tractions of the constant stress s a aᵀ on a box.
fn pull(a: [f64; 3], s: f64, dim: usize) -> String {
    let sides = ["left", "right", "bottom", "top", "back", "front"];
    let traction = |(k, side): (usize, &&str)| {
        let normal = [-1.0, 1.0][k % 2] * a[k / 2];
        let t: Vec<f64> = a[..dim].iter().map(|x| s * x * normal).collect();
        format!("{side} = {t:?}")
    };
    let all: Vec<String> = sides[..2 * dim].iter().enumerate().map(traction).collect();
    format!("traction = {{ {} }}\n", all.join(", "))
}

#[test]
fn a_pull_along_the_fibres_and_across_them_has_the_energy_of_its_modulus() {
    let fibre = [0.36, 0.48, 0.8];
    let across = [0.8, -0.6, 0.0];
    for (a, young) in [(fibre, 140.0), (across, 10.0)] {
        for more in ["", "element = \"p1\"\n", "order = 2\n"] {
            let text = format!(
                "dimension = 3\nphysics = \"elasticity\"\n{more}[[body]]\nsize = [2, 1, 1]\nelements = [4, 2, 2]\n\
                 subdomains = [2, 1, 1]\nmaterial = {{ {FIBRES}, axes = [{fibre:?}, {across:?}] }}\n{}",
                pull(a, 3.0, 3)
            );
            let expected = -0.5 * 2.0 * 9.0 / young;
            let found = solve(&text).energy;
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{more} {found} {expected}"
            );
        }
    }
}

#[test]
fn plane_stress_and_plane_strain_of_fibres_in_the_plane() {
    let (fibre, across) = ([0.6, 0.8, 0.0], [-0.8, 0.6, 0.0]);
    for (plane, along) in [
        ("stress", 1.0 / 140.0),
        ("strain", (1.0 - 0.3 * 0.3 / 14.0) / 140.0),
    ] {
        let text = format!(
            "physics = \"elasticity\"\nplane = \"{plane}\"\n[[body]]\nsize = [2, 1]\nelements = [6, 4]\n\
             subdomains = [2, 1]\nmaterial = {{ {FIBRES}, axes = [{:?}, {:?}] }}\n{}",
            &fibre[..2],
            &across[..2],
            pull(fibre, 3.0, 2)
        );
        let (found, expected) = (solve(&text).energy, -9.0 * along);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{plane} {found} {expected}"
        );
    }
}

#[test]
fn axes_are_turned_with_copies() {
    // A bar of wood, held at its foot and pulled sideways; its copy is turned with its load.
    let bar = "elements = [2, 2, 6]\nsubdomains = [1, 1, 2]\nsize = [1, 1, 3]\n\
               material = { orthotropic = { young = [12, 0.9, 0.5], poisson = [0.35, 0.45, 0.6], \
               shear = [0.8, 0.7, 0.05] }, axes = [[0.6, 0, 0.8], [0, 1, 0]] }\ndirichlet = [\"back\"]\n";
    let head = "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"bar\"\n";
    let one = solve(&format!("{head}{bar}load = [0, 0.1, 0]\n"));
    let two = solve(&format!(
        "{head}{bar}instances = [[0, 0, 0], {{ at = [9, 0, 0], axis = [1, 0, 0], angle = 90 }}]\n\
         [[body.only]]\ninstances = 0\nload = [0, 0.1, 0]\n[[body.only]]\ninstances = 1\nload = [0, 0, 0.1]\n"
    ));
    assert!(
        (two.energy / one.energy - 2.0).abs() < 1e-9,
        "{} {}",
        two.energy,
        one.energy
    );
    assert!(two.kinds <= one.kinds + 1, "{} {}", two.kinds, one.kinds);
}

/// The displacement of a ring whose stiffness is E_r outwards and E_t around, under a pressure inside (Lekhnitskii,
/// *Anisotropic plates*, plane stress).
fn ring(r: f64, [a, b]: [f64; 2], [er, et, nu]: [f64; 3]) -> f64 {
    let k = (et / er).sqrt();
    let c = a / b;
    let factor = c.powf(k + 1.0) / (1.0 - c.powf(2.0 * k));
    let (up, down) = ((r / b).powf(k - 1.0), (r / b).powf(-k - 1.0));
    let (radial, around) = (factor * (up - down), factor * k * (up + down));
    r * (around / et - nu / er * radial)
}

#[test]
fn a_ring_of_hoops_has_its_closed_form() {
    let (er, et, nu) = (10.0, 90.0, 0.1);
    let mut errors = Vec::new();
    for n in [6, 12] {
        let text = format!(
            "physics = \"elasticity\"\nplane = \"stress\"\n[[body]]\n\
             shape = {{ annulus = {{ inner = 1, outer = 2, from = 0, to = 90 }} }}\nelements = [{n}, {}]\n\
             subdomains = [2, 3]\nmaterial = {{ orthotropic = {{ young = [{er}, {et}, 10], \
             poisson = [{nu}, 0.2, 0.2], shear = [4, 4, 4] }}, axes = {{ cylinder = {{ centre = [0, 0] }} }} }}\n\
             pressure = {{ left = 1 }}\ndirichlet = {{ bottom = {{ y = 0 }}, top = {{ x = 0 }} }}\n",
            3 * n
        );
        let mut worst = 0.0_f64;
        for (p, c, u) in solve(&text).nodes {
            let r = p[0].hypot(p[1]);
            let exact = ring(r, [1.0, 2.0], [er, et, nu]) * p[c] / r;
            worst = worst.max((u - exact).abs());
        }
        errors.push(worst / ring(1.0, [1.0, 2.0], [er, et, nu]));
    }
    // The second order of bilinear elements.
    assert!(
        errors[1] < 6e-3 && errors[0] > 3.4 * errors[1],
        "{errors:?}"
    );
}

#[test]
fn a_law_that_does_not_fit_is_refused_in_one_sentence() {
    let body = |material: &str| {
        format!(
            "physics = \"elasticity\"\n[[body]]\nelements = 4\nsize = 1\nmaterial = {material}\n"
        )
    };
    check(
        &body("{ orthotropic = { young = [1, 1], poisson = [0, 0, 0], shear = [1, 1, 1] } }"),
        "s.toml:5: a list of 2 where three numbers along the axes of the material was expected",
    );
    check(
        &body("{ orthotropic = { young = [1, -1, 1], poisson = [0, 0, 0], shear = [1, 1, 1] } }"),
        "s.toml:5: orthotropic: young is -1, expected a positive number",
    );
    check(
        &body("{ orthotropic = { young = [1, 1, 1], poisson = [0.9, 0.9, 0.9], shear = [1, 1, 1] } }"),
        "s.toml:2: body `body0`: the law of its material: some strain has no positive energy with these constants, \
         expected one for every strain",
    );
    check(
        &body(&format!("{{ {FIBRES}, axes = [[1, 0], [2, 0]] }}")),
        "s.toml:5: two parallel vectors where those of two axes were expected",
    );
    check(
        &format!("{}young = 3\n", body(&format!("{{ {FIBRES} }}"))),
        "s.toml:6: `young` beside `material`, which has its constants",
    );
    check(
        &format!(
            "{}instances = [[0, 0], [3, 0]]\n[[body.only]]\ninstances = 1\npoisson = 0.2\n",
            body(&format!("{{ {FIBRES} }}"))
        ),
        "s.toml:9: one of `young` and `poisson` in place of `material` (both were expected)",
    );
    check(
        &format!("locking = \"bbar\"\n{}", body(&format!("{{ {FIBRES} }}"))),
        "s.toml:3: body `body0`: the law of its material: a cure of locking is given with a law that is not \
         isotropic, expected none: cures take the dilatation apart",
    );
}
