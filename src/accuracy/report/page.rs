//! The report: one self-contained HTML file that begins with the summary.

mod curve;
mod details;
mod html;
mod origin;
mod robust;
mod scene;
mod glossary;

pub use origin::Origin;

use super::plots::charts;
use crate::accuracy::measure::Measured;
use glossary::GLOSSARY;
use html::{Html, escaped};
use std::error::Error;

/// The HTML of the report.
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
    curve::pictures(&mut html, measured)?;
    curve::prices(&mut html, measured);
    details::temporal(&mut html, measured);
    scene::parts(&mut html, measured);
    robust::robustness(&mut html, measured)?;
    scene::fireflies(&mut html, measured)?;
    details::convergence(&mut html, measured);
    details::layers(&mut html, measured);
    details::hard_cases(&mut html, measured);
    details::settings(&mut html, measured);
    html.tag("h2", "Glossary");
    html.list(GLOSSARY.iter().map(|(word, meaning)| (word.to_string(), meaning.to_string())));
    html.tag("h2", "How it was measured");
    details::how(&mut html, measured, origin);
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

/// The advice, with commands to paste.
fn advice(html: &mut Html, measured: &Measured, origin: &Origin) {
    html.tag("h2", "Recommended settings");
    html.raw("<table><tr><th>goal</th><th>command</th><th>effect</th></tr>\n");
    for advice in measured.advice() {
        html.raw("<tr>");
        html.tag("td", &advice.goal);
        if advice.flags.is_empty() {
            html.raw("<td>–</td>");
        } else {
            let command = format!("kinora render {} {}", origin.file, advice.flags);
            html.raw(&format!("<td><code>{}</code></td>", escaped(&command)));
        }
        html.tag("td", &advice.effect);
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}
