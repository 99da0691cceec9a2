//! The program `fmu-check`, which finds the rules of FMI 2.0 that an FMU breaks.

use clap::{Parser, Subcommand};
use fmu_check::command::{self, Arguments, Failed, LibraryRun};
use indicatif::ProgressBar;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Check an FMI 2.0 co-simulation FMU from any tool: archive, model description, libraries, and a run of the library
#[derive(Parser)]
#[command(
    version,
    arg_required_else_help = true,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true
)]
struct Program {
    #[command(flatten)]
    arguments: Option<Arguments>,
    #[command(subcommand)]
    process: Option<Process>,
}

#[derive(Subcommand)]
enum Process {
    /// Run the library of an unpacked FMU; an examination starts this
    #[command(name = fmu_check::COMMAND, hide = true)]
    RunLibrary(LibraryRun),
}

/// `true` once the user has pressed Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

fn main() -> ExitCode {
    match run(&Program::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of standard output has closed it (`| head`).
        Err(Failed::Output(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(program: &Program) -> Result<(), Failed> {
    match program {
        Program { process: Some(Process::RunLibrary(arguments)), .. } => {
            Ok(command::run_in_process(arguments)?)
        }
        Program { arguments: Some(arguments), .. } => examine(arguments),
        Program { .. } => Ok(()),
    }
}

/// Examines an FMU. A spinner shows the stage of the run where standard error is a terminal.
fn examine(arguments: &Arguments) -> Result<(), Failed> {
    let spinner = ProgressBar::new_spinner();
    // Until the run has files to remove, Ctrl-C ends the program at once.
    let listen = Once::new();
    let result = command::run(arguments, &mut |stage| {
        listen.call_once(|| {
            // If no handler can be set, Ctrl-C keeps ending the program at once.
            let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
            spinner.enable_steady_tick(Duration::from_millis(200));
        });
        spinner.set_message(stage.to_owned());
        if STOP.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    spinner.finish_and_clear();
    result
}
