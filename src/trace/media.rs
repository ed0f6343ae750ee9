//! What a ray is inside of.

use crate::material::{Material, Medium};
use crate::math::DVec3;
use crate::optics::{Fresnel, refract};

/// Enclosing surfaces at once, at most; the outermost are forgotten beyond it.
const DEEPEST: usize = 6;

/// The refractive surfaces that a ray is inside of, in the order in which it entered. Where several overlap,
/// the medium of the highest priority is there; of equal ones the one entered last (Schmidt and Budge,
/// *Simple Nested Dielectrics in Ray Traced Images*, 2002).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Media {
    inside: [Enclosure; DEEPEST],
    count: u8,
}

/// A primitive with its material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Enclosure {
    pub primitive: u32,
    pub material: u32,
}

/// What lies on the two sides of a surface that a ray passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    pub before: Medium,
    pub behind: Medium,
    /// Whether another medium of higher priority fills both sides: then there is nothing to see.
    pub hidden: bool,
    /// What the ray is inside of once it has passed.
    pub passed: Media,
}

/// Light that goes on behind a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    pub direction: DVec3,
    /// The share that the boundary reflects instead.
    pub reflected: f64,
}

impl Boundary {
    /// What becomes of light that meets the boundary in a direction, across a normal that faces it (both unit
    /// vectors); none if all of it is reflected.
    pub fn meet(&self, fresnel: Fresnel, direction: DVec3, normal: DVec3) -> Option<Bent> {
        let eta = self.behind.ior / self.before.ior;
        let (bent, cosine) = refract(direction, normal, eta)?;
        let reflected = fresnel.reflectance(-direction.dot(normal), cosine, eta);
        Some(Bent { direction: bent, reflected })
    }
}

impl Boundary {
    /// The share of light that is reflected where it goes straight on, as shadow rays do. Between two boundaries of a
    /// thing that is so thin or so large that it hardly shifts light, the way outside is the straight one, and inside it
    /// is bent: the angle is that on the side of the lower index, from where no light is reflected totally.
    pub fn straight(&self, fresnel: Fresnel, direction: DVec3, normal: DVec3) -> f64 {
        let eta = (self.behind.ior / self.before.ior).max(self.before.ior / self.behind.ior);
        let bent = refract(direction, normal, eta);
        bent.map_or(0.0, |(_, cosine)| fresnel.reflectance(-direction.dot(normal), cosine, eta))
    }
}

impl Media {
    /// Whether the ray is inside of nothing.
    pub fn is_outside(&self) -> bool {
        self.count == 0
    }

    /// The medium around the ray.
    pub fn here(&self, materials: &[Material]) -> Medium {
        let prevailing = self.prevailing(materials);
        prevailing.map_or(Medium::EMPTY, |entry| materials[entry.material as usize].medium)
    }

    /// The boundary at a surface that the ray enters, or else leaves.
    pub fn boundary(&self, at: Enclosure, entering: bool, materials: &[Material]) -> Boundary {
        let entry = if entering { None } else { self.entry(at) };
        let (outside, within, enclosure) = match entry {
            Some(index) => (self.without(index), *self, self.inside[index]),
            // A ray that started inside never entered.
            None => (*self, self.entered(at), at),
        };
        let hidden = within.prevailing(materials) != Some(enclosure);
        let (from, to) = if entering { (outside, within) } else { (within, outside) };
        Boundary { before: from.here(materials), behind: to.here(materials), hidden, passed: to }
    }

    /// The entry that a surface ends: its own last one. A mesh of several materials may have been entered by another
    /// of them; then that one's medium is what the ray leaves.
    fn entry(&self, at: Enclosure) -> Option<usize> {
        let entered = &self.inside[..usize::from(self.count)];
        let own = entered.iter().rposition(|entry| *entry == at);
        own.or_else(|| entered.iter().rposition(|entry| entry.primitive == at.primitive))
    }

    fn entered(mut self, at: Enclosure) -> Self {
        if usize::from(self.count) == DEEPEST {
            self.inside.rotate_left(1);
            self.count -= 1;
        }
        self.inside[usize::from(self.count)] = at;
        self.count += 1;
        self
    }

    fn without(mut self, index: usize) -> Self {
        let count = usize::from(self.count);
        self.inside[index..count].rotate_left(1);
        self.inside[count - 1] = Enclosure::default();
        self.count -= 1;
        self
    }

    /// The enclosure whose medium is there: of equal priorities the last (as `max_by_key` gives it).
    fn prevailing(&self, materials: &[Material]) -> Option<Enclosure> {
        let entered = self.inside[..usize::from(self.count)].iter().copied();
        entered.max_by_key(|entry| materials[entry.material as usize].medium.priority)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::LayerId;
    use crate::material::{Exponent, Highlight, Lobes};

    fn glass(ior: f64, priority: i32) -> Material {
        Material {
            lobes: Lobes { refraction: Rgb::ONE, ..Lobes::default() },
            paints: Vec::new(),
            emission_layer: LayerId::CONSTANT,
            highlight: Highlight::Phong,
            shininess: Exponent::new(1.0),
            fresnel: Fresnel::Off,
            medium: Medium { ior, absorption: Rgb::ZERO, priority },
        }
    }

    /// The indices of refraction that a ray meets along surfaces (0: glass, 1: liquid), with what is hidden.
    fn way(materials: &[Material], events: &[(u32, bool)]) -> Vec<(f64, f64, bool)> {
        let of_its_own = |&(index, entering)| (Enclosure { primitive: index, material: index }, entering);
        along(materials, events.iter().map(of_its_own))
    }

    fn along(
        materials: &[Material],
        events: impl Iterator<Item = (Enclosure, bool)>,
    ) -> Vec<(f64, f64, bool)> {
        let mut media = Media::default();
        let step = |(at, entering): (Enclosure, bool)| {
            let boundary = media.boundary(at, entering, materials);
            media = boundary.passed;
            (boundary.before.ior, boundary.behind.ior, boundary.hidden)
        };
        let found = events.map(step).collect();
        assert_eq!(media, Media::default(), "a ray that has left everything");
        found
    }

    /// The same along surfaces of one mesh.
    fn way_through_mesh(materials: &[Material], events: &[(u32, bool)]) -> Vec<(f64, f64, bool)> {
        along(
            materials,
            events.iter().map(|&(material, entering)| (Enclosure { primitive: 7, material }, entering)),
        )
    }

    #[test]
    fn meshes_of_several_materials_are_left_by_any_of_them() {
        let glass = [glass(1.5, 0), glass(1.5, 0), glass(1.33, 0)];
        assert_eq!(
            way_through_mesh(&glass, &[(0, true), (1, false)]),
            [(1.0, 1.5, false), (1.5, 1.0, false)]
        );
        // What the ray is inside of is what it has entered.
        assert_eq!(
            way_through_mesh(&glass, &[(0, true), (2, false)]),
            [(1.0, 1.5, false), (1.5, 1.0, false)]
        );
        // A glass with its liquid, which reaches into the wall, in one file: each is left by itself.
        let found = way_through_mesh(&glass, &[(0, true), (2, true), (0, false), (2, false)]);
        assert_eq!(found, [(1.0, 1.5, false), (1.5, 1.33, false), (1.33, 1.33, true), (1.33, 1.0, false)]);
    }

    #[test]
    fn overlapping_media_follow_their_priorities() {
        // A glass whose liquid reaches a little into its wall: the glass prevails.
        let materials = [glass(1.5, 2), glass(1.33, 1)];
        let found = way(&materials, &[(0, true), (1, true), (0, false), (1, false)]);
        assert_eq!(found, [(1.0, 1.5, false), (1.5, 1.5, true), (1.5, 1.33, false), (1.33, 1.0, false)]);
    }

    #[test]
    fn of_equal_media_the_inner_one_prevails() {
        let materials = [glass(1.5, 0), glass(1.0, 0)];
        let found = way(&materials, &[(0, true), (1, true), (1, false), (0, false)]);
        assert_eq!(found, [(1.0, 1.5, false), (1.5, 1.0, false), (1.0, 1.5, false), (1.5, 1.0, false)]);
    }

    #[test]
    fn rays_that_start_inside_leave() {
        assert_eq!(way(&[glass(1.5, 0)], &[(0, false)]), [(1.5, 1.0, false)]);
    }
}
