//! Unit tests of `crates/report/src/progress.rs`.

use super::*;
use std::cell::{Cell, RefCell};
use std::rc::Rc;

#[derive(Clone, Default)]
struct Terminal(Rc<RefCell<Vec<u8>>>);

impl Write for Terminal {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Terminal {
    /// The visible text of the line after all output.
    fn shown(&self) -> String {
        let mut cells: Vec<char> = Vec::new();
        let mut at = 0;
        for c in String::from_utf8(self.0.borrow().clone()).unwrap().chars() {
            match c {
                '\r' => at = 0,
                c => {
                    cells.resize(cells.len().max(at + 1), ' ');
                    cells[at] = c;
                    at += 1;
                }
            }
        }
        cells.iter().collect::<String>().trim_end().to_string()
    }

    fn redraws(&self) -> usize {
        self.0.borrow().iter().filter(|&&b| b == b'\r').count()
    }
}

fn progress() -> (Terminal, Rc<Cell<u64>>, ProgressLine) {
    let (terminal, clock) = (Terminal::default(), Rc::new(Cell::new(0)));
    let time = clock.clone();
    let progress = ProgressLine::to(
        Some(Box::new(terminal.clone())),
        Box::new(move || Duration::from_millis(time.get())),
    );
    (terminal, clock, progress)
}

#[test]
fn the_line_shows_the_state_and_goes_away() {
    let (terminal, clock, mut p) = progress();
    p.step(3, 1130);
    assert!(terminal
        .shown()
        .starts_with("contact step 3, 1130 active  [>"));
    clock.set(100);
    p.residual(1e-4, 1e-8, 17);
    let half = format!("[{}>{}]", "#".repeat(15), " ".repeat(14));
    assert_eq!(
        terminal.shown(),
        format!("contact step 3, 1130 active  {half} 1.0e-4 of 1.0e-8, 17 it")
    );
    // A shorter line leaves no rest of the longer one.
    p.step(4, 9);
    assert_eq!(
        terminal.shown(),
        format!("contact step 4, 9 active  [>{}]", " ".repeat(29))
    );
    p.finish();
    assert_eq!(terminal.shown(), "");
    let redraws = terminal.redraws();
    drop(p);
    assert_eq!(terminal.redraws(), redraws, "finished once");
}

#[test]
fn at_most_twenty_redraws_a_second() {
    let (terminal, clock, mut p) = progress();
    p.step(1, 0);
    for k in 1..=10_000 {
        clock.set(k / 10); // ten residuals a millisecond, for one second
        p.residual(0.5, 1e-8, k as usize);
    }
    assert_eq!(terminal.redraws(), 21);
    drop(p);
    assert_eq!(terminal.shown(), "");
}

#[test]
fn nothing_is_written_where_nobody_looks() {
    let mut p = ProgressLine::to(None, Box::new(|| Duration::ZERO));
    p.step(1, 5);
    p.residual(0.1, 1e-3, 1);
    assert_eq!(p.width, 0);
    let mut p = ProgressLine::new(false);
    p.step(1, 5);
    assert!(p.out.is_none() && p.width == 0);
}

#[test]
fn a_broken_terminal_ends_the_line_and_not_the_run() {
    struct Gone;
    impl Write for Gone {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("gone"))
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut p = ProgressLine::to(Some(Box::new(Gone)), Box::new(|| Duration::ZERO));
    p.step(1, 5);
    assert!(p.out.is_none());
    p.finish();
}

#[test]
fn the_bar_counts_decades() {
    assert_eq!(fraction(1.0, 1e-8), 0.0);
    assert_eq!(fraction(1e-2, 1e-8), 0.25);
    assert_eq!(fraction(1e-12, 1e-8), 1.0);
    assert_eq!(fraction(7.0, 1e-8), 0.0);
    assert_eq!(fraction(0.0, 0.0), 1.0);
    assert_eq!(fraction(f64::NAN, 1e-8), 0.0);
    assert_eq!((fraction(0.5, 2.0), fraction(3.0, 2.0)), (1.0, 0.0));
}

#[test]
fn load_steps_say_how_many_are_left_and_for_how_long() {
    let (terminal, clock, mut p) = progress();
    // Resumed at the third of five.
    p.load_step(2, 5);
    assert_eq!(terminal.shown(), "load step 3 of 5");
    p.step(1, 7);
    let shown = terminal.shown();
    assert!(
        shown.starts_with("load step 3 of 5, contact step 1, 7 active  [>"),
        "{shown}"
    );
    clock.set(20_000);
    p.load_step(3, 5);
    assert_eq!(terminal.shown(), "load step 4 of 5, about 40 s left");
    p.finish();
    assert_eq!(terminal.shown(), "");
}
