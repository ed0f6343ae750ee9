//! What a ray is inside of.

use crate::material::{Material, Medium};

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

impl Media {
    /// The medium around the ray.
    pub fn here(&self, materials: &[Material]) -> Medium {
        let prevailing = self.prevailing(materials);
        prevailing.map_or(Medium::EMPTY, |entry| materials[entry.material as usize].medium)
    }

    /// The boundary at a surface that the ray enters, or else leaves.
    pub fn boundary(&self, at: Enclosure, entering: bool, materials: &[Material]) -> Boundary {
        let (outside, within) = if entering {
            (*self, self.entered(at))
        } else {
            // A ray that started inside never entered.
            let outside = self.left(at);
            (outside, if outside == *self { self.entered(at) } else { *self })
        };
        let hidden = within.prevailing(materials) != Some(at);
        let (from, to) = if entering { (outside, within) } else { (within, outside) };
        Boundary { before: from.here(materials), behind: to.here(materials), hidden, passed: to }
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

    /// Without the last entry of a surface.
    fn left(mut self, at: Enclosure) -> Self {
        let count = usize::from(self.count);
        if let Some(last) = self.inside[..count].iter().rposition(|entry| *entry == at) {
            self.inside[last..count].rotate_left(1);
            self.count -= 1;
            self.inside[count - 1] = Enclosure::default();
        }
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
    use crate::optics::Fresnel;

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
        let mut media = Media::default();
        let step = |&(index, entering): &(u32, bool)| {
            let at = Enclosure { primitive: index, material: index };
            let boundary = media.boundary(at, entering, materials);
            media = boundary.passed;
            (boundary.before.ior, boundary.behind.ior, boundary.hidden)
        };
        events.iter().map(step).collect()
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
