//! Large data that many own and nobody changes.

use std::ops::Deref;
use std::sync::Arc;

/// Something loaded once, compared by where it is and not by what it holds: values that are compared in every
/// frame must not walk through an image's texels.
#[derive(Debug)]
pub struct Shared<T>(Arc<T>);

impl<T> Shared<T> {
    pub fn new(value: T) -> Self {
        Self(Arc::new(value))
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_is_who_shares() {
        let one = Shared::new(1);
        assert_eq!(one, one.clone());
        assert_ne!(one, Shared::new(1));
    }
}
