//! Motion that a program computes, instead of keys.

use crate::base::math::DAffine3;
use crate::base::time::Time;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// A map as a function of time in seconds. It must be pure: the same time gives the same map, in any order of calls and
/// on any thread.
#[derive(Clone)]
pub struct Motion(Arc<dyn Fn(f64) -> DAffine3 + Send + Sync>);

impl Motion {
    pub fn new(map: impl Fn(f64) -> DAffine3 + Send + Sync + 'static) -> Self {
        Self(Arc::new(map))
    }

    pub fn at(&self, time: Time) -> DAffine3 {
        self.0(*time.numer() as f64 / *time.denom() as f64)
    }
}

/// Whether both are the same function, not whether two functions have the same values.
impl PartialEq for Motion {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Debug for Motion {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str("Motion")
    }
}
