//! The command `kinora`.

use std::process::ExitCode;

fn main() -> ExitCode {
    kinora::cli::main()
}
