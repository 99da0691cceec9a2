//! `amontons study merge`.

use crate::arguments::Arguments;
use amontons_cli::shards::{Program, merging, tell_command};
use clap::Args;
use std::error::Error;
use std::path::PathBuf;

#[derive(Args)]
pub struct Merge {
    /// The folder that the workers were given with -o
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

pub fn run(arguments: &Merge) -> Result<(), Box<dyn Error>> {
    let merge: Arguments = merging(Program::Amontons, &arguments.folder)?;
    let merged = crate::run(&merge.command);
    if merged.as_ref().is_err_and(|error| error.is::<amontons::Error>()) {
        tell_command(&arguments.folder);
    }
    merged
}
