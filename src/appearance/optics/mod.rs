//! Reflection and refraction at surfaces, as formulas over unit vectors and cosines.

mod fresnel;
mod fuzz;
mod microfacet;
mod refract;
#[cfg(test)]
mod tests;

pub use fresnel::{Fresnel, schlick};
pub use fuzz::Fuzz;
pub use microfacet::Microfacet;
pub use refract::{Refraction, reflect, refract};
