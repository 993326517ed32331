use super::*;

fn none(name: &str) -> Result<Vec<u8>> {
    Err(Error::input(format!("there is no file {name}")))
}

fn cards(text: &str) -> Cards {
    Cards::new("a.inp", text.as_bytes(), &none).expect("a deck")
}

fn message(text: &str, include: &dyn Fn(&str) -> Result<Vec<u8>>) -> String {
    let error = Cards::new("a.inp", text.as_bytes(), include).expect_err("no deck");
    error.to_string()
}

fn fields(cards: &Cards, card: usize) -> Vec<Vec<String>> {
    let rows = cards.rows(&cards.cards[card]);
    rows.map(|r| r.fields.iter().map(|f| f.to_string()).collect())
        .collect()
}

#[test]
fn blanks_case_comments_and_empty_fields() {
    let deck = cards(
        "\u{feff}** comment\r\n\r\n  *Node , NSET = n a ll\r\n1, 2.,, 3 ,,\r\n\
         ** no\r\n ,\r\n*EL PRINT\r\n",
    );
    assert_eq!(deck.cards[0].keyword, "NODE");
    let param = Param {
        name: "NSET".into(),
        value: "NALL".into(),
    };
    assert_eq!(deck.cards[0].params, [param]);
    assert_eq!(deck.cards[0].place.line, 3);
    assert_eq!(fields(&deck, 0), [vec!["1", "2.", "", "3"], vec![]]);
    assert_eq!(deck.cards[1].keyword, "ELPRINT");
    assert_eq!(deck.cards[1].place.line, 7);
}

#[test]
fn keyword_lines_go_on_after_a_comma_if_parameters_follow() {
    let deck = cards(
        "*ELEMENT, TYPE=C3D4,\nELSET=E\n1,2\n*BOUNDARY,\nN1,1,3\n*NSET,NSET=A,\ngenerate\n1,5\n",
    );
    assert_eq!(deck.cards[0].params.len(), 2);
    assert_eq!(fields(&deck, 0).len(), 1);
    assert_eq!(deck.cards[1].params.len(), 0);
    assert_eq!(fields(&deck, 1), [["N1", "1", "3"]]);
    assert_eq!(deck.cards[2].params[1].name, "GENERATE");
}

#[test]
fn titles_may_be_anything() {
    let deck = cards("*HEADING\nModel, of = something\n nothing\n*NODE\n1\n");
    assert_eq!(fields(&deck, 0).len(), 0);
    assert_eq!(fields(&deck, 1), [["1"]]);
}

#[test]
fn files_are_included_where_they_are_named() {
    let include = |name: &str| match name {
        "Nodes.inp" => Ok(b"*NODE\n1,0\n*INCLUDE,INPUT=\"two more.inp\"\n".to_vec()),
        "two more.inp" => Ok(b"2,1\n3,2".to_vec()),
        _ => none(name),
    };
    let deck = Cards::new(
        "a.inp",
        b"*HEADING\nx\n*Include, Input=Nodes.inp\n4,3\n*STEP",
        &include,
    )
    .expect("a deck");
    assert_eq!(
        fields(&deck, 1),
        [["1", "0"], ["2", "1"], ["3", "2"], ["4", "3"]]
    );
    let rows: Vec<String> = deck
        .rows(&deck.cards[1])
        .map(|r| deck.files.at(r.place))
        .collect();
    assert_eq!(
        rows,
        [
            "Nodes.inp, line 2",
            "two more.inp, line 1",
            "two more.inp, line 2",
            "a.inp, line 4"
        ]
    );
}

#[test]
fn what_cannot_be_included_is_said() {
    let itself = |_: &str| Ok(b"*INCLUDE,INPUT=b.inp".to_vec());
    assert_eq!(
        message("*INCLUDE,INPUT=b.inp", &itself),
        "b.inp, line 1: b.inp includes itself"
    );
    let deeper = |name: &str| Ok(format!("\n*INCLUDE,INPUT=x{name}").into_bytes());
    assert!(message("*INCLUDE,INPUT=b", &deeper).contains("line 2: too many included files"));
    // Twelve files within each other twice would be 4096.
    let twice =
        |name: &str| Ok(format!("*INCLUDE,INPUT={name}1\n*INCLUDE,INPUT={name}2").into_bytes());
    assert!(message("*INCLUDE,INPUT=b", &twice).contains("too many included files"));
    assert_eq!(
        message("*NODE\n*INCLUDE,INPUT=b", &none),
        "a.inp, line 2: b cannot be included: there is no file b"
    );
    assert!(message("*INCLUDE", &none).contains("line 1: *INCLUDE needs INPUT="));
}

#[test]
fn what_is_no_deck_is_said() {
    assert!(message("1,2,3\n*NODE", &none)
        .starts_with("a.inp, line 1: a line of data that belongs to no keyword"));
    assert!(message("*NODE\n1,\0", &none).contains("a.inp is no deck"));
    assert!(Cards::new("a.inp", b"*NODE\n** K\xf6rper\n1,2", &none).is_ok());
    assert!(cards("").cards.is_empty());
}
