//! Lines on standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};
use std::process::exit;

/// Prints a line as `println!` does, but without a panic if the reader has closed standard output (`| head`).
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => { $crate::say::line(format_args!($($words)*)) };
}

/// Prints a line, or nothing if the reader has closed standard output: the files of a command are written all the same.
/// Any other failure ends the program.
pub fn line(words: Arguments<'_>) {
    match writeln!(stdout(), "{words}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("error: cannot write to standard output: {error}");
            exit(crate::exit::FAILED.into())
        }
        _ => {}
    }
}
