//! `kinora plan`: what a render would trace and build, and what it would not. Only a trial of a few small pictures is
//! traced.

use super::failure::Failure;
use super::json::Object;
use super::loading;
use super::options::Options;
use super::outlook as words;
use super::plan_films::{each_film, with_forecast, with_forecasts};
use super::render::frames_of;
use super::scaling::{Farm, Share};
use super::{check, load, overrides, terminal, values};
use crate::base::clock::{Clock, timed};
use crate::base::escape;
use crate::base::frame_set::FrameSet;
use crate::base::units::{self, count, counted};
use crate::film::{Extras, LayerId};
use crate::pipeline::memory;
use crate::pipeline::plan::{
    Caller, Effect, Effort, Expected, FilmForecast, Outline, Outlook, Part, Patience, Plan, Reason,
    RunForecast, Span, look_ahead, outline, pilot,
};
use crate::pipeline::render::{self, Reuse, extras, pool};
use crate::sequence::Sequence;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Tell what a render would trace, and which frames it would make of films that are there.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron).
    file: PathBuf,

    /// Frames that would be rendered, as `render` has them [default: all]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    #[command(flatten)]
    options: Options,

    /// Memory for films that later frames are made of, such as 2GB [default: a share]
    #[arg(long, value_name = "SIZE", value_parser = values::file_size)]
    memory: Option<u64>,

    /// How long so many workers would take, of as many threads each: 1,2,50; up to 10000
    ///
    /// A few frames are rendered to find out what rays, trees, files and the start of a task
    /// take on this machine, with -t threads. Tasks are those of `kinora farm export`.
    #[arg(
        long, value_name = "N", value_parser = values::workers, value_delimiter = ',',
        allow_hyphen_values = true, verbatim_doc_comment
    )]
    workers: Vec<NonZeroUsize>,

    /// About how many tasks these share, as in `farm export` [default: as many as are worth one]
    #[arg(long, value_name = "N", requires = "workers")]
    chunks: Option<NonZeroUsize>,

    /// Trace nothing: counts alone, without times and errors
    #[arg(long, conflicts_with = "workers")]
    no_pilot: bool,

    /// One JSON object, for programs
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  kinora plan show.ron                    time, error, films, effects, layers, rays and memory
  kinora plan show.ron --no-pilot         the same without time and error, at once
  kinora plan show.ron --memory 200MB     the same with less room for films
  kinora plan show.ron --workers 1,8,100  how long a farm takes, and what it wastes
  kinora plan show.ron --json             for programs

Films, trees and memory are exact, and rays of the camera too where the samples are set. Time and
error come of a pilot of a second or two: blocks of 8x8 pixels of up to six films, at full
resolution. The time is that of tracing, with -t threads, without loading and writing; it is known
to about 10 % for a number of samples and to about 20 % for an error to reach, or a range is told.
Where few bright pixels make the error, it may be twice as long.";

/// What a film is, for whoever reads the word for the first time.
const FILM: &str = "a film is the light traced for a frame, in layers; frames in which lights only change their \
                    brightness share one";

/// Where there are no times to tell.
const NONE: &str = "no pilot was traced";

/// What is told of a plan.
struct Told<'a> {
    sequence: &'a Sequence,
    plan: Plan,
    outline: Outline,
    expected: Expected,
    /// What a pilot has found, with what follows for the sequence's own quality.
    outlook: Option<(Outlook, RunForecast)>,
    budget: u64,
    /// What workers make of it, if that is asked for.
    farm: Option<Farm>,
    /// Of films that wait for the encoder and the pictures made of them.
    besides: u64,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = &arguments.options;
    let loading = loading::Reporter::new(options.progress, options.quiet);
    let (sequence, load) = timed(|| load::sequence(&arguments.file, options.allow_outside, loading));
    let sequence = sequence?;
    let sequence = overrides::applied(sequence, &options.overrides()).map_err(Failure::Bad)?;
    let frames = frames_of(arguments.frames.as_ref(), &sequence)?;
    // What none would render needs no plan.
    render::check(&sequence, &check::request(&sequence))?;
    let extras = extras(&sequence, &sequence.output.files);
    let budget = arguments.memory.map_or(Reuse::Share, Reuse::Within).budget(&sequence, extras);
    let besides = memory::needed(&sequence, extras);
    let share = Share { workers: &arguments.workers, chunks: arguments.chunks, threads: options.threads };
    let farm =
        (!arguments.workers.is_empty()).then(|| Farm::of(&sequence, &frames, &share, load)).transpose()?;
    let told = pool(options.threads)?.install(|| {
        let plan = Plan::new(&sequence, &frames, extras, budget);
        let outline = outline(&sequence, &plan);
        let (expected, outlook) = match arguments.no_pilot {
            true => (Expected::of(&sequence, &plan), None),
            false => looked_ahead(&sequence, &plan, extras),
        };
        Told { sequence: &sequence, plan, outline, expected, outlook, budget, farm, besides }
    });
    terminal::say(&if arguments.json { told.json() } else { told.text() })
}

/// What a pilot says of rays, times and errors.
fn looked_ahead(
    sequence: &Sequence,
    plan: &Plan,
    extras: Extras,
) -> (Expected, Option<(Outlook, RunForecast)>) {
    let outlook = look_ahead(sequence, plan, extras, Patience::PLAN, Clock::Machine);
    let forecast = outlook.forecast(&sequence.quality);
    let known = Expected::of(sequence, plan);
    let expected = match known.exact {
        true => pilot(sequence, plan, Effort::PLAN),
        // Alone, every frame takes what its film takes.
        false => {
            let alone = |part: fn(&FilmForecast) -> f64| {
                plan.of.iter().map(|&film| part(&forecast.films[film])).sum::<f64>() as u64
            };
            Expected {
                camera: forecast.camera as u64,
                camera_alone: alone(|film| film.camera),
                rays: Some(forecast.rays as u64),
                rays_alone: Some(alone(|film| film.rays)),
                ..known
            }
        }
    };
    (expected, Some((outlook, forecast)))
}

impl Told<'_> {
    fn text(&self) -> String {
        let Self { plan, outline, expected, .. } = self;
        let (frames, films) = (plan.of.len() as u64, plan.takes.len() as u64);
        let mut groups = vec![
            (
                "frames",
                vec![format!(
                    "{}, {} of them from films of other frames",
                    count(frames),
                    count(frames - films)
                )],
            ),
            ("films", vec![self.films(), FILM.to_owned()]),
            ("why", vec![self.why()]),
        ];
        groups.extend(self.expectations());
        groups.push(("spans", outline.spans.iter().map(|span| self.span(span)).collect()));
        groups.push(("layers", self.layers()));
        let effect = |(effect, caller): (&Effect, &Caller)| {
            format!("{}: {}{}", effect.name(), self.caller(*caller), self.price(*effect))
        };
        groups.push(("effects", outline.effects.iter().map(effect).collect()));
        groups.push(("unused", vec![self.unused().collect::<Vec<_>>().join(", ")]));
        groups.push(("builds", vec![counted(plan.builds(), "tree")]));
        let (alone, reused) = (expected.rays_alone, expected.rays);
        groups.push((
            "rays",
            vec![
                format!("frame by frame  {}", rays(expected.camera_alone, expected.exact, alone)),
                format!(
                    "with this plan  {}{}",
                    rays(expected.camera, expected.exact, reused),
                    fewer(alone, reused)
                ),
            ],
        ));
        let kept = units::bytes(plan.kept_bytes());
        groups.push((
            "memory",
            vec![
                format!("{kept} for films that are kept, of {}", units::bytes(self.budget)),
                format!("{} for pictures on their way", units::bytes(self.besides)),
            ],
        ));
        groups.extend(self.farm.iter().map(|farm| ("farm", farm.lines())));
        let mut text = String::new();
        for (heading, lines) in groups {
            for (place, line) in lines.iter().enumerate() {
                let heading = if place == 0 { heading } else { "" };
                text += &format!("{heading:<7} {}\n", escape::line(line));
            }
        }
        text.truncate(text.trim_end().len());
        text
    }

    /// Why there are as many films as there are.
    fn why(&self) -> String {
        let told = |(reason, films): &(Reason, usize)| {
            let films = count(*films as u64);
            match reason {
                Reason::First => format!("{films} to begin with"),
                Reason::Change(changes) => format!("{films} where {}", self.changes(changes)),
                Reason::Samples => format!("{films} where samples become random or stop being so"),
                Reason::Memory => format!("{films} again, for want of --memory"),
            }
        };
        self.outline.reasons.iter().map(told).collect::<Vec<_>>().join("; ")
    }

    /// How long all takes, how good it becomes, and the films one by one or in groups.
    fn expectations(&self) -> Vec<(&'static str, Vec<String>)> {
        let Some((outlook, forecast)) = &self.outlook else { return vec![("time", vec![NONE.to_owned()])] };
        let mut time = format!("tracing takes {}", words::about(&forecast.wall));
        if let Some(cpu) = &forecast.cpu {
            time += &format!(", {} of processors", words::about(cpu));
        }
        let advice = words::advice(&self.sequence.quality, forecast, outlook);
        let error = match &forecast.error {
            Some(error) => format!("{} of the brightness, in the worst frame", words::share(error)),
            None => "none, as nothing is random".to_owned(),
        };
        let each = each_film(&self.plan, &forecast.films);
        vec![("time", [vec![time], advice].concat()), ("error", vec![error]), ("each", each)]
    }

    /// What films take together that call for an effect.
    fn price(&self, effect: Effect) -> String {
        let (Some((_, forecast)), Some(films)) = (&self.outlook, self.outline.calls.get(&effect)) else {
            return String::new();
        };
        let wall: f64 = films.iter().map(|&film| forecast.films[film].took.wall).sum();
        format!(" ({}, {})", counted(films.len() as u64, "film"), words::rough(wall))
    }

    /// How many films there are, and what does not fit.
    fn films(&self) -> String {
        let takes = &self.plan.takes;
        let most = takes.iter().map(|take| take.lit.len()).max().unwrap_or(0) as u64;
        let films = counted(takes.len() as u64, "film");
        let mut text = format!("{films}, with up to {} of light", counted(most, "layer"));
        let unlimited = self.transports();
        if takes.len() > unlimited {
            text += &format!(
                "; with more --memory {} would do, as films give way to others or have no room for all layers",
                count(unlimited as u64)
            );
        }
        text
    }

    /// Films that would be traced if there were room for all.
    fn transports(&self) -> usize {
        let looks = &self.plan.survey.frames;
        let mut different: Vec<_> = looks.iter().map(|look| look.transport).collect();
        different.sort_unstable();
        different.dedup();
        different.len()
    }

    fn span(&self, span: &Span) -> String {
        let frame = |index: usize| self.plan.survey.frames[index].frame;
        let range = match (frame(span.first), frame(span.last)) {
            (first, last) if first == last => first.to_string(),
            (first, last) => format!("{first}-{last}"),
        };
        let films = counted(span.traced as u64, "film");
        let changes = match span.changes.is_empty() {
            true => "nothing changes".to_owned(),
            false => self.changes(&span.changes),
        };
        format!("{range}: {changes} ({films})")
    }

    /// Every layer of light with what shines in it, and whether it is traced.
    fn layers(&self) -> Vec<String> {
        let names = self.sequence.about().layers;
        let traced = |layer: usize| {
            let id = LayerId(layer as u32);
            self.plan.takes.iter().filter(|take| take.lit.contains(&id)).count() as u64
        };
        let told = |(layer, name): (usize, String)| match traced(layer) {
            0 => format!("{name}: dark, not traced"),
            films => format!("{name}: in {}", counted(films, "film")),
        };
        names.into_iter().enumerate().map(told).collect()
    }

    fn unused(&self) -> impl Iterator<Item = &'static str> {
        let unused = Effect::ALL.iter().filter(|effect| !self.outline.effects.contains_key(effect));
        unused.map(|effect| effect.name())
    }

    /// Who changes, those first that do the same.
    fn changes(&self, changes: &[Part]) -> String {
        let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
        for part in changes {
            let (who, does) = self.part(*part);
            match groups.iter_mut().find(|(same, _)| *same == does) {
                Some((_, all)) => all.push(who),
                None => groups.push((does, vec![who])),
            }
        }
        let told = |(does, all): &(&str, Vec<String>)| match &all[..] {
            [rest @ .., last] if !rest.is_empty() => {
                // Several move where one moves.
                format!("{} and {last} {}", rest.join(", "), does.trim_end_matches('s'))
            }
            all => format!("{} {does}", all.concat()),
        };
        groups.iter().map(told).collect::<Vec<_>>().join("; ")
    }

    /// Who it is, and what is seen of the change.
    fn part(&self, part: Part) -> (String, &'static str) {
        let Sequence { cameras, objects, materials, lights, .. } = self.sequence;
        let named = |kind: &str, name: &str| format!("{kind} \"{name}\"");
        match part {
            Part::Camera(index) => (named("camera", &cameras[index].name), "moves"),
            Part::Cut => ("the active camera".to_owned(), "is another"),
            Part::Object(index) => (named("object", &objects[index].name), "moves"),
            Part::Material(index) => (material(&materials[index].name), "changes"),
            Part::Light(index) => (named("light", &lights[index].name), "moves"),
            Part::Switch(index) => (named("light", &lights[index].name), "toggles"),
            Part::Brightness(index) => (named("light", &lights[index].name), "fades"),
            Part::Emission(index) => (format!("emission of {}", material(&materials[index].name)), "fades"),
            Part::Background => ("the background".to_owned(), "changes"),
            Part::BackgroundBrightness => ("the background".to_owned(), "fades"),
            Part::Ambient => ("ambient light".to_owned(), "fades"),
            Part::Fog => ("the fog".to_owned(), "changes"),
            Part::FogColor => ("the fog's colour".to_owned(), "fades"),
            Part::Exposure => ("the exposure".to_owned(), "changes"),
        }
    }

    fn caller(&self, caller: Caller) -> String {
        match caller {
            Caller::Camera => "the camera".to_owned(),
            Caller::Integrator => "the integrator".to_owned(),
            Caller::Background => "the background".to_owned(),
            Caller::Ambient => "the ambient light".to_owned(),
            Caller::Fog => "the fog".to_owned(),
            Caller::Light(index) => format!("light \"{}\"", self.sequence.lights[index as usize].name),
            Caller::Material(index) => material(&self.sequence.materials[index as usize].name),
        }
    }

    fn json(&self) -> String {
        let Self { plan, outline, expected, .. } = self;
        let frame = |index: usize| u64::from(plan.survey.frames[index].frame);
        let span = |span: &Span| {
            Object::new()
                .whole("first", frame(span.first))
                .whole("last", frame(span.last))
                .texts(
                    "changes",
                    span.changes.iter().map(|part| {
                        let (who, does) = self.part(*part);
                        format!("{who} {does}")
                    }),
                )
                .whole("films", span.traced as u64)
        };
        let names = self.sequence.about().layers;
        let film = |(index, take): (usize, &crate::pipeline::plan::Take)| {
            let forecast = self.outlook.as_ref().map(|(_, forecast)| &forecast.films[index]);
            let object = Object::new()
                .whole("traced_for", frame(take.frames[0]))
                .whole("frames", take.frames.len() as u64)
                .texts("layers", take.lit.iter().map(|layer| names[layer.index()].clone()));
            forecast.into_iter().fold(object, with_forecast)
        };
        let effect_films = |object: Object, (effect, films): (&Effect, &Vec<usize>)| {
            let of = Object::new().whole("films", films.len() as u64);
            let sum =
                self.outlook.as_ref().map(|(_, forecast)| films.iter().map(|&film| forecast.films[film]));
            object.object(effect.name(), sum.into_iter().fold(of, with_forecasts))
        };
        let reason = |(reason, films): &(Reason, usize)| {
            let object = Object::new().whole("films", *films as u64);
            match reason {
                Reason::First => object.text("why", "first"),
                Reason::Samples => object.text("why", "samples"),
                Reason::Memory => object.text("why", "memory"),
                Reason::Change(parts) => object.text("why", "change").texts(
                    "changes",
                    parts.iter().map(|part| {
                        let (who, does) = self.part(*part);
                        format!("{who} {does}")
                    }),
                ),
            }
        };
        let effect = |object: Object, (effect, caller): (&Effect, &Caller)| {
            object.text(effect.name(), &self.caller(*caller))
        };
        let rays = |camera: u64, all: Option<u64>| {
            let object = Object::new().whole("camera", camera).raw("exact", expected.exact);
            all.into_iter().fold(object, |object, all| object.whole("all", all))
        };
        let object = Object::new()
            .text("event", "plan")
            .whole("frames", plan.of.len() as u64)
            .whole("reused", plan.reused() as u64)
            .objects("spans", outline.spans.iter().map(span))
            .objects("films", plan.takes.iter().enumerate().map(film))
            .objects("why_films", outline.reasons.iter().map(reason))
            .texts("layers", names.iter().cloned())
            .object("effects", outline.effects.iter().fold(Object::new(), effect))
            .object("effect_films", outline.calls.iter().fold(Object::new(), effect_films))
            .texts("unused_effects", self.unused().map(str::to_owned))
            .whole("bvh_builds", plan.builds())
            .object("rays_frame_by_frame", rays(expected.camera_alone, expected.rays_alone))
            .object("rays", rays(expected.camera, expected.rays))
            .whole("kept_bytes", plan.kept_bytes())
            .whole("budget_bytes", self.budget);
        let object = self.outlook.iter().fold(object, |object, (outlook, forecast)| {
            let advice = words::advice(&self.sequence.quality, forecast, outlook);
            words::seconds(object, forecast).texts("advice", advice.into_iter())
        });
        self.farm.iter().fold(object, |object, farm| object.object("farm", farm.json())).finish()
    }
}

/// A material by its name; that of an object is called by where it is written.
fn material(name: &str) -> String {
    if name.starts_with("objects.") { name.to_owned() } else { format!("material \"{name}\"") }
}

/// `about 12,000 rays, 3,000 of them from the camera`.
fn rays(camera: u64, exact: bool, all: Option<u64>) -> String {
    let camera = format!("{}{} ", if exact { "" } else { "about " }, count(camera));
    match all {
        Some(all) => format!("about {}, {camera}of them from the camera", count(all)),
        None => format!("{camera}from the camera"),
    }
}

fn fewer(alone: Option<u64>, reused: Option<u64>) -> String {
    match (alone, reused) {
        (Some(alone), Some(reused)) if reused > 0 && alone > reused => {
            format!("; {:.1} times fewer", alone as f64 / reused as f64)
        }
        _ => String::new(),
    }
}
