//! `kinora completions`: prints a script that lets a shell complete commands, options and values.

use super::failure::Failure;
use super::{program, terminal};
use clap::Args;
use clap_complete::Shell;

/// Print a script that completes commands, options and values in a shell.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Examples:
  kinora completions bash > ~/.local/share/bash-completion/completions/kinora
  kinora completions zsh > \"${fpath[1]}/_kinora\"
  kinora completions fish > ~/.config/fish/completions/kinora.fish
  kinora completions powershell >> $PROFILE

The script works in shells that start afterwards.")]
pub struct Arguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    terminal::print_text(script(arguments.shell).trim_end())
}

fn script(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program(), "kinora", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_shell_completes_every_command() {
        for shell in Shell::value_variants() {
            let script = script(*shell);
            for command in program().get_subcommands() {
                assert!(script.contains(command.get_name()), "{shell}: {}", command.get_name());
            }
            assert!(script.contains("time-limit"), "{shell} completes options");
        }
    }
}
