//! Unit tests of `crates/scene/src/checkpoint/file.rs`.

use super::super::NoRecords;
use super::*;
use crate::stepper::GlobalState;
use fetifeti::solution::State;
use serde::Deserialize;
use serde_json::{json, Value};

/// Records of a program.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Records {
    residuals: Vec<f64>,
    iterations: Vec<usize>,
}

fn example() -> Checkpoint<Records> {
    let mut example: Checkpoint<Records> = serde_json::from_value(fields()).expect("all fields");
    // The smallest step from 0.1, which a reader that rounds would lose.
    let residual = f64::from_bits(0.1f64.to_bits() + 1);
    example.records.residuals.push(residual);
    example
}

fn fields() -> Value {
    json!({
        "title": "Ein Körper",
        "scene": 0x1234_5678_9abc_def0_u64,
        "records": { "residuals": [], "iterations": [1, 2] },
        "stepper": {
            "load_step": 3,
            "left": [[0, 5, [1e-3, -0.25, 0.0]], [2, 0, [0.0, 0.0, 0.0]]],
            "contact": { "local": [2, 0, 1], "blocks": [[7, 2], [40, 1]], "all": state() },
        },
    })
}

fn state() -> State {
    let lambda = vec![0.5, -1e-300, f64::MAX, 3.0, 0.0, -0.0];
    let mut state = State::warm(lambda, &[true, false, true]);
    state.before = vec![true, true, false];
    (state.reference, state.steps, state.accuracy) = (0.1, 12, 0.01);
    (state.safeguarded, state.mu) = (true, vec![-2.5]);
    state
}

#[test]
fn what_is_written_is_read() {
    let c = example();
    assert_eq!(from_bytes(&to_bytes(&c)), Ok(c));
}

#[test]
fn records_may_be_of_another_program() {
    let c = example();
    let other: Checkpoint = from_bytes(&to_bytes(&c)).expect("other records are passed over");
    assert_eq!(other.records, NoRecords {});
    assert_eq!(other.stepper, c.stepper);
}

#[test]
fn fields_may_be_added() {
    let read =
        |fields: &Value| from_bytes::<Records>(&around(&serde_json::to_vec(fields).expect("JSON")));
    let whole = read(&fields()).expect("a checkpoint");
    let mut newer = fields();
    newer["stepper"]["slip"] = json!([0.5]);
    assert_eq!(read(&newer), Ok(whole));
    let mut older = fields();
    let stepper = older["stepper"].as_object_mut().expect("fields");
    stepper.remove("left");
    assert_eq!(read(&older).expect("a checkpoint").stepper.left, []);
    let stepper = older["stepper"].as_object_mut().expect("fields");
    stepper.remove("contact");
    read(&older).expect_err("nothing to start from");
}

#[test]
fn every_damage_is_found() {
    let bytes = to_bytes(&example());
    for n in 0..bytes.len() {
        let message = from_bytes::<Records>(&bytes[..n]).expect_err("too short");
        assert!(message.contains("truncated"), "{n}: {message}");
    }
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut bad = bytes.clone();
            bad[at] ^= 1 << bit;
            assert!(from_bytes::<Records>(&bad).is_err(), "byte {at}, bit {bit}");
        }
    }
    let longer = [&bytes[..], b"x"].concat();
    assert!(from_bytes::<Records>(&longer)
        .expect_err("too long")
        .contains("damaged"));
}

#[test]
fn contents_that_contradict_themselves_are_refused() {
    let wrong: [fn(&mut GlobalState); 4] = [
        |s| s.local[0] = u64::MAX,
        |s| s.blocks[0].1 = 1,
        |s| s.all.lambda.truncate(5),
        |s| s.all.before.truncate(2),
    ];
    for change in wrong {
        let mut c = example();
        change(&mut c.stepper.contact);
        let message = from_bytes::<Records>(&to_bytes(&c)).expect_err("wrong counts");
        assert!(message.contains("contradicts itself"), "{message}");
    }
    // A right hash around a content that is no checkpoint.
    for content in ["", "{}", "[1, 2", "{\"title\": 3}"] {
        let message = from_bytes::<Records>(&around(content.as_bytes())).expect_err("no fields");
        assert!(message.contains("contradicts itself"), "{message}");
    }
}
