//! Faults at 1, 2 and 4 ranks: each run ends with one sentence, none hangs, and a file is whole or not there.

use std::path::Path;

use crate::support::mpi::{as_rank, mpirun, Output, Scratch};
use crate::support::program::{run_fetifeti, PATH};
use base::linalg::csr::Csr;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;

const MODEL: &str = "../../examples/scenes/model_contact.toml";
const PRESS: &str = "../../examples/scenes/press_ramp.toml";

const RANKS: [usize; 3] = [1, 2, 4];

/// The run has ended with this exit code and one sentence, which begins and goes on like this.
fn said(out: &Output, code: i32, parts: &[&str]) {
    assert_eq!(out.code, code, "{parts:?}: {}", out.all());
    let lines: Vec<&str> = out
        .stderr
        .lines()
        .filter(|l| l.starts_with("Error"))
        .collect();
    assert_eq!(lines.len(), 1, "{}", out.all());
    for part in parts {
        assert!(lines[0].contains(part), "{part}: {}", out.all());
    }
}

/// Files of results are whole: each ends as its kind does. Returns their number.
pub fn whole(dir: &str) -> usize {
    let files = std::fs::read_dir(dir).expect("a directory").flatten();
    let check = |path: &Path| {
        let bytes = std::fs::read(path).expect("a file");
        let ends = |end: &[u8]| bytes.trim_ascii_end().ends_with(end);
        let fit = match path.extension().and_then(|e| e.to_str()) {
            Some("vtu" | "pvd" | "pvtu") => ends(b"</VTKFile>"),
            Some("json") => ends(b"}"),
            Some("svg") => ends(b"</svg>"),
            Some("png") => ends(b"IEND\xaeB`\x82"),
            Some("csv") => bytes.ends_with(b"\n"),
            _ => false,
        };
        assert!(fit, "{}", path.display());
    };
    files.map(|f| check(&f.path())).count()
}

#[test]
fn what_cannot_be_written_is_named() {
    let scratch = Scratch::new("faults");
    let (file, folder) = (scratch.file("file", ""), scratch.path("folder"));
    std::fs::create_dir(&folder).expect("a directory");
    let below = format!("{file}/below");
    for ranks in RANKS {
        let solve =
            |more: &[&str]| run_fetifeti(ranks, &[&["solve", MODEL, "--quiet"], more].concat());
        said(
            &solve(&["--out", &file]),
            3,
            &[&file, "is a file, expected a directory"],
        );
        said(
            &solve(&["--json", &folder]),
            3,
            &[&folder, "is a directory, expected a file"],
        );
        for file in ["--json", "--checkpoint", "--events"] {
            // One of them stands for all on four ranks.
            if ranks < 4 || file == "--events" {
                let out = solve(&[file, "/dev/full"]);
                said(&out, 3, &["/dev/full", "No space left"]);
            }
        }
    }
    let out = run_fetifeti(2, &["solve", MODEL, "--quiet", "--out", &below]);
    said(&out, 3, &[&below]);
    // Nobody reads what it prints.
    let closed = [
        "-o",
        "pipefail",
        "-c",
        "exec 3>&1; \"$0\" \"$@\" 2>&3 | true",
        PATH,
        "solve",
        MODEL,
    ];
    let out = mpirun(1, "bash", &closed, &[]);
    let pipe = "Error: cannot write to standard output: Broken pipe (os error 32)";
    // In front of it stands what a terminal gets, which mpirun is to the program.
    let ends = out.stdout.trim().ends_with(pipe);
    assert!(out.code == 3 && ends, "{}", out.all());
}

/// A disk of 64 kB, and a directory that is mounted read-only, in a name space of their own: what a user may do without
/// being root.
#[test]
fn a_full_and_a_read_only_disk_are_named() {
    let scratch = Scratch::new("faults-disk");
    let disk = scratch.path("disk");
    std::fs::create_dir(&disk).expect("a directory");
    let run = |mount: &str, ranks: usize| {
        let script = format!(
            "mount -t tmpfs -o size=64k none {disk} || exit 99; {mount}\n\
             mpirun -n {ranks} {PATH} solve {PRESS} --quiet --out {disk}/out; code=$?\n\
             find {disk} -type f | wc -l; find {disk} -name '*.tmp' | wc -l\n\
             for file in {disk}/out/*.vtu; do tail -n 1 $file; done | sort -u; exit $code"
        );
        let args = ["--map-root-user", "--mount", "sh", "-c", &script];
        let mut unshare = crate::support::mpi::command("unshare");
        let out = unshare.args(args).output().expect("unshare starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Output {
            code: out.status.code().unwrap_or(-2),
            stdout: text(&out.stdout),
            stderr: text(&out.stderr),
            seconds: 0.0,
        }
    };
    let allowed = run("exit 0", 1);
    if allowed.code != 0 {
        println!(
            "skipped: a name space with a disk of its own is not allowed: {}",
            allowed.stderr
        );
        return;
    }
    for ranks in RANKS {
        let out = run("", ranks);
        said(&out, 3, &["cannot write", "No space left on device"]);
        let lines: Vec<&str> = out.stdout.split_whitespace().collect();
        assert!(
            lines[0] != "0" && lines[1..] == ["0", "</VTKFile>"],
            "{}",
            out.all()
        );
        let out = run(&format!("mount -o remount,ro {disk}"), ranks);
        said(&out, 3, &[&disk, "Read-only file system"]);
    }
}

#[test]
fn a_number_that_is_none_at_step_7_is_named() {
    let scratch = Scratch::new("faults-nan");
    let text = std::fs::read_to_string(PRESS).expect("the scene");
    let text = text.replacen("load = \"t\"", "load = \"sqrt(0.65 - t)\"", 1);
    let scene = scratch.file("nan.toml", &text);
    let started = as_rank(|session, _| {
        let scene = Scene::load(MODEL)?;
        let share = fetifeti::share(session, scene.n_subdomains());
        let problem = scene.substructures(&|s| share.contains(&s))?;
        let mut loads: Vec<Vec<f64>> = problem.local.iter().map(|s| s.f.clone()).collect();
        let gaps: Vec<f64> = problem.rows.iter().map(|r| r.gap).collect();
        let mut solver = FetiFeti::new(session, problem, MethodSettings::default())?;
        for step in 1..=7 {
            if step == 7 && session.rank() == session.size() - 1 {
                loads[0][3] = f64::NAN;
            }
            solver.set_loads(loads.clone(), &gaps);
            let solution = solver.solve()?;
            assert!(step < 7, "{:?}", solution.status);
        }
        Ok(())
    });
    for ranks in RANKS {
        let out = run_fetifeti(ranks, &["solve", &scene, "--quiet"]);
        said(&out, 2, &[&scene, "`load`", "is NaN at t = 0.7"]);
        said(&started.run(ranks, "steps"), 2, &["NaN"]);
    }
}

#[test]
fn a_callback_that_panics_ends_the_run() {
    let started = as_rank(|session, case| {
        let scene = Scene::load(MODEL)?;
        let share = fetifeti::share(session, scene.n_subdomains());
        let problem = scene.substructures(&|s| share.contains(&s))?;
        let mut solver = FetiFeti::new(session, problem, MethodSettings::default())?;
        let last = session.rank() == session.size() - 1;
        let mut steps = 0;
        solver.solve_from(None, &mut |_, _| {
            steps += 1;
            assert!(
                steps < 2 || (case == "one" && !last),
                "an observer's own mistake"
            );
            Ok(())
        })?;
        Ok(())
    });
    for ranks in RANKS {
        for case in ["one", "all"] {
            let out = started.run(ranks, case);
            said(&out, 3, &["an observer's own mistake"]);
        }
    }
}

/// The matrix of one subdomain has a row of zeros inside, or is zero altogether.
#[test]
fn a_singular_matrix_on_one_rank_only_is_named() {
    let started = as_rank(|session, case| {
        let scene = Scene::load(MODEL)?;
        let share = fetifeti::share(session, scene.n_subdomains());
        let mut problem = scene.substructures(&|s| share.contains(&s))?;
        if session.rank() == session.size() - 1 {
            let subdomain = &mut problem.local[0];
            let n = subdomain.f.len();
            // Nodes inside have nine neighbours.
            let row = |i: usize| subdomain.k.row(i);
            let inside = (0..n)
                .find(|&i| row(i).0.len() == 9)
                .expect("a node inside");
            let kept = |i: usize, j: usize| case == "one" && i != inside && j != inside;
            let entries = |i: usize| {
                let (columns, values) = row(i);
                let all = columns.iter().zip(values);
                all.map(move |(&j, &v)| (i as u32, j, v))
            };
            let all = (0..n).flat_map(entries);
            let all: Vec<(u32, u32, f64)> = all
                .filter(|&(i, j, _)| kept(i as usize, j as usize))
                .collect();
            subdomain.k = Csr::from_triplets(n, &all).into();
        }
        FetiFeti::new(session, problem, MethodSettings::default())?.solve()?;
        Ok(())
    });
    for ranks in RANKS {
        for case in ["one", "all"] {
            let out = started.run(ranks, case);
            said(
                &out,
                2,
                &["the matrix of subdomain", "is not positive semidefinite"],
            );
        }
    }
}

/// A row of zeros at a node that subdomains share, in one of them or in all.
#[test]
fn a_zero_row_on_an_interface_is_named() {
    let started = as_rank(|session, case| {
        let scene = Scene::load(MODEL)?;
        let share = fetifeti::share(session, scene.n_subdomains());
        let mut problem = scene.substructures(&|s| share.contains(&s))?;
        // Inside the lower left body: a side of the first subdomain, and its corner with three others.
        let (place, first_only) = match case {
            "side" => ([0.0625, 0.25, 0.0], true),
            _ => ([0.25, 0.25, 0.0], false),
        };
        for sub in &mut problem.local {
            let n = sub.f.len();
            let places = sub.coordinates.as_ref().expect("nodes have places");
            let at = (0..n).find(|&i| places[i] == place);
            let Some(at) = at.filter(|_| sub.index == 0 || !first_only) else {
                continue;
            };
            let entries = |i: usize| {
                let (columns, values) = sub.k.row(i);
                let all = columns.iter().zip(values);
                all.map(move |(&j, &v)| (i as u32, j, v))
            };
            let all = (0..n).flat_map(entries);
            let kept = all.filter(|&(i, j, _)| i as usize != at && j as usize != at);
            let kept: Vec<(u32, u32, f64)> = kept.collect();
            sub.k = Csr::from_triplets(n, &kept).into();
        }
        FetiFeti::new(session, problem, MethodSettings::default())?.solve()?;
        Ok(())
    });
    for ranks in RANKS {
        for (case, place) in [("side", "(0.0625, 0.25, 0)"), ("corner", "(0.25, 0.25, 0)")] {
            let out = started.run(ranks, case);
            let parts = [
                "in body \"left\" has a row of zeros on its interface",
                place,
            ];
            said(&out, 2, &parts);
        }
    }
}

#[test]
fn ranks_that_read_different_files_are_named() {
    let scratch = Scratch::new("faults-files");
    let text = std::fs::read_to_string(PRESS).expect("the scene");
    for rank in 0..4 {
        let own = if rank % 2 == 1 {
            text.replace("sin(pi", "cos(pi")
        } else {
            text.clone()
        };
        scratch.file(&format!("{rank}.toml"), &own);
    }
    let dir = scratch.path("");
    for ranks in [2, 4] {
        let own = format!("exec {PATH} solve {dir}$OMPI_COMM_WORLD_RANK.toml --quiet");
        let out = mpirun(ranks, "sh", &["-c", &own], &[]);
        let who = if ranks == 2 {
            "rank 1 has"
        } else {
            "rank 1, 3 has"
        };
        said(&out, 3, &["0.toml", who, "another file than rank 0"]);
    }
}

/// The factors take 240 MB, and a rank may have 600 MB in all, of which libraries take half.
#[test]
fn no_memory_in_a_factorisation_is_one_sentence() {
    let scratch = Scratch::new("faults-memory");
    let scene = scratch.file(
        "large.toml",
        "dimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [2, 1, 1]\nsubdomains = [1, 1, 1]\n\
         elements_per_subdomain = 24\nload = [-1, 0, 0]\nyoung = 1\npoisson = 0.3\ndirichlet = [\"left\"]\n\
         [[contact]]\nbodies = \"all\"\n",
    );
    for ranks in [1, 2] {
        let limited = format!(
            "ulimit -v 600000; exec {PATH} solve {scene} --quiet -fetifeti_memory_limit 100000"
        );
        let out = mpirun(
            ranks,
            "sh",
            &["-c", &limited],
            &[("RAYON_NUM_THREADS", "1")],
        );
        assert_eq!(out.code, 3, "{}", out.all());
        assert!(
            out.stderr.contains("there is no memory for another"),
            "{}",
            out.all()
        );
        assert!(!out.stderr.contains("Signal:"), "{}", out.all());
    }
}

/// No rank has a list of all subdomains: whichever rank finds the mistake, all of them say the same.
#[test]
fn wrong_numbers_of_subdomains_and_bodies_are_named() {
    let ranks = as_rank(|session, case| {
        let (size, rank) = (session.size(), session.rank());
        let text = "[grid]\nbodies = 2\nsubdomains = 2\nelements_per_subdomain = 2\nload = \"1\"\n\
                    dirichlet = [\"left\"]\n";
        let scene = Scene::parse("scene.toml", text)?;
        let mut problem = scene.substructures(&|s| s % size == rank)?;
        for sub in &mut problem.local {
            match (case, sub.index) {
                ("twice", 7) => sub.index = 4,
                ("above", 7) => sub.index = 16,
                ("body", 7) => sub.body = 4,
                _ => {}
            }
        }
        if case == "missing" {
            problem.local.retain(|sub| sub.index != 7);
        }
        FetiFeti::new(session, problem, MethodSettings::default()).map(|_| ())
    });
    let cases = [
        ("right", ""),
        (
            "twice",
            "subdomain index 4 is used twice or is not below 16",
        ),
        (
            "above",
            "subdomain index 16 is used twice or is not below 16",
        ),
        ("body", "subdomain 7 names body 4, but there are 4 bodies"),
        ("missing", "no rank holds subdomain 7"),
    ];
    for n in RANKS {
        for (case, sentence) in cases {
            let out = ranks.run(n, case);
            match sentence {
                "" => assert_eq!(out.code, 0, "{}", out.all()),
                _ => said(&out, 2, &[sentence]),
            }
        }
    }
}
