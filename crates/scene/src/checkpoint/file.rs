//! The file of a checkpoint.
//!
//! ```text
//!     "fetifeti checkpoint\n"   version u32   length of the content u64   content   hash of all before u64
//! ```
//!
//! The content is a [`Checkpoint`] as JSON, so that its fields have names: a file from before a field was added is read
//! with the field's default, and a field that is not known is passed over. The numbers around it are little-endian. The
//! content is not read before length and hash are found right. A file is replaced as a whole or not at all.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::Serialize;

use super::Checkpoint;
use base::{output, Error, Location, Result};

const MAGIC: &[u8] = b"fetifeti checkpoint\n";
/// Version of the format; it changes with the meaning of fields, not with new ones.
const VERSION: u32 = 5;
/// Bytes in front of the content; bytes behind it.
const HEAD: usize = MAGIC.len() + 4 + 8;
const TAIL: usize = 8;

/// Writes the file, atomically. To be called on one rank.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path; the old file is then untouched.
pub fn write<R: Serialize>(path: &Path, checkpoint: &Checkpoint<R>) -> Result<()> {
    output::write_durably(path, &to_bytes(checkpoint))
}

/// Reads a file. To be called on one rank.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with the path, what was found and what was expected, for anything but a
/// whole checkpoint of this version.
pub fn read<R: Default + DeserializeOwned>(path: &Path) -> Result<Checkpoint<R>> {
    let name = path.display();
    let refused = |e| {
        Error::input("the checkpoint cannot be read")
            .at(Location::file_named(name.to_string()))
            .because(e)
    };
    let mut file = File::open(path).map_err(refused)?;
    let mut bytes = Vec::new();
    let mut start = (&mut file).take(MAGIC.len() as u64);
    start.read_to_end(&mut bytes).map_err(refused)?;
    // A file that is no checkpoint may be of any size.
    if MAGIC.starts_with(&bytes) {
        file.read_to_end(&mut bytes).map_err(refused)?;
    }
    from_bytes(&bytes).map_err(|what| Error::input(format!("{name}: {what}")))
}

/// The FNV-1a hash. It always changes when a single byte does.
pub(super) fn hash(bytes: &[u8]) -> u64 {
    hash_from(START, bytes)
}

/// The hash of no bytes.
const START: u64 = 0xcbf2_9ce4_8422_2325;

/// The hash of what `start` is the hash of, followed by these bytes.
fn hash_from(start: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(start, |h, &byte| {
        (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// [`hash`] of the content of a file, which may be large.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with the path, if the file cannot be read.
pub(super) fn hash_of(path: &Path) -> Result<u64> {
    let name = path.display();
    let refused = |e| {
        Error::input("the file cannot be read")
            .at(Location::file_named(name.to_string()))
            .because(e)
    };
    let mut file = File::open(path).map_err(refused)?;
    let (mut out, mut part) = (START, vec![0; 1 << 16]);
    loop {
        match file.read(&mut part).map_err(refused)? {
            0 => return Ok(out),
            n => out = hash_from(out, &part[..n]),
        }
    }
}

fn to_bytes<R: Serialize>(checkpoint: &Checkpoint<R>) -> Vec<u8> {
    around(&serde_json::to_vec(checkpoint).expect("numbers, texts and lists have a form"))
}

/// The file with this content.
pub fn around(content: &[u8]) -> Vec<u8> {
    let mut file = Vec::with_capacity(HEAD + content.len() + TAIL);
    file.extend(MAGIC);
    file.extend(VERSION.to_le_bytes());
    file.extend((content.len() as u64).to_le_bytes());
    file.extend(content);
    file.extend(hash(&file).to_le_bytes());
    file
}

/// The content of a file with these bytes.
///
/// # Errors
/// A clause that says what is wrong with them.
pub fn from_bytes<R: Default + DeserializeOwned>(
    file: &[u8],
) -> std::result::Result<Checkpoint<R>, String> {
    let found = file.len();
    if !file.starts_with(&MAGIC[..found.min(MAGIC.len())]) {
        return Err("the file is no checkpoint, expected one that fetifeti has written".into());
    }
    if found < HEAD {
        return Err(format!(
            "the checkpoint is truncated: {found} bytes, expected at least {}",
            HEAD + TAIL
        ));
    }
    let number = |bytes: &[u8]| {
        let places = bytes.iter().rev();
        places.fold(0u64, |n, &byte| n << 8 | u64::from(byte))
    };
    let version = number(&file[MAGIC.len()..MAGIC.len() + 4]);
    if version != u64::from(VERSION) {
        return Err(format!(
            "the checkpoint has format {version}, expected format {VERSION}, which this version of fetifeti reads"
        ));
    }
    let wanted = number(&file[MAGIC.len() + 4..HEAD]).saturating_add((HEAD + TAIL) as u64);
    if wanted != found as u64 {
        let longer = wanted < found as u64;
        let state = if longer { "damaged" } else { "truncated" };
        return Err(format!(
            "the checkpoint is {state}: {found} bytes, expected {wanted}"
        ));
    }
    let (whole, tail) = file.split_at(found - TAIL);
    let (here, written) = (hash(whole), number(tail));
    if here != written {
        return Err(format!(
            "the checkpoint is damaged: checksum {here:016x}, expected {written:016x}"
        ));
    }
    match serde_json::from_slice::<Checkpoint<R>>(&whole[HEAD..]) {
        Ok(checkpoint) if checkpoint.stepper.contact.is_consistent() => Ok(checkpoint),
        _ => {
            Err("the checkpoint contradicts itself, expected one that fetifeti has written".into())
        }
    }
}

#[cfg(test)]
#[path = "../../tests/checkpoint/file.rs"]
mod tests;
