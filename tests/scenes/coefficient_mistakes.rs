//! Coefficients from files: each mistake gets one sentence.

use crate::support::{cells, mpi};
use cells::{bytes32, bytes64, counting, paint, Grid};
use mpi::Scratch;
use png::{BitDepth, ColorType};
use scene::Scene;

#[test]
fn mistakes_in_numbers() {
    let grid = Grid(Scratch::new("mistakes"));
    grid.refuses(
        "{ file = \"none.bin\" }",
        "none.bin cannot be read: No such file or directory (os error 2)",
    );
    grid.refuses(
        "{ file = \".\" }",
        ". is no file, where one with coefficients was expected",
    );
    grid.refuses(
        "{ file = 3 }",
        "the number 3 where the name of a file was expected",
    );
    grid.write("short.bin", &bytes32(&counting(31)));
    grid.refuses(
        "{ file = \"short.bin\" }",
        "short.bin has 124 bytes where 128 (f32) or 256 (f64) were expected for 8 x 4 numbers",
    );
    grid.refuses(
        "{ file = \"short.bin\", type = \"f64\", shape = [31, 1] }",
        "short.bin has 124 bytes where 248 (f64) were expected for 31 x 1 numbers",
    );
    grid.refuses(
        "{ file = \"short.bin\", shape = [31, 1, 1] }",
        "a list of 3 where a pair of positive whole numbers was expected \
         (`dimension = 3` at the top makes the scene solid)",
    );
    grid.refuses(
        "{ file = \"short.bin\", shape = [0, 1] }",
        "the number 0 where a positive whole number was expected",
    );
    grid.write("empty.bin", b"");
    assert!(grid
        .message("{ file = \"empty.bin\" }")
        .starts_with("empty.bin has 0 bytes where 128"));
    grid.write("short.txt", b"1 2 3\n4");
    grid.refuses(
        "{ file = \"short.txt\" }",
        "short.txt: 4 numbers where 8 x 4 were expected",
    );
    grid.write("word.txt", b"1 2\n3 four # five\n");
    grid.refuses(
        "{ file = \"word.txt\" }",
        "word.txt:2: \"four\" where a number was expected",
    );
    grid.write("binary.txt", &[0xff, 0xfe, 1, 2]);
    assert!(grid
        .message("{ file = \"binary.txt\" }")
        .starts_with("binary.txt cannot be read as text: "));
    grid.refuses(
        "{ file = \"short.bin\", type = \"f16\" }",
        "the text \"f16\" where \"png\", \"text\", \"f32\" or \"f64\" was expected",
    );
    grid.refuses(
        "{ file = \"short.bin\", values = [1, 2] }",
        "`values` for a file of numbers, where only a picture (`*.png`) has greys",
    );
    assert!(grid
        .message("{ file = \"short.txt\", shape = [2, 2], value = 1 }")
        .starts_with("unknown key `value` in this table (known keys are file, type, "));
    // Only coefficients may come from files.
    let text = Grid::text("1") + "load = { file = \"short.txt\", shape = [2, 2] }\n";
    let error = Scene::parse("s.toml", &text).unwrap_err();
    assert_eq!(
        error.to_string(),
        "s.toml:7: a `file`, which only `rho`, `young` and `poisson` take"
    );
}

#[test]
fn values_that_are_no_coefficients() {
    let grid = Grid(Scratch::new("values"));
    for (value, named) in [
        (0.0, "0"),
        (-1.5, "-1.5"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
    ] {
        let mut values = counting(32);
        values[13] = value;
        values[30] = value;
        let expected = |file: &str| {
            format!("ρ = {named} in cell (5, 1) of 8 x 4 in {file} where a positive number was expected")
        };
        grid.write("bad.f32", &bytes32(&values));
        grid.refuses("{ file = \"bad.f32\" }", &expected("bad.f32"));
        grid.write("bad.f64", &bytes64(&values));
        grid.refuses("{ file = \"bad.f64\" }", &expected("bad.f64"));
        let words: Vec<String> = values.iter().map(f64::to_string).collect();
        grid.write("bad.txt", words.join(" ").as_bytes());
        grid.refuses("{ file = \"bad.txt\" }", &expected("bad.txt"));
    }
    // In space, and for ν.
    let scratch = Scratch::new("ratios");
    let mut values = vec![0.25; 8];
    values[6] = 0.5;
    std::fs::write(scratch.path("nu.bin"), bytes64(&values)).unwrap();
    let text = "dimension = 3\nphysics = \"elasticity\"\n\
                [[body]]\nname = \"a\"\nsize = 1\nelements = 2\npoisson = { file = \"nu.bin\" }\n";
    let error = Scene::load(scratch.file("s.toml", text)).unwrap_err();
    let directory = format!("{}/", scratch.0.display());
    assert_eq!(
        error.to_string().replace(&directory, ""),
        "s.toml:3: body `a`: ν = 0.5 in cell (0, 1, 1) of 2 x 2 x 2 \
         in nu.bin where a number above -1 and below 1/2 was expected"
    );
}

#[test]
fn mistakes_in_pictures() {
    let grid = Grid(Scratch::new("pixels"));
    let path = grid.0.path("p.png");
    let form = "{ file = \"p.png\", values = [1, 2] }";
    grid.write("p.png", b"no picture");
    assert!(grid
        .message(form)
        .starts_with("p.png is no PNG picture that can be read: "));
    let mut colours = vec![7; 3 * 6];
    colours[3 * 4] = 9;
    paint(&path, [3, 2], ColorType::Rgb, BitDepth::Eight, &colours);
    grid.refuses(
        form,
        "p.png: the pixel (1, 1) has the colour (9, 7, 7) where grey was expected",
    );
    paint(&path, [2, 1], ColorType::Indexed, BitDepth::Eight, &[1, 3]);
    grid.refuses(
        form,
        "p.png: the pixel (1, 0) has the colour (9, 0, 0) where grey was expected",
    );
    let glass = [7, 7, 7, 255, 7, 7, 7, 254];
    paint(&path, [2, 1], ColorType::Rgba, BitDepth::Eight, &glass);
    grid.refuses(
        form,
        "p.png: the pixel (1, 0) is transparent where an opaque one was expected",
    );
    paint(
        &path,
        [2, 1],
        ColorType::Grayscale,
        BitDepth::Eight,
        &[0, 255],
    );
    grid.refuses(
        "{ file = \"p.png\" }",
        "this table has no `values` (a pair of values, for black and for white was expected)",
    );
    grid.refuses(
        "{ file = \"p.png\", values = 1 }",
        "the number 1 where a pair of values, for black and for white was expected",
    );
    grid.refuses(
        "{ file = \"p.png\", values = [0, 1], scale = \"log\" }",
        "p.png: the values 0 and 1 where positive numbers were expected for a logarithmic scale",
    );
    grid.refuses(
        "{ file = \"p.png\", values = [1, 2], scale = \"cubic\" }",
        "the text \"cubic\" where \"linear\" or \"log\" was expected",
    );
    grid.refuses(
        "{ file = \"p.png\", values = [1, 2], shape = [2, 1] }",
        "`shape` for a picture, which has as many cells as pixels",
    );
    grid.refuses(
        "{ file = \"p.png\", values = [1, 0] }",
        "ρ = 0 in the pixel (1, 0) of 2 x 1 in p.png where a positive number was expected",
    );
    // A picture cut off in the middle.
    let greys: Vec<u8> = (0..=255).cycle().take(64 * 64).collect();
    paint(
        &path,
        [64, 64],
        ColorType::Grayscale,
        BitDepth::Eight,
        &greys,
    );
    let whole = std::fs::read(&path).unwrap();
    grid.scene(form).unwrap();
    for cut in [10, 30, 50, whole.len() / 2] {
        grid.write("p.png", &whole[..cut]);
        let message = grid.message(form);
        assert!(
            message.starts_with("p.png is no PNG picture that can be read: "),
            "{message}"
        );
    }
    // A header that promises more pixels than anyone has.
    let mut huge = whole;
    huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    grid.write("p.png", &huge);
    assert!(grid.message(form).starts_with("p.png is "));
}

#[test]
fn a_file_that_changes_under_way_is_noticed() {
    let grid = Grid(Scratch::new("changes"));
    grid.write("c.bin", &bytes32(&counting(32)));
    let scene = grid.scene("{ file = \"c.bin\" }").unwrap();
    let mut values = counting(32);
    values[0] = -4.0;
    grid.write("c.bin", &bytes32(&values));
    let message = scene.subdomain_mesh(0).unwrap_err().to_string();
    assert!(message.contains("ρ = -4 at "), "{message}");
    grid.write("c.bin", &bytes32(&values[..3]));
    let message = scene.subdomain_mesh(3).unwrap_err().to_string();
    assert!(
        message.contains("c.bin cannot be read any more"),
        "{message}"
    );
    std::fs::remove_file(grid.0.path("c.bin")).unwrap();
    let message = scene.subdomain_mesh(0).unwrap_err().to_string();
    assert!(message.contains("c.bin cannot be read: "), "{message}");
}
