//! Every pair of values of the options that touch the same operators, on small scenes, on one rank and on two, against
//! the solution of the assembled problem. A run ends with the right answer, or says that it did not converge.

use std::collections::BTreeSet;

use crate::support::assembled::Assembled;
use crate::support::direct::with_options;
use crate::support::mpi::as_rank;
use crate::support::rng::Rng;
use crate::support::sample::all_cases;
use base::Result;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use parallel::exchange::sum_all;
use petsc::Session;
use scene::Scene;

/// An option that is not given.
const UNSET: &str = "";

/// The options with all their names; numbers by a few values.
const OPTIONS: [(&str, &[&str]); 16] = [
    (
        "pc_type",
        &["auto", "none", "lumped", "dirichlet", "coarse_corrected"],
    ),
    ("operators", &["auto", "explicit", "implicit"]),
    ("adaptive", &["auto", "off", "2", "30"]),
    ("adaptive_max", &[UNSET, "1"]),
    ("scaling", &["rho", "stiffness", "multiplicity", "deluxe"]),
    ("scaling_gamma", &[UNSET, "0.5"]),
    ("lifting", &["auto", "all", "vertices"]),
    (
        "projector",
        &["auto", "identity", "diagonal", "preconditioner"],
    ),
    ("primal", &["vertices", "vertices,edges", "vertices,faces"]),
    ("precision", &["double", "mixed"]),
    ("memory", &[UNSET, "1"]),
    ("recycle", &[UNSET, "20"]),
    ("ksp_type", &["cg", "gmres", "fcg"]),
    ("coarse_pc_type", &[UNSET, "lu", "cholesky", "redundant"]),
    ("gtg_pc_type", &[UNSET, "lu", "svd"]),
    ("contact_type", &["active_set", "smalbe"]),
];

/// What is asked of every run, and the distance in the energy norm up to which an answer is right: the bound of the
/// certificate.
const RTOL: &str = "1e-8";
const RIGHT: f64 = 1e-5;

const SCENES: [(&str, &str); 5] = [
    (
        "scalar, a channel of 1e4",
        "[grid]\nbodies = 2\nsubdomains = 3\nelements_per_subdomain = 4\nload = \"1 + x\"\n\
         dirichlet = [\"left\", \"bottom\"]\nrho = \"if(mod(floor(24*y), 4) == 1, 1e4, 1)\"\n",
    ),
    (
        "scalar, subdomains that share a matrix up to a factor",
        "[grid]\nbodies = 2\nsubdomains = 3\nelements_per_subdomain = 3\nload = \"1 + x\"\n\
         dirichlet = [\"left\"]\nrho = { checkerboard = [1, 1e3], by = \"subdomain\" }\n",
    ),
    (
        "elastic plane",
        "physics = \"elasticity\"\n[grid]\nbodies = 2\nsubdomains = 2\nelements_per_subdomain = 3\n\
         young = { checkerboard = [1, 50], by = \"body\" }\npoisson = 0.3\n\
         load = [\"1 + x*y\", \"sin(3*x) - y\"]\ndirichlet = [\"left\"]\n",
    ),
    (
        "elastic solid",
        "dimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [1, 2, 1]\nsubdomains = [2, 2, 2]\n\
         elements_per_subdomain = 2\nyoung = { checkerboard = [1, 7], by = \"subdomain\" }\npoisson = 0.3\n\
         load = [\"0.3*y\", -1, 0.1]\ndirichlet = [\"bottom\"]\n",
    ),
    (
        "contact",
        "physics = \"elasticity\"\n\
         [[body]]\nname = \"low\"\nsize = 1\nsubdomains = 2\nelements_per_subdomain = 3\nyoung = 1\n\
         poisson = 0.3\ndirichlet = [\"bottom\"]\n\
         [[body]]\nname = \"high\"\norigin = [0, 1]\nsize = 1\nsubdomains = 2\nelements_per_subdomain = 3\n\
         young = 10\npoisson = 0.3\ndirichlet = { left = { x = 0 } }\ntraction = { top = [0, -0.2] }\n\
         [[contact]]\nbodies = [\"low\", \"high\"]\ngap = \"0.05*x^2\"\n",
    ),
];

/// Runs, each with the number of a value for every option, so that every pair of values of two options is in one of
/// them: of some random runs the one with the most pairs that are new is taken, until no pair is left.
fn runs() -> Vec<Vec<usize>> {
    let mut rng = Rng::new(7);
    let sizes: Vec<usize> = OPTIONS.iter().map(|o| o.1.len()).collect();
    let mut left = BTreeSet::new();
    for a in 0..sizes.len() {
        for b in 0..a {
            for v in 0..sizes[a] {
                left.extend((0..sizes[b]).map(|w| (b, w, a, v)));
            }
        }
    }
    let mut out = vec![vec![0; sizes.len()]];
    let pairs = |run: &[usize]| -> Vec<(usize, usize, usize, usize)> {
        let of = |a: usize| (0..a).map(move |b| (b, a));
        let all = (0..run.len()).flat_map(of);
        all.map(|(b, a)| (b, run[b], a, run[a])).collect()
    };
    for p in pairs(&out[0]) {
        left.remove(&p);
    }
    while let Some(&(b, w, a, v)) = left.first() {
        let mut best: Option<(usize, Vec<usize>)> = None;
        for _ in 0..60 {
            let mut run: Vec<usize> = sizes.iter().map(|n| rng.below(*n)).collect();
            (run[b], run[a]) = (w, v);
            let new = pairs(&run).iter().filter(|p| left.contains(p)).count();
            if best.as_ref().is_none_or(|best| new > best.0) {
                best = Some((new, run));
            }
        }
        let Some((_, run)) = best else { continue };
        for p in pairs(&run) {
            left.remove(&p);
        }
        out.push(run);
    }
    out
}

/// The end of a run.
enum End {
    Right,
    Said(String),
    Wrong(String),
}

/// One run. Collective.
fn run(
    session: &Session,
    scene: &Scene,
    reference: &Reference,
    run: &[usize],
    more: &[(&str, &str)],
) -> Result<End> {
    let values = OPTIONS.iter().zip(run).map(|(o, &v)| (o.0, o.1[v]));
    let mut options: Vec<(&str, &str)> = values.filter(|o| o.1 != UNSET).collect();
    options.retain(|o| more.iter().all(|m| m.0 != o.0));
    options.extend(more);
    if session.size() > 1 {
        // PETSc has no factorisation of its own that spans ranks.
        let spans =
            |o: &&mut (&str, &str)| o.0 == "coarse_pc_type" && ["lu", "cholesky"].contains(&o.1);
        options
            .iter_mut()
            .filter(spans)
            .for_each(|o| o.1 = "redundant");
    }
    options.push(("ksp_rtol", RTOL));
    options.push(("ksp_max_it", "200"));
    let (ranks, rank) = (session.size(), session.rank());
    let solved: base::Result<_> = with_options(session, &options, || {
        let mine = |s: usize| s % ranks == rank;
        let problem = scene.substructures(&mine)?;
        let mut solver = FetiFeti::new(session, problem, MethodSettings::default())?;
        let solution = solver.solve()?;
        let mut sums = [0.0; 2];
        for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
            let exact: Vec<f64> = sub.dofs.iter().map(|&d| reference.at(d)).collect();
            let wrong: Vec<f64> = u.iter().zip(&exact).map(|(u, e)| u - e).collect();
            for (sum, x) in sums.iter_mut().zip([&wrong, &exact]) {
                let mut force = vec![0.0; x.len()];
                sub.k.mul(x, &mut force);
                *sum += x.iter().zip(&force).map(|(x, f)| x * f).sum::<f64>();
            }
        }
        sum_all(session.comm(), &mut sums);
        Ok((solution.status, (sums[0].max(0.0) / sums[1]).sqrt()))
    });
    Ok(match solved {
        Ok((status, far)) if status.converged() => {
            if far <= RIGHT {
                End::Right
            } else {
                End::Wrong(format!("{status}, but {far:.1e} away"))
            }
        }
        Ok((status, _)) => End::Said(status.to_string()),
        Err(error) if error.is_not_converged() => End::Said(error.to_string()),
        Err(other) => End::Wrong(other.to_string()),
    })
}

/// The solution of an assembled problem, by body dof.
struct Reference {
    dofs: Vec<u64>,
    u: Vec<f64>,
}

impl Reference {
    fn new(scene: &Scene) -> Reference {
        let problem = Assembled::of_scene(scene);
        let solved = problem.solve();
        Reference {
            dofs: problem.dofs,
            u: solved.u,
        }
    }

    fn at(&self, dof: u64) -> f64 {
        self.u[self.dofs.binary_search(&dof).expect("a body dof")]
    }
}

/// The options of a run as a user would write them.
fn written(run: &[usize], more: &[(&str, &str)]) -> String {
    let values = OPTIONS.iter().zip(run).map(|(o, &v)| (o.0, o.1[v]));
    let all = values.chain(more.iter().copied()).filter(|o| o.1 != UNSET);
    let words: Vec<String> = all.map(|(n, v)| format!("-fetifeti_{n} {v}")).collect();
    words.join(" ")
}

/// Solvers of the coarse problems that do not solve them: with any other options the answer must be refused, unless it
/// is right all the same.
const INEXACT: [(&str, &str); 3] = [
    ("coarse_pc_type", "jacobi"),
    ("coarse_pc_type", "sor"),
    ("gtg_pc_type", "jacobi"),
];

#[test]
fn all_pairs_of_options_are_right_or_say_that_they_are_not() {
    let ranks = as_rank(|session, case| {
        let runs = runs();
        let (mut right, mut said, mut wrong) = (0, 0, 0);
        // An iteration is mostly messages here: on two ranks one or two of the scenes are enough.
        let some = |k: usize| session.size() == 1 || k == 1 && all_cases() || k == 4;
        for (_, (what, text)) in SCENES.into_iter().enumerate().filter(|(k, _)| some(*k)) {
            let scene = Scene::parse("scene.toml", text)?;
            let reference = Reference::new(&scene);
            let mut judge = |chosen: &[usize], more: &[(&str, &str)]| -> Result<()> {
                match run(session, &scene, &reference, chosen, more)? {
                    End::Right => right += 1,
                    End::Said(why) => {
                        said += 1;
                        println!("{what}: {why}: {}", written(chosen, more));
                    }
                    End::Wrong(why) => {
                        wrong += 1;
                        println!("WRONG {what}: {why}: {}", written(chosen, more));
                    }
                }
                Ok(())
            };
            for (k, chosen) in runs.iter().enumerate() {
                match case {
                    "exact" => judge(chosen, &[])?,
                    _ if k % 8 == 0 => INEXACT.iter().try_for_each(|o| judge(chosen, &[*o]))?,
                    _ => {}
                }
            }
        }
        println!("RESULT {right} {said} {wrong}");
        Ok(())
    });
    for (n, case) in [(1, "exact"), (1, "inexact"), (2, "exact")] {
        let out = ranks.run(n, case);
        assert_eq!(out.code, 0, "{}", out.all());
        let line = out.stdout.lines().find_map(|l| l.split("RESULT ").nth(1));
        let counts: Vec<usize> = line
            .expect("counts")
            .split_whitespace()
            .map(|v| v.parse().expect("a count"))
            .collect();
        let [right, said, wrong] = counts[..] else {
            panic!("{counts:?}")
        };
        println!("{n} ranks, {case}: {right} right, {said} said, {wrong} wrong");
        assert_eq!(wrong, 0, "{}", out.all());
        match case {
            "exact" => assert!(20 * said <= right, "{}", out.all()),
            _ => assert!(said > 0, "{}", out.all()),
        }
    }
}
