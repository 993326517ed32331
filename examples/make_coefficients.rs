//! Writes the data files of the scenes `examples/scenes/coefficients_*`.
//!
//!     cargo run --release --example make_coefficients [DIRECTORY]
//!
//! The files are committed. This program documents their content, and can write others for other parameters. Every run
//! writes the same files: the program has its own random number generator.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs::File;
use std::io::{BufWriter, Error, Result};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let directory = std::env::args_os().nth(1);
    let directory = directory.map_or_else(|| PathBuf::from("examples/scenes"), PathBuf::from);
    match write(&directory) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!(
                "Error: the files cannot be written into {}: {e}",
                directory.display()
            );
            ExitCode::from(3)
        }
    }
}

/// All files.
pub fn write(directory: &Path) -> Result<()> {
    let file = |name: &str| directory.join(format!("coefficients_{name}"));
    let text = text(
        "16 x 16 squares, 1 and 10^4 in turns; the lowest row first",
        16,
        &checkerboard(),
    );
    std::fs::write(file("checkerboard.txt"), text)?;
    picture(&file("channels.png"), 96, &channels())?;
    picture(&file("inclusions.png"), 80, &inclusions())?;
    std::fs::write(file("layers.bin"), layers())?;
    let text = self::text(
        "random numbers from 10^-3 to 10^3, equally distributed in the logarithm; the lowest row first",
        12,
        &by_subdomain(),
    );
    std::fs::write(file("random.txt"), text)
}

/// Rows of numbers.
fn text(comment: &str, width: usize, values: &[f64]) -> String {
    let mut out = format!("# {comment}\n");
    for row in values.chunks(width) {
        let row: Vec<String> = row.iter().map(|v| format!("{v:.4e}")).collect();
        let _ = writeln!(out, "{}", row.join(" "));
    }
    out
}

/// A square PNG picture of 8-bit greys, the top row first.
fn picture(path: &Path, side: u32, greys: &[u8]) -> Result<()> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(Error::other)?;
    writer.write_image_data(greys).map_err(Error::other)?;
    writer.finish().map_err(Error::other)
}

fn checkerboard() -> Vec<f64> {
    let squares = (0..16).flat_map(|j| (0..16).map(move |i| (i + j) % 2));
    squares.map(|k| [1.0, 1e4][k]).collect()
}

/// White channels on black: three that wind from left to right and one that crosses them.
fn channels() -> Vec<u8> {
    // Height in the middle, amplitude, waves, phase, half the width.
    let along = [
        [0.17, 0.06, 1.3, 0.1, 0.022],
        [0.48, 0.09, 0.9, 0.6, 0.028],
        [0.80, 0.05, 1.7, 0.3, 0.020],
    ];
    let across = [0.63, 0.07, 1.1, 0.4, 0.018];
    let inside = |[middle, amplitude, waves, phase, half]: [f64; 5], s: f64, t: f64| {
        (t - middle - amplitude * (TAU * (waves * s + phase)).sin()).abs() < half
    };
    pixels(96, |x, y| {
        let white = along.iter().any(|c| inside(*c, x, y)) || inside(across, y, x);
        255 * u8::from(white)
    })
}

/// Discs of random position, size and grey on black; later ones cover earlier ones.
fn inclusions() -> Vec<u8> {
    let mut random = Random(2);
    let discs: Vec<([f64; 2], f64, u8)> = (0..34)
        .map(|_| {
            let centre = [random.uniform(), random.uniform()];
            let radius = 0.025 + 0.05 * random.uniform();
            (centre, radius, 128 + (127.99 * random.uniform()) as u8)
        })
        .collect();
    pixels(80, |x, y| {
        let disc = discs
            .iter()
            .rev()
            .find(|(c, r, _)| (x - c[0]).powi(2) + (y - c[1]).powi(2) < r * r);
        disc.map_or(0, |d| d.2)
    })
}

/// The greys of a picture of the unit square, from the top.
fn pixels(side: usize, grey: impl Fn(f64, f64) -> u8) -> Vec<u8> {
    let at = |k: usize| (k as f64 + 0.5) / side as f64;
    let rows = (0..side).rev();
    let place = |j| (0..side).map(move |i| (i, j));
    rows.flat_map(place)
        .map(|(i, j)| grey(at(i), at(j)))
        .collect()
}

/// Permeabilities in the manner of the tenth SPE comparative solution project, 24 x 24 x 12 cells, as f32: six layers
/// of two cells. The upper three layers are smooth, each with its own level; the lower three are tight rock with
/// channels of sand.
fn layers() -> Vec<u8> {
    let mut random = Random(10);
    let mut out = Vec::new();
    for layer in 0..6 {
        let field = Waves::new(&mut random);
        let level = 2.0 * random.uniform() - 1.0;
        let bends: Vec<[f64; 3]> = (0..3)
            .map(|k| {
                let middle = (k as f64 + 0.2 + 0.6 * random.uniform()) / 3.0;
                [middle, 0.06 + 0.06 * random.uniform(), random.uniform()]
            })
            .collect();
        for _ in 0..2 {
            for (i, j) in (0..24).flat_map(|j| (0..24).map(move |i| (i, j))) {
                let [x, y] = [i, j].map(|k| (f64::from(k) + 0.5) / 24.0);
                let smooth = field.at(x, y) + 0.3 * random.normal();
                let sand = bends
                    .iter()
                    .any(|[m, a, p]| (y - m - a * (TAU * (1.5 * x + p)).sin()).abs() < 0.05);
                let log = match (layer < 3, sand) {
                    (true, true) => 2.0 + 0.4 * smooth,
                    (true, false) => -2.0 + 0.4 * smooth,
                    (false, _) => level + 0.8 * smooth,
                };
                let value = 10_f64.powf(log.clamp(-3.0, 3.0));
                out.extend((value as f32).to_le_bytes());
            }
        }
    }
    out
}

/// One number for each of 12 x 12 subdomains.
fn by_subdomain() -> Vec<f64> {
    let mut random = Random(10);
    let exponents = (0..144).map(|_| 6.0 * random.uniform() - 3.0);
    exponents.map(|e| 10_f64.powf(e)).collect()
}

/// A smooth random function of mean 0 and variance 1: waves of random direction, length and phase.
struct Waves(Vec<[f64; 3]>);

impl Waves {
    fn new(random: &mut Random) -> Waves {
        let wave = |_| [random.normal(), random.normal(), random.uniform()];
        Waves((0..24).map(wave).collect())
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        let waves = self.0.iter();
        let sum: f64 = waves
            .map(|[kx, ky, phase]| (TAU * (kx * x + ky * y + phase)).cos())
            .sum();
        sum * (2.0 / self.0.len() as f64).sqrt()
    }
}

/// A linear congruential generator (Knuth's multiplier); only the upper bits are used.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Nearly normal, of mean 0 and variance 1: a sum of twelve uniform numbers.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
