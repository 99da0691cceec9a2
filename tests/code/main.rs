//! What the code is held to, whatever it computes: the order of its modules, and the cost of a step.
//!
//! Apart from other tests, whose allocator this one's is not to be; it counts for each thread alone, so neighbours here
//! are not in each other's numbers.

mod architecture;
#[path = "../support/c.rs"]
mod c;
#[path = "../support/callgrind.rs"]
mod callgrind;
mod instructions;
mod no_allocation;
#[path = "../support/oscillator.rs"]
mod oscillator;
