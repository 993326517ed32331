//! Checkpoints as files.
//!
//! ```text
//!     "fetifeti checkpoint\n"   version u32   length of the content u64   content   hash of all before u64
//! ```
//!
//! Numbers are little-endian, lists begin with their length. Nothing is believed before the file has the length that it announces and
//! its hash is right; a file is replaced as a whole or not at all.

use std::path::Path;

use super::output;
use crate::contact::checkpoint::{Checkpoint, GlobalState};
use crate::contact::Caution;
use crate::{Error, Result};

const MAGIC: &[u8] = b"fetifeti checkpoint\n";
/// Changes when the content or its meaning does.
const VERSION: u32 = 1;
/// Bytes in front of the content, and behind it.
const HEAD: usize = MAGIC.len() + 4 + 8;
const TAIL: usize = 8;

/// Writes the file, atomically. To be called on one rank.
///
/// # Errors
/// [`Error::Environment`] with the path; the old file is then untouched.
pub fn write(path: &Path, checkpoint: &Checkpoint) -> Result<()> {
    output::write_durably(path, &to_bytes(checkpoint))
}

/// Reads a file. To be called on one rank.
///
/// # Errors
/// [`Error::Input`] with the path, what was found and what was expected, for anything but a whole checkpoint of this version.
pub fn read(path: &Path) -> Result<Checkpoint> {
    let file = path.display();
    let bytes = std::fs::read(path)
        .map_err(|e| Error::input(format!("{file}: the checkpoint cannot be read: {e}")))?;
    from_bytes(&bytes).map_err(|what| Error::input(format!("{file}: {what}")))
}

/// FNV-1a: differs for sure where one byte does.
pub fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &byte| {
        (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn to_bytes(c: &Checkpoint) -> Vec<u8> {
    let s = &c.state;
    let mut out = Writer(Vec::new());
    out.bytes(c.title.as_bytes());
    out.word(c.scene);
    out.word(c.load_step as u64);
    out.bytes(c.records.as_bytes());
    out.word(s.reference.to_bits());
    out.word(s.steps);
    out.word(s.caution as u64);
    out.words(s.visited.iter().copied());
    out.words(s.mu.iter().map(|m| m.to_bits()));
    out.words(s.local.iter().copied());
    out.words(s.blocks.iter().map(|b| b.0));
    out.words(s.blocks.iter().map(|b| b.1));
    out.words(s.lambda.iter().map(|l| l.to_bits()));
    let sets = s.active.iter().zip(&s.before);
    let sets: Vec<u8> = sets
        .map(|(&now, &was)| u8::from(now) | u8::from(was) << 1)
        .collect();
    out.bytes(&sets);
    let content = out.0;

    let mut file = Vec::with_capacity(HEAD + content.len() + TAIL);
    file.extend(MAGIC);
    file.extend(VERSION.to_le_bytes());
    file.extend((content.len() as u64).to_le_bytes());
    file.extend(content);
    file.extend(hash(&file).to_le_bytes());
    file
}

fn from_bytes(file: &[u8]) -> std::result::Result<Checkpoint, String> {
    let there = file.len().min(MAGIC.len());
    if file[..there] != MAGIC[..there] {
        return Err("the file is no checkpoint, expected one that --checkpoint has written".into());
    }
    if file.len() < HEAD {
        return Err(format!(
            "the checkpoint is truncated: {} bytes, expected at least {}",
            file.len(),
            HEAD + TAIL
        ));
    }
    let (head, rest) = file.split_at(HEAD);
    let number = |bytes: &[u8]| {
        let places = bytes.iter().rev();
        places.fold(0u64, |n, &byte| n << 8 | u64::from(byte))
    };
    let version = number(&head[MAGIC.len()..MAGIC.len() + 4]);
    if version != u64::from(VERSION) {
        return Err(format!(
            "the checkpoint has format {version}, expected format {VERSION}, which this version of fetifeti reads"
        ));
    }
    let length = number(&head[MAGIC.len() + 4..]);
    let wanted = length.saturating_add((HEAD + TAIL) as u64);
    if wanted != file.len() as u64 {
        let state = if wanted > file.len() as u64 {
            "truncated"
        } else {
            "damaged"
        };
        return Err(format!(
            "the checkpoint is {state}: {} bytes, expected {wanted}",
            file.len()
        ));
    }
    let (content, tail) = rest.split_at(rest.len() - TAIL);
    let found = hash(&file[..file.len() - TAIL]);
    if found != number(tail) {
        return Err(format!(
            "the checkpoint is damaged: checksum {found:016x}, expected {:016x}",
            number(tail)
        ));
    }
    parse(content).ok_or_else(|| {
        "the checkpoint contradicts itself, expected one that --checkpoint has written".into()
    })
}

fn parse(content: &[u8]) -> Option<Checkpoint> {
    let mut input = Reader(content);
    let title = input.text()?;
    let scene = input.word()?;
    let load_step = usize::try_from(input.word()?).ok()?;
    let records = input.text()?;
    let reference = f64::from_bits(input.word()?);
    let steps = input.word()?;
    let caution = *Caution::ALL.get(usize::try_from(input.word()?).ok()?)?;
    let visited = input.words()?;
    let mu = input.numbers()?;
    let local = input.words()?;
    let (blocks, sizes) = (input.words()?, input.words()?);
    let lambda = input.numbers()?;
    let sets = input.bytes()?;
    let sum = |counts: &[u64]| counts.iter().try_fold(0u64, |sum, n| sum.checked_add(*n));
    let (n_local, n_contact) = (sum(&local)?, sum(&sizes)?);
    let whole = input.0.is_empty()
        && blocks.len() == sizes.len()
        && n_contact == sets.len() as u64
        && n_local.checked_add(n_contact)? == lambda.len() as u64;
    whole.then(|| Checkpoint {
        title,
        scene,
        load_step,
        records,
        state: GlobalState {
            local,
            blocks: blocks.into_iter().zip(sizes).collect(),
            lambda,
            active: sets.iter().map(|s| s & 1 == 1).collect(),
            before: sets.iter().map(|s| s >> 1 & 1 == 1).collect(),
            reference,
            steps,
            visited,
            caution,
            mu,
        },
    })
}

struct Writer(Vec<u8>);

impl Writer {
    fn word(&mut self, word: u64) {
        self.0.extend(word.to_le_bytes());
    }

    fn words(&mut self, words: impl ExactSizeIterator<Item = u64>) {
        self.word(words.len() as u64);
        words.for_each(|w| self.word(w));
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        self.0.extend(bytes);
    }
}

/// What is left to read; `None` where that is less than announced.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(taken)
    }

    fn word(&mut self) -> Option<u64> {
        let bytes = self.take(8)?;
        Some(u64::from_le_bytes(bytes.try_into().ok()?))
    }

    fn words(&mut self) -> Option<Vec<u64>> {
        let n = usize::try_from(self.word()?).ok()?;
        let bytes = self.take(n.checked_mul(8)?)?;
        let word = |w: &[u8]| w.iter().rev().fold(0, |n, &byte| n << 8 | u64::from(byte));
        Some(bytes.chunks_exact(8).map(word).collect())
    }

    fn numbers(&mut self) -> Option<Vec<f64>> {
        let words = self.words()?.into_iter();
        Some(words.map(f64::from_bits).collect())
    }

    fn bytes(&mut self) -> Option<&'a [u8]> {
        let n = usize::try_from(self.word()?).ok()?;
        self.take(n)
    }

    fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Checkpoint {
        Checkpoint {
            title: "Ein Körper".into(),
            scene: 0x1234_5678_9abc_def0,
            load_step: 3,
            records: "{\"steps\": [1, 2]}".into(),
            state: GlobalState {
                local: vec![2, 0, 1],
                blocks: vec![(7, 2), (40, 1)],
                lambda: vec![0.5, -1e-300, f64::MAX, 3.0, 0.0, -0.0],
                active: vec![true, false, true],
                before: vec![true, true, false],
                reference: 0.1,
                steps: 12,
                visited: vec![u64::MAX, 5],
                caution: Caution::Single,
                mu: vec![-2.5],
            },
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let c = example();
        assert_eq!(from_bytes(&to_bytes(&c)), Ok(c));
    }

    #[test]
    fn every_damage_is_found() {
        let bytes = to_bytes(&example());
        for n in 0..bytes.len() {
            let message = from_bytes(&bytes[..n]).expect_err("too short");
            assert!(message.contains("truncated"), "{n}: {message}");
        }
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut bad = bytes.clone();
                bad[at] ^= 1 << bit;
                assert!(from_bytes(&bad).is_err(), "byte {at}, bit {bit}");
            }
        }
        let longer = [&bytes[..], b"x"].concat();
        assert!(from_bytes(&longer)
            .expect_err("too long")
            .contains("damaged"));
    }

    #[test]
    fn contents_that_contradict_themselves_are_refused() {
        let wrong: [fn(&mut GlobalState); 3] = [
            |s| s.local[0] = u64::MAX,
            |s| s.blocks[0].1 = 1,
            |s| s.lambda.truncate(5),
        ];
        for change in wrong {
            let mut c = example();
            change(&mut c.state);
            let message = from_bytes(&to_bytes(&c)).expect_err("wrong counts");
            assert!(message.contains("contradicts itself"), "{message}");
        }
    }
}
