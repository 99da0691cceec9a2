//! The command line of `amontons`: it reads arguments and writes results; the library does the computation.

mod accuracy;
mod arguments;
mod check;
mod effects;
mod export;
mod reduce;
mod reference;
mod scenes;
mod simulate;
mod study;
mod sweep;

use amontons_cli::exit;
use amontons_cli::shards::Missing;
use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match run(&Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of standard output has closed it (`| head`).
        Err(error) if simulate::is_broken_pipe(&*error) => ExitCode::SUCCESS,
        Err(error) => {
            // Which pieces are missing is told as a result.
            if !error.is::<Missing>() {
                eprintln!("error: {error}");
            }
            ExitCode::from(exit_code(&*error))
        }
    }
}

fn run(command: &Command) -> Result<(), Box<dyn std::error::Error>> {
    match command {
        Command::Export(arguments) => export::run(arguments),
        Command::Simulate(arguments) => simulate::run(arguments),
        Command::Accuracy(arguments) => accuracy::run(arguments),
        Command::Effects(arguments) => effects::run(arguments),
        Command::Reduce(arguments) => reduce::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::RunLibrary(arguments) => Ok(fmu_check::command::run_in_process(arguments)?),
        Command::Study { command } => study::run(command),
        Command::Scenes { command } => scenes::run(command.as_ref()),
    }
}

fn exit_code(error: &(dyn std::error::Error + 'static)) -> u8 {
    if error.is::<reduce::NotShown>() {
        return exit::NOT_SHOWN;
    }
    match error.downcast_ref::<fmu_check::command::Failed>() {
        Some(failed) => failed.exit_code(),
        None => exit::code(error),
    }
}
