//! A sequence file while it is read.

use super::expand::source::{Sources, quoted_value};
use super::expand::source_map::SourceMap;
use super::fault::Fault;
use super::font_files::FontFiles;
use super::image_files::ImageFiles;
use super::key_clock::KeyClock;
use super::mesh_files::MeshFiles;
use super::scene_files::SceneFiles;
use super::schema::Watch;
use super::table_files::TableFiles;
use super::text_shape::TextMeshes;
use crate::base::files::Root;
use crate::base::math::UpAxis;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

/// The file being read: its faults so far, the unit of its key times, and the files that it names.
pub struct File<'s> {
    pub(super) source: &'s str,
    /// The number of the source's first byte in places. Several sources share one numbering.
    pub base: usize,
    /// Whether the whole file is in the most common notation, which is read without ron.
    pub(super) is_common: bool,
    /// Whether the source, or a file that it includes, is in JSON, which has fewer forms than RON: an array is a list or
    /// a tuple, an object has fields or is a map, and a text may stand for a word. `Node` says which is read as what.
    pub is_json: bool,
    faults: RefCell<Vec<Fault>>,
    /// Warnings, each with its byte in the source.
    warnings: RefCell<Vec<(usize, String)>>,
    pub clock: Cell<KeyClock>,
    /// The upward axis of the file.
    pub up: Cell<UpAxis>,
    /// Images named in the file.
    pub images: ImageFiles,
    /// Meshes named in the file.
    pub meshes: MeshFiles,
    /// glTF files named in the file.
    pub scenes: SceneFiles,
    /// Tables named in the file.
    pub tables: TableFiles,
    /// Fonts named in the file.
    pub fonts: FontFiles,
    /// Solids of texts.
    pub texts: TextMeshes,
    /// Where the source was written, if it was expanded.
    pub written: Option<Written<'s>>,
    /// Parts of an expanded source that a plain file must write in another way, with their texts there.
    rewritten: RefCell<Vec<(Range<usize>, String)>>,
    /// What decoders took values for, by their first bytes, where the other notation must know.
    forms: RefCell<HashMap<usize, Form>>,
    /// Set while the schema is made.
    pub watch: Option<Watch>,
}

/// A form of a value that JSON or RON writes like another one. A later one of these is surer than an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// A word of RON where a text could stand, too.
    WordOrText,
    /// Brackets as `json::is_tuple` reads them.
    Fields,
    LikelyTuple,
    LikelyList,
    /// What a decoder asked for.
    Tuple,
    List,
    Map,
    Word,
}

/// Where an expanded source was written.
pub struct Written<'s> {
    pub map: &'s SourceMap,
    pub sources: &'s Sources,
}

impl<'s> File<'s> {
    /// The file's own paths are relative to `folder` and must be within `root`.
    pub fn new(source: &'s str, folder: &Path, root: Root, is_common: bool) -> Self {
        let tables = TableFiles::new(folder, root.clone());
        let scenes = SceneFiles::new(folder, root.clone());
        let fonts = FontFiles::new(folder, root.clone());
        let (images, meshes) = (ImageFiles::new(folder, root.clone()), MeshFiles::new(folder, root));
        Self {
            source,
            base: 0,
            is_common,
            is_json: false,
            faults: RefCell::default(),
            warnings: RefCell::default(),
            clock: Cell::default(),
            up: Cell::default(),
            images,
            meshes,
            scenes,
            tables,
            fonts,
            texts: TextMeshes::default(),
            written: None,
            rewritten: RefCell::default(),
            forms: RefCell::default(),
            watch: None,
        }
    }

    pub fn push(&self, fault: Fault) {
        self.faults.borrow_mut().push(fault);
    }

    /// Notes something about a byte of the source that is worth knowing, such as outdated notation.
    pub fn warn(&self, at: usize, warning: String) {
        self.warnings.borrow_mut().push((at, warning));
    }

    /// All warnings, each with its byte in the source, in the order of the file.
    pub fn warnings(&self) -> Vec<(usize, String)> {
        let mut warnings = self.warnings.borrow().clone();
        warnings.sort_by_key(|(at, _)| *at);
        warnings
    }

    /// The path in the quoted `name` at `span`, relative to the folder of the sequence. Paths of included files are
    /// relative to those files.
    pub fn path(&self, span: &Range<usize>, name: String) -> String {
        let Some(written) = &self.written else { return name };
        let folder = &written.sources.of(written.map.place(span).span.start).folder;
        if folder.as_os_str().is_empty() {
            return name;
        }
        let path = folder.join(&name).to_string_lossy().replace('\\', "/");
        self.rewritten.borrow_mut().push((span.clone(), quoted_value(&path)));
        path
    }

    /// Whether an expression gave the value at `span`.
    pub fn is_computed(&self, span: &Range<usize>) -> bool {
        self.written.as_ref().is_some_and(|written| written.map.place(span).is_computed)
    }

    /// Notes that a plain file writes the part at `span` as `text`.
    pub fn rewrite(&self, span: Range<usize>, text: String) {
        self.rewritten.borrow_mut().push((span, text));
    }

    /// The source as a plain file.
    pub fn plain(&self) -> String {
        let mut parts = self.rewritten.borrow().clone();
        parts.sort_by_key(|(span, _)| span.start);
        let (mut text, mut at) = (String::with_capacity(self.source.len()), 0);
        for (span, new) in &parts {
            // A value that is decoded twice is rewritten once.
            let Some(kept) = self.source.get(at..span.start) else { continue };
            text.push_str(kept);
            text.push_str(new);
            at = span.end;
        }
        text.push_str(self.source.get(at..).unwrap_or_default());
        text
    }

    pub(super) fn note_form(&self, start: usize, form: Form) {
        let mut forms = self.forms.borrow_mut();
        let known = forms.entry(start).or_insert(form);
        *known = form.max(*known);
    }

    /// Takes the forms of values, by their first bytes.
    pub fn take_forms(&self) -> HashMap<usize, Form> {
        self.forms.take()
    }

    pub fn fault_count(&self) -> usize {
        self.faults.borrow().len()
    }

    /// Sets the field's name in all faults from index `first` on.
    pub fn name_faults(&self, first: usize, field: &str) {
        self.faults.borrow_mut().iter_mut().skip(first).for_each(|fault| fault.name_field(field));
    }

    /// Takes the faults so far.
    pub fn take_faults(&self) -> Vec<Fault> {
        self.faults.take()
    }

    pub fn into_faults(self) -> Vec<Fault> {
        self.faults.into_inner()
    }

    /// The place of a part of the source.
    pub fn span_of(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.source.as_ptr() as usize) + self.base;
        start..start + part.len()
    }
}
