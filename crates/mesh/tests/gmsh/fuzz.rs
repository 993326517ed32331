//! Files that were cut off or have wrong bits: they are read or refused, and nothing else happens.

use super::*;

/// A sequence of numbers that is the same every time.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) % n as u64) as usize
    }
}

/// A message is one line that begins with the file.
fn check(message: &str) {
    assert!(message.starts_with("a.msh"), "{message}");
    let printable = message.chars().all(|c| !c.is_control());
    assert!(printable && message.len() < 400, "{message:?}");
}

#[test]
fn cut_files_are_refused() {
    for file in meshes(&folder()) {
        let bytes = std::fs::read(&file).expect("a file");
        let whole = read("a.msh", &bytes).map_err(|e| e.to_string());
        for n in (0..bytes.len()).step_by(50) {
            match read("a.msh", &bytes[..n]) {
                // What is passed over may be missing.
                Ok(mesh) => assert_eq!(Ok(&mesh), whole.as_ref(), "{}: {n} bytes", name(&file)),
                Err(e) => check(&e.to_string()),
            }
        }
    }
}

#[test]
fn wrong_bits_do_no_harm() {
    let mut numbers = Numbers(19);
    let (mut read_all, mut refused) = (0, 0);
    for file in meshes(&folder()) {
        let whole = std::fs::read(&file).expect("a file");
        for round in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..1 + numbers.below(3) {
                let k = numbers.below(bytes.len());
                match round % 4 {
                    0 | 1 => bytes[k] ^= 1 << numbers.below(8),
                    2 => bytes[k] = b"0123456789-+.$\n \"eE"[numbers.below(19)],
                    _ => {
                        // A count becomes a large number, in whatever encoding.
                        let end = bytes.len().min(k + 4);
                        let wrong = [b'9', 0xff, 0x7f][numbers.below(3)];
                        bytes[k..end].fill(wrong);
                    }
                }
            }
            match read("a.msh", &bytes) {
                Ok(mesh) => {
                    let points = mesh.points.len();
                    let nodes = mesh.cells.all_nodes();
                    assert!(nodes.iter().all(|&n| (n as usize) < points));
                    assert!(mesh.points.as_flattened().iter().all(|x| x.is_finite()));
                    read_all += 1;
                }
                Err(e) => {
                    check(&e.to_string());
                    refused += 1;
                }
            }
        }
    }
    assert!(
        read_all > 500 && refused > 500,
        "{read_all} read, {refused} refused"
    );
}

/// Sections and pieces of sections in any order.
#[test]
fn shuffled_pieces_do_no_harm() {
    let mut numbers = Numbers(4);
    for file in meshes(&folder()) {
        let bytes = std::fs::read(&file).expect("a file");
        for _ in 0..50 {
            let mut cuts: Vec<usize> = (0..6).map(|_| numbers.below(bytes.len())).collect();
            cuts.sort_unstable();
            let mut mixed = bytes[..cuts[0]].to_vec();
            mixed.extend(&bytes[cuts[2]..cuts[3]]);
            mixed.extend(&bytes[cuts[1]..cuts[2]]);
            mixed.extend(&bytes[cuts[4]..]);
            if let Err(e) = read("a.msh", &mixed) {
                check(&e.to_string());
            }
        }
    }
}
