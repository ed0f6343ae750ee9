//! `kinora explain`: prints what the reference says about a field, a kind or a section of the sequence file.

mod markdown;
mod print;
mod search;

use super::failure::Failure;
use super::terminal;
use crate::base::escape;
use crate::sequence::{listed, nearest};
use clap::Args;
use markdown::Reference;
use search::{Found, Query};

/// Print what a field, a kind or a section of the sequence file means.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Examples:
  kinora explain tonemap           a field: what it takes, its default, whether it takes keys
  kinora explain lights.intensity  a field of one section or kind
  kinora explain Sphere            a kind, here the shape and the light
  kinora explain 'camera paths'    a whole section
  kinora explain                   the names of all sections")]
pub struct Arguments {
    /// A field, a kind or a section, with dots between an owner and its field
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// The reference of the sequence file, and that of annotations.
const PAGES: [&str; 2] =
    [include_str!("../../../sequences/README.md"), include_str!("../../../docs/annotations.md")];

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let reference = Reference::read(&PAGES);
    let Some(name) = &arguments.name else {
        return terminal::print_text(print::titles(&reference).trim_end());
    };
    terminal::print_text(answer(&reference, name)?.trim_end())
}

/// What the reference says about names of the file. In front of each name are those of its owners.
pub fn describer() -> impl Fn(&[&str]) -> Option<String> {
    let reference = Reference::read(&PAGES);
    move |path| print::sentences(&Query::new(&path.join(".")).best(&reference)?)
}

fn answer(reference: &Reference, name: &str) -> Result<String, Failure> {
    let query = Query::new(name);
    let found = query.find(reference);
    if !found.is_empty() {
        return Ok(print::found(&found));
    }
    let shown = escape::line(name);
    // The field may exist, but not there.
    let elsewhere = Query::new(query.name()).find(reference);
    if !elsewhere.is_empty() {
        let places: Vec<String> = elsewhere.iter().map(Found::owner).collect();
        let places = listed(places.iter().map(String::as_str));
        return Err(Failure::Bad(format!(
            "the reference has no `{shown}`; it has `{}` of {places}",
            query.name()
        )));
    }
    let names = search::names(reference);
    let hint = match nearest(query.name(), names.iter().map(String::as_str)) {
        Some(name) => format!("did you mean `{name}`?"),
        None => "`kinora explain` without a name lists the sections".to_owned(),
    };
    Err(Failure::Bad(format!("the reference has no `{shown}`; {hint}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn explained(name: &str) -> String {
        answer(&Reference::read(&PAGES), name).unwrap_or_else(|failure| format!("{failure:?}"))
    }

    #[test]
    fn fields_have_their_row() {
        let text = explained("output.tonemap");
        assert!(text.starts_with("`tonemap` · output\n"), "{text}");
        assert!(text.contains("  default: `Srgb`\n") && text.contains("  keys: no\n"), "{text}");
        assert!(!text.contains("](#"), "links have no place in a terminal: {text}");
        let version = explained("kinora");
        assert!(
            version.contains("the oldest version of Kinora") && version.contains("keys: no"),
            "{version}"
        );
    }

    #[test]
    fn owners_select_among_fields_of_the_same_name() {
        let all = explained("intensity");
        assert!(all.contains("· lights\n"), "{all}");
        let one = explained("lights.intensity");
        assert!(one.len() < all.len() && one.contains("· lights\n"), "{one}");
        assert_eq!(explained("light.intensity"), one);
        let tube = explained("Torus.minor");
        assert!(tube.contains("`minor: 0.25`") && tube.starts_with("`Torus`"), "{tube}");
    }

    #[test]
    fn kinds_and_sections_are_found() {
        let sphere = explained("Sphere");
        assert!(sphere.contains("Shapes") && sphere.contains("lights"), "{sphere}");
        assert_eq!(explained("sphere"), sphere);
        let section = explained("camera paths");
        assert!(section.starts_with("Camera paths\n"), "{section}");
        assert!(explained("Clock").contains("Text and pictures"));
        assert!(explained("shadows").contains("whether objects block the light"));
        assert!(explained("Scalar").contains("by the colours of a map"));
    }

    #[test]
    fn unknown_names_have_a_suggestion() {
        assert!(explained("tonmap").contains("did you mean `tonemap`?"));
        assert!(explained("zzzzzz").contains("lists the sections"));
        let elsewhere = explained("output.roughness");
        assert!(elsewhere.contains("no `output.roughness`; it has `roughness` of"), "{elsewhere}");
    }

    #[test]
    fn every_section_can_be_asked_for() {
        let reference = Reference::read(&PAGES);
        for section in reference.sections.iter().filter(|section| section.level > 1) {
            let text = explained(&section.name());
            assert!(text.contains(&section.name()), "{}: {text}", section.name());
        }
    }
}
