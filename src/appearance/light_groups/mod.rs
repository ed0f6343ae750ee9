//! Light groups: lights that are keyed alike share a layer of the film, which is weighted afterwards.

pub mod glow;
pub mod layers;
