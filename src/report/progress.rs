//! A progress line on stderr for the contact loop, redrawn in place and removed at the end. There is none where stderr
//! is not a terminal.
//!
//! ```text
//! contact step 3, 130 active  [##############>               ] 2.3e-4 of 1.0e-8, 17 it
//! ```

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Length of the bar in characters.
const BAR: usize = 30;
/// Shortest time between two redraws: more than twenty per second are not visible.
const PAUSE: Duration = Duration::from_millis(50);

/// The line.
pub struct Progress {
    out: Option<Box<dyn Write>>,
    now: Box<dyn Fn() -> Duration>,
    drawn: Option<Duration>,
    width: usize,
    step: usize,
    active: usize,
}

impl Progress {
    /// A line on stderr, if that is a terminal and `enabled` is set: on rank 0, without `--quiet`.
    pub fn new(enabled: bool) -> Self {
        let start = Instant::now();
        let terminal = enabled && std::io::stderr().is_terminal();
        let out: Option<Box<dyn Write>> = if terminal {
            Some(Box::new(std::io::stderr()))
        } else {
            None
        };
        Progress::to(out, Box::new(move || start.elapsed()))
    }

    /// A line on any writer, or none, with any clock; for tests.
    pub fn to(out: Option<Box<dyn Write>>, now: Box<dyn Fn() -> Duration>) -> Self {
        Progress {
            out,
            now,
            drawn: None,
            width: 0,
            step: 0,
            active: 0,
        }
    }

    /// Starts an outer step. The line is always redrawn: outer steps are few.
    pub fn step(&mut self, step: usize, active: usize) {
        (self.step, self.active) = (step, active);
        self.draw(&self.line(None));
    }

    /// Shows the residual after some inner iterations of the step, relative to its start. The line is redrawn at most
    /// twenty times a second.
    pub fn residual(&mut self, relative: f64, tolerance: f64, iterations: usize) {
        if self.out.is_none() {
            return;
        }
        let early = |last: Duration| (self.now)() < last + PAUSE;
        if self.drawn.is_some_and(early) {
            return;
        }
        self.draw(&self.line(Some((relative, tolerance, iterations))));
    }

    /// Removes the line. Also done when the value is dropped.
    pub fn finish(&mut self) {
        if self.width > 0 {
            let blank = " ".repeat(self.width);
            self.put(&format!("\r{blank}\r"));
            self.width = 0;
        }
    }

    fn line(&self, residual: Option<(f64, f64, usize)>) -> String {
        let mut text = format!("contact step {}, {} active", self.step, self.active);
        let (relative, tolerance, iterations) = residual.unwrap_or((1.0, f64::NAN, 0));
        let cells = (fraction(relative, tolerance) * BAR as f64) as usize;
        let mut bar = "#".repeat(cells);
        if cells < BAR {
            bar.push('>');
        }
        text += &format!("  [{bar:<BAR$}]");
        if residual.is_some() {
            text += &format!(" {relative:.1e} of {tolerance:.1e}, {iterations} it");
        }
        text
    }

    fn draw(&mut self, line: &str) {
        if self.out.is_none() {
            return;
        }
        let width = line.chars().count();
        // Blanks overwrite the end of a longer line before.
        let rest = " ".repeat(self.width.saturating_sub(width));
        self.put(&format!("\r{line}{rest}"));
        self.width = width;
        self.drawn = Some((self.now)());
    }

    fn put(&mut self, text: &str) {
        if let Some(out) = &mut self.out {
            // If the terminal has gone away, the computation continues.
            if out
                .write_all(text.as_bytes())
                .and_then(|()| out.flush())
                .is_err()
            {
                self.out = None;
            }
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

/// Progress of a residual from 1 to the tolerance, in decades; between 0 and 1.
fn fraction(relative: f64, tolerance: f64) -> f64 {
    if relative.is_nan() || tolerance.is_nan() || tolerance >= 1.0 {
        // No decades to cover, or no number: full when the residual is small enough.
        return if relative <= tolerance { 1.0 } else { 0.0 };
    }
    let decades = relative.max(1e-300).log10() / tolerance.max(1e-300).log10();
    decades.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
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

    fn progress() -> (Terminal, Rc<Cell<u64>>, Progress) {
        let (terminal, clock) = (Terminal::default(), Rc::new(Cell::new(0)));
        let time = clock.clone();
        let progress = Progress::to(
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
        let mut p = Progress::to(None, Box::new(|| Duration::ZERO));
        p.step(1, 5);
        p.residual(0.1, 1e-3, 1);
        assert_eq!(p.width, 0);
        let mut p = Progress::new(false);
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
        let mut p = Progress::to(Some(Box::new(Gone)), Box::new(|| Duration::ZERO));
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
}
