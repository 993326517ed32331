//! Reads the command line: options with one dash are PETSc's, clap takes the rest.

use std::os::unix::fs::FileTypeExt;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};

use super::args::{Command, CommandLine};
use base::{Error, Result};

/// The action that the arguments ask for.
#[derive(Debug, Clone, PartialEq)]
pub enum Wanted {
    /// Print a text: help, version.
    Say(String),
    /// Run a command.
    Run(Command),
}

/// The parsed command line.
#[derive(Debug, Clone, PartialEq)]
pub struct Invocation {
    /// The action.
    pub wanted: Wanted,
    /// Arguments for PetscInitialize.
    pub petsc: Vec<String>,
}

/// Reads the arguments (without the program's name).
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input), one sentence.
pub fn parse(args: Vec<String>) -> Result<Invocation> {
    let (ours, petsc) = split(args);
    check_options_files(&petsc)?;
    let set = std::env::var("PETSC_OPTIONS").unwrap_or_default();
    let words: Vec<String> = set.split_whitespace().map(String::from).collect();
    check_options_files(&words).map_err(|e| Error::input("PETSC_OPTIONS").because(e))?;
    let words = std::iter::once("fetifeti".to_string()).chain(ours);
    let wanted = match CommandLine::try_parse_from(words) {
        Ok(CommandLine { command, .. }) => {
            command.map_or_else(|| Wanted::Say(usage()), Wanted::Run)
        }
        Err(said) if !said.use_stderr() => Wanted::Say(said.to_string()),
        Err(mistake) => return Err(Error::input(sentence(&mistake))),
    };
    Ok(Invocation { wanted, petsc })
}

/// The text that `fetifeti --help` prints.
pub fn usage() -> String {
    CommandLine::command().render_help().to_string()
}

/// Separates our arguments from PETSc's, in the manner of PETSc: an argument behind an option is its value unless it is
/// an option itself.
fn split(args: Vec<String>) -> (Vec<String>, Vec<String>) {
    let is_option = |word: &str| word.starts_with('-') && word.parse::<f64>().is_err();
    let (mut ours, mut petsc) = (Vec::new(), Vec::new());
    let mut args = args.into_iter().peekable();
    while let Some(arg) = args.next() {
        if arg.starts_with("--") || !arg.starts_with('-') || arg == "-" {
            ours.push(arg);
            continue;
        }
        petsc.push(arg);
        petsc.extend(args.next_if(|next| !is_option(next)));
    }
    (ours, petsc)
}

/// Bytes of the longest file of options.
const MOST: u64 = 1 << 24;

/// Refuses what is no file of options: PETSc would read it to the end, and a device may have none.
fn check_options_files(petsc: &[String]) -> Result<()> {
    let named = petsc.windows(2).filter(|w| w[0] == "-options_file");
    for file in named.map(|w| &w[1]) {
        // What is not there is PETSc's to say.
        let Ok(data) = std::fs::metadata(file) else {
            continue;
        };
        let kind = data.file_type();
        let endless = kind.is_char_device() && file != "/dev/null" || kind.is_block_device();
        if endless || data.len() > MOST {
            return Err(Error::input(format!(
                "-options_file is {file}, {}, where a file with options was expected",
                if endless {
                    "a device".into()
                } else {
                    format!("which has {} bytes", data.len())
                }
            )));
        }
    }
    Ok(())
}

/// clap's message of several lines as one sentence.
fn sentence(mistake: &clap::Error) -> String {
    let of = |kind| match mistake.get(kind) {
        Some(ContextValue::String(one)) => Some(one.clone()),
        Some(ContextValue::Strings(several)) => Some(several.join(", ")),
        _ => None,
    };
    let wrong = of(ContextKind::InvalidSubcommand).or_else(|| of(ContextKind::InvalidArg));
    let mut out = match (mistake.kind(), wrong) {
        (ErrorKind::InvalidSubcommand, Some(name)) => format!("\"{name}\" is no command"),
        (ErrorKind::UnknownArgument, Some(flag)) if flag.starts_with("--") => {
            format!("{flag} is no option of this command")
        }
        (ErrorKind::UnknownArgument, Some(word)) => {
            format!("\"{word}\" was not expected behind the other arguments")
        }
        (ErrorKind::MissingRequiredArgument, Some(names)) => {
            let names = names.replace(['<', '>'], "").to_lowercase();
            format!("no {names} was given")
        }
        // The first paragraph of the message says what is wrong.
        _ => {
            let text = mistake.to_string();
            let text = text.strip_prefix("error: ").unwrap_or(&text);
            let first = text.split("\n\n").next().unwrap_or_default();
            first.split_whitespace().collect::<Vec<_>>().join(" ")
        }
    };
    let similar = [
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedArg,
        ContextKind::SuggestedValue,
    ];
    if let Some(name) = similar.into_iter().find_map(of) {
        out += &format!(", did you mean {name}?");
    }
    out + " (fetifeti --help tells more; PETSc options have one dash)"
}

#[cfg(test)]
#[path = "../tests/parse.rs"]
mod tests;
