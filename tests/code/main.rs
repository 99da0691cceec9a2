//! The code keeps the order of its modules, and a step keeps its cost.
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
