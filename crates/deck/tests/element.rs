use super::*;

#[test]
fn names_tell_kinds_and_integration() {
    for &element in ElementType::ALL {
        assert_eq!(ElementType::named(element.name()), Some(element));
        assert_eq!(shape(element.name()), Some(element.kind()));
        let name = element.name();
        let (family, rest) = name.split_at(3);
        let nodes: String = rest.chars().take_while(char::is_ascii_digit).collect();
        assert_eq!(nodes.parse(), Ok(element.kind().nodes()), "{name}");
        let model = match family {
            "C3D" => ElementModel::Solid,
            "CPE" => ElementModel::PlaneStrain,
            "CPS" => ElementModel::PlaneStress,
            _ => ElementModel::Axisymmetric,
        };
        assert_eq!(element.model(), model, "{name}");
        assert_eq!(element.kind().dim(), if family == "C3D" { 3 } else { 2 });
        assert_eq!(
            element.integration() == Integration::Reduced,
            name.ends_with('R'),
            "{name}"
        );
        assert_eq!(
            element.integration() == Integration::Incompatible,
            name.ends_with('I'),
            "{name}"
        );
    }
    assert_eq!(ElementType::named("S8R"), None);
    assert_eq!(shape("S8R"), Some(CellKind::Quad8));
    assert_eq!(shape("NOTHING"), None);
}

#[test]
fn messages_say_what_an_element_is() {
    assert_eq!(what_is("S8R"), "shells");
    assert_eq!(what_is("SPRINGA"), "springs");
    assert_eq!(what_is("D"), "networks of fluids");
    assert_eq!(what_is("DCOUP3D"), "couplings");
    assert_eq!(what_is("X"), "unknown elements");
}
