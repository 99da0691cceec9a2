//! Code that the programs `amontons` and `amontons-stability` and the examples share.

pub mod arguments;
pub mod charts;
pub mod exit;
pub mod interrupt;
pub mod progress;
pub mod say;
pub mod shards;
pub mod words;
