//! The FMU's library as a host in C has it: FMI's functions by their names.

#[path = "../../../../tests/support/fmi2.rs"]
mod fmi2;

pub use fmi2::{Callbacks, Handle};
use fmi2::{References, functions};
use libloading::Library;
use std::ffi::{c_char, c_int};

macro_rules! declare {
    ($($name:ident($($argument:ty),*) -> $result:ty;)*) => {
        #[allow(non_snake_case)]
        pub struct Fmi {
            $(pub $name: unsafe extern "C" fn($($argument),*) -> $result,)*
            // Last: it goes after what points into it.
            _library: Library,
        }

        /// All of them.
        pub const NAMES: &[&str] = &[$(stringify!($name)),*];

        impl Fmi {
            pub fn load(path: &str) -> Self {
                // SAFETY: loading runs no code of its own, and the functions have FMI's types.
                unsafe {
                    let library = Library::new(path).expect("the library can be loaded");
                    Self {
                        $($name: *library.get(stringify!($name)).expect("it is exported"),)*
                        _library: library,
                    }
                }
            }
        }
    };
}

functions!(declare);
