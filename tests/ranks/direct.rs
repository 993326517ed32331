//! Every example equals a direct solution of its assembled problem, on one rank and on 2 or 4, which take turns. The
//! sample leaves out the largest, and every other run on several ranks.
//!
//! The method solves with `-fetifeti_ksp_rtol 1e-12`: the default of 1e-6 gives errors of about its size. The problem
//! is assembled body by body and its equations are factored and refined in twice the working precision
//! (`tests/support/qp`). Which rows hold is guessed from the method's multipliers, which saves the direct solver its
//! search; the solution is then certified by all conditions of optimality, to 1e-11, and so is the only one.

use std::path::Path;

use crate::support::assembled::{Assembled, Place};
use crate::support::mpi::{as_rank, Scratch};
use crate::support::sample::{all_cases, of};
use base::Error;
use fetifeti::settings::{MergeKind, MethodSettings};
use fetifeti::FetiFeti;
use parallel::exchange::gather_all;
use petsc::Session;
use scene::Scene;

const RTOL: f64 = 1e-12;

/// The bound of the distance in the energy norm, relative.
const RIGHT: f64 = 1e-8;

const RANKS: [usize; 3] = [1, 2, 4];

/// So many ranks have bodies that are tied for good as one.
const MERGING: usize = 2;

/// Whether scene `k` of a folder is solved on so many ranks.
fn on(k: usize, ranks: usize) -> bool {
    let every = of(4, 2);
    ranks == 1 || k % every == ranks / 4
}

/// A million unknowns, whose direct solution takes a quarter of the time of all.
const LARGEST: &str = "speed_1024.toml";

/// The folders of examples, and a number of scenes that each of them has at least: an empty folder proves nothing.
const FOLDERS: [(&str, usize); 2] = [("gallery", 5), ("scenes", 30)];

/// The scenes of a folder of examples, by name.
fn scenes(folder: &str) -> Vec<(String, Scene)> {
    let entries = std::fs::read_dir(Path::new("../../examples").join(folder)).expect("a folder");
    let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    // The arch that falls has no solution.
    paths.retain(|p| !p.ends_with("arch_falls.toml"));
    paths.retain(|p| !p.ends_with(LARGEST) || all_cases());
    paths.sort();
    let load = |path: &std::path::PathBuf| {
        let name = path.file_stem().expect("a name").to_string_lossy().into();
        (name, Scene::load(path).expect("a scene"))
    };
    paths.iter().map(load).collect()
}

/// The method's answer: values by body dof, one for each subdomain that has it, and multipliers by row.
pub struct Answer {
    copies: Vec<(u64, f64)>,
    multipliers: Vec<f64>,
}

impl Answer {
    /// From a file of words: a count, so many dofs and values, then the multipliers.
    pub fn read(path: &str) -> Answer {
        let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let word = |b: &[u8]| u64::from_le_bytes(b.try_into().expect("eight bytes"));
        let words: Vec<u64> = bytes.chunks_exact(8).map(word).collect();
        let (n, rest) = (words[0] as usize, &words[1..]);
        let values = rest[n..].iter().map(|w| f64::from_bits(*w));
        let values: Vec<f64> = values.collect();
        Answer {
            copies: rest[..n].iter().copied().zip(values.clone()).collect(),
            multipliers: values[n..].to_vec(),
        }
    }
}

/// Solves this rank's part of a scene and writes the answer into `out`. Collective.
pub fn solve(session: &Session, name: &str, scene: &Scene, out: &str) -> base::Result<()> {
    let share = fetifeti::share(session, scene.n_subdomains());
    let problem = scene.substructures(&|s| share.contains(&s))?;
    let mut settings = MethodSettings::default().rtol(RTOL);
    if session.size() == MERGING {
        settings = settings.merge(MergeKind::Ties);
    }
    let mut solver = FetiFeti::new(session, problem, settings)?;
    let solution = solver.solve()?;
    if !solution.converged() {
        let why = format!("{name}: {}", solution.status);
        return Err(Error::not_converged(why));
    }
    let dofs = solver.problem().local.iter().flat_map(|s| &s.dofs);
    let dofs = gather_all(session.comm(), &dofs.copied().collect::<Vec<_>>()).concat();
    let values = gather_all(session.comm(), &solution.u.concat()).concat();
    let rows: Vec<f64> = solution.rows().iter().map(|r| r.multiplier).collect();
    let values = [values, gather_all(session.comm(), &rows).concat()].concat();
    if session.rank() == 0 {
        let words = [vec![dofs.len() as u64], dofs].concat();
        let values = values.iter().flat_map(|v| v.to_le_bytes());
        let words = words.iter().flat_map(|w| w.to_le_bytes());
        let bytes: Vec<u8> = words.chain(values).collect();
        std::fs::write(Path::new(out).join(name), bytes)
            .map_err(|e| Error::input(e.to_string()))?;
    }
    Ok(())
}

#[test]
fn every_example_has_the_direct_solution() {
    let ranks = as_rank(|session, case| {
        let (folder, out) = case.split_once(' ').expect("a folder and a directory");
        for (k, (name, scene)) in scenes(folder).into_iter().enumerate() {
            if on(k, session.size()) {
                solve(session, &name, &scene, out)?;
            }
        }
        Ok(())
    });
    for (folder, least) in FOLDERS {
        let scratch = RANKS.map(|n| {
            let scratch = Scratch::new(&format!("direct-{n}"));
            let out = ranks.run(n, &format!("{folder} {}", scratch.0.display()));
            assert_eq!(out.code, 0, "{}", out.all());
            println!("{folder} on {n} ranks: {:.1} s", out.seconds);
            scratch
        });
        let all = scenes(folder);
        assert!(all.len() >= least, "{} {folder}", all.len());
        for (k, (name, scene)) in all.into_iter().enumerate() {
            let runs = RANKS.iter().zip(&scratch).filter(|(n, _)| on(k, **n));
            let answers = runs.map(|(_, scratch)| Answer::read(&scratch.path(&name)));
            compare(&name, &scene, &answers.collect::<Vec<_>>());
        }
    }
}

/// The answers on several numbers of ranks, the first of them one, against the direct solution.
pub fn compare(name: &str, scene: &Scene, answers: &[Answer]) {
    let clock = std::time::Instant::now();
    let problem = Assembled::of_scene(scene);
    let qp = &problem.qp;
    let gather = |a: &Answer| {
        let copies = a.copies.iter().copied();
        problem
            .gather(copies, RIGHT)
            .unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let gathered: Vec<_> = answers.iter().map(gather).collect();
    // On one rank rows are in the order of the scene.
    assert_eq!(answers[0].multipliers.len(), problem.rows.len());
    let (mut equal, mut below) = (vec![0.0; qp.equal.len()], vec![0.0; qp.below.len()]);
    for (place, multiplier) in problem.place.iter().zip(&answers[0].multipliers) {
        match *place {
            Place::Nowhere => {}
            Place::Equal(k) => equal[k] = *multiplier,
            Place::Below(k) => below[k] = *multiplier,
        }
    }
    let direct = qp.near(&gathered[0], &equal, &below);
    let square = |v: &[f64]| {
        let mut kv = vec![0.0; v.len()];
        qp.k.mul(v, &mut kv);
        kv.iter().zip(v).map(|(a, b)| a * b).sum::<f64>().max(0.0)
    };
    let size = square(&direct.u);
    let away = gathered.iter().map(|u| {
        let wrong: Vec<f64> = u.iter().zip(&direct.u).map(|(a, b)| a - b).collect();
        (square(&wrong) / size).sqrt()
    });
    let away: Vec<f64> = away.collect();
    let list: Vec<String> = away.iter().map(|a| format!("{a:.1e}")).collect();
    println!(
        "{name}: {} unknowns, {} of {} inequalities hold, {} away, {:.1} s",
        qp.f.len(),
        direct.closed.len(),
        below.len(),
        list.join(" "),
        clock.elapsed().as_secs_f64()
    );
    assert!(away.iter().all(|a| *a <= RIGHT), "{name}: {away:?}");
}
