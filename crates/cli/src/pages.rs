//! The program's shell completions and manual pages.

use std::path::Path;

use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use super::args::CommandLine;
use base::{Error, Result};
use report::destination::Destination;
use report::output;

/// The completion script for a shell.
pub fn completions(shell: Shell) -> String {
    let line = CommandLine::command();
    // Commands by which processes of the program call each other are left out.
    let users = line.get_subcommands().filter(|c| !c.is_hide_set()).cloned();
    let mut shown = Command::new("fetifeti")
        .version(env!("CARGO_PKG_VERSION"))
        .disable_help_flag(true)
        .disable_version_flag(true)
        .args(line.get_arguments().cloned())
        .subcommands(users);
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut shown, "fetifeti", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Prints the manual page of the program, or writes it into the directory with those of its commands.
pub fn manual(dir: Option<&Path>) -> Result<()> {
    let mut line = CommandLine::command().disable_help_subcommand(true);
    line.build();
    let Some(dir) = dir else {
        return output::print(&roff(&Man::new(line))?);
    };
    let commands = line.get_subcommands().filter(|c| !c.is_hide_set());
    let mut names = Vec::new();
    for command in std::iter::once(&line).chain(commands) {
        let version = concat!("fetifeti ", env!("CARGO_PKG_VERSION"));
        let page = Man::new(Command::clone(command)).source(version);
        output::write_text(&dir.join(page.get_filename()), &roff(&page)?)?;
        names.push(page.get_filename());
    }
    Destination {
        out: Some(dir.into()),
        ..Destination::default()
    }
    .written(&names)
}

fn roff(page: &Man) -> Result<String> {
    let mut text = Vec::new();
    page.render(&mut text)
        .map_err(|e| Error::environment("cannot write the manual").because(e))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
