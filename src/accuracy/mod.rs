//! How far results are off, and what each step of accuracy costs.

pub mod exact;
pub mod hard_cases;
