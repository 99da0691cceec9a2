//! Structures whose matrices depend on one parameter, and their modes followed over it.

mod description;
mod follow;

pub use description::{Family, Loaded, Parameter};
pub use follow::{Branch, Crossing, Follower, Point, grows};
