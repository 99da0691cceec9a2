//! What the programs `amontons` and `amontons-stability` share.

pub mod progress;
