//! The example scenes with coefficients from files: their data and their solutions, which do not depend on how data are
//! read or distributed.

#[allow(dead_code)] // its main is not called here
#[path = "../../examples/make_coefficients.rs"]
mod make_coefficients;

use crate::support::checks::number;
use crate::support::sample::sample;
use crate::support::{mpi, program};
use mpi::Scratch;
use program::{fetifeti, run_fetifeti};
use scene::Scene;
use serde_json::Value;
use std::fs;

const SCENES: [&str; 5] = ["checkerboard", "channels", "inclusions", "layers", "random"];

fn path(name: &str) -> String {
    format!("../../examples/scenes/coefficients_{name}.toml")
}

fn load(name: &str) -> Scene {
    Scene::load(path(name)).unwrap()
}

/// The greys of a picture.
fn pixels(path: &str) -> (u32, Vec<u8>) {
    let mut reader = png::Decoder::new(fs::File::open(path).unwrap())
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(frame.color_type, png::ColorType::Grayscale);
    (frame.width, bytes)
}

fn floats(path: &str) -> Vec<f64> {
    let bytes = fs::read(path).unwrap();
    let number = |b: &[u8]| f64::from(f32::from_le_bytes(b.try_into().unwrap()));
    bytes.chunks(4).map(number).collect()
}

fn words(path: &str) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|l| !l.starts_with('#'));
    lines
        .flat_map(str::split_whitespace)
        .map(|w| w.parse().unwrap())
        .collect()
}

#[test]
fn the_generator_writes_the_committed_files() {
    let scratch = Scratch::new("generator");
    make_coefficients::write(&scratch.0).unwrap();
    let mut seen = 0;
    for written in scratch.files() {
        let name = written.rsplit('/').next().unwrap();
        let committed = format!("../../examples/scenes/{name}");
        assert!(fs::metadata(&committed).unwrap().len() < 200_000);
        // PNG compression and the last digit of a power may differ between machines.
        if name.ends_with(".png") {
            assert_eq!(pixels(&written), pixels(&committed), "{name}");
        } else {
            let read = if name.ends_with(".bin") {
                floats
            } else {
                words
            };
            let (a, b) = (read(&written), read(&committed));
            assert_eq!(a.len(), b.len(), "{name}");
            let off = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-4 * b;
            assert!(!a.iter().zip(&b).any(off), "{name}");
        }
        seen += 1;
    }
    assert_eq!(seen, SCENES.len());
}

#[test]
fn coefficients_range_as_the_scenes_say() {
    for (name, [low, high]) in [
        ("checkerboard", [1.0, 1e4]),
        ("channels", [1.0, 1e6]),
        ("inclusions", [1.0, 1e4]),
        ("layers", [1e-3, 1e3]),
        ("random", [1e-3, 1e3]),
    ] {
        let ranges = load(name).coefficient_ranges(&|_| true).unwrap();
        for [a, b] in ranges {
            assert!(
                low <= a * (1.0 + 1e-6) && b <= high * (1.0 + 1e-6),
                "{name}"
            );
            // Every body contains nearly the whole range: constants by body would not suffice.
            assert!(b / a > 0.5 * (high / low).sqrt(), "{name}: {a} {b}");
        }
    }
}

#[test]
fn lines_of_the_coefficient_are_none_of_the_partition() {
    for name in ["checkerboard", "channels", "inclusions", "layers"] {
        let scene = load(name);
        let inside = (0..scene.n_subdomains()).filter(|&s| {
            let rho = scene.subdomain_mesh(s).unwrap().rho;
            rho.iter().any(|v| *v != rho[0])
        });
        let inside = inside.count();
        assert!(3 * inside > scene.n_subdomains(), "{name}: {inside}");
    }
    // By subdomain: one value in each.
    let scene = load("random");
    let values: Vec<f64> = (0..scene.n_subdomains())
        .map(|s| {
            let rho = scene.subdomain_mesh(s).unwrap().rho;
            assert!(rho.iter().all(|v| *v == rho[0]));
            rho[0]
        })
        .collect();
    // Subdomain 1 of body 0 is the second entry of the first line. Subdomain 0 of body 3, which is the first body of
    // the second row, is the first entry of the fifth line.
    let listed = words("../../examples/scenes/coefficients_random.txt");
    assert_eq!([values[1], values[16 * 3]], [listed[1], listed[12 * 4]]);
    assert_eq!(values.len(), 144);
}

/// ρ-scaling uses the stiffest of a subdomain's elements around a node.
#[test]
fn weights_are_those_of_the_stiffest_element() {
    for name in ["checkerboard", "layers", "inclusions"] {
        let scene = load(name);
        for s in [0, scene.n_subdomains() / 2] {
            let (mesh, sub) = (
                scene.subdomain_mesh(s).unwrap(),
                scene.subdomain(s).unwrap(),
            );
            let mut largest = vec![0.0_f64; mesh.points.len()];
            let grid = mesh.grid().unwrap();
            for (e, place) in grid.element_places().enumerate() {
                for node in grid.element_nodes(place) {
                    largest[node] = largest[node].max(mesh.rho[e]);
                }
            }
            let c = mesh.components();
            for (k, _) in mesh.dof.iter().enumerate() {
                if let Some(d) = mesh.local_dof(k) {
                    assert_eq!(sub.rho[d as usize], largest[k / c], "{name}");
                }
            }
        }
    }
}

fn solve(ranks: usize, scene: &str, more: &[&str]) -> Value {
    let args = [&["solve", scene, "--json", "-"], more].concat();
    let out = match ranks {
        0 => fetifeti(&args),
        n => run_fetifeti(n, &args),
    };
    assert_eq!(out.code, 0, "{scene}, {ranks} ranks: {}", out.all());
    serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()))
}

#[test]
fn a_file_is_as_good_as_an_expression() {
    let scratch = Scratch::new("expression");
    let text = fs::read_to_string(path("checkerboard")).unwrap();
    let line = text.lines().find(|l| l.starts_with("rho")).unwrap();
    let said = "rho = \"if(mod(floor(16*x) + floor(16*y), 2) == 0, 1, 1e4)\"";
    let other = scratch.file("said.toml", &text.replace(line, said));
    let (read, said) = (load("checkerboard"), Scene::load(&other).unwrap());
    for s in 0..read.n_subdomains() {
        let (a, b) = (read.subdomain(s).unwrap(), said.subdomain(s).unwrap());
        assert_eq!((a.k, a.f, a.rho), (b.k, b.f, b.rho), "subdomain {s}");
    }
    let [a, b] = [&path("checkerboard"), &other].map(|scene| solve(0, scene, &[]));
    let energies = [&a, &b].map(|r| number(&r["energy"]));
    assert!(
        (energies[0] / energies[1] - 1.0).abs() < 1e-12,
        "{energies:?}"
    );
    assert_eq!(a["iterations"], b["iterations"]);
}

#[test]
fn every_scene_is_solved_with_the_same_answer_on_every_number_of_ranks() {
    for name in SCENES {
        let tight = ["-fetifeti_ksp_rtol", "1e-9"];
        let one = solve(0, &path(name), &tight);
        let counts: &[usize] = if name == "layers" { &[4] } else { &[4, 1, 2] };
        for &ranks in sample(2, counts) {
            let deal = ["block", "cyclic"][ranks / 2 % 2];
            let more = [&tight[..], &["-fetifeti_distribution", deal]].concat();
            let other = solve(ranks, &path(name), &more);
            let what = format!("{name} on {ranks} ranks");
            for key in [
                "bodies",
                "floating_bodies",
                "subdomains",
                "dofs",
                "multipliers",
            ] {
                assert_eq!(one[key], other[key], "{what}: {key}");
            }
            let energies = [&one, &other].map(|r| number(&r["energy"]));
            assert!(
                (energies[0] / energies[1] - 1.0).abs() < 1e-8,
                "{what}: {energies:?}"
            );
            assert!(number(&other["kkt"]["stationarity"]) < 1e-6, "{what}");
            assert!(number(&other["kkt"]["feasibility"]) < 1e-6, "{what}");
        }
    }
}

#[test]
fn the_plan_says_how_far_the_coefficient_ranges() {
    for (name, wanted) in [
        (
            "checkerboard",
            "ρ from 1 to 10000, inside a body by a factor of up to 10000; \
                          ../../examples/scenes/coefficients_checkerboard.txt, 16 x 16 cells\n",
        ),
        (
            "channels",
            "ρ from 1 to 1e6, inside a body by a factor of up to 1e6; \
                      ../../examples/scenes/coefficients_channels.png, 96 x 96 cells\n",
        ),
        ("inclusions", "E from 1 to "),
        (
            "layers",
            "ρ from 0.001024 to 1000, inside a body by a factor of up to 9.77e5; ",
        ),
    ] {
        let plans = [1, 3].map(|ranks| {
            let out = run_fetifeti(ranks, &["plan", &path(name)]);
            assert_eq!(out.code, 0, "{}", out.all());
            let found = out.stdout.lines().find(|l| l.starts_with("coefficient"));
            found.expect("a line").to_string() + "\n"
        });
        assert_eq!(plans[0], plans[1]);
        let start = format!("{:<22}{wanted}", "coefficient");
        assert!(plans[0].starts_with(&start), "{}", plans[0]);
    }
}

/// A missing file ends all ranks with one sentence.
#[test]
fn a_missing_file_is_bad_input() {
    let scratch = Scratch::new("missing");
    let text = fs::read_to_string(path("random")).unwrap();
    let scene = scratch.file("s.toml", &text);
    for out in [
        fetifeti(&["solve", &scene]),
        run_fetifeti(3, &["plan", &scene]),
    ] {
        assert_eq!(out.code, 2, "{}", out.all());
        let errors = out.stderr.lines().filter(|l| l.starts_with("Error: "));
        let errors: Vec<&str> = errors.collect();
        assert_eq!(errors.len(), 1, "{}", out.all());
        assert!(
            errors[0].contains("coefficients_random.txt cannot be read: No such file"),
            "{}",
            out.all()
        );
    }
}

/// A field that varies inside bodies gets a picture in addition to the other two.
#[test]
fn the_picture_shows_the_coefficient() {
    let scratch = Scratch::new("pictured");
    let width = |scene: &str, out: &str| {
        let out = scratch.path(out);
        solve(0, scene, &["--out", &out]);
        let picture = fs::File::open(format!("{out}/solution.png")).unwrap();
        let reader = png::Decoder::new(picture).read_info().unwrap();
        f64::from(reader.info().width)
    };
    let text = fs::read_to_string(path("inclusions")).unwrap();
    let line = text.lines().find(|l| l.starts_with("young")).unwrap();
    let constant = scratch.file("constant.toml", &text.replace(line, "young = 100"));
    let (two, three) = (width(&constant, "two"), width(&path("inclusions"), "three"));
    assert!((three / two - 1.5).abs() < 0.1, "{two} {three}");
}
