//! The geometry: a slot for each object, visible or not, with the transform of each shape to its own space, columns for
//! the tracer, and a journal of changes.

use super::journal::Journal;
use super::primitive::{Finish, Primitive};
use super::surfaces::SurfaceTable;
use crate::appearance::texture::{Footprint, TextureEvalContext, TextureInputs, TexturedObject};
use crate::base::digest::{Content, Digest, Digester};
use crate::base::lanes::{Bits, Color, Mask, Real, Row, Select, Vec3, lanes, transform_vector};
use crate::base::math::{DAffine3, DMat3, DVec3, inverse};
use crate::geometry::mesh::ArrayKey;
use crate::geometry::ray_kinds::{RayKind, RayKinds};
use crate::geometry::shape::{LaneSurface, Mesh, OneRay, Particles, Shape};
use crate::geometry::table_rows::TableRow;
use std::collections::HashMap;

/// The primitives in the order of the file, each in a slot of its own. The slot of a hidden or flattened object is
/// empty, so the index of a primitive never changes.
#[derive(Clone, Debug, Default)]
#[warn(missing_docs)]
pub struct Geometry {
    /// The content of each slot.
    pub primitives: Vec<Primitive>,
    /// For each primitive, the shape in its own space. Only textures read it.
    origins: Vec<Origin>,
    /// Columns for what the tracer reads at every hit.
    finishes: Vec<Finish>,
    pub(super) surfaces: SurfaceTable,
    /// How many primitives show each material, and how many are each light.
    materials: UseCounts,
    lights: UseCounts,
    /// How many primitives each kind of ray does not see.
    hidden: [u32; 3],
    /// The slots that were rewritten.
    journal: Journal,
    /// How often a primitive was replaced by another one.
    replaced: u64,
}

/// Equal content, however it came about.
impl PartialEq for Geometry {
    fn eq(&self, other: &Self) -> bool {
        self.primitives == other.primitives && self.origins == other.origins
    }
}

/// A shape in its own space, and its numbers of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    shape: Shape,
    to_object: DAffine3,
    row: Option<TableRow>,
}

impl Content for Origin {
    fn feed(&self, into: &mut Digester) {
        let Self { shape, to_object, row } = self;
        shape.feed(into);
        to_object.feed(into);
        // Most shapes have none.
        if let Some(row) = row {
            row.feed(into);
        }
    }
}

impl Origin {
    /// The map from the world to the space of the shape.
    pub fn to_object(&self) -> &DAffine3 {
        &self.to_object
    }

    const EMPTY: Self = Self { shape: Shape::Group, to_object: DAffine3::IDENTITY, row: None };
}

/// The number of primitives that use each index of a list.
#[derive(Clone, Debug, Default)]
struct UseCounts(Vec<u32>);

impl UseCounts {
    fn add(&mut self, index: u32) {
        let least = index as usize + 1;
        if self.0.len() < least {
            self.0.resize(least, 0);
        }
        self.0[index as usize] += 1;
    }

    fn remove(&mut self, index: u32) {
        self.0[index as usize] -= 1;
    }

    /// The indices that are used, ascending.
    fn used(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.0).filter(|(_, users)| **users > 0).map(|(index, _)| index)
    }
}

#[warn(missing_docs)]
impl Geometry {
    /// Geometry of empty slots.
    pub fn with_slots(count: usize) -> Self {
        let mut geometry = Self::default();
        geometry.resize(count);
        geometry
    }

    /// Adds empty slots at the end.
    fn resize(&mut self, count: usize) {
        self.primitives.resize(count, Primitive::EMPTY);
        self.origins.resize(count, Origin::EMPTY);
        self.finishes.resize(count, Finish::Empty);
        self.surfaces.resize(count);
    }

    /// Adds a slot with a shape transformed by `to_world`. The slot is empty if that flattens the shape.
    pub fn push(&mut self, shape: &Shape, to_world: DAffine3, finish: Finish) {
        let slot = self.primitives.len();
        self.resize(slot + 1);
        self.set(slot, Some((shape, to_world, finish)));
    }

    /// Sets the content of a slot: a shape transformed by `to_world`. The slot is empty if there is no shape, or if
    /// the transform flattens it. Nothing is written if that changes nothing.
    pub fn set(&mut self, slot: usize, content: Option<(&Shape, DAffine3, Finish)>) {
        let content = content.as_ref().map(|(shape, to_world, finish)| (*shape, to_world, *finish));
        self.set_seen(slot, content, RayKinds::ALL);
    }

    /// [`Geometry::set`] of what only some rays see.
    pub fn set_seen(&mut self, slot: usize, content: Option<(&Shape, &DAffine3, Finish)>, rays: RayKinds) {
        const UNMOVED: &DAffine3 = &DAffine3::IDENTITY;
        match content.and_then(|content| Some((content, inverse(content.1)?))) {
            Some(((shape, to_world, finish), to_object)) => {
                self.place(slot, shape, (to_world, &to_object), (finish, rays));
            }
            None => self.place(slot, &Shape::Group, (UNMOVED, UNMOVED), (Finish::Empty, RayKinds::ALL)),
        }
    }

    /// Sets the content of a slot, with the transform and its inverse. Shapes and transforms are large, so they are moved
    /// and cloned as rarely as possible: most objects keep their shapes.
    #[inline]
    fn place(
        &mut self,
        slot: usize,
        shape: &Shape,
        (to_world, to_object): (&DAffine3, &DAffine3),
        look: (Finish, RayKinds),
    ) {
        let origin = &mut self.origins[slot];
        let (has_shape, has_place) = (origin.shape == *shape, origin.to_object == *to_object);
        if !has_shape {
            origin.shape = shape.clone();
        }
        if !has_place {
            origin.to_object = *to_object;
        }
        if self.replace(slot, shape, (to_world, &to_object.matrix3), look) || !has_shape || !has_place {
            self.journal.note(slot as u32);
        }
    }

    /// Sets the numbers of a table that the object of a slot has. Nothing is written if that changes nothing.
    pub fn set_row(&mut self, slot: usize, row: Option<&TableRow>) {
        if self.origins[slot].row.as_ref() != row {
            self.origins[slot].row = row.cloned();
            self.journal.note(slot as u32);
        }
    }

    /// Replaces a primitive by a placed shape. Returns whether it differs.
    fn replace(
        &mut self,
        slot: usize,
        shape: &Shape,
        place: (&DAffine3, &DMat3),
        look: (Finish, RayKinds),
    ) -> bool {
        let primitive = &mut self.primitives[slot];
        let (finish_before, rays_before) = (primitive.finish, primitive.rays);
        if !primitive.replace(shape, place, look) {
            return false;
        }
        self.surfaces.set(slot, primitive);
        self.replaced += 1;
        let (finish, rays) = look;
        if finish_before != finish {
            self.count(finish, UseCounts::add);
            self.count(finish_before, UseCounts::remove);
            self.finishes[slot] = finish;
        }
        if rays_before != rays {
            for kind in RayKind::ALL {
                let hidden = &mut self.hidden[kind.index()];
                *hidden += u32::from(!rays.has(kind));
                *hidden -= u32::from(!rays_before.has(kind));
            }
        }
        true
    }

    fn count(&mut self, finish: Finish, count: fn(&mut UseCounts, u32)) {
        finish.materials().for_each(|material| count(&mut self.materials, material));
        if let Finish::Light(light) = finish {
            count(&mut self.lights, light);
        }
    }

    /// The slots that were rewritten since a revision, in order; a slot may occur several times. None if the revision
    /// is too old.
    pub fn changes_since(&self, revision: u64) -> Option<&[u32]> {
        self.journal.since(revision)
    }

    /// The number of slots that were ever rewritten.
    pub fn revision(&self) -> u64 {
        self.journal.revision()
    }

    /// How often a primitive was replaced by another one. A shape that turns in itself is rewritten, because its textures
    /// turn, but not replaced.
    pub fn replaced(&self) -> u64 {
        self.replaced
    }

    /// Forgets old changes if they take more memory than it is worth. Readers that have seen the present revision do
    /// not notice.
    pub fn forget_old_changes(&mut self) {
        self.journal.forget(self.primitives.len());
    }

    /// The visible materials, ascending.
    pub fn materials(&self) -> impl Iterator<Item = u32> {
        self.materials.used()
    }

    /// The lights that are visible shapes, ascending.
    pub fn lights(&self) -> impl Iterator<Item = u32> {
        self.lights.used()
    }

    /// Whether rays of a kind do not see some of the primitives.
    #[inline(always)]
    pub fn hides_from(&self, kind: RayKind) -> bool {
        self.hidden[kind.index()] > 0
    }

    /// The material or light of every slot.
    pub fn finishes(&self) -> &[Finish] {
        &self.finishes
    }

    /// The shape of a slot in its own space.
    pub fn origin(&self, slot: usize) -> &Origin {
        &self.origins[slot]
    }

    /// The digest of the meshes' data of these keys, by the materials that read it. The digest of a mesh of a series
    /// covers its data already, and that of an `Origin` its row of a table.
    pub fn arrays(&self, keys: &HashMap<u32, Vec<&ArrayKey>>) -> Digest {
        let mut digests = Vec::new();
        for (primitive, Origin { shape, .. }) in self.primitives.iter().zip(&self.origins) {
            let read = primitive.materials().filter_map(|material| keys.get(&material)).flatten();
            let read: Vec<_> = read.collect();
            note_arrays(shape, &read, &mut digests);
        }
        Digest::of(&digests)
    }

    /// What textures read at points of primitives in the lanes `wanted`, as far as `inputs` names it. `seen` are the
    /// footprints of the pixels in the world. The other lanes are arbitrary.
    #[inline(always)]
    pub fn texture_context<F: Real>(
        &self,
        (primitive, part): (F::U32, F::U32),
        surface: &LaneSurface<F>,
        seen: &Footprint<F>,
        inputs: TextureInputs,
        wanted: F::Mask,
    ) -> TextureEvalContext<'_, F> {
        let mut context = TextureEvalContext { part, ..TextureEvalContext::nowhere() };
        let (indices, mut rest) = (primitive.to_array(), wanted.bits());
        while rest != 0 {
            let index = indices[rest.trailing_zeros() as usize];
            let same = primitive.eq(F::U32::splat(index)) & wanted;
            rest &= !same.bits();
            let origin = &self.origins[index as usize];
            for lane in lanes(same.bits()) {
                context.objects[lane] =
                    TexturedObject { shape: Some(&origin.shape), row: origin.row.as_ref() };
            }
            read_inputs(origin, &mut context, (surface, seen), inputs, same);
        }
        context
    }
}

/// Reads what textures read of an object, in the lanes of a mask.
#[inline(always)]
fn read_inputs<F: Real>(
    Origin { shape, to_object, .. }: &Origin,
    context: &mut TextureEvalContext<'_, F>,
    (surface, seen): (&LaneSurface<F>, &Footprint<F>),
    inputs: TextureInputs,
    same: F::Mask,
) {
    let DAffine3 { matrix3, translation } = to_object;
    let point = transform_vector(matrix3, surface.point) + Vec3::splat(*translation);
    context.point = Vec3::select(same, point, context.point);
    if inputs.uv {
        let [u, v] = shape.uv_in(point, context.part, same);
        context.uv = [F::select(same, u, context.uv[0]), F::select(same, v, context.uv[1])];
        let (parts, mut ends) = (context.part.to_array(), [0; 2]);
        for lane in lanes(same.bits()) {
            let of_part = shape.uv_ends(parts[lane]);
            ends = [ends[0] | u32::from(of_part[0]) << lane, ends[1] | u32::from(of_part[1]) << lane];
        }
        context.ends =
            [context.ends[0] | F::Mask::from_bits(ends[0]), context.ends[1] | F::Mask::from_bits(ends[1])];
    }
    if inputs.color {
        context.color = Color::select(same, colors(shape, point, context.part, same), context.color);
    }
    if inputs.footprint | inputs.footprint_uv {
        let error = transform_vector(&matrix3.abs(), surface.error);
        context.error = Vec3::select(same, error, context.error);
        context.footprint = Footprint::select(same, seen.moved(matrix3), context.footprint);
    }
    if inputs.footprint_uv {
        let found = footprints_in_uv(shape, (point, context.part), &context.footprint, same);
        context.footprint_uv = Footprint::select(same, found, context.footprint_uv);
    }
}

/// The vertex colours of a shape at points in the lanes of a mask.
#[inline(always)]
fn colors<F: Real>(shape: &Shape, point: Vec3<F>, part: F::U32, wanted: F::Mask) -> Color<F::F32> {
    let (points, parts) = (point.store(), part.to_array());
    let black = F::F32::splat(0.0).to_array();
    let (mut r, mut g, mut b) = (black, black, black);
    for lane in lanes(wanted.bits()) {
        (r[lane], g[lane], b[lane]) = shape.color(points[lane], parts[lane]).into();
    }
    Color { r: Row::from_array(r), g: Row::from_array(g), b: Row::from_array(b) }
}

/// The footprints at points of a shape, in u and v, in the lanes of a mask.
#[inline(always)]
fn footprints_in_uv<F: Real>(
    shape: &Shape,
    (point, part): (Vec3<F>, F::U32),
    footprint: &Footprint<F>,
    wanted: F::Mask,
) -> Footprint<F> {
    let (points, parts) = (point.store(), part.to_array());
    let [first, second] = [footprint.0[0].store(), footprint.0[1].store()];
    let mut found = [[F::splat(0.0).to_array(); 2]; 2];
    for lane in lanes(wanted.bits()) {
        let uv = |point: DVec3| shape.uv_at(point, parts[lane]);
        let own = Footprint([first[lane].into(), second[lane].into()]).to_uv(points[lane], uv);
        for (found, diameter) in found.iter_mut().zip(own.0) {
            (found[0][lane], found[1][lane]) = (diameter.x, diameter.y);
        }
    }
    let [first, second] = found;
    let zero = F::splat(0.0);
    Footprint([
        Vec3::new(F::from_array(first[0]), F::from_array(first[1]), zero),
        Vec3::new(F::from_array(second[0]), F::from_array(second[1]), zero),
    ])
}

/// Adds the digests of a shape's data of these keys.
fn note_arrays(shape: &Shape, read: &[&&ArrayKey], digests: &mut Vec<Option<Digest>>) {
    match shape {
        Shape::Mesh(Mesh { mesh, step: None, .. }) => {
            digests.extend(read.iter().map(|key| mesh.array_digest(key)));
        }
        Shape::Particles(Particles(set)) => digests.extend(read.iter().map(|key| set.column_digest(key))),
        Shape::Solid(solid) => solid.parts().iter().for_each(|part| note_arrays(part, read, digests)),
        _ => {}
    }
}
