//! Instances of groups: an object and all below it, at the places of a table.
//!
//! Every instance is made of objects of its own, which share meshes, textures and materials with the group. So all that
//! holds for objects holds for them: keys, cuts, exploded views, groups within groups.

use super::fault::Fault;
use super::placement::children;
use super::pose_tracks::Placement;
use super::source_file::File;
use super::suggest::shortened;
use super::syntax::MAX_ENTRIES;
use super::{Named, Object};
use crate::geometry::shape::Shape;
use crate::track::Animated;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Most groups within each other.
const DEEPEST: usize = 16;

/// What an object shows instead of a shape: another object, at these places.
pub struct GroupDraft {
    /// The object, or behind those of the file a node of a scene.
    pub of: usize,
    /// Where the file names it.
    pub place: Range<usize>,
    pub placements: Vec<Placement>,
}

/// Objects, some of which are copies of others.
pub struct CopiedObjects {
    /// For each object, the one that it is like; itself if it is no copy.
    pub originals: Vec<usize>,
}

/// Adds the objects of all instances behind the others, each below the object that shows them. Groups that hold
/// instances of themselves, and more objects than a file may have, are faults.
pub fn add(
    file: &File<'_>,
    objects: &mut Vec<Named<Object>>,
    drafts: Vec<(usize, GroupDraft)>,
) -> CopiedObjects {
    let originals = (0..objects.len()).collect();
    if drafts.is_empty() {
        return CopiedObjects { originals };
    }
    let children = children(objects);
    let order: Vec<usize> = drafts.iter().map(|(index, _)| *index).collect();
    let drafts = drafts.into_iter().map(|(index, draft)| (index, State::Waiting(draft))).collect();
    let mut copier = Copier { file, objects, children, originals, drafts };
    for index in order {
        if copier.add(index, 0).is_none() {
            break;
        }
    }
    CopiedObjects { originals: copier.originals }
}

impl CopiedObjects {
    /// For each object from index `first` on, its original, or for the place of an instance the object that shows it.
    pub fn sources(&self, objects: &[Named<Object>], first: usize) -> Vec<usize> {
        let source = |index: usize| match objects[index].value.parent {
            Some(parent) if self.originals[index] == index => self.originals[parent],
            _ => self.originals[index],
        };
        (first..objects.len()).map(source).collect()
    }

    /// For each object, what the one that it is like has, if `all` holds anything.
    pub fn of_originals<T: Clone>(&self, mut all: Vec<Option<T>>) -> Vec<Option<T>> {
        if all.iter().any(Option::is_some) {
            let missing = self.originals.get(all.len()..).unwrap_or_default();
            let further: Vec<_> =
                missing.iter().map(|&original| all.get(original).cloned().flatten()).collect();
            all.extend(further);
        }
        all
    }

    /// For each object of the file, whether there are copies of it.
    pub fn are_copied(&self) -> Vec<bool> {
        let mut copied = vec![false; self.originals.len()];
        for (copy, &original) in self.originals.iter().enumerate() {
            copied[original] |= copy != original;
        }
        copied
    }

    /// Gives copies the meshes of what they are like, where these were deformed later.
    pub fn share_deformations(&self, objects: &mut [Named<Object>], deformed: &HashSet<usize>) {
        for (copy, &original) in
            self.originals.iter().enumerate().filter(|(copy, original)| copy != *original)
        {
            if deformed.contains(&original) {
                let Object { shape, tracks, .. } = objects[original].value.clone();
                (objects[copy].value.shape, objects[copy].value.tracks) = (shape, tracks);
            }
        }
    }
}

/// How far the instances of an object are.
enum State {
    Waiting(GroupDraft),
    /// Those within its group come first.
    Begun,
    Added,
}

struct Copier<'a, 'f> {
    file: &'a File<'f>,
    objects: &'a mut Vec<Named<Object>>,
    children: Vec<Vec<usize>>,
    originals: Vec<usize>,
    drafts: HashMap<usize, State>,
}

impl Copier<'_, '_> {
    /// Adds the instances of an object, which are in the groups of `depth` others. None after a fault.
    fn add(&mut self, index: usize, depth: usize) -> Option<()> {
        let Some(State::Waiting(draft)) = self.drafts.insert(index, State::Begun) else {
            self.drafts.insert(index, State::Added);
            return Some(());
        };
        if depth == DEEPEST {
            let title = format!("groups hold instances of each other at most {DEEPEST} deep");
            self.file.push(Fault::new(draft.place, title, "these are deeper"));
            return None;
        }
        for inner in self.all_below(draft.of)? {
            if matches!(self.drafts.get(&inner), Some(State::Begun)) {
                let name = shortened(&self.objects[draft.of].name);
                let title = format!("`{name}` cannot be shown within itself");
                let label = format!("these instances are in `{name}`, or in what it shows");
                self.file.push(Fault::new(draft.place, title, label));
                return None;
            }
            if self.drafts.contains_key(&inner) {
                self.add(inner, depth + 1)?;
            }
        }
        let group = self.all_below(draft.of)?;
        let more = draft.placements.len().saturating_mul(group.len() + 1);
        if more.saturating_add(self.objects.len()) > MAX_ENTRIES {
            let title = format!("a sequence has at most {MAX_ENTRIES} objects");
            let label = format!("{} instances of {} objects", draft.placements.len(), group.len());
            self.file.push(Fault::new(draft.place, title, label));
            return None;
        }
        let places = group.iter().enumerate().map(|(place, of)| (*of, place)).collect();
        for (number, placement) in draft.placements.into_iter().enumerate() {
            self.add_one(index, number, placement, (&group, &places));
        }
        self.drafts.insert(index, State::Added);
        Some(())
    }

    /// An object and all below it, parents before children. None if an object is its own parent, which is reported
    /// where parents are decoded.
    fn all_below(&self, object: usize) -> Option<Vec<usize>> {
        let (mut all, mut next) = (vec![object], 0);
        while let Some(&above) = all.get(next) {
            all.extend(&self.children[above]);
            next += 1;
            if all.len() > self.objects.len() {
                return None;
            }
        }
        Some(all)
    }

    /// Adds one instance of a group below an object. `places` holds the place of each object in the group.
    fn add_one(
        &mut self,
        shown_by: usize,
        number: usize,
        placement: Placement,
        (group, places): (&[usize], &HashMap<usize, usize>),
    ) {
        let Placement { transform, visible, row } = placement;
        let name = format!("{}[{number}]", self.objects[shown_by].name);
        let parent = Some(shown_by);
        let place = Object { transform, visible, parent, ..Object::new(Shape::Group, 0) };
        let place = self.push(Named { name: name.clone(), value: place }, None);
        let first = self.objects.len();
        let copy_of = |object: usize| places.get(&object).map(|place| first + place);
        for &of in group {
            let Named { name: own, value } = &self.objects[of];
            let mut value = value.clone();
            // The parent of the group itself is outside of it.
            value.parent = value.parent.and_then(copy_of).or(Some(place));
            value.skin_of = value.skin_of.map(|node| copy_of(node).unwrap_or(node));
            value.row.get_or_insert_with(|| row.clone());
            // A group that is there only for its instances is hidden itself.
            if of == group[0] && value.visible == Animated::Constant(false) {
                value.visible = true.into();
            }
            let copy = Named { name: format!("{name}/{own}"), value };
            self.push(copy, Some(of));
        }
    }

    /// Adds an object, a copy of `original` if there is one. Returns its index.
    fn push(&mut self, object: Named<Object>, original: Option<usize>) -> usize {
        let index = self.objects.len();
        if let Some(parent) = object.value.parent {
            self.children[parent].push(index);
        }
        self.children.push(Vec::new());
        self.originals.push(original.map_or(index, |original| self.originals[original]));
        self.objects.push(object);
        index
    }
}
