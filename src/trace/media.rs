//! What a ray is inside of.

use crate::material::{Material, Medium};
use crate::math::DVec3;
use crate::optics::{Fresnel, refract};

/// The refractive surfaces that a ray is inside of: an entry of [`Nesting`]. Outside of all by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media(u32);

/// A primitive with its material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Enclosure {
    pub primitive: u32,
    pub material: u32,
}

/// A surface that a ray passes: into what it encloses, or out of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passage {
    pub of: Enclosure,
    pub enters: bool,
    /// Whether the ray touches an edge, and is on the same side of the surface before and behind.
    pub grazes: bool,
}

/// What lies on the two sides of a place where a ray passes one or more surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    pub before: Medium,
    pub behind: Medium,
    /// Whether the same medium fills both sides: then there is nothing to see.
    pub hidden: bool,
    /// What the ray is inside of once it has passed.
    pub passed: Media,
    /// Which of the surfaces is seen.
    pub seen: usize,
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
    pub fn is_outside(self) -> bool {
        self == Self::default()
    }
}

/// Lists of enclosing surfaces in the order in which rays entered them, any number long: each is another one with one more
/// surface, so that a ray carries a number alone. Where several overlap, the medium of the highest priority is there; of
/// equal ones that of the one entered last (Schmidt and Budge, *Simple Nested Dielectrics in Ray Traced Images*, 2002).
#[derive(Debug, Default)]
pub struct Nesting {
    entries: Vec<Entry>,
    /// What has to be entered again.
    above: Vec<Enclosure>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    at: Enclosure,
    outside: Media,
    /// Whose medium is there.
    prevailing: Enclosure,
}

impl Nesting {
    /// Forgets all lists. No ray may be inside of anything.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// How many lists there are; for [`Nesting::forget_beyond`].
    pub fn count(&self) -> usize {
        self.entries.len()
    }

    /// Forgets the lists that were made since there were so many.
    pub fn forget_beyond(&mut self, count: usize) {
        self.entries.truncate(count);
    }

    fn entry(&self, media: Media) -> Option<&Entry> {
        self.entries.get((media.0 as usize).checked_sub(1)?)
    }

    /// The enclosure whose medium is there.
    fn prevailing(&self, media: Media) -> Option<Enclosure> {
        self.entry(media).map(|entry| entry.prevailing)
    }

    /// The medium around a ray.
    pub fn here(&self, media: Media, materials: &[Material]) -> Medium {
        self.prevailing(media).map_or(Medium::EMPTY, |at| materials[at.material as usize].medium)
    }

    fn entered(&mut self, outside: Media, at: Enclosure, materials: &[Material]) -> Media {
        let priority = |at: Enclosure| materials[at.material as usize].medium.priority;
        let above = self.prevailing(outside).filter(|other| priority(*other) > priority(at));
        self.entries.push(Entry { at, outside, prevailing: above.unwrap_or(at) });
        Media(self.entries.len() as u32)
    }

    /// The innermost list whose last entry passes a test, of those that a list is made of.
    fn last(&self, mut media: Media, test: impl Fn(Enclosure) -> bool) -> Option<Media> {
        while let Some(entry) = self.entry(media) {
            if test(entry.at) {
                return Some(media);
            }
            media = entry.outside;
        }
        None
    }

    /// The entry that a surface ends: its own last one. A mesh of several materials may have been entered by another
    /// of them; then that one's medium is what the ray leaves.
    fn ended(&self, media: Media, by: Enclosure) -> Option<Media> {
        let own = self.last(media, |at| at == by);
        own.or_else(|| self.last(media, |at| at.primitive == by.primitive))
    }

    fn without(&mut self, media: Media, ended: Media, materials: &[Material]) -> Media {
        self.above.clear();
        let mut next = media;
        while next != ended
            && let Some(Entry { at, outside, .. }) = self.entry(next).copied()
        {
            self.above.push(at);
            next = outside;
        }
        let mut left = self.entry(ended).map_or(ended, |entry| entry.outside);
        while let Some(at) = self.above.pop() {
            left = self.entered(left, at, materials);
        }
        left
    }

    /// What becomes of a ray that passes some surfaces in one place: it enters all that it enters before it leaves any, so
    /// that between two media that touch there is no film of what is around both.
    pub fn boundary(&mut self, media: Media, passages: &[Passage], materials: &[Material]) -> Boundary {
        // In and out at once, as at an edge, is past.
        let passes_by = |passage: &Passage| {
            let back = |other: &Passage| {
                other.of.primitive == passage.of.primitive && other.enters != passage.enters
            };
            passage.grazes || passages.iter().any(back)
        };
        let crossed = || passages.iter().filter(|passage| !passes_by(passage));
        let mut before = media;
        for left in crossed().filter(|passage| !passage.enters) {
            // A ray that started inside never entered.
            if self.ended(before, left.of).is_none() {
                before = self.entered(before, left.of, materials);
            }
        }
        let mut passed = before;
        for entered in crossed().filter(|passage| passage.enters) {
            passed = self.entered(passed, entered.of, materials);
        }
        for left in crossed().filter(|passage| !passage.enters) {
            if let Some(ended) = self.ended(passed, left.of) {
                passed = self.without(passed, ended, materials);
            }
        }
        let sides = [before, passed].map(|side| self.prevailing(side));
        let seen = seen(passages, sides, materials);
        Boundary {
            before: self.here(before, materials),
            behind: self.here(passed, materials),
            hidden: sides[0] == sides[1],
            passed,
            seen,
        }
    }
}

/// Which of some surfaces between two media is seen, of those that one of the media ends at: that of the higher priority, so
/// that it is the same from both sides; of equal ones the first.
fn seen(passages: &[Passage], [before, behind]: [Option<Enclosure>; 2], materials: &[Material]) -> usize {
    let ends = |passage: &Passage| {
        let side = if passage.enters { behind } else { before };
        side.is_some_and(|side| side.primitive == passage.of.primitive)
    };
    let priority = |passage: &Passage| materials[passage.of.material as usize].medium.priority;
    let candidates = passages.iter().enumerate().filter(|(_, passage)| ends(passage));
    let best = candidates.reduce(|best, next| if priority(next.1) > priority(best.1) { next } else { best });
    best.map_or(0, |(index, _)| index)
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
        let (mut nesting, mut media) = (Nesting::default(), Media::default());
        let step = |(of, enters): (Enclosure, bool)| {
            let boundary = nesting.boundary(media, &[Passage { of, enters, grazes: false }], materials);
            media = boundary.passed;
            (boundary.before.ior, boundary.behind.ior, boundary.hidden)
        };
        let found = events.map(step).collect();
        assert!(media.is_outside(), "a ray that has left everything");
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

    /// However many there are, the medium of the one entered last is there, and each is left again, in any order.
    #[test]
    fn any_number_of_media_is_nested() {
        let materials: Vec<_> = (1..=200).map(|k| glass(1.0 + 0.01 * f64::from(k), 0)).collect();
        let inwards = (0..200).map(|k| (k, true));
        let outwards = (0..200).map(|k| (k * 7 % 200, false));
        let events: Vec<_> = inwards.chain(outwards).collect();
        let mut inside = Vec::new();
        for (&(k, enters), found) in events.iter().zip(way(&materials, &events)) {
            if enters {
                inside.push(k);
            } else {
                inside.retain(|other| *other != k);
            }
            let here = inside.last().map_or(1.0, |k| materials[*k as usize].medium.ior);
            assert_eq!(found.1, here, "{k} {enters}");
        }
    }

    fn at_once(materials: &[Material], inside: &[u32], passages: &[(u32, bool)]) -> Boundary {
        let (mut nesting, mut media) = (Nesting::default(), Media::default());
        let own = |k: u32| Enclosure { primitive: k, material: k };
        for &k in inside {
            media = nesting
                .boundary(media, &[Passage { of: own(k), enters: true, grazes: false }], materials)
                .passed;
        }
        let passages: Vec<_> =
            passages.iter().map(|&(k, enters)| Passage { of: own(k), enters, grazes: false }).collect();
        nesting.boundary(media, &passages, materials)
    }

    /// Where two media touch there is one boundary, the same both ways and whichever is named first.
    #[test]
    fn surfaces_in_one_place_are_one_boundary() {
        for priorities in [[0, 0], [1, 0], [0, 1]] {
            let materials = [glass(1.5, priorities[0]), glass(1.33, priorities[1])];
            for passages in [[(0, false), (1, true)], [(1, true), (0, false)]] {
                let down = at_once(&materials, &[0], &passages);
                let up = at_once(&materials, &[1], &passages.map(|(k, enters)| (k, !enters)));
                assert_eq!((down.before.ior, down.behind.ior, down.hidden), (1.5, 1.33, false));
                assert_eq!((up.before.ior, up.behind.ior, up.hidden), (1.33, 1.5, false));
                // Of different priorities the same surface is seen.
                let shown = |boundary: Boundary, passages: [(u32, bool); 2]| passages[boundary.seen].0;
                assert_eq!(shown(down, passages), shown(up, passages));
            }
        }
        // In and out at once, as at an edge: nothing.
        let edge = at_once(&[glass(1.5, 0)], &[], &[(0, true), (0, false)]);
        assert!(edge.hidden && edge.passed.is_outside());
        let grazed = Passage { of: Enclosure::default(), enters: true, grazes: true };
        let edge = Nesting::default().boundary(Media::default(), &[grazed], &[glass(1.5, 0)]);
        assert!(edge.hidden && edge.passed.is_outside());
    }
}
