//! Volume by places: prisms between the skin and a core that moves with it, gathered by cells of the core [MATH §9].

mod balls;
mod cells;
pub mod following;
mod largest_ball;
mod prisms;
pub mod rest;
