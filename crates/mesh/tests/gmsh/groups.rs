//! Physical groups: what they are called, and elements that are in several.

use super::mistakes::{replaced, FOUR, TWO};
use super::*;

/// Groups of one name and dimension are one group; a name that is another's number is refused.
#[test]
fn names_of_groups_may_meet() {
    let two = TWO.replace("1 4 \"rim\"", "2 6 \"plate\"");
    let two = two.replace("3 2 2 5 1 1 3 4", "3 2 2 6 1 1 3 4");
    let mesh = read("a.msh", two.as_bytes()).expect("a mesh");
    let names: Vec<&str> = mesh.groups.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["plate", "4"]);
    let cells = vec![1, 2];
    assert_eq!(mesh.groups[0].members, Members::Cells { dim: 2, cells });

    let number = two.replace("\"plate\"\n$", "\"7\"\n$");
    let number = number
        .replace("2 6 \"plate\"", "1 4 \"rim\"")
        .replace(" 6 1 1 3 4", " 7 1 1 3 4");
    let message = read("a.msh", number.as_bytes()).unwrap_err().to_string();
    let expected = "a.msh, line 7: \"7\" names one physical group and is the number of another";
    assert_eq!(message, expected);

    // A name without elements is an empty group.
    let mesh = replaced(TWO, "1 1 2 4 1 1 2\n", "1 1 2 0 1 1 2\n").expect("a mesh");
    let cells = Vec::new();
    assert_eq!(mesh.groups[0].members, Members::Cells { dim: 1, cells });
    assert_eq!(mesh.groups[0].name, "rim");
}

/// A group that an entity is in twice, with any sign, or under two numbers of one name has its cells once.
#[test]
fn no_cell_is_in_a_group_twice() {
    let cells = Members::Cells {
        dim: 2,
        cells: vec![1, 2],
    };
    let mesh = replaced(FOUR, "2 5 6 1 1", "4 5 -5 0 5 1 1").expect("a mesh");
    assert_eq!(mesh.groups.len(), 2);
    assert_eq!(mesh.groups[1].members, cells);
    let names = "$PhysicalNames\n2\n2 6 \"plate\"\n2 5 \"plate\"\n$EndPhysicalNames\n$Entities\n0";
    let mesh = replaced(FOUR, "$Entities\n0", names).expect("a mesh");
    assert_eq!(mesh.groups.len(), 2);
    assert_eq!(mesh.groups[0].name, "plate");
    assert_eq!(mesh.groups[0].members, cells);
}

/// Format 2 writes an element once for each of its groups.
#[test]
fn an_element_in_two_groups_is_one_cell() {
    let again = "3 2 2 5 1 1 3 4\n4 2 2 8 1 4 3 1\n";
    let text = TWO
        .replace("3 2 2 5 1 1 3 4\n", again)
        .replace("3\n1 1 2 4", "4\n1 1 2 4");
    let mesh = read("a.msh", text.as_bytes()).expect("a mesh");
    assert_eq!((mesh.cells.len(), &mesh.cell_ids[..]), (3, &[1, 2, 3][..]));
    let cells = vec![2];
    assert_eq!(mesh.groups[2].members, Members::Cells { dim: 2, cells });
    // In the same group it is another cell, which whoever checks meshes will find.
    let text = text.replace("4 2 2 8", "4 2 2 5");
    let mesh = read("a.msh", text.as_bytes()).expect("a mesh");
    assert_eq!(mesh.cells.len(), 4);
}

/// An entity in more groups than the file can mean.
#[test]
fn many_groups_of_many_elements_are_refused() {
    let tags: Vec<String> = (1..=3000).map(|k| k.to_string()).collect();
    let entity = format!("7 0 0 0 1 1 0 3000 {} 1 1", tags.join(" "));
    let triangles: Vec<String> = (2..=3001).map(|k| format!("{k} 1 2 3")).collect();
    let text = FOUR
        .replace("7 0 0 0 1 1 0 2 5 6 1 1", &entity)
        .replace("2 3 1 3\n1", "2 3001 1 3\n1");
    let text = text.replace(
        "2 7 2 2\n2 1 2 3\n3 1 3 4",
        &format!("2 7 2 3000\n{}", triangles.join("\n")),
    );
    let message = read("a.msh", text.as_bytes()).unwrap_err().to_string();
    let expected =
        "a.msh, line 25: entity 7 is in 3000 physical groups, which is too many for its elements";
    assert_eq!(message, expected);
}

/// Some programs write names without quotes: the rest of the line is the name.
#[test]
fn names_may_have_no_quotes() {
    let names = |text: &str| -> Vec<String> {
        let mesh = read("a.msh", text.as_bytes()).expect("a mesh");
        mesh.groups.into_iter().map(|g| g.name).collect()
    };
    let bare = TWO
        .replace("\"rim\"", "outer rim \t")
        .replace("2 5 \"plate\"", " 2\t5  plate-1");
    assert_eq!(names(&bare), ["outer rim", "plate-1"]);
    // A number may be a name; without quotes, too.
    assert_eq!(names(&TWO.replace("\"rim\"", "12")), ["12", "plate"]);
    // Format 2.0 may name groups without their dimension.
    let old = bare.replace("2.2 0 8", "2.0 0 8");
    assert_eq!(names(&old), ["outer rim", "plate-1"]);
    let short = old
        .replace("1 4 outer", "4 outer")
        .replace("2\t5  plate", "5 plate");
    assert_eq!(names(&short), ["outer rim", "plate-1"]);
    for wrong in [
        "1 4",
        "1 4 ",
        "4 rim",
        "1 rim",
        "9 4 rim",
        "1 4 rim\"",
        "1 0 rim",
    ] {
        let text = TWO.replace("1 4 \"rim\"", wrong);
        let message = read("a.msh", text.as_bytes()).unwrap_err().to_string();
        assert!(
            message.contains("line 6: found") && message.contains("and a name of UTF-8"),
            "{message}"
        );
    }
}
