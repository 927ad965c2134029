//! `completions` and `man`: what packagers install beside the program. Both come from the definition of the command
//! line, so they cannot go out of date.

use clap::CommandFactory;
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use crate::args::CommandLine;
use crate::exit::{Failure, Outcome};
use crate::output::write_stdout;

/// Prints the completions of a shell.
pub(crate) fn completions(shell: Shell) -> Outcome {
    let mut command = CommandLine::command();
    let name = command.get_name().to_owned();
    let mut bytes = Vec::new();
    generate(shell, &mut command, name, &mut bytes);
    Ok(write_stdout(&bytes)?)
}

/// Prints the manual page of the program, or of one of its commands.
pub(crate) fn man(subcommand: Option<&str>) -> Outcome {
    let mut command = CommandLine::command();
    // The options that every command has are passed on to them.
    command.build();
    let page = match subcommand {
        None => command,
        Some(name) => command
            .find_subcommand(name)
            .cloned()
            .ok_or_else(|| Failure::wrong_use(format!("man: there is no command {name}")))?
            .display_name(format!("{}-{name}", command.get_name())),
    };
    let mut bytes = Vec::new();
    Man::new(page).render(&mut bytes)?;
    Ok(write_stdout(&bytes)?)
}
