//! The command line: ours with two dashes, PETSc's with one, resolved once.

use std::path::PathBuf;

use super::args::{Command, Invocation, Solve, Study, StudyName, Table1};
use crate::baselines::{Benchmark, Comparison};
use crate::report::destination::Destination;
use crate::{Error, Result};

/// Splits the arguments (without the program's name).
///
/// # Errors
/// [`Error::Input`] naming the argument and what was expected.
pub fn parse(args: &[String]) -> Result<Invocation> {
    let (words, petsc) = split(args)?;
    let mut words = Words { rest: words };
    let command = match words.next_plain() {
        None if words.flag("--version") => Command::Version,
        None => {
            words.flag("--help");
            Command::Help
        }
        Some(name) if words.flag("--help") => {
            known(&name)?;
            return Ok(Invocation {
                command: Command::Help,
                petsc,
            });
        }
        Some(name) => words.command(&name)?,
    };
    words.finish()?;
    Ok(Invocation { command, petsc })
}

const COMMANDS: [&str; 8] = [
    "solve", "plan", "compare", "bench", "table1", "study", "baseline", "measure",
];

/// Rounds of `bench` where `--rounds` does not say.
const ROUNDS: usize = 5;

fn known(name: &str) -> Result<()> {
    if COMMANDS.contains(&name) {
        return Ok(());
    }
    Err(Error::input(format!(
        "\"{name}\" is no command, expected solve, plan, compare, bench, table1 or study (fetifeti --help tells more)"
    )))
}

/// Flags of ours that take a value.
const WITH_VALUE: [&str; 7] = [
    "--out",
    "--json",
    "--rows",
    "--with",
    "--rounds",
    "--checkpoint",
    "--resume",
];

/// Ours (plain words and --flags with their values, in order) and PETSc's.
fn split(args: &[String]) -> Result<(Vec<String>, Vec<String>)> {
    let (mut ours, mut petsc) = (Vec::new(), Vec::new());
    let mut args = args.iter().peekable();
    while let Some(arg) = args.next() {
        if let Some((flag, value)) = arg.split_once('=').filter(|(f, _)| WITH_VALUE.contains(f)) {
            ours.extend([flag.to_string(), value.to_string()]);
        } else if WITH_VALUE.contains(&arg.as_str()) {
            let value = args.next().ok_or_else(|| {
                Error::input(format!("{arg} stands last, expected a value behind it"))
            })?;
            ours.extend([arg.clone(), value.clone()]);
        } else if arg.starts_with("--") || !arg.starts_with('-') || arg == "-" {
            ours.push(arg.clone());
        } else {
            petsc.push(arg.clone());
            // As PETSc reads them: what follows an option and is no option is its value.
            let is_value = |next: &&String| !next.starts_with('-') || next.parse::<f64>().is_ok();
            if let Some(value) = args.next_if(is_value) {
                petsc.push(value.clone());
            }
        }
    }
    Ok((ours, petsc))
}

struct Words {
    rest: Vec<String>,
}

impl Words {
    fn next_plain(&mut self) -> Option<String> {
        let mut at = 0;
        while at < self.rest.len() {
            match self.rest[at].as_str() {
                word if WITH_VALUE.contains(&word) => at += 2,
                word if word.starts_with("--") => at += 1,
                _ => return Some(self.rest.remove(at)),
            }
        }
        None
    }

    fn flag(&mut self, name: &str) -> bool {
        let before = self.rest.len();
        self.rest.retain(|w| w != name);
        self.rest.len() < before
    }

    fn value(&mut self, name: &str) -> Option<String> {
        let at = self.rest.iter().position(|w| w == name)?;
        self.rest.remove(at);
        Some(self.rest.remove(at))
    }

    fn path(&mut self, name: &str) -> Option<PathBuf> {
        self.value(name).map(PathBuf::from)
    }

    fn scene(&mut self, command: &str) -> Result<PathBuf> {
        self.next_plain().map(PathBuf::from).ok_or_else(|| {
            Error::input(format!(
                "{command} was given no scene, expected a TOML file right behind the command"
            ))
        })
    }

    fn destination(&mut self) -> Destination {
        Destination {
            out: self.path("--out"),
            json: self.path("--json"),
            quiet: self.flag("--quiet"),
        }
    }

    fn with(&mut self) -> Vec<String> {
        let list = self.value("--with");
        list.map(|list| list.split(',').map(|s| s.trim().to_string()).collect())
            .unwrap_or_default()
    }

    fn rounds(&mut self) -> Result<usize> {
        let Some(text) = self.value("--rounds") else {
            return Ok(ROUNDS);
        };
        let number = text.parse().ok().filter(|&n: &usize| n > 0);
        number.ok_or_else(|| {
            Error::input(format!(
                "--rounds is \"{text}\", expected a whole number from 1"
            ))
        })
    }

    fn study(&mut self) -> Result<StudyName> {
        let names = StudyName::ALL.map(StudyName::name).join(", ");
        let Some(word) = self.next_plain() else {
            return Err(Error::input(format!(
                "study was given no name, expected one of {names} right behind the command"
            )));
        };
        let found = StudyName::ALL.into_iter().find(|s| s.name() == word);
        found
            .ok_or_else(|| Error::input(format!("\"{word}\" is no study, expected one of {names}")))
    }

    fn command(&mut self, name: &str) -> Result<Command> {
        known(name)?;
        Ok(match name {
            "solve" => Command::Solve(Solve {
                scene: self.scene(name)?,
                out: self.path("--out"),
                json: self.path("--json"),
                quiet: self.flag("--quiet"),
                checkpoint: self.path("--checkpoint"),
                resume: self.path("--resume"),
            }),
            "plan" => Command::Plan {
                scene: self.scene(name)?,
            },
            "table1" => Command::Table1(Table1 {
                rows: std::iter::from_fn(|| self.value("--rows"))
                    .map(|text| row(&text))
                    .collect::<Result<_>>()?,
                out: self.path("--out"),
                json: self.path("--json"),
                quiet: self.flag("--quiet"),
            }),
            "compare" => Command::Compare(Comparison {
                scene: self.scene(name)?,
                with: self.with(),
                destination: self.destination(),
                petsc: Vec::new(),
            }),
            "bench" if self.flag("--list") => Command::BenchList,
            "bench" => Command::Bench(Benchmark {
                rounds: self.rounds()?,
                with: self.with(),
                destination: self.destination(),
                quick: self.flag("--quick"),
                cases: std::iter::from_fn(|| self.next_plain()).collect(),
                petsc: Vec::new(),
            }),
            "study" => Command::Study(Study {
                name: self.study()?,
                case: self.next_plain(),
                json: self.path("--json"),
                out: self.path("--out"),
                quick: self.flag("--quick"),
                quiet: self.flag("--quiet"),
            }),
            "measure" => Command::Measure {
                task: self.scene(name)?,
            },
            _ => Command::Baseline {
                job: self.scene(name)?,
            },
        })
    }

    fn finish(self) -> Result<()> {
        match self.rest.first() {
            None => Ok(()),
            Some(word) if word.starts_with("--") => Err(Error::input(format!(
                "{word} is no option of this command (fetifeti --help tells more; PETSc options have one dash)"
            ))),
            Some(word) => Err(Error::input(format!(
                "\"{word}\" was not expected behind the other arguments"
            ))),
        }
    }
}

/// `1/H_b,H_b/H_s,H_s/h`, as in `2,4,2`.
fn row(text: &str) -> Result<[usize; 3]> {
    let wrong = || {
        Error::input(format!(
            "--rows {text} is no row of the table, expected three counts of at least 1 (2 for the first) as in 2,4,2"
        ))
    };
    let counts: Vec<usize> = text
        .split(',')
        .map(|n| n.trim().parse().map_err(|_| wrong()))
        .collect::<Result<_>>()?;
    match counts[..] {
        [b, s, e] if b >= 2 && s >= 1 && e >= 1 => Ok([b, s, e]),
        _ => Err(wrong()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Invocation> {
        parse(
            &line
                .split_whitespace()
                .map(String::from)
                .collect::<Vec<_>>(),
        )
    }

    #[test]
    fn ours_and_petscs_arguments_mix() {
        let out = read(
            "solve a.toml -fetifeti_ksp_rtol 1e-9 --json - -fetifeti_ksp_monitor --quiet -n -3",
        )
        .expect("fine");
        let solve = Solve {
            scene: "a.toml".into(),
            json: Some("-".into()),
            quiet: true,
            ..Solve::default()
        };
        assert_eq!(out.command, Command::Solve(solve));
        assert_eq!(
            out.petsc,
            [
                "-fetifeti_ksp_rtol",
                "1e-9",
                "-fetifeti_ksp_monitor",
                "-n",
                "-3"
            ]
        );
    }

    #[test]
    fn a_run_is_resumed_and_goes_on_writing() {
        let out = read("solve --resume=a.ckpt --checkpoint b.ckpt a.toml").expect("fine");
        let solve = Solve {
            scene: "a.toml".into(),
            checkpoint: Some("b.ckpt".into()),
            resume: Some("a.ckpt".into()),
            ..Solve::default()
        };
        assert_eq!(out.command, Command::Solve(solve));
    }

    #[test]
    fn rows_repeat_and_are_checked() {
        let out = read("table1 --rows 2,4,2 --rows=2,2,8 --json -").expect("fine");
        let Command::Table1(table) = out.command else {
            panic!("table1")
        };
        assert_eq!(table.rows, [[2, 4, 2], [2, 2, 8]]);
        for bad in ["2,4", "2,4,0", "a,b,c", "1,2,2", ""] {
            assert!(read(&format!("table1 --rows={bad}")).is_err(), "{bad}");
        }
    }

    #[test]
    fn bench_takes_any_number_of_cases() {
        let out = read("bench cube-24 --rounds 7 a.toml --with gamg,mumps --quick").expect("fine");
        let bench = Benchmark {
            cases: vec!["cube-24".into(), "a.toml".into()],
            rounds: 7,
            with: vec!["gamg".into(), "mumps".into()],
            quick: true,
            ..Benchmark::default()
        };
        assert_eq!(out.command, Command::Bench(bench));
        let Command::Bench(all) = read("bench").expect("fine").command else {
            panic!("bench")
        };
        assert_eq!((all.cases.len(), all.rounds), (0, 5));
    }

    #[test]
    fn mistakes_are_named() {
        for (line, part) in [
            ("solv a.toml", "solv"),
            ("solve", "no scene"),
            ("solve a.toml b.toml", "b.toml"),
            ("solve a.toml --jsn x", "--jsn"),
            ("solve a.toml --json", "--json"),
            ("solve a.toml --resume", "--resume"),
            ("plan a.toml --checkpoint c", "--checkpoint"),
            ("bench --rounds 0", "--rounds is \"0\""),
            ("bench --rounds many", "many"),
            ("bench --rounds", "--rounds"),
            ("study", "no name"),
            ("study hurtz", "hurtz"),
            ("study hertz sphere a.toml", "a.toml"),
        ] {
            let message = read(line).expect_err(line).to_string();
            assert!(message.contains(part), "{line}: {message}");
        }
        assert_eq!(read("").expect("usage").command, Command::Help);
        assert_eq!(
            read("--version").expect("version").command,
            Command::Version
        );
    }
}
