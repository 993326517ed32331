//! Unit tests of `crates/cli/src/checkpoint/file.rs`.

use super::super::rows::GlobalState;
use super::*;
use fetifeti::solution::State;

fn example() -> Checkpoint {
    Checkpoint {
        title: "Ein Körper".into(),
        scene: 0x1234_5678_9abc_def0,
        load_step: 3,
        records: "{\"steps\": [1, 2]}".into(),
        left: vec![(0, 5, [1e-3, -0.25, 0.0]), (2, 0, [0.0; 3])],
        state: GlobalState {
            local: vec![2, 0, 1],
            blocks: vec![(7, 2), (40, 1)],
            all: state(),
        },
    }
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
    let wrong: [fn(&mut GlobalState); 4] = [
        |s| s.local[0] = u64::MAX,
        |s| s.blocks[0].1 = 1,
        |s| s.all.lambda.truncate(5),
        |s| s.all.before.truncate(2),
    ];
    for change in wrong {
        let mut c = example();
        change(&mut c.state);
        let message = from_bytes(&to_bytes(&c)).expect_err("wrong counts");
        assert!(message.contains("contradicts itself"), "{message}");
    }
    // A right hash around a content that announces a list of 2⁶³ numbers.
    let content = [&[0, 0, 0, 0][..], &[0xff; 9], &[0x7f]].concat();
    let mut file = [
        MAGIC,
        &VERSION.to_le_bytes(),
        &(content.len() as u64).to_le_bytes(),
        &content,
    ]
    .concat();
    file.extend(hash(&file).to_le_bytes());
    let message = from_bytes(&file).expect_err("no such list");
    assert!(message.contains("contradicts itself"), "{message}");
}
