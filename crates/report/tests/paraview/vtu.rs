//! Unit tests of `crates/report/src/paraview/vtu.rs`.

use super::*;
use base64::Engine;
use elements::kind::CellKind;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// The bytes of a named array, read as the format says.
fn bytes_of(file: &str, name: &str) -> Vec<u8> {
    let after = file.split(&format!("Name=\"{name}\"")).nth(1).unwrap();
    let content = after.split_once('>').unwrap().1.split_once('<').unwrap().0;
    let content = content.trim();
    let words = |text: &str| -> Vec<usize> {
        let bytes = STANDARD.decode(text).unwrap();
        let word = |b: &[u8]| u64::from_le_bytes(b.try_into().unwrap()) as usize;
        bytes.chunks_exact(8).map(word).collect()
    };
    // Four characters stand for three bytes, so that 32 have the first three numbers.
    let n = words(&content[..32])[0];
    let (header, data) = content.split_at((8 * (3 + n)).div_ceil(3) * 4);
    let header = words(header);
    assert_eq!(header.len(), 3 + n);
    let data = STANDARD.decode(data).unwrap();
    let mut out = Vec::new();
    let mut start = 0;
    for (k, size) in header[3..].iter().enumerate() {
        let before = out.len();
        let mut block = ZlibDecoder::new(&data[start..start + size]);
        block.read_to_end(&mut out).unwrap();
        let last = k + 1 == n && header[2] > 0;
        assert_eq!(out.len() - before, header[1 + usize::from(last)]);
        start += size;
    }
    assert_eq!(start, data.len());
    out
}

fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks(8)
        .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

const POINTS: [[f64; 3]; 6] = [
    [0., 0., 0.],
    [1., 0., 0.],
    [2., 0., 0.],
    [0., 1., 0.],
    [1., 1., 0.],
    [2., 1.5, 0.],
];
const QUADS: [u32; 8] = [0, 1, 4, 3, 1, 2, 5, 4];

fn cells() -> Cells {
    let mut cells = Cells::default();
    for quad in QUADS.chunks_exact(4) {
        cells.push(CellKind::Quad4, quad);
    }
    cells
}

fn text(vtu: &Vtu) -> String {
    let mut out = Vec::new();
    vtu.fill(&mut out).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn arrays_read_back() {
    let u = [0.0, 0.1, -2.5, 1e-300, f64::MAX, 6.0];
    let body = [0, -1];
    let velocity: Vec<f64> = (0..6).map(f64::from).collect();
    let cells = cells();
    let vtu = Vtu::new(&POINTS, &cells)
        .point_data("u", 1, &u[..])
        .cell_data("v", 3, &velocity[..])
        .cell_data("body", 1, &body[..]);
    vtu.check().unwrap();
    let file = text(&vtu);
    assert!(file.contains("NumberOfPoints=\"6\" NumberOfCells=\"2\""));
    assert_eq!(floats(&bytes_of(&file, "u")), u);
    assert_eq!(floats(&bytes_of(&file, "v")), velocity);
    assert_eq!(bytes_of(&file, "body"), [0, 0, 0, 0, 255, 255, 255, 255]);
    assert_eq!(floats(&bytes_of(&file, "Points")), POINTS.concat());
    let integers = |name| -> Vec<i64> {
        bytes_of(&file, name)
            .chunks(8)
            .map(|b| i64::from_le_bytes(b.try_into().unwrap()))
            .collect()
    };
    assert_eq!(integers("connectivity"), QUADS.map(i64::from));
    assert_eq!(integers("offsets"), [4, 8]);
    assert_eq!(bytes_of(&file, "types"), [9, 9]);
}

#[test]
fn what_does_not_fit_is_refused() {
    let (short, cells) = ([1.0; 5], cells());
    let path = Path::new("/dev/null");
    let cases = [
        (
            Vtu::new(&POINTS, &cells).point_data("u", 1, &short[..]),
            "'u' has 5 numbers",
        ),
        (Vtu::new(&POINTS[..5], &cells), "point 5"),
    ];
    for (vtu, part) in cases {
        let message = vtu.write(path).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
}

/// VTK numbers the triangles of a linear wedge the other way round.
#[test]
fn kinds_are_mixed() {
    let points = [[0.0; 3]; 9];
    let mut cells = Cells::default();
    cells.push(CellKind::Wedge6, &[0, 1, 2, 3, 4, 5]);
    cells.push(CellKind::Tet4, &[5, 6, 7, 8]);
    let vtu = Vtu::new(&points, &cells);
    vtu.check().unwrap();
    let file = text(&vtu);
    let integers: Vec<i64> = bytes_of(&file, "connectivity")
        .chunks(8)
        .map(|b| i64::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(integers, [0, 2, 1, 3, 5, 4, 5, 6, 7, 8]);
    assert_eq!(bytes_of(&file, "types"), [13, 10]);
}

/// Several blocks, the last of them full or not.
#[test]
fn arrays_of_several_blocks_read_back() {
    let cells = cells();
    let full = 2 * BLOCK / 8;
    for n in [full, full + 1, full - 1] {
        let points = vec![[0.5, 0.0, 0.0]; n.max(6)];
        let values: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
        let vtu = Vtu::new(&points, &cells).point_data("v", 1, &values[..]);
        vtu.check().unwrap();
        assert_eq!(floats(&bytes_of(&text(&vtu), "v")), values);
    }
}

#[test]
fn an_index_names_pieces_and_arrays() {
    let cells = cells();
    let (u, body) = ([0.0; 18], [0, 1]);
    let vtu = Vtu::new(&POINTS, &cells)
        .point_data("u", 3, &u[..])
        .cell_data("body", 1, &body[..]);
    let mut out = Vec::new();
    let pieces = ["a_0000.vtu", "a_0001.vtu"].map(String::from);
    vtu.fill_index(&mut out, &pieces).unwrap();
    let file = String::from_utf8(out).unwrap();
    let place = |part: &str| {
        let at = file.find(part);
        at.unwrap_or_else(|| panic!("{part} is missing in {file}"))
    };
    assert!(place("type=\"PUnstructuredGrid\"") < place("<PPointData>"));
    let u = "<PDataArray type=\"Float64\" Name=\"u\" NumberOfComponents=\"3\"/>";
    assert!((place("<PPointData>")..place("</PPointData>")).contains(&place(u)));
    let body = "<PDataArray type=\"Int32\" Name=\"body\"/>";
    assert!((place("<PCellData>")..place("</PCellData>")).contains(&place(body)));
    assert!(place("<Piece Source=\"a_0000.vtu\"/>") < place("<Piece Source=\"a_0001.vtu\"/>"));
}
