//! Decodes `quality`.

use super::fields::Fields;
use super::node::Node;
use super::values::{between, is_number, positive, switch, tuple, whole};
use super::words::{Variants, variant, word};
use crate::film::filter::{Filter, Kernel};
use crate::sampling::SamplerKind;
use crate::sequence::quality::{
    Denoise, Integrator, MAX_SAMPLES, NoiseTarget, PathSettings, Quality, SampleReuse,
};
use std::ops::RangeInclusive;

/// Filter widths in pixels. Wider filters would blur instead of reconstruct.
const FILTER_WIDTHS: RangeInclusive<f64> = 0.01..=16.0;

/// Range of target errors.
pub const ERRORS: RangeInclusive<f64> = 1e-4..=1.0;

/// Decodes `quality`: fields, or `Error(0.01)` alone.
pub fn quality(node: Node<'_>) -> Option<Quality> {
    let default = Quality::default();
    if node.begins_with("Error") {
        let error = error(node)?;
        return Some(Quality { noise: Some(NoiseTarget { error, most: NoiseTarget::MOST }), ..default });
    }
    let mut fields = Fields::of(node, "the quality")?;
    let integrator = fields.or("integrator", integrator, default.integrator);
    let bounces = fields.or("bounces", whole(0..=1000), default.bounces);
    let antialias = fields.or("antialias", whole(1..=64), default.antialias);
    let samples = fields.or("samples", whole(1..=MAX_SAMPLES), default.samples);
    let noise = fields.optional("noise", between(ERRORS));
    let max_samples = fields.renamed("max_samples", "most_samples", whole(1..=MAX_SAMPLES));
    let points = fields.or("sampler", points, default.points);
    let filter = fields.or("filter", filter, default.filter);
    let threshold = fields.or("threshold", between(0.0..=1.0), f64::from(default.threshold));
    let clamp = fields.optional("clamp", positive);
    let shutter_steps = fields.or("shutter_steps", whole(1..=4096), default.shutter_steps);
    let smooth_terminator = fields.or("smooth_terminator", switch, default.smooth_terminator);
    let seed = fields.or("seed", whole(0..=u32::MAX), default.seed);
    let vary_noise = fields.or("vary_noise", switch, default.vary_noise);
    let reuse = fields.or("reuse", reuse, default.reuse);
    let denoise = fields.or("denoise", denoise, default.denoise);
    if matches!(noise, Some(Some(_))) && fields.is_given("samples") {
        let note = "`samples` has no effect: `noise` decides how many there are";
        node.file.warn(fields.place("samples").start, note.to_owned());
    }
    fields.finish();
    let (noise, most) = (noise?, max_samples?.unwrap_or(NoiseTarget::MOST));
    let noise = noise.map(|error| NoiseTarget { error, most });
    Some(Quality {
        integrator: integrator?,
        bounces: bounces?,
        antialias: antialias?,
        samples: samples?,
        noise,
        points: points?,
        filter: filter?,
        threshold: threshold? as f32,
        clamp: clamp?.map(|clamp| clamp as f32),
        shutter_steps: shutter_steps?,
        smooth_terminator: smooth_terminator?,
        seed: seed?,
        vary_noise: vary_noise?,
        reuse: reuse?,
        denoise: denoise?,
    })
}

/// `Error(0.01)`.
fn error(node: Node<'_>) -> Option<f64> {
    let [error] = tuple(node, "Error(0.01)")?;
    between(ERRORS)(error)
}

fn points(node: Node<'_>) -> Option<SamplerKind> {
    word(node, "sampler", &[("Sobol", SamplerKind::Sobol), ("Independent", SamplerKind::Independent)])
}

fn reuse(node: Node<'_>) -> Option<SampleReuse> {
    word(node, "reuse", &[("Off", SampleReuse::Off), ("Zoom", SampleReuse::Zoom)])
}

fn denoise(node: Node<'_>) -> Option<Denoise> {
    word(node, "denoise", &[("Off", Denoise::Off), ("Auto", Denoise::Auto), ("Alone", Denoise::Alone)])
}

fn integrator(node: Node<'_>) -> Option<Integrator> {
    let table: &Variants<'_, Integrator> = &[("Whitted", whitted), ("Path", path)];
    variant(node, "integrator", table)
}

fn whitted(node: Node<'_>) -> Option<Integrator> {
    Fields::of(node, "`Whitted`")?.finish();
    Some(Integrator::Whitted)
}

fn path(node: Node<'_>) -> Option<Integrator> {
    let default = PathSettings::default();
    let mut fields = Fields::of(node, "`Path`")?;
    let roulette = fields.or("roulette", roulette, default.roulette);
    let refractive_shadows = fields.or("refractive_shadows", switch, default.refractive_shadows);
    fields.finish();
    Some(Integrator::Path(PathSettings { roulette: roulette?, refractive_shadows: refractive_shadows? }))
}

/// A number of bounces, or `Off`.
fn roulette(node: Node<'_>) -> Option<Option<u32>> {
    let word = node.as_word();
    if word.begins_with("Off") && word.bare_word().is_some() {
        return Some(None);
    }
    if !is_number(node) {
        node.expected("a whole number of bounces from 0 to 1000, or `Off`");
        return None;
    }
    whole(0..=1000)(node).map(Some)
}

/// A reconstruction filter, alone or with its width.
fn filter(node: Node<'_>) -> Option<Filter> {
    let table: &Variants<'_, Filter> = &[
        ("Box", |node| kernel(node, "`Box`", Kernel::Box)),
        ("Tent", |node| kernel(node, "`Tent`", Kernel::Tent)),
        ("Gaussian", |node| kernel(node, "`Gaussian`", Kernel::Gaussian)),
        ("BlackmanHarris", |node| kernel(node, "`BlackmanHarris`", Kernel::BlackmanHarris)),
    ];
    variant(node, "filter", table)
}

fn kernel(node: Node<'_>, what: &'static str, kernel: Kernel) -> Option<Filter> {
    let mut fields = Fields::of(node, what)?;
    let width = fields.or("width", between(FILTER_WIDTHS), Filter::from(kernel).width);
    fields.finish();
    Some(Filter { kernel, width: width? })
}
