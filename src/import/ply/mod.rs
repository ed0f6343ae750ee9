//! PLY files (Turk 1994): vertices and faces with any properties, as text, or binary in both byte orders.

mod header;
mod read;
mod records;
mod scalars;
#[cfg(test)]
mod tests;
mod vertices;
mod write;

pub use read::{read, read_sized};
pub use write::write;
