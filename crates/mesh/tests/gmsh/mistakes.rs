//! Mistakes in files, and the sentence for each.

use super::*;

/// A square of two triangles, and one of its sides.
pub(super) const TWO: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 4 \"rim\"
2 5 \"plate\"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
3
1 1 2 4 1 1 2
2 2 2 5 1 1 2 3
3 2 2 5 1 1 3 4
$EndElements
";

/// A square of two triangles, which are in two groups, and one of its sides.
pub(super) const FOUR: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 1 1 0
1 0 0 0 1 0 0 1 4 0
7 0 0 0 1 1 0 2 5 6 1 1
$EndEntities
$Nodes
1 4 1 4
2 7 0 4
1
2
3
4
0 0 0
1 0 0
1 1 0
0 1 0
$EndNodes
$Elements
2 3 1 3
1 1 1 1
1 1 2
2 7 2 2
2 1 2 3
3 1 3 4
$EndElements
";

/// Reads the text with one piece replaced, which it has once.
pub(super) fn replaced(text: &str, old: &str, new: &str) -> Result<MeshFile> {
    assert_eq!(text.matches(old).count(), 1, "{old:?}");
    read("a.msh", text.replace(old, new).as_bytes())
}

fn refused(text: &str, old: &str, new: &str) -> String {
    match replaced(text, old, new) {
        Ok(_) => panic!("{new:?} for {old:?} was read"),
        Err(error) if error.is_input() => error.to_string(),
        Err(other) => panic!("{other:?}"),
    }
}

/// Makes each mistake of a list; "⏎" is a new line.
fn try_all(text: &str, mistakes: &str) {
    let lines: Vec<&str> = mistakes.trim().lines().collect();
    assert!(lines.len() % 2 == 0 && lines.len() > 30);
    for pair in lines.chunks_exact(2) {
        let (old, new) = pair[0].split_once(" =>").expect("a mistake");
        let (old, new) = (old.replace('⏎', "\n"), new.replace('⏎', "\n"));
        let found = refused(text, &old, new.strip_prefix(' ').unwrap_or(&new));
        let message = format!("a.msh, {}", pair[1].trim());
        assert!(found.starts_with(&message), "{found}");
    }
}

#[test]
fn the_originals_are_read() {
    let of = |mesh: &MeshFile, k: usize| {
        let group = &mesh.groups[k];
        (group.name.clone(), group.members.clone())
    };
    let cells = |dim, cells: &[u32]| Members::Cells {
        dim,
        cells: cells.to_vec(),
    };
    let mesh = read("a.msh", TWO.as_bytes()).expect("a mesh");
    assert_eq!((mesh.points.len(), mesh.cells.len()), (4, 3));
    assert_eq!(of(&mesh, 0), ("rim".into(), cells(1, &[0])));
    assert_eq!(of(&mesh, 1), ("plate".into(), cells(2, &[1, 2])));
    let mesh = read("a.msh", FOUR.as_bytes()).expect("a mesh");
    assert_eq!((mesh.points.len(), mesh.cells.len()), (4, 3));
    assert_eq!(of(&mesh, 0), ("4".into(), cells(1, &[0])));
    assert_eq!(of(&mesh, 1), ("5".into(), cells(2, &[1, 2])));
    assert_eq!(of(&mesh, 2), ("6".into(), cells(2, &[1, 2])));
}

/// Replacements in [`TWO`], and the beginning of the sentence for each.
const WRONG_TWO: &str = r##"
2.2 0 8 => 3.0 0 8
    line 2: found the format "3.0" where 2.0, 2.1, 2.2, 4.0 or 4.1 was expected
2.2 0 8 => 2.2 2 8
    line 2: found "2" where 0 (text) or 1 (binary) was expected
2.2 0 8 => 2.2 0 16
    line 2: found "16" where a size of 4 or 8 bytes was expected
2.2 0 8 => 2.2
    line 2: found "2.2" where version, kind and size were expected, such as "4.1 0 8"
$MeshFormat⏎2 => $NOD⏎2
    line 1: format 1 is not read, 2.0 to 2.2, 4.0 or 4.1 was expected; Gmsh converts it
$MeshFormat⏎2 => # a mesh⏎2
    line 1: found "# a mesh" where a section such as $Nodes was expected
1 4 "rim" => 4 "rim"
    line 6: found "4 \"rim\"" where a physical group was expected: dimension, number and a name of UTF-8, such as
1 4 "rim" => 5 4 "rim"
    line 6: found "5 4 \"rim\"" where
1 4 "rim" => 2 5 "rim"
    line 7: physical group 5 has a second name here, after line 6
2⏎1 4 => 3⏎1 4
    line 8: found "$EndPhysicalNames" where a physical group was expected
4⏎1 0 => 5⏎1 0
    line 15: found "$EndNodes" where the number of a node was expected, a whole number
4⏎1 0 => 3⏎1 0
    line 14: found "4 0 1 0" where $EndNodes was expected
4⏎1 0 => 1000000000⏎1 0
    line 10: the number of nodes is 1000000000, but the 113 bytes that are left cannot hold as many
4⏎1 0 => 99999999999999999999⏎1 0
    line 10: found "99999999999999999999" where the number of nodes was expected
4⏎1 0 => -4⏎1 0
    line 10: found "-4" where the number of nodes was expected
2 1 0 0 => 2 1 nan 0
    line 12: found NaN where the coordinate y of a node was expected, which is finite
2 1 0 0 => 2 1e999 0 0
    line 12: found inf where the coordinate x of a node was expected, which is finite
2 1 0 0 => 2 1e300 0 0
    line 12: found 1e300 where the coordinate x of a node was expected, at most 1e50 (take other units)
2 1 0 0 => 2 1,5 0 0
    line 12: found "1,5" where a coordinate was expected, a number
2 1 0 0 => -2 1 0 0
    line 12: found -2 where the number of a node was expected, which is not negative
4 0 1 0 => 2 0 1 0
    line 14: node 2 is here a second time, after line 12
4 0 1 0 => 1000 0 1 0
    line 20: element 3 has the node 4, which is not in $Nodes
2 2 2 5 1 1 2 3 => 2 2 2 5 1 1 2 -3
    line 19: found -3 where the number of a node was expected, which is not negative
2 2 2 5 1 1 2 3 => 2 2 2 5 1 1 2 9
    line 19: element 2 has the node 9, which is not in $Nodes
2 2 2 5 1 1 2 3 => 1 2 2 5 1 1 2 3
    line 19: element 1 is here a second time, after line 18
2 2 2 5 1 1 2 3 => 2 19 2 5 1 1 2 3
    line 19: element 2 is of type 19 (a pyramid of 13 nodes), where points
2 2 2 5 1 1 2 3 => 2 26 2 5 1 1 2 3
    line 19: element 2 is of type 26 (a segment of order 3 or higher), where points
2 2 2 5 1 1 2 3 => 2 4711 2 5 1 1 2 3
    line 19: element 2 is of type 4711 (no type of Gmsh), where points
2 2 2 5 1 1 2 3 => 2 2 -2 5 1 1 2 3
    line 19: found -2 where the number of tags was expected, which is not negative
2 2 2 5 1 1 2 3 => 2 2 900 5 1 1 2 3
    line 19: the number of tags is 900, but the 40 bytes that are left cannot hold as many
3⏎1 1 2 4 => 2⏎1 1 2 4
    line 20: found "3 2 2 5 1 1 3 4" where $EndElements was expected
3 4⏎$EndElements⏎ => 3
    line 20: the file ends where the number of a node was expected
$EndElements⏎ =>
    line 21: the file ends where $EndElements was expected
$EndElements⏎ => $EndElements⏎$NodeData⏎1⏎
    line 22: the section $NodeData begins here, and $EndNodeData is missing
$EndElements⏎ => $EndElements⏎and more
    line 22: found "and more" where a section such as $Nodes was expected
$EndElements⏎ => $EndElements⏎$Nodes⏎
    line 22: $Nodes is here a second time
$Nodes⏎4 => $Points⏎4
    line 9: the section $Points begins here, and $EndPoints is missing
$EndMeshFormat⏎ => $EndMesh⏎
    line 3: found "$EndMesh" where $EndMeshFormat was expected
"##;

#[test]
fn mistakes_in_format_2() {
    try_all(TWO, WRONG_TWO);
}

/// As [`WRONG_TWO`], in [`FOUR`].
const WRONG_FOUR: &str = r##"
0 1 1 0⏎1 0 => 0 1000000000 1 0⏎1 0
    line 5: a number of entities is 1000000000, but the
7 0 0 0 1 1 0 2 5 6 1 1 => 8 0 0 0 1 1 0 2 5 6 1 1
    line 25: these elements are of entity 7 of dimension 2, which is not in $Entities
7 0 0 0 1 1 0 2 5 6 1 1 => 7 0 0 0 1 1 0 99 5 6 1 1
    line 7: the number of physical groups of an entity is 99, but the
0 1 1 0⏎1 0 => 0 2 0 0⏎1 0
    line 25: these elements are of entity 7 of dimension 2, which is not in $Entities
1 4 1 4 => 1 5 1 4
    line 10: the section says that it has 5 nodes, and its blocks have 4
1 4 1 4 => 2 4 1 4
    line 20: found "$EndNodes" where an entity was expected, a whole number
1 4 1 4 => 1 1000000000 1 4
    line 10: the number of nodes is 1000000000, but the
2 7 0 4 => 2 7 2 4
    line 11: found 2 where 0 or 1 was expected: whether nodes are parametric
2 7 0 4 => 4 7 0 4
    line 11: found 4 where the dimension of an entity was expected, 0 to 3
2 7 0 4 => 2 7 0 1000000000
    line 11: the number of nodes is 1000000000, but the
2 7 0 4 => 2 7 1 4
    line 20: found "$EndNodes" where
3⏎4⏎0 => 3⏎3⏎0
    line 15: node 3 is here a second time, after line 14
3⏎4⏎0 => 3000000⏎3000000⏎0
    line 15: node 3000000 is here a second time, after line 14
3⏎4⏎0 => 3000000⏎4000000⏎0
    line 26: element 2 has the node 3, which is not in $Nodes
2 3 1 3⏎1 => 2 4 1 3⏎1
    line 22: the section says that it has 4 elements, and its blocks have 3
2 7 2 2 => 2 7 1 2
    line 26: element 2 is a segment of 2 nodes on an entity of dimension 2
2 7 2 2 => 2 7 9 2
    line 28: found "$EndElements" where the number of a node was expected, a whole number
2 7 2 2 => 2 7 13 2
    line 26: element 2 is of type 13 (a wedge of 18 nodes), where points
3 1 3 4 => 2 1 3 4
    line 27: element 2 is here a second time, after line 26
3 1 3 4 => 3 1 3 18446744073709551615
    line 27: found "18446744073709551615" where the number of a node was expected, a whole number
$Entities⏎0 => $Elements⏎0
    line 4: $Elements was expected after $Nodes
"##;

#[test]
fn mistakes_in_format_4() {
    try_all(FOUR, WRONG_FOUR);
    let (before, entities) = FOUR.split_once("$Entities").expect("entities");
    let (entities, after) = entities.split_once("$Nodes").expect("nodes");
    let late = format!("{before}$Nodes{after}$Entities{entities}");
    assert_eq!(
        read("a.msh", late.as_bytes()).unwrap_err().to_string(),
        "a.msh, line 24: $Entities was expected before $Elements"
    );
    let whole = |text: &str| read("a.msh", text.as_bytes()).unwrap_err().to_string();
    assert_eq!(
        whole(""),
        "a.msh: the file is empty, $MeshFormat was expected"
    );
    let (start, _) = FOUR.split_once("$Elements").expect("elements");
    assert_eq!(
        whole(start),
        "a.msh: the section $Elements was expected and is missing"
    );
    let (start, _) = FOUR.split_once("$Nodes").expect("nodes");
    assert_eq!(
        whole(start),
        "a.msh: the section $Nodes was expected and is missing"
    );
}

/// Binary files name the byte.
#[test]
fn mistakes_in_binary_files() {
    let bytes = std::fs::read(folder().join("bricks2i.gmsh22.bin.msh")).expect("a file");
    let refused = |bytes: &[u8]| read("a.msh", bytes).unwrap_err().to_string();
    let at = |word: &[u8]| {
        let found = bytes.windows(word.len()).position(|w| w == word);
        found.expect("the word") + word.len()
    };
    // The order of bytes.
    let one = at(b"2.2 1 8\n");
    let mut wrong = bytes.clone();
    wrong[one..one + 4].copy_from_slice(&[1, 0, 0, 1]);
    assert_eq!(
        refused(&wrong),
        format!("a.msh, byte {one}: found 16777217 where the number 1 was expected, which tells the order of bytes")
    );
    wrong[one..one + 4].copy_from_slice(&[0, 0, 0, 1]);
    let first = at(b"$Nodes\n44\n");
    let message = refused(&wrong);
    // Coordinates are read the other way round.
    let expected = "a.msh, byte 563: found -2.65";
    assert!(message.starts_with(expected), "{message}");
    // A node, a coordinate, and a type.
    let mut wrong = bytes.clone();
    wrong[first..first + 4].copy_from_slice(&(-1_i32).to_le_bytes());
    assert_eq!(
        refused(&wrong),
        format!("a.msh, byte {first}: found -1 where the number of a node was expected, which is not negative")
    );
    let mut wrong = bytes.clone();
    wrong[first + 4..first + 12].copy_from_slice(&f64::NAN.to_le_bytes());
    let y = first + 4;
    assert_eq!(
        refused(&wrong),
        format!("a.msh, byte {y}: found NaN where the coordinate x of a node was expected, which is finite")
    );
    let elements = bytes.len() - bytes[at(b"$Elements\n")..].len();
    let header = elements
        + bytes[elements..]
            .iter()
            .position(|&b| b == b'\n')
            .expect("a line")
        + 1;
    let mut wrong = bytes.clone();
    wrong[header + 4..header + 8].copy_from_slice(&1_000_000_000_i32.to_le_bytes());
    let message = refused(&wrong);
    let place = format!(
        "a.msh, byte {}: the number of elements of one type is 1000000000, but the",
        header + 4
    );
    assert!(message.starts_with(&place), "{message}");
    wrong[header + 4..header + 8].copy_from_slice(&0_i32.to_le_bytes());
    let message = refused(&wrong);
    let place = format!("a.msh, byte {}: 0 elements follow, where 1 to ", header + 4);
    assert!(message.starts_with(&place), "{message}");
    // The end.
    let cut = first + 30;
    assert_eq!(
        refused(&bytes[..cut]),
        format!("a.msh, byte {first}: the number of nodes is 44, but the 30 bytes that are left cannot hold as many")
            .replace(&format!("byte {first}"), &format!("byte {}", first - 3))
    );
    // Eight bytes are for 4.1 alone.
    let old = String::from_utf8_lossy(&bytes[..20]).replace("2.2 1 8", "2.2 1 4");
    assert_eq!(
        refused(old.as_bytes()),
        "a.msh, line 2: found numbers of 4 bytes where 8 were expected in this format"
    );
}

/// Lines may end as on Windows, and numbers may stand on any line of a section of text.
#[test]
fn white_space_is_free() {
    let mesh = read("a.msh", FOUR.as_bytes()).expect("a mesh");
    for text in [
        FOUR.replace('\n', "\r\n"),
        FOUR.replace("\n1 1 2\n", " 1\n\n1\t2 "),
        format!("\n{FOUR}\n\n"),
    ] {
        assert_eq!(read("a.msh", text.as_bytes()).expect("a mesh"), mesh);
    }
    let mesh = read("a.msh", TWO.as_bytes()).expect("a mesh");
    assert_eq!(
        read("a.msh", TWO.replace('\n', "\r\n").as_bytes()).expect("a mesh"),
        mesh
    );
}
