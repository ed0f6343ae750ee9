//! Kinds of rays, and which of them see an object.

use crate::base::digest::Content;
use crate::base::time::Time;
use crate::track::Animated;

/// Why a ray is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera, also after surfaces that let it pass straight on.
    Camera,
    /// Reflected, refracted or scattered by a surface.
    Scattered,
    /// From a surface to a light.
    Shadow,
}

impl RayKind {
    pub const ALL: [Self; 3] = [Self::Camera, Self::Scattered, Self::Shadow];

    pub fn index(self) -> usize {
        self as usize
    }
}

/// A set of kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub struct RayKinds(u8);

impl RayKinds {
    pub const ALL: Self = Self(0b111);
    pub const NONE: Self = Self(0);

    pub fn is_empty(self) -> bool {
        self == Self::NONE
    }

    #[inline(always)]
    pub fn has(self, kind: RayKind) -> bool {
        self.0 >> kind.index() & 1 == 1
    }

    /// The kinds of both sets.
    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    fn of(kinds: [(RayKind, bool); 3]) -> Self {
        Self(kinds.into_iter().map(|(kind, has)| u8::from(has) << kind.index()).sum())
    }
}

/// Which rays see an object over time.
#[derive(Clone, Debug, PartialEq)]
pub struct RayVisibility {
    pub camera: Animated<bool>,
    pub reflections: Animated<bool>,
    pub shadows: Animated<bool>,
}

impl Default for RayVisibility {
    fn default() -> Self {
        Self { camera: true.into(), reflections: true.into(), shadows: true.into() }
    }
}

impl RayVisibility {
    pub fn is_keyed(&self) -> bool {
        let Self { camera, reflections, shadows } = self;
        [camera, reflections, shadows].into_iter().any(Animated::is_keyed)
    }

    pub fn at(&self, time: Time) -> RayKinds {
        let Self { camera, reflections, shadows } = self;
        RayKinds::of([
            (RayKind::Camera, camera.at(time)),
            (RayKind::Scattered, reflections.at(time)),
            (RayKind::Shadow, shadows.at(time)),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_have_the_kinds_that_are_on() {
        let rays = RayVisibility { reflections: false.into(), ..RayVisibility::default() };
        let kinds = rays.at(Time::from_integer(0));
        assert_eq!(RayKind::ALL.map(|kind| kinds.has(kind)), [true, false, true]);
        assert_eq!(RayVisibility::default().at(Time::from_integer(0)), RayKinds::ALL);
        assert!(kinds.and(RayKinds::NONE).is_empty());
    }
}
