//! Code that the programs `amontons` and `amontons-stability` share.

pub mod progress;
