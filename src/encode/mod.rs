//! In: films or finished pictures, and a job that names the outputs and their formats.
//! Out: still images and animations, in files or on the standard output, and a report of what was written.
//! Uses: `base`, `film` and `drawing`.
//!
//! The encoder runs on its own thread. It develops films into pictures and writes them:
//!
//! ```text
//! Film ─┬─ exr ▶ atomic ▶ frame_0000.exr …
//!       └─ develop ▶ Picture ▶ marks ─┬─ png, jpeg, ppm ▶ atomic ▶ frame_0000.png …
//!                                     ├─ movie: apng, webp, mp4, y4m ▶ atomic ▶ out.mp4
//!                                     ├─ store (the PNGs, or a spool) ──┐
//!                                     └─ gif: histogram ▶ palette ──────┴▶ dither ▶ delta ▶ atomic ▶ out.gif
//! ```

mod animations;
mod annotation_layer;
mod assembler;
mod atomic;
mod channel;
mod commits;
mod develop;
mod disk;
mod encoder;
mod error;
mod exr;
#[cfg(test)]
mod fault_tests;
mod file_state;
mod flaw;
mod frame_bytes;
mod frame_key;
mod gif;
mod identity;
mod info;
mod inspect;
mod job;
mod jpeg;
mod keep;
mod lease;
mod leftovers;
mod limits;
mod message;
mod metadata;
mod movie;
mod new_folders;
mod number_format;
mod output;
mod pattern;
mod picture;
mod place;
mod png;
mod ppm;
mod redraw;
mod report;
mod settings;
mod sheet;
mod single;
mod status;
mod store;
mod template;
#[cfg(test)]
mod template_tests;
mod temporary;
#[cfg(test)]
mod tests;
mod tonemap;
mod worker;

pub use annotation_layer::ANNOTATIONS;
pub use assembler::{AnimationAssembler, read_picture};
pub use atomic::write as write_file;

pub use develop::{ToneTable, displayed};
pub use encoder::{Encoder, FrameLease};
pub use error::{EncodeError, FilmsError, JobError};
pub use exr::{ALBEDO, NORMAL, SAMPLES};
pub use flaw::Flaw;
pub use frame_key::FrameKey;
pub use info::{FrameInfo, SequenceInfo, TimeBudget};
pub use inspect::{Inspection, inspect, inspect_job};
pub use job::{EncodeJob, Existing, check_within, prepare_picture};
pub use lease::{Lease, LeaseHolder};
pub use limits::check_size;
pub use new_folders::NewFolders;
pub use number_format::NumberFormat;
pub use output::{AnimationFormat, Output, OutputError, StillFormat, StreamFormat};
pub use pattern::{FramePattern, PatternError};
pub use picture::Picture;
pub use place::same_file;
pub use png::texts as frame_texts;
pub use report::Report;
pub use settings::{
    DEFAULT_BACKGROUND_COLOR, ExrLayers, ExrSettings, Formats, GifSettings, JpegSettings, LoopCount,
    Mp4Settings, PngSettings, PpmSettings, Y4mSettings,
};
pub use sheet::{Sheet, columns as sheet_columns};
pub use single::{png_bytes, write_picture, write_png};
pub use status::{FrameStatus, frame_statuses, lease_holder};
pub use template::{Template, TemplateError, listed as listed_letters, missing_glyphs_note};
pub use tonemap::Tonemap;
