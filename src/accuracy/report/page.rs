//! The report: one HTML file that holds all it shows.

use super::crops::crops;
use super::plots::charts;
use crate::accuracy::findings::{described, factor, percent, seconds};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::Axis;
use crate::accuracy::statistics::Estimate;
use std::error::Error;

/// Where the measurements come from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// As it was typed.
    pub command: String,
    pub machine: String,
    /// The sequence file, for commands to paste.
    pub file: String,
}

/// What a reader has to know about each number.
const WORDS: [(&str, &str); 10] = [
    (
        "error (RMSE)",
        "How far the light of a pixel is from what it should be, typically: the root of the mean of the squared \
         differences, over all pixels and colours, in linear light. Given as a share of the picture's mean brightness.",
    ),
    (
        "relMSE",
        "The same squared difference divided by the square of what the pixel should be (plus 0.01), so that dark parts \
         count as much as bright ones. Plots show its root.",
    ),
    (
        "PSNR",
        "The error of the displayed picture against the full range of a display, in decibels; higher is better, 6 dB are half the error.",
    ),
    (
        "FLIP",
        "How different two pictures look to a person who flips between them on a usual screen: 0 is no difference, 1 the \
         largest there is (Andersson and others, 2020).",
    ),
    (
        "noise and bias",
        "Noise is what chance adds; more samples take it away. A bias is what stays however many samples there are, such \
         as light that too few bounces leave out.",
    ),
    (
        "efficiency",
        "1 / (squared error x seconds), as a multiple of the file's own: twice the efficiency is the same picture in half \
         the time.",
    ),
    (
        "reference",
        "What the picture should be: two long renders with random numbers of their own, of at least 64 times the samples \
         of what they judge; less of what is sampled until it is good. Multiplying the differences to both leaves the references' own noise out.",
    ),
    (
        "interval",
        "± or bars: if everything was measured again, 95 of 100 times the true value would lie within.",
    ),
    ("quartiles", "Half of the measured times lie between them; the median is the middle one."),
    (
        "Pareto front",
        "Settings that no other one beats in both error and time. Only these are worth choosing.",
    ),
];

/// The whole page.
pub fn page(measured: &Measured, origin: &Origin) -> Result<String, Box<dyn Error>> {
    let mut html = Html::default();
    html.head(&format!("What accuracy costs: {}", measured.name));
    html.tag("h1", &format!("What accuracy costs in time: {}", measured.name));
    answer(&mut html, measured);
    advice(&mut html, measured, origin);
    html.tag("h2", "Error against time");
    for chart in charts(measured) {
        html.raw(&format!("<figure id=\"{}\">{}", chart.name, chart.plot.svg()?));
        html.tag("figcaption", &chart.caption);
        html.raw("</figure>\n");
    }
    pictures(&mut html, measured)?;
    prices(&mut html, measured);
    convergence(&mut html, measured);
    layers(&mut html, measured);
    precision(&mut html, measured);
    settings(&mut html, measured);
    html.tag("h2", "What the words mean");
    html.list(WORDS.iter().map(|(word, meaning)| (word.to_string(), meaning.to_string())));
    html.tag("h2", "How it was measured");
    how(&mut html, measured, origin);
    html.raw("</main></body></html>\n");
    Ok(html.0)
}

fn answer(html: &mut Html, measured: &Measured) {
    html.raw("<section class=\"answer\">\n");
    for line in measured.lines() {
        html.tag("p", &line);
    }
    html.raw("</section>\n");
}

fn advice(html: &mut Html, measured: &Measured, origin: &Origin) {
    let all = measured.advice();
    html.tag("h2", "What to do with it");
    if all.is_empty() {
        html.tag("p", "The file's own setting is as good as any that was tried.");
        return;
    }
    html.raw("<table><tr><th>you want</th><th>render with</th><th>why</th></tr>\n");
    for advice in all {
        let command = format!("kinora render {} {}", origin.file, advice.flags);
        html.raw("<tr>");
        html.tag("td", &advice.goal);
        html.raw(&format!("<td><code>{}</code></td>", escaped(&command)));
        html.tag("td", &advice.effect);
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}

fn pictures(html: &mut Html, measured: &Measured) -> Result<(), Box<dyn Error>> {
    html.tag("h2", "What it looks like");
    html.tag(
        "p",
        "Where the file's own setting is worst, enlarged: the file's own, settings that take about as long \
         (at most 2.5 times, at least 0.4), and what it should be. Below each, what an eye sees in it (FLIP): black is no difference, white a large one.",
    );
    html.raw("<div class=\"crops\">\n");
    for crop in crops(measured)? {
        html.raw(&format!("<figure><img src=\"{}\" alt=\"{}\">", crop.picture, escaped(&crop.title)));
        if let Some(difference) = crop.difference {
            html.raw(&format!("<img src=\"{difference}\" alt=\"difference\">"));
        }
        html.raw(&format!(
            "<figcaption><b>{}</b><br>{}</figcaption></figure>\n",
            escaped(&crop.title),
            escaped(&crop.told)
        ));
    }
    html.raw("</div>\n");
    Ok(())
}

fn prices(html: &mut Html, measured: &Measured) {
    html.tag("h2", "Price list");
    html.tag(
        "p",
        "Times and errors as multiples of the file's own setting, which is the first row. Rows in bold lie on the \
         Pareto front. Bounces, roulette and layers are measured with few samples and compared with the first row of their \
         kind that has the file's value.",
    );
    html.raw(
        "<table class=\"prices\"><tr><th>setting</th><th>time</th><th>x</th><th>quartiles</th><th>processor</th>\
         <th>rays</th><th>samples</th><th>error</th><th>x</th><th>relMSE</th><th>PSNR</th><th>FLIP</th><th>bias</th>\
         <th>efficiency</th></tr>\n",
    );
    let front = measured.front(Point::error);
    for point in &measured.points {
        row(html, measured, point, front.iter().any(|other| std::ptr::eq(*other, point)));
    }
    html.raw("</table>\n");
}

/// What a point is compared with: the file's own value on its axis.
fn twin<'m>(measured: &'m Measured, point: &Point) -> &'m Point {
    let own = measured.own();
    let short = matches!(point.setting.axis, Axis::Bounces | Axis::Roulette | Axis::Layers);
    let same = |other: &&Point| {
        let (a, b) = (&other.setting.quality, &own.setting.quality);
        other.setting.axis == point.setting.axis
            && a.bounces == b.bounces
            && a.integrator == b.integrator
            && other.setting.layering == own.setting.layering
    };
    if short { measured.points.iter().find(same).unwrap_or(own) } else { own }
}

fn row(html: &mut Html, measured: &Measured, point: &Point, best: bool) {
    let own = twin(measured, point);
    let share = |estimate: Estimate| estimate.root().map(|error| measured.share(error));
    let error = share(point.squared);
    let spread = (error.high - error.low) / 2.0;
    let error = if spread > 0.0 {
        format!("{} ± {}", percent(error.mean), percent(spread))
    } else {
        percent(error.mean)
    };
    let psnr = point.psnr.mean;
    let cells = [
        described(point),
        seconds(point.wall.median),
        factor(point.wall.median / own.wall.median),
        format!("{} – {}", seconds(point.wall.lower), seconds(point.wall.upper)),
        point.cpu.map_or_else(|| "?".to_owned(), |cpu| seconds(cpu.median)),
        crate::humane::count(point.rays.round() as u64),
        format!("{:.0}", point.samples),
        error,
        if own.error() > 0.0 { factor(point.error() / own.error()) } else { "–".to_owned() },
        format!("{:.2e}", point.relative.mean),
        if psnr.is_finite() { format!("{psnr:.1}") } else { "∞".to_owned() },
        format!("{:.3}", point.flip.mean),
        percent(measured.share(point.bias.max(0.0).sqrt())),
        factor(point.efficiency() / own.efficiency()),
    ];
    html.raw(if best { "<tr class=\"best\">" } else { "<tr>" });
    cells.iter().for_each(|cell| html.tag("td", cell));
    html.raw("</tr>\n");
}

fn convergence(html: &mut Html, measured: &Measured) {
    if measured.slopes.is_empty() {
        return;
    }
    html.tag("h2", "How fast the error falls");
    html.tag(
        "p",
        "The error falls as a power of the number of samples. For independent samples the power is -0.5: four times the \
         samples, half the error. Evenly spread ones do better where light is smooth.",
    );
    html.raw(
        "<table><tr><th>samples</th><th>power</th><th>interval</th><th>half the error takes</th></tr>\n",
    );
    for (axis, slope) in &measured.slopes {
        html.raw("<tr>");
        html.tag("td", axis.name());
        html.tag("td", &format!("{:.3}", slope.mean));
        html.tag("td", &format!("{:.3} to {:.3}", slope.low, slope.high));
        html.tag("td", &format!("{} times the samples", factor(libm::exp2(-1.0 / slope.mean))));
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}

fn layers(html: &mut Html, measured: &Measured) {
    if measured.layers.len() < 2 {
        return;
    }
    html.tag("h2", "Layers of light");
    html.tag(
        "p",
        "Light that keys switch or fade is kept apart, each kind in a layer of its own. This is how bright and how \
         noisy each is at the file's own setting.",
    );
    html.raw("<table><tr><th>layer</th><th>share of the brightness</th><th>its own error</th></tr>\n");
    for layer in &measured.layers {
        html.raw("<tr>");
        html.tag("td", &layer.name);
        html.tag("td", &percent(layer.share));
        html.tag("td", &percent(layer.error));
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}

fn precision(html: &mut Html, measured: &Measured) {
    html.tag("h2", "Precision");
    html.tag(
        "p",
        "Where rays meet surfaces is computed with numbers of 64 bits (f64) and formulas that lose none of their digits. \
         Most renderers have numbers of 32 bits (f32). These are the hard cases of Kinora's tests in four ways; wrong is \
         what is off by kind, such as a ray that passes through a crack. It is the same for all sequences, so no option \
         changes it; kinora accuracy --hard-cases lists the cases.",
    );
    html.raw("<table><tr><th>way</th><th>hard cases</th><th>with wrong answers</th><th>time</th></tr>\n");
    for way in &measured.precision {
        html.raw("<tr>");
        html.tag("td", way.way);
        html.tag("td", &way.cases.to_string());
        html.tag("td", &way.failing.to_string());
        html.tag("td", &format!("{} times", factor(way.time)));
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}

fn settings(html: &mut Html, measured: &Measured) {
    html.tag("h2", "What was tried");
    let tried =
        Axis::ALL.into_iter().filter(|axis| measured.points.iter().any(|point| point.setting.axis == *axis));
    html.list(tried.map(|axis| (axis.name().to_owned(), axis.meaning().to_owned())));
    if !measured.left_out.is_empty() {
        html.tag("p", "Left out:");
        html.list(measured.left_out.iter().map(|left| (left.what.to_owned(), left.why.clone())));
    }
}

fn how(html: &mut Html, measured: &Measured, origin: &Origin) {
    let runs = match measured.random {
        true => format!("{} renders of each setting with different random numbers, in turn", measured.runs),
        false => {
            format!("{} renders of each setting, in turn, for the time; they are all the same", measured.runs)
        }
    };
    let frames = measured.frames.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    let (width, height) = measured.size;
    let (full_width, full_height) = measured.full_size;
    html.list([
        ("command".to_owned(), origin.command.clone()),
        ("machine".to_owned(), format!("{}, {} threads", origin.machine, measured.threads)),
        ("frames".to_owned(), frames),
        (
            "size".to_owned(),
            format!("{width} x {height} pixels (the file: {full_width} x {full_height}). Errors hardly depend on it, times are in proportion"),
        ),
        ("renders".to_owned(), runs),
        (
            "reference".to_owned(),
            format!(
                "two of {} samples a pixel; their own error is {}",
                measured.reference,
                percent(measured.share(measured.reference_error))
            ),
        ),
        ("times".to_owned(), "of tracing a frame with all that leads to it, without loading and writing files".to_owned()),
    ]);
}

/// A page in the making.
#[derive(Default)]
struct Html(String);

impl Html {
    fn raw(&mut self, text: &str) {
        self.0.push_str(text);
    }

    /// An element that holds text.
    fn tag(&mut self, name: &str, text: &str) {
        self.0 += &format!("<{name}>{}</{name}>\n", escaped(text));
    }

    /// Words and what they mean.
    fn list(&mut self, entries: impl IntoIterator<Item = (String, String)>) {
        self.raw("<dl>\n");
        for (word, meaning) in entries {
            self.0 += &format!("<dt>{}</dt><dd>{}</dd>\n", escaped(&word), escaped(&meaning));
        }
        self.raw("</dl>\n");
    }

    fn head(&mut self, title: &str) {
        self.raw("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
        self.raw("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
        self.tag("title", title);
        self.raw("<style>\n");
        self.raw(include_str!("page.css"));
        self.raw("</style></head><body><main>\n");
    }
}

/// Text that browsers do not take for anything else.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
