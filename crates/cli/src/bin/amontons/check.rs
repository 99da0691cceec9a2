//! `amontons check`: the command of the program `fmu-check`, with the progress bar and the handling of Ctrl-C of
//! `amontons`.

use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use fmu_check::command::{self, Arguments, Failed};
use std::error::Error;
use std::sync::Once;

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let shown = Progress::new("the check", 0);
    // Until there are files to remove, Ctrl-C ends the program at once.
    let listen = Once::new();
    let result = command::run(arguments, &mut |stage| {
        listen.call_once(interrupt::listen);
        shown.say(stage);
        interrupt::stopped()
    });
    shown.finish();
    result.map_err(|failed| match failed {
        Failed::Interrupted => Interrupted.into(),
        Failed::Output(error) => error.into(),
        other => other.into(),
    })
}
