//! The functions of the FMU's library, for tests that link it.
#![allow(dead_code, unsafe_code)] // No test needs all, and they are C's.

#[path = "fmi2.rs"]
mod fmi2;

pub use fmi2::{Callbacks, Handle};
use fmi2::{References, functions};
use std::ffi::{c_char, c_int};

macro_rules! declare {
    ($($name:ident($($argument:ty),*) -> $result:ty;)*) => {
        unsafe extern "C" {
            $(pub fn $name($(_: $argument),*) -> $result;)*
        }
    };
}

functions!(declare);
