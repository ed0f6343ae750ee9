//! Decodes a mesh per time: `Mesh(series: "wave_####.ply", at: (first: 0, step: 0.1))`.

use super::fault::Fault;
use super::fields::Fields;
use super::keys::{interval, key_time, repeat, row_time};
use super::mesh::{KINDS, preparation, shading};
use super::node::{Node, NodeContent};
use super::suggest::shortened;
use super::values::{file_path, list, one_of, whole};
use crate::base::files;
use crate::base::time::Time;
use crate::geometry::mesh::Preparation;
use crate::import::series::{
    MeshSeries, NumberRange, NumberedError, PvdFile, PvdStep, SeriesFiles, StepError, StepMix, numbered,
    read_pvd,
};
use crate::track::{Animated, Ease, Key, Repeat, Track};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The maximum size of a PVD file in bytes.
const MAX_LIST_SIZE: u64 = 64 << 20;

/// The most files of which the faults are reported one by one.
const MOST_FAULTS: usize = 8;

/// The files that a series names, and their times if it gives these.
struct Listed {
    steps: Vec<Vec<PathBuf>>,
    times: Option<Vec<Time>>,
}

/// The times that the sequence file gives.
enum Times {
    Listed(Vec<Time>),
    Even { first: Time, step: Time },
}

/// Decodes a series from the fields of a mesh that has the field `series`.
pub fn series(fields: &mut Fields<'_>) -> Option<Arc<MeshSeries>> {
    let preparation = preparation(fields);
    let normals = fields.optional("normals", |node| shading(node, KINDS));
    let numbers = fields.or("numbers", numbers, NumberRange::default());
    let ease = fields.or("between", one_of("kind of series", BETWEEN), Ease::Step);
    let repeat = fields.or("repeat", repeat, Repeat::Hold);
    let at = fields.optional("at", times);
    let mut name = None;
    let listed = fields.required("series", |node| {
        name = Some(node);
        listed(node, numbers?)
    });
    let (listed, name, at) = (listed?, name?, at?);
    let count = listed.steps.len();
    let times = match (at, listed.times) {
        (Some(at), _) => at.of(fields, count)?,
        (None, Some(times)) => times,
        (None, None) => {
            let fault = Fault::new(fields.node().head(), "the series has no times", "needs the field `at`");
            fields.node().fault(fault.help(
                "write `at: (first: 0, step: 0.1)` for even times, or a list with the time of each file",
            ));
            return None;
        }
    };
    let (ease, repeat) = (ease?, repeat?);
    let key = |(step, time)| Key { time, value: StepMix::only(step), ease };
    // The times ascend: lists are checked, and steps are above 0.
    let track = Track::new(times.into_iter().enumerate().map(key).collect(), repeat, false).ok()?;
    let track = if count == 1 { Animated::Constant(StepMix::only(0)) } else { Animated::Keyed(track) };
    let shading = normals?;
    let preparation = Preparation { crease: shading.and_then(|shading| shading.crease()), ..preparation? };
    let normals = shading.map(|shading| shading.normals());
    let series = opened(name, SeriesFiles { steps: listed.steps, track, preparation, normals })?;
    if ease == Ease::Linear {
        note_held(name, &series);
    }
    Some(series)
}

/// Notes the meshes that cannot be blended with the next one.
fn note_held(node: Node<'_>, series: &MeshSeries) {
    let held: Vec<usize> = series
        .steps()
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0].topology != pair[1].topology)
        .map(|(at, _)| at)
        .collect();
    let Some(first) = held.first().and_then(|&at| series.paths().nth(at)) else { return };
    let file = first.file_name().unwrap_or(first.as_os_str()).to_string_lossy();
    let (pairs, file) = (series.steps().len() - 1, shortened(&file));
    let note = format!(
        "{} of {pairs} meshes are held and not blended, as the next one has other triangles; the first is {file:?}",
        held.len()
    );
    node.file.warn(node.span().start, note);
}

const BETWEEN: &[(&str, Ease)] = &[("Hold", Ease::Step), ("Blend", Ease::Linear)];

/// The numbers of a series.
fn numbers(node: Node<'_>) -> Option<NumberRange> {
    let mut fields = Fields::of(node, "`numbers`")?;
    let first = fields.optional("first", whole(0..=u32::MAX));
    let last = fields.optional("last", whole(0..=u32::MAX));
    let step = fields.or("step", whole(1..=u32::MAX), 1u32);
    let place = fields.place("last");
    fields.finish();
    let (first, last) = (first?, last?);
    if first.is_some_and(|first| last.is_some_and(|last| last < first)) {
        let fault = Fault::new(place, "the numbers of a series ascend", "the last is before the first");
        node.fault(fault);
        return None;
    }
    Some(NumberRange { first: first.map(u64::from), last: last.map(u64::from), step: step?.into() })
}

/// A list of times, or `(first: 0, step: 0.1)`.
fn times(node: Node<'_>) -> Option<Times> {
    match node.content()? {
        NodeContent::List(_) if node.word().is_empty() => {
            let timed = |node| Some((key_time(node)?, node));
            let times = list(node, "times", timed)?;
            super::keys::report_unsorted(times.iter().copied())
                .then(|| Times::Listed(times.into_iter().map(|(time, _)| time).collect()))
        }
        NodeContent::Fields(_) if node.word().is_empty() => {
            let mut fields = Fields::of(node, "`at`")?;
            let first = fields.or("first", key_time, Time::from_integer(0));
            let step = fields.required("step", interval);
            fields.finish();
            Some(Times::Even { first: first?, step: step? })
        }
        _ => {
            node.expected("the times of the files: a list [0, 0.5, 2], or (first: 0, step: 0.1)");
            None
        }
    }
}

impl Times {
    /// The times of `count` files.
    fn of(self, fields: &Fields<'_>, count: usize) -> Option<Vec<Time>> {
        match self {
            Self::Even { first, step } => {
                Some((0..count as i128).map(|index| first + step * Time::from_integer(index)).collect())
            }
            Self::Listed(times) if times.len() == count => Some(times),
            Self::Listed(times) => {
                let title = format!("the series has {count} files, and {} times", times.len());
                let fault = Fault::new(fields.place("at"), title, "needs a time for each file");
                fields.node().fault(fault);
                None
            }
        }
    }
}

/// Whether a file lists the files of a series.
pub fn is_list(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pvd"))
}

/// The files of a pattern or a PVD file.
fn listed(node: Node<'_>, numbers: NumberRange) -> Option<Listed> {
    let name = file_path(node)?;
    let fault = |why: String| {
        let title = format!("cannot read the series {:?}", shortened(&name));
        node.fault(Fault::new(node.span(), title, why));
    };
    if !is_list(&name) {
        return match numbered(&node.file.meshes.folder().join(&name), numbers) {
            Ok(paths) => {
                Some(Listed { steps: paths.into_iter().map(|path| vec![path]).collect(), times: None })
            }
            Err(error) => {
                fault(explained(error));
                None
            }
        };
    }
    if numbers != NumberRange::default() {
        fault("a PVD file lists its files itself, without `numbers`".to_owned());
        return None;
    }
    list_of(node, &name).map_err(fault).ok()
}

/// The files and times of a PVD file.
fn list_of(node: Node<'_>, name: &str) -> Result<Listed, String> {
    let path = node.file.meshes.admit(name)?;
    let bytes = files::read(&path, MAX_LIST_SIZE).map_err(|error| files::describe(&error))?;
    let steps = read_pvd(&bytes).map_err(|error| error.to_string())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let clock = node.file.clock.get();
    let mut times: Vec<Time> = Vec::new();
    for step in &steps {
        let time = row_time(step.time, clock).filter(|time| times.last().is_none_or(|last| last < time));
        times.push(time.ok_or_else(|| {
            let (line, time) = (step.line(), step.time);
            format!("line {line}: the time {time} is beyond 1e9, or less than 1e-9 after the time before")
        })?);
    }
    let is_missing = |file: &&PvdFile| !folder.join(&file.name).exists();
    if let Some(PvdFile { name, line }) = steps.iter().flat_map(|step| &step.files).find(is_missing) {
        return Err(format!("line {line}: there is no file {:?}", shortened(name)));
    }
    let in_folder = |step: PvdStep| step.files.into_iter().map(|file| folder.join(file.name)).collect();
    Ok(Listed { steps: steps.into_iter().map(in_folder).collect(), times: Some(times) })
}

fn explained(error: NumberedError) -> String {
    match error {
        NumberedError::NoPattern => {
            "write # for each digit of the number in the file's name, such as \"wave_####.ply\", or name a PVD file".to_owned()
        }
        NumberedError::Unreadable(error) => format!("its folder cannot be read: {}", files::describe(&error)),
        NumberedError::None => "no file has such a name".to_owned(),
        NumberedError::TooMany => "it has more than 100000 files".to_owned(),
        NumberedError::Missing { names, missing, apart } => {
            let more = match missing - names.len() as u64 {
                0 => String::new(),
                more => format!(", and {more} more"),
            };
            let verb = if missing == 1 { "is" } else { "are" };
            let step = match apart {
                0 | 1 => String::new(),
                apart => format!("; for numbers that are {apart} apart, write `numbers: (step: {apart})`"),
            };
            format!("{}{more} {verb} missing{step}", names.join(", "))
        }
    }
}

/// Checks the files of a series.
fn opened(node: Node<'_>, files: SeriesFiles) -> Option<Arc<MeshSeries>> {
    let errors = match node.file.meshes.series(files) {
        Ok(series) => return Some(series),
        Err(errors) => errors,
    };
    let rest = errors.len().saturating_sub(MOST_FAULTS);
    for StepError { path, why } in errors.iter().take(MOST_FAULTS) {
        let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let title = format!("cannot read the mesh {:?} of the series", shortened(&file));
        let fault = Fault::new(node.span(), title, why.clone());
        node.fault(if rest > 0 { fault.help(format!("{rest} more files cannot be read")) } else { fault });
    }
    None
}
