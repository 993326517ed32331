//! Material images: the grey values of PNG pictures as coefficients.

use super::numbers;
use base::{Error, Result};
use png::{ColorType, Decoder, DecodingError, Limits, Transformations};
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

/// The interpolation between the values of black and white.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// The value is linear in the grey.
    #[default]
    Linear,
    /// The logarithm of the value is linear in the grey.
    Log,
}

/// Grey levels; the lowest row comes first.
#[derive(Debug, PartialEq)]
pub(crate) struct Picture {
    levels: Vec<u16>,
    /// The value of each level.
    table: Vec<f64>,
}

/// Largest number of pixels: a damaged header must not exhaust the memory.
const MOST_PIXELS: u64 = 1 << 26;

impl Picture {
    /// The picture in the file, and its size.
    pub fn read(path: &Path, values: [f64; 2], tone: Tone) -> Result<(Picture, [usize; 3])> {
        if tone == Tone::Log && !values.iter().all(|v| *v > 0.0) {
            let (file, [black, white]) = (path.display(), values);
            return Err(Error::input(format!(
                "{file}: the values {black} and {white} where positive numbers were expected for a logarithmic scale"
            )));
        }
        let (pixels, size, white) = grey(path)?;
        let table = (0..=white)
            .map(|level| value(f64::from(level) / f64::from(white), values, tone))
            .collect();
        // Pictures store the top row first.
        let rows = pixels.chunks_exact(size[0]).rev();
        let levels = rows.flatten().copied().collect();
        Ok((Picture { levels, table }, [size[0], size[1], 1]))
    }

    /// The values of all pixels.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.part(0..self.levels.len())
    }

    /// The values of some pixels.
    pub fn part(&self, which: Range<usize>) -> impl Iterator<Item = f64> + '_ {
        let levels = self.levels[which].iter();
        levels.map(|level| self.table[usize::from(*level)])
    }
}

/// The value of grey t from 0 (black) to 1 (white); exact at both ends.
fn value(t: f64, [black, white]: [f64; 2], tone: Tone) -> f64 {
    match tone {
        _ if t == 0.0 => black,
        _ if t == 1.0 => white,
        Tone::Linear => (1.0 - t) * black + t * white,
        Tone::Log => ((1.0 - t) * black.ln() + t * white.ln()).exp(),
    }
}

/// The grey levels of a picture, row by row from the top; its width and height; and the level of white.
fn grey(path: &Path) -> Result<(Vec<u16>, [usize; 2], u16)> {
    let file = path.display();
    let (opened, _) = numbers::open(path)?;
    let fail = |e: DecodingError| {
        let reason = e.to_string();
        let reason = reason.trim_end_matches('.');
        Error::input(format!(
            "{file} is no PNG picture that can be read: {reason}"
        ))
    };
    let limits = Limits { bytes: 1 << 30 };
    let mut decoder = Decoder::new_with_limits(BufReader::new(opened), limits);
    // The decoder expands palettes to colours and fewer than eight bits to eight.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(fail)?;
    let size = [reader.info().width, reader.info().height];
    if u64::from(size[0]) * u64::from(size[1]) > MOST_PIXELS {
        let [width, height] = size;
        return Err(Error::input(format!(
            "{file} is a picture of {width} x {height} pixels where at most {MOST_PIXELS} were expected"
        )));
    }
    let mut bytes = vec![0; reader.output_buffer_size()];
    let frame = reader.next_frame(&mut bytes).map_err(fail)?;
    let wide = frame.bit_depth == png::BitDepth::Sixteen;
    let (step, white) = if wide { (2, u16::MAX) } else { (1, 255) };
    let channels = frame.color_type.samples();
    let coloured = matches!(frame.color_type, ColorType::Rgb | ColorType::Rgba);
    let alpha = matches!(
        frame.color_type,
        ColorType::Rgba | ColorType::GrayscaleAlpha
    );
    let size = size.map(|n| n as usize);
    let mut out = Vec::with_capacity(size[0] * size[1]);
    let pixels = bytes[..frame.buffer_size()].chunks_exact(step * channels);
    for (k, pixel) in pixels.enumerate() {
        let sample = |c: usize| {
            if wide {
                u16::from_be_bytes([pixel[2 * c], pixel[2 * c + 1]])
            } else {
                u16::from(pixel[c])
            }
        };
        // Messages count from the upper left corner, as image programs do.
        let bad = |what: String| {
            let (i, j) = (k % size[0], k / size[0]);
            Err(Error::input(format!(
                "{file}: the pixel ({i}, {j}) {what} was expected"
            )))
        };
        let level = sample(0);
        if coloured && (sample(1) != level || sample(2) != level) {
            let [g, b] = [1, 2].map(sample);
            return bad(format!("has the colour ({level}, {g}, {b}) where grey"));
        }
        if alpha && sample(channels - 1) != white {
            return bad("is transparent where an opaque one".into());
        }
        out.push(level);
    }
    Ok((out, size, white))
}

#[cfg(test)]
#[path = "../../../tests/model/cells/picture.rs"]
mod tests;
