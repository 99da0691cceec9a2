//! The code keeps the order of its modules, and a step allocates nothing.
//!
//! Apart from other tests, whose allocator this one's is not to be; it counts for each thread alone, so neighbours here
//! are not in each other's numbers.

mod architecture;
#[path = "../support/brake_pad.rs"]
mod brake_pad;
#[path = "../support/c.rs"]
mod c;
mod no_allocation;
