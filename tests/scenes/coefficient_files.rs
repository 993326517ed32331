//! Coefficients from files: numbers and pictures in all their forms.

use crate::support::{cells, mpi};
use cells::{bytes32, bytes64, counting, elements, paint, rho, Grid};
use mesh::BoxMesh;
use mpi::Scratch;
use png::{BitDepth, ColorType};
use scene::{BodySpec, CellGrid, Field, Load, Scene, SceneSpec, Tone};
use std::path::Path;

#[test]
fn numbers_in_all_their_formats() {
    let grid = Grid(Scratch::new("coefficients"));
    let values = counting(32);
    grid.write("c.bin", &bytes32(&values));
    assert_eq!(grid.values("{ file = \"c.bin\" }"), values);
    assert_eq!(
        grid.values("{ file = \"c.bin\", type = \"f32\", shape = [8, 4] }"),
        values
    );
    let fine: Vec<f64> = values.iter().map(|v| v + 1e-12).collect();
    grid.write("c.raw", &bytes64(&fine));
    assert_eq!(grid.values("{ file = \"c.raw\" }"), fine);
    assert_eq!(grid.values("{ file = \"c.raw\", type = \"f64\" }"), fine);
    // As f32 the same bytes are twice as many numbers.
    let message = grid.message("{ file = \"c.raw\", type = \"f32\" }");
    assert_eq!(
        message,
        "c.raw has 256 bytes where 128 (f32) were expected for 8 x 4 numbers"
    );
    let words: Vec<String> = values.iter().map(f64::to_string).collect();
    let mut text = String::from("# a comment\n\n");
    for (k, row) in words.chunks(8).enumerate() {
        text += &row.join([" ", ", ", ";", "\t"][k]);
        text += " # the end of a row\n";
    }
    for name in ["c.txt", "c.csv", "c.TXT"] {
        grid.write(name, text.as_bytes());
        assert_eq!(grid.values(&format!("{{ file = \"{name}\" }}")), values);
    }
    grid.write("c.dat", text.as_bytes());
    assert_eq!(grid.values("{ file = \"c.dat\", type = \"text\" }"), values);
    // Absolute paths are used as they are.
    let absolute = grid.0.path("c.bin");
    assert_eq!(grid.values(&format!("{{ file = \"{absolute}\" }}")), values);
}

#[test]
fn the_shape_may_be_another_than_that_of_the_elements() {
    let grid = Grid(Scratch::new("shapes"));
    // The sizes: one number for each quarter of a body, for all of it, and for columns of three cells over eight
    // elements.
    grid.write("eight.txt", b"1 2 3 4\n5 6 7 8");
    let found = grid.values("{ file = \"eight.txt\", shape = [4, 2] }");
    let place = |e: usize| (e % 8, e / 8);
    for (e, value) in found.iter().enumerate() {
        let (i, j) = place(e);
        assert_eq!(*value, (1 + i / 2 + 4 * (j / 2)) as f64);
    }
    grid.write("three.txt", b"1 2 3");
    let found = grid.values("{ file = \"three.txt\", shape = [3, 1] }");
    assert_eq!(found[..8], [1.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0]);
    assert_eq!(found[..8], found[24..]);
    // Data finer than the mesh: the cell that contains the midpoint counts; of four adjacent cells, the upper right
    // one.
    grid.write("fine.bin", &bytes32(&counting(16 * 8)));
    let found = grid.values("{ file = \"fine.bin\", shape = [16, 8] }");
    for (e, value) in found.iter().enumerate() {
        let (i, j) = place(e);
        assert_eq!(*value, (1 + 16 * (2 * j + 1) + 2 * i + 1) as f64);
    }
}

#[test]
fn solids_and_single_bodies() {
    let scratch = Scratch::new("solids");
    let path = |name: &str| scratch.path(name);
    std::fs::write(path("solid.bin"), bytes32(&counting(6 * 4 * 4))).unwrap();
    let text = "dimension = 3\n[grid]\nbodies = [3, 1, 2]\nelements = [2, 4, 2]\n\
                subdomains = [1, 2, 1]\ndirichlet = [\"left\"]\n";
    let scene = |rho: &str| Scene::load(scratch.file("s.toml", &format!("{text}rho = {rho}\n")));
    let found = rho(&scene("{ file = \"solid.bin\" }").unwrap(), [3, 1, 2]);
    assert_eq!(found, counting(96));
    // A picture is the same in all layers.
    let greys: Vec<u8> = (0..24).map(|k| 10 * k).collect();
    paint(
        &path("p.png"),
        [6, 4],
        ColorType::Grayscale,
        BitDepth::Eight,
        &greys,
    );
    let flat = scene("{ file = \"p.png\", values = [1, 256] }").unwrap();
    for (e, value) in rho(&flat, [3, 1, 2]).iter().enumerate() {
        let (i, j) = (e % 6, e / 6 % 4);
        let grey = f64::from(greys[(3 - j) * 6 + i]);
        assert!((value - 1.0 - grey).abs() < 1e-12, "{e}: {value}");
    }

    // One bent body: cells follow the numbers of elements, not coordinates. E and ν each have their file.
    std::fs::write(path("e.bin"), bytes64(&counting(12))).unwrap();
    std::fs::write(path("nu.txt"), "0.1 0.2 0.3 0.4").unwrap();
    let text =
        "physics = \"elasticity\"\n[[body]]\nshape = { annulus = { inner = 1, outer = 2 } }\n\
                elements = [4, 3]\nsubdomains = [2, 1]\n\
                dirichlet = [\"left\"]\nyoung = { file = \"e.bin\" }\n\
                poisson = { file = \"nu.txt\", shape = [4, 1] }\n";
    let scene = Scene::load(scratch.file("b.toml", text)).unwrap();
    assert_eq!(rho(&scene, [1; 3]), counting(12));
    let poisson = elements(&scene, [1; 3], |s| scene.subdomain_mesh(s).unwrap().poisson);
    assert_eq!(poisson, [0.1, 0.2, 0.3, 0.4].repeat(3));
}

#[test]
fn pictures_in_all_their_depths() {
    let grid = Grid(Scratch::new("pictures"));
    let eight = [8, 4];
    let path = grid.0.path("p.png");
    let linear = || grid.values("{ file = \"p.png\", values = [1, 256] }");
    // The top row of the picture is the last row of elements.
    let upside_down = |v: &[f64]| -> Vec<f64> { v.chunks(8).rev().flatten().copied().collect() };
    let close = |found: &[f64], wanted: &[f64]| {
        let off = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-12 * b;
        assert_eq!(found.len(), wanted.len());
        assert!(!found.iter().zip(wanted).any(off), "{found:?}\n{wanted:?}");
    };

    let greys: Vec<u8> = (0..32).map(|k| 8 * k).collect();
    let wanted: Vec<f64> = greys.iter().map(|g| 1.0 + f64::from(*g)).collect();
    let wanted = upside_down(&wanted);
    paint(&path, eight, ColorType::Grayscale, BitDepth::Eight, &greys);
    close(&linear(), &wanted);
    let three: Vec<u8> = greys.iter().flat_map(|g| [*g; 3]).collect();
    paint(&path, eight, ColorType::Rgb, BitDepth::Eight, &three);
    close(&linear(), &wanted);
    let opaque: Vec<u8> = greys.iter().flat_map(|g| [*g, 255]).collect();
    let colour = ColorType::GrayscaleAlpha;
    paint(&path, eight, colour, BitDepth::Eight, &opaque);
    close(&linear(), &wanted);

    // On a logarithmic scale equal differences of grey are equal factors.
    paint(&path, eight, ColorType::Grayscale, BitDepth::Eight, &greys);
    let found = grid.values("{ file = \"p.png\", values = [1e-3, 1e3], scale = \"log\" }");
    let wanted: Vec<f64> = greys
        .iter()
        .map(|g| 10_f64.powf(6.0 * f64::from(*g) / 255.0 - 3.0))
        .collect();
    close(&found, &upside_down(&wanted));
    // White may be the smaller value.
    let found =
        grid.values("{ file = \"p.png\", values = [9, 2], scale = \"linear\", type = \"png\" }");
    assert_eq!(found[24], 9.0);
    assert!(found[7] < 2.3 && found[7] > 2.0);

    // 16 bits, 1 bit, and a palette of greys.
    let wide: Vec<u16> = (0..32).map(|k| 2114 * k + 1).collect();
    let bytes: Vec<u8> = wide.iter().flat_map(|g| g.to_be_bytes()).collect();
    paint(
        &path,
        eight,
        ColorType::Grayscale,
        BitDepth::Sixteen,
        &bytes,
    );
    let found = grid.values("{ file = \"p.png\", values = [1, 65536] }");
    let wanted: Vec<f64> = wide.iter().map(|g| 1.0 + f64::from(*g)).collect();
    close(&found, &upside_down(&wanted));
    let bits = [0b1010_0000, 0b0000_0001, 0xff, 0];
    paint(&path, eight, ColorType::Grayscale, BitDepth::One, &bits);
    let found = grid.values("{ file = \"p.png\", values = [0.001, 1e6] }");
    for (e, value) in found.iter().enumerate() {
        let white = bits[3 - e / 8] >> (7 - e % 8) & 1 == 1;
        assert_eq!(*value, if white { 1e6 } else { 0.001 });
    }
    let index = |k: usize| [0, 1, 2, 1][k % 4];
    let indices: Vec<u8> = (0..32).map(index).collect();
    paint(&path, eight, ColorType::Indexed, BitDepth::Eight, &indices);
    close(&linear()[..4], &[1.0, 256.0, 52.0, 256.0]);
}

#[test]
fn a_program_may_hand_over_cells() {
    let mesh = BoxMesh::plane([0.0; 2], [1.0; 2], [4, 2], [2, 1]);
    let cells = |values: Vec<f64>| CellGrid::new("permeability", [4, 2, 1], values);
    let with = |rho: Field, load: Field| {
        let mut body = BodySpec::new("rock", mesh);
        body.rho = rho;
        body.load = Load::scalar(load);
        Scene::new(SceneSpec::tied("", vec![body])).map_err(|e| e.to_string())
    };
    let one = || Field::constant(1.0);
    let good = Field::Cells(cells(counting(8)).unwrap());
    let scene = with(good.clone(), one()).unwrap();
    assert_eq!(rho(&scene, [1; 3]), counting(8));
    let ranges = scene.coefficient_ranges(&|s| s == 1).unwrap();
    assert_eq!(ranges, [[3.0, 8.0]]);
    assert_eq!(
        cells(counting(7)).unwrap_err().to_string(),
        "permeability: 7 numbers where 4 x 2 were expected"
    );
    let mut values = counting(8);
    values[5] = 0.0;
    let bad = Field::Cells(cells(values).unwrap());
    assert_eq!(
        with(bad, one()).unwrap_err(),
        "body `rock`: ρ = 0 in cell (1, 1) of 4 x 2 in permeability where a positive number was expected"
    );
    assert_eq!(
        with(one(), good).unwrap_err(),
        "body `rock`: permeability gives a load, a spring or a side where only coefficients were expected"
    );
    let missing = CellGrid::picture(Path::new("no/such.png"), [1.0, 2.0], Tone::Linear);
    assert!(missing.unwrap_err().to_string().contains("no/such.png"));
}
