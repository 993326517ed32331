use super::of;

#[test]
fn files_that_a_scene_names_are_hashed() {
    let names = |scene: &str| -> Vec<String> {
        let inputs = of(std::path::Path::new(scene));
        inputs.into_iter().map(|input| input.file).collect()
    };
    let wall = names("../../examples/scenes/wall.toml");
    let named = ["wall.toml", "wall_bricks.txt", "wall_halves.txt"];
    assert_eq!(wall, named.map(|n| format!("../../examples/scenes/{n}")));
    let flange = names("../../examples/gallery/bolted_flange.toml");
    assert_eq!(flange[1], "../../examples/gallery/bolted_flange.msh");
    assert!(of(std::path::Path::new("no such file")).is_empty());
}

#[test]
fn hashes_are_those_of_sha256() {
    // The example of FIPS 180-2, and the file that a deck includes.
    let folder = std::env::temp_dir().join(format!("fetifeti-inputs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("abc.txt"), "abc").expect("written");
    let deck = "*HEADING\n*INCLUDE, INPUT=abc.txt\n*INCLUDE,INPUT=missing.txt\n";
    std::fs::write(folder.join("deck.inp"), deck).expect("written");
    let inputs = of(&folder.join("deck.inp"));
    std::fs::remove_dir_all(&folder).expect("removed");
    assert_eq!(inputs.len(), 2);
    assert_eq!(inputs[1].bytes, 3);
    let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(inputs[1].sha256, expected);
}
