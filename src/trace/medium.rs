//! The media around rays.
//!
//! Overlapping refractive surfaces follow their priorities (Schmidt and Budge, *Simple Nested Dielectrics in Ray Traced
//! Images*, 2002): the medium of the highest priority counts, and of equal ones that of the surface entered last. The
//! depth of nesting is not limited. A path stores the number of its list of media, as a scene has few different lists.

use crate::appearance::material::{Material, Medium};
use rustc_hash::FxHashMap;

/// A primitive with its material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Enclosure {
    pub primitive: u32,
    pub material: u32,
}

/// The number of the empty list, for rays outside of all media.
pub const OUTSIDE: u32 = 0;

/// The passage of a ray through a surface, which it enters or leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Passage {
    pub of: Enclosure,
    pub enters: bool,
    /// Whether the ray touches an edge, so that it is on the same side of the surface before and behind.
    pub grazes: bool,
}

/// The media on the two sides of a place that a ray passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// The index of refraction behind over that in front.
    pub eta: f64,
    /// Whether a medium of higher priority fills both sides, so that the place is invisible.
    pub hidden: bool,
    /// The number of the list of media around the ray after the place.
    pub behind: u32,
}

/// All lists of media around rays so far.
#[derive(Debug)]
pub struct MediaLists {
    /// The refractive surfaces around a ray, in the order of entry.
    lists: Vec<Vec<Enclosure>>,
    numbers: FxHashMap<Vec<Enclosure>, u32>,
    /// The medium that counts in each list.
    media: Vec<Medium>,
    /// Known transitions at single surfaces.
    single: FxHashMap<(u32, Passage), Transition>,
}

impl Default for MediaLists {
    fn default() -> Self {
        let numbers = [(Vec::new(), OUTSIDE)].into_iter().collect();
        Self { lists: vec![Vec::new()], numbers, media: vec![Medium::EMPTY], single: FxHashMap::default() }
    }
}

/// The most lists and transitions that are kept from wave to wave.
const MAX_KEPT: usize = 1 << 14;

impl MediaLists {
    /// Discards all lists if there are too many. All numbers become invalid.
    pub fn trim(&mut self) {
        if self.len() > MAX_KEPT {
            *self = Self::default();
        }
    }

    /// Discards all lists. All numbers become invalid.
    pub fn clear(&mut self) {
        if self.len() > 1 {
            *self = Self::default();
        }
    }

    /// The number of lists and transitions.
    fn len(&self) -> usize {
        self.lists.len() + self.single.len()
    }

    /// The medium around a ray.
    #[inline]
    pub fn medium(&self, inside: u32) -> &Medium {
        &self.media[inside as usize]
    }

    /// The transition of a ray that passes a surface.
    pub fn pass(&mut self, inside: u32, passage: Passage, materials: &[Material]) -> Transition {
        if let Some(transition) = self.single.get(&(inside, passage)) {
            return *transition;
        }
        let transition = self.pass_all(inside, &[passage], materials);
        self.single.insert((inside, passage), transition);
        transition
    }

    /// The transition of a ray that passes coincident surfaces. It enters all that it enters before it leaves any, so
    /// there is no film of the surrounding medium between two media that touch.
    pub fn pass_all(&mut self, inside: u32, passages: &[Passage], materials: &[Material]) -> Transition {
        let [before, behind] = self.sides(inside, passages);
        let [from, to] = [&before, &behind].map(|list| prevailing(list, materials));
        let ior = |at: Option<Enclosure>| at.map_or(1.0, |at| materials[at.material as usize].medium.ior);
        let (eta, hidden) = (ior(to) / ior(from), from == to);
        Transition { eta, hidden, behind: self.number(behind, materials) }
    }

    /// The visible surface of a boundary of several surfaces. It is one at which the medium on one side ends: that of
    /// the higher priority, so that it is the same from both sides, and of equal ones the first.
    pub fn visible(&self, inside: u32, passages: &[Passage], materials: &[Material]) -> usize {
        let [before, behind] = self.sides(inside, passages).map(|list| prevailing(&list, materials));
        let ends = |passage: &Passage| {
            let side = if passage.enters { behind } else { before };
            side.is_some_and(|side| side.primitive == passage.of.primitive)
        };
        let priority = |passage: &Passage| materials[passage.of.material as usize].medium.priority;
        let candidates = passages.iter().enumerate().filter(|(_, passage)| ends(passage));
        let best =
            candidates.reduce(|best, next| if priority(next.1) > priority(best.1) { next } else { best });
        best.map_or(0, |(index, _)| index)
    }

    /// The lists of media in front of and behind coincident surfaces.
    fn sides(&self, inside: u32, passages: &[Passage]) -> [Vec<Enclosure>; 2] {
        // A ray that enters and leaves at once, as at an edge, passes by.
        let passes_by = |passage: &Passage| {
            let back = |other: &Passage| {
                other.of.primitive == passage.of.primitive && other.enters != passage.enters
            };
            passage.grazes || passages.iter().any(back)
        };
        let crossed = || passages.iter().filter(|passage| !passes_by(passage));
        let mut before = self.lists[inside as usize].clone();
        for left in crossed().filter(|passage| !passage.enters) {
            // A ray that started inside has never entered.
            if position(&before, left.of).is_none() {
                before.push(left.of);
            }
        }
        let mut behind = before.clone();
        behind.extend(crossed().filter(|passage| passage.enters).map(|passage| passage.of));
        for left in crossed().filter(|passage| !passage.enters) {
            if let Some(index) = position(&behind, left.of) {
                behind.remove(index);
            }
        }
        [before, behind]
    }

    fn number(&mut self, list: Vec<Enclosure>, materials: &[Material]) -> u32 {
        if let Some(number) = self.numbers.get(&list) {
            return *number;
        }
        let number = self.lists.len() as u32;
        let medium = prevailing(&list, materials).map(|at| materials[at.material as usize].medium);
        self.media.push(medium.unwrap_or(Medium::EMPTY));
        self.lists.push(list.clone());
        self.numbers.insert(list, number);
        number
    }
}

/// The entry that a surface ends: its own last entry. A ray may have entered a mesh of several materials through
/// another material. Then the entry of that material ends.
fn position(list: &[Enclosure], of: Enclosure) -> Option<usize> {
    let own = list.iter().rposition(|entry| *entry == of);
    own.or_else(|| list.iter().rposition(|entry| entry.primitive == of.primitive))
}

/// The enclosure whose medium counts. Of equal priorities it is the last one, as `max_by_key` returns it.
fn prevailing(list: &[Enclosure], materials: &[Material]) -> Option<Enclosure> {
    list.iter().copied().max_by_key(|entry| materials[entry.material as usize].medium.priority)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::optics::Fresnel;
    use crate::testing;

    fn glass(ior: f64, priority: i32) -> Material {
        testing::glass(ior, priority, Fresnel::Off)
    }

    fn passage(primitive: u32, material: u32, enters: bool) -> Passage {
        Passage { of: Enclosure { primitive, material }, enters, grazes: false }
    }

    /// The relative indices of refraction along places, and whether each place is hidden.
    fn along(materials: &[Material], places: &[&[Passage]]) -> Vec<(f64, bool)> {
        let (mut lists, mut inside) = (MediaLists::default(), OUTSIDE);
        let found = places.iter().map(|place| {
            let transition = match place {
                [only] => lists.pass(inside, *only, materials),
                _ => lists.pass_all(inside, place, materials),
            };
            inside = transition.behind;
            (transition.eta, transition.hidden)
        });
        let found = found.collect();
        assert_eq!(inside, OUTSIDE, "a ray that has left everything");
        found
    }

    /// Along surfaces. Each number is both the primitive and its material.
    fn way(materials: &[Material], events: &[(u32, bool)]) -> Vec<(f64, bool)> {
        let passages: Vec<_> =
            events.iter().map(|&(index, enters)| [passage(index, index, enters)]).collect();
        along(materials, &passages.iter().map(|place| &place[..]).collect::<Vec<_>>())
    }

    /// The same along the surfaces of one mesh.
    fn way_through_mesh(materials: &[Material], events: &[(u32, bool)]) -> Vec<(f64, bool)> {
        let passages: Vec<_> = events.iter().map(|&(index, enters)| [passage(7, index, enters)]).collect();
        along(materials, &passages.iter().map(|place| &place[..]).collect::<Vec<_>>())
    }

    #[test]
    fn meshes_of_several_materials_are_left_by_any_of_them() {
        let glass = [glass(1.5, 0), glass(1.5, 0), glass(1.33, 0)];
        assert_eq!(way_through_mesh(&glass, &[(0, true), (1, false)]), [(1.5, false), (1.0 / 1.5, false)]);
        // The ray is inside the medium that it has entered.
        assert_eq!(way_through_mesh(&glass, &[(0, true), (2, false)]), [(1.5, false), (1.0 / 1.5, false)]);
        // A glass and its liquid, which reaches into the wall, in one file: the ray leaves each of them separately.
        let found = way_through_mesh(&glass, &[(0, true), (2, true), (0, false), (2, false)]);
        assert_eq!(found, [(1.5, false), (1.33 / 1.5, false), (1.0, true), (1.0 / 1.33, false)]);
    }

    #[test]
    fn overlapping_media_follow_their_priorities() {
        // A glass whose liquid reaches a little into its wall: the glass prevails.
        let materials = [glass(1.5, 2), glass(1.33, 1)];
        let found = way(&materials, &[(0, true), (1, true), (0, false), (1, false)]);
        assert_eq!(found, [(1.5, false), (1.0, true), (1.33 / 1.5, false), (1.0 / 1.33, false)]);
    }

    #[test]
    fn of_equal_media_the_inner_one_prevails() {
        let materials = [glass(1.5, 0), glass(1.0, 0)];
        let found = way(&materials, &[(0, true), (1, true), (1, false), (0, false)]);
        assert_eq!(found, [(1.5, false), (1.0 / 1.5, false), (1.5, false), (1.0 / 1.5, false)]);
    }

    #[test]
    fn rays_that_start_inside_leave() {
        assert_eq!(way(&[glass(1.5, 0)], &[(0, false)]), [(1.0 / 1.5, false)]);
    }

    /// Between two bodies that share a face there is no air, in either order.
    #[test]
    fn coincident_boundaries_are_one() {
        let materials = [glass(1.5, 0), glass(1.33, 0)];
        let (out, enter) = (passage(0, 0, false), passage(1, 1, true));
        for place in [[out, enter], [enter, out]] {
            let found = along(&materials, &[&[passage(0, 0, true)], &place, &[passage(1, 1, false)]]);
            assert_eq!(found, [(1.5, false), (1.33 / 1.5, false), (1.0 / 1.33, false)]);
        }
    }

    #[test]
    fn as_many_media_are_held_as_are_nested() {
        let materials: Vec<_> = (0..300).map(|k| glass(1.0 + 0.001 * f64::from(k), k)).collect();
        let there = (0..300).map(|index| (index, true));
        let back = (0..300).rev().map(|index| (index, false));
        let found = way(&materials, &there.chain(back).collect::<Vec<_>>());
        for (index, (eta, hidden)) in found.into_iter().enumerate() {
            let ior = |k: i32| if k < 0 { 1.0 } else { 1.0 + 0.001 * f64::from(k) };
            let index = index as i32;
            let expected = match index < 300 {
                true => ior(index) / ior(index - 1),
                false => ior(598 - index) / ior(599 - index),
            };
            assert_eq!((eta, hidden), (expected, false), "{index}");
        }
    }

    #[test]
    fn only_many_lists_are_forgotten() {
        let glass = [glass(1.5, 0)];
        let mut lists = MediaLists::default();
        let inside = |lists: &mut MediaLists, primitive| {
            lists.pass(OUTSIDE, passage(primitive, 0, true), &glass).behind
        };
        let first = inside(&mut lists, 0);
        lists.trim();
        assert_eq!((lists.medium(first).ior, lists.len()), (1.5, 3));
        for primitive in 1..MAX_KEPT as u32 {
            inside(&mut lists, primitive);
        }
        assert!(lists.len() > MAX_KEPT);
        lists.trim();
        assert_eq!(lists.len(), MediaLists::default().len());
        let again = inside(&mut lists, 7);
        assert_eq!(lists.medium(again).ior, 1.5);
    }

    /// The medium of the last entry prevails at any depth of nesting, and surfaces may be left in any order.
    #[test]
    fn any_number_of_media_is_nested() {
        let materials: Vec<_> = (1..=200).map(|k| glass(1.0 + 0.01 * f64::from(k), 0)).collect();
        let inwards = (0..200).map(|k| (k, true));
        let outwards = (0..200).map(|k| (k * 7 % 200, false));
        let events: Vec<_> = inwards.chain(outwards).collect();
        let mut inside = Vec::new();
        for (&(k, enters), (eta, _)) in events.iter().zip(way(&materials, &events)) {
            let here = |inside: &[u32]| inside.last().map_or(1.0, |k| materials[*k as usize].medium.ior);
            let before = here(&inside);
            if enters {
                inside.push(k);
            } else {
                inside.retain(|other| *other != k);
            }
            assert_eq!(eta, here(&inside) / before, "{k} {enters}");
        }
    }

    /// The transition at passages in one place, for a ray inside these media, and the visible surface.
    fn at_once(
        materials: &[Material],
        entered: &[u32],
        passages: &[(u32, bool)],
    ) -> (Transition, MediaLists, u32) {
        let (mut lists, mut inside) = (MediaLists::default(), OUTSIDE);
        for &index in entered {
            inside = lists.pass(inside, passage(index, index, true), materials).behind;
        }
        let passages: Vec<_> =
            passages.iter().map(|&(index, enters)| passage(index, index, enters)).collect();
        let seen = passages[lists.visible(inside, &passages, materials)].of.primitive;
        (lists.pass_all(inside, &passages, materials), lists, seen)
    }

    /// Where two media touch there is one boundary, the same in both directions and for either order.
    #[test]
    fn surfaces_in_one_place_are_one_boundary() {
        for priorities in [[0, 0], [1, 0], [0, 1]] {
            let materials = [glass(1.5, priorities[0]), glass(1.33, priorities[1])];
            for passages in [[(0, false), (1, true)], [(1, true), (0, false)]] {
                let (down, below, seen_down) = at_once(&materials, &[0], &passages);
                let back = passages.map(|(index, enters)| (index, !enters));
                let (up, above, seen_up) = at_once(&materials, &[1], &back);
                assert_eq!((down.eta, down.hidden), (1.33 / 1.5, false));
                assert_eq!((up.eta, up.hidden), (1.5 / 1.33, false));
                assert_eq!((below.medium(down.behind).ior, above.medium(up.behind).ior), (1.33, 1.5));
                // With different priorities, the same surface is visible from both sides.
                assert_eq!(seen_down, seen_up);
            }
        }
        // A ray that enters and leaves at once, as at an edge, changes nothing.
        let (edge, ..) = at_once(&[glass(1.5, 0)], &[], &[(0, true), (0, false)]);
        assert_eq!(edge, Transition { eta: 1.0, hidden: true, behind: OUTSIDE });
        let grazed = Passage { grazes: true, ..passage(0, 0, true) };
        let edge = MediaLists::default().pass_all(OUTSIDE, &[grazed], &[glass(1.5, 0)]);
        assert_eq!(edge, Transition { eta: 1.0, hidden: true, behind: OUTSIDE });
    }
}
