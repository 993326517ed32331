//! A reader of the VTU files that the program writes.

use std::io::Read;

use base64::engine::general_purpose::STANDARD;
use base64::Engine;
use flate2::read::ZlibDecoder;

/// A file of one piece.
pub struct Vtu(pub String);

impl Vtu {
    pub fn read(path: &str) -> Vtu {
        Vtu(std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}")))
    }

    /// A count in the head of the piece, such as `NumberOfPoints`.
    pub fn count(&self, name: &str) -> usize {
        let tail = self.0.split(&format!("{name}=\"")).nth(1);
        let digits = tail.and_then(|t| t.split('"').next());
        digits.expect("a count").parse().expect("a number")
    }

    /// The bytes of an array in a section such as `PointData`.
    fn bytes(&self, section: &str, name: &str) -> Vec<u8> {
        let inside = self.0.split(&format!("<{section}>")).nth(1);
        let inside = inside.and_then(|t| t.split(&format!("</{section}>")).next());
        let tag = format!("Name=\"{name}\"");
        let array = inside.and_then(|t| t.split(&tag).nth(1));
        let array = array.unwrap_or_else(|| panic!("no array {name} in {section}"));
        let content = array.split_once('>').expect("a tag").1;
        let content = content.split('<').next().expect("a tag").trim();
        let words = |text: &str| -> Vec<usize> {
            let bytes = STANDARD.decode(text).expect("base64");
            let word = |b: &[u8]| u64::from_le_bytes(b.try_into().expect("8 bytes")) as usize;
            bytes.chunks_exact(8).map(word).collect()
        };
        let blocks = words(&content[..32])[0];
        let (header, data) = content.split_at((8 * (3 + blocks)).div_ceil(3) * 4);
        let (mut out, mut start) = (Vec::new(), 0);
        let data = STANDARD.decode(data).expect("base64");
        for size in &words(header)[3..] {
            let mut block = ZlibDecoder::new(&data[start..start + size]);
            block.read_to_end(&mut out).expect("a block of zlib");
            start += size;
        }
        out
    }

    /// An array of Float64.
    pub fn floats(&self, section: &str, name: &str) -> Vec<f64> {
        let bytes = self.bytes(section, name);
        let number = |b: &[u8]| f64::from_le_bytes(b.try_into().expect("8 bytes"));
        bytes.chunks_exact(8).map(number).collect()
    }

    /// An array of Int32.
    pub fn whole(&self, section: &str, name: &str) -> Vec<i32> {
        let bytes = self.bytes(section, name);
        let number = |b: &[u8]| i32::from_le_bytes(b.try_into().expect("4 bytes"));
        bytes.chunks_exact(4).map(number).collect()
    }

    /// The positions of the points.
    pub fn points(&self) -> Vec<[f64; 3]> {
        let all = self.floats("Points", "Points");
        all.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()
    }
}
