//! The command line: arguments in, results out; the work is the library's.

mod accuracy;
mod arguments;
mod check;
mod effects;
mod export;
mod interrupt;
mod paper;
mod say;
mod scenes;
mod simulate;
mod study;
mod sweep;

use arguments::{Arguments, Command};
use clap::Parser;
use interrupt::Interrupted;
use std::process::ExitCode;

/// Exit codes: what kind of thing went wrong (2 is clap's too).
mod exit {
    pub const FAILED: u8 = 1;
    pub const ARGUMENTS: u8 = 2;
    pub const SCENE: u8 = 3;
    pub const RUN: u8 = 4;
    /// As shells have it for Ctrl-C.
    pub const INTERRUPTED: u8 = 130;
}

fn main() -> ExitCode {
    match run(&Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever reads has read enough (`| head`).
        Err(error) if simulate::is_broken_pipe(&*error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
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
        Command::Check(arguments) => check::run(arguments),
        Command::RunLibrary(arguments) => Ok(fmu_check::command::run_in_process(arguments)?),
        Command::Paper(arguments) => paper::run(arguments),
        Command::Study { command } => study::run(command),
        Command::Scenes { command } => scenes::run(command.as_ref()),
    }
}

fn exit_code(error: &(dyn std::error::Error + 'static)) -> u8 {
    if error.is::<Interrupted>() {
        return exit::INTERRUPTED;
    }
    if let Some(failed) = error.downcast_ref::<fmu_check::command::Failed>() {
        return failed.exit_code();
    }
    match error.downcast_ref::<amontons::Error>() {
        Some(error) if error.is_argument() => exit::ARGUMENTS,
        Some(error) if error.is_step() => exit::RUN,
        Some(error) if error.is_package() || error.is_file() || error.is_picture() => exit::FAILED,
        Some(_) => exit::SCENE,
        None => exit::FAILED,
    }
}
