//! Lines on standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};
use std::process::exit;

/// Prints a line as `println!` does, which ends with a panic where nobody reads on, as after `| head`.
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => { $crate::say::line(format_args!($($words)*)) };
}

/// Prints a line, or nothing where nobody reads on: the files that a command writes are written all the same. Any other failure
/// ends the program.
pub fn line(words: Arguments<'_>) {
    match writeln!(stdout(), "{words}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("error: cannot print: {error}");
            exit(crate::exit::FAILED.into())
        }
        _ => {}
    }
}
