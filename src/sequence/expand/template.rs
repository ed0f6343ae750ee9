//! Templates: objects that are written once, with parameters.

use super::super::fault::Fault;
use super::super::fields::Fields;
use super::super::names::{Entry, entries};
use super::super::node::Node;
use super::super::suggest::{listed, nearest, shortened};
use super::expression::{is_name, is_reserved};
use super::parts::Part;
use super::scope::{Scope, Value, Values};
use super::state::{Context, State};
use super::visibility::sort_first;
use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

/// The field of an object that names its template.
pub const TEMPLATE: &str = "template";

/// The field of an object with the values of a template's parameters.
pub const WITH: &str = "with";

/// The word for a parameter without a default.
const REQUIRED: &str = "Required";

/// Templates that use each other this deep.
const DEEPEST: usize = 16;

pub struct Template<'s> {
    pub name: String,
    /// The place of its name.
    pub place: Range<usize>,
    /// The index of its file.
    pub module: usize,
    parameters: Vec<Parameter<'s>>,
    objects: Node<'s>,
    /// The entries of `objects`, split when they are first used. None if they have a fault.
    entries: OnceCell<Option<Vec<Entry<'s>>>>,
    names: OnceCell<HashSet<String>>,
}

impl<'s> Template<'s> {
    /// The objects, unless their section has a fault.
    pub fn entries(&self) -> Option<&[Entry<'s>]> {
        self.entries.get_or_init(|| entries(self.objects, "object")).as_deref()
    }

    /// The names of the objects.
    pub fn names(&self) -> &HashSet<String> {
        let all = || self.entries().unwrap_or_default().iter().map(|entry| entry.name.clone()).collect();
        self.names.get_or_init(all)
    }
}

struct Parameter<'s> {
    name: String,
    place: Range<usize>,
    default: Option<Node<'s>>,
}

/// Reports a name that expressions cannot use.
pub fn check_name(node: Node<'_>, name: &str, what: &str) -> bool {
    let fault = if is_reserved(name) {
        let title = format!("`{name}` already has a meaning in expressions");
        Fault::new(node.span(), title, "choose another name")
    } else if is_name(name) {
        return true;
    } else {
        let title = format!("the name of a {what} has letters, digits and `_`, and begins with no digit");
        Fault::new(node.span(), title, "expressions cannot use this name")
    };
    node.fault(fault);
    false
}

/// Decodes a template: `(parameters: { "width": 1, "wood": Required }, objects: { ... })`.
pub fn template<'s>(node: Node<'s>, name: &str, place: Range<usize>, module: usize) -> Option<Template<'s>> {
    let mut fields = Fields::of(node, "a template")?;
    let parameters = fields.optional("parameters", |node| {
        let parameters = entries(node, "parameter")?.into_iter().map(|entry| {
            let good = !entry.name.is_empty() && check_name(entry.key, &entry.name, "parameter");
            let default = Some(entry.value).filter(|value| value.bare_word() != Some(REQUIRED));
            good.then(|| Parameter { name: entry.name, place: entry.key.span(), default })
        });
        parameters.collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>()
    });
    let objects = fields.required("objects", Some);
    fields.finish();
    let parameters = parameters?.unwrap_or_default();
    Some(Template {
        name: name.to_owned(),
        place,
        module,
        parameters,
        objects: objects?,
        entries: OnceCell::new(),
        names: OnceCell::new(),
    })
}

/// A use of a template: the values of its parameters.
pub struct Instance<'s> {
    pub template: Rc<Template<'s>>,
    /// The place of the template's name in the object that uses it.
    pub place: Range<usize>,
    given: HashMap<String, (Vec<Part<'s>>, Range<usize>)>,
}

impl<'s> Instance<'s> {
    /// Decodes the fields `template` and `with` of an object.
    pub fn new(
        state: &State<'s>,
        name: Node<'_>,
        with: Option<Node<'_>>,
        context: &Context<'_>,
    ) -> Option<Self> {
        let text = state.field(name, TEMPLATE, context, super::super::values::text)?;
        let templates = state.templates_of(context.module)?;
        let template = match templates.get(&text) {
            Some(template) => Rc::clone(template.as_ref()?),
            None => {
                let mut known: Vec<_> = templates.names().collect();
                sort_first(&mut known);
                if !templates.is_partial() {
                    super::super::words::report_unknown(name, "template", &text, known);
                }
                return None;
            }
        };
        let instance = Self { place: name.span(), given: HashMap::new(), template };
        if let Some(open) = context.open
            && instance.closes_circle(state, open, context)
        {
            return None;
        }
        let mut given = HashMap::new();
        let mut good = true;
        if let Some(with) = with {
            if state.refuse_expression(with, "values with the names of parameters { \"name\": ... }", context)
            {
                return None;
            }
            for entry in entries(with, "parameter")? {
                if instance.template.parameters.iter().any(|parameter| parameter.name == entry.name) {
                    let parts = state.parts_at(entry.value.span(), context.used);
                    given.insert(entry.name, (parts, entry.key.span()));
                } else if !entry.name.is_empty() {
                    instance.report_unknown_parameter(entry.key, &entry.name);
                    good = false;
                }
            }
        }
        let required = instance.template.parameters.iter().filter(|parameter| parameter.default.is_none());
        for missing in required.filter(|parameter| !given.contains_key(&parameter.name)) {
            let title = format!("the template `{}` needs `{}`", shortened(&text), shortened(&missing.name));
            let fault = Fault::new(name.span(), title, "write it in `with: { ... }`");
            name.fault(fault.also(missing.place.clone(), "this parameter has no default"));
            good = false;
        }
        good.then_some(Self { given, ..instance })
    }

    fn report_unknown_parameter(&self, key: Node<'_>, name: &str) {
        let known = || self.template.parameters.iter().map(|parameter| parameter.name.as_str());
        let label = nearest(name, known())
            .map_or_else(|| "unknown".to_owned(), |near| format!("did you mean `{}`?", shortened(near)));
        let title = format!(
            "the template `{}` has no parameter `{}`",
            shortened(&self.template.name),
            shortened(name)
        );
        let fault = Fault::new(key.span(), title, label).also(self.template.place.clone(), "the template");
        key.fault(fault.help(format!("its parameters are {}", listed(known()))));
    }

    /// Reports templates that use each other in a circle, or too deeply.
    fn closes_circle(&self, state: &State<'s>, open: &super::state::Open<'_>, context: &Context<'_>) -> bool {
        let mut chain: Vec<_> = open.chain().map(|open| (open.template, &open.place)).collect();
        let again = chain.iter().position(|(_, place)| **place == self.template.place);
        let name = shortened(&self.template.name);
        let fault = match again {
            Some(0) => Fault::new(
                self.place.clone(),
                format!("the template `{name}` uses itself"),
                "used again here",
            ),
            Some(last) => {
                chain.truncate(last + 1);
                let names = chain.iter().rev().map(|(name, _)| format!("`{}`", shortened(name)));
                let names = names.collect::<Vec<_>>().join(" uses ");
                Fault::new(
                    self.place.clone(),
                    "templates use each other in a circle",
                    format!("{names} uses `{name}`"),
                )
            }
            None if chain.len() >= DEEPEST => {
                let title = format!("templates use each other more than {DEEPEST} deep");
                Fault::new(self.place.clone(), title, "one too many")
            }
            None => return false,
        };
        state.fault(fault, context.used);
        true
    }

    /// The values of all parameters. Defaults see the parameters above them, and the values of the template's file.
    pub fn values(&self, state: &State<'s>, context: &Context<'_>) -> Values {
        let mut values = Values::new();
        let file = state.values_of(self.template.module);
        for Parameter { name, place, default } in &self.template.parameters {
            let value: Value = match (self.given.get(name), default) {
                (Some((parts, place)), _) => state.value_of(parts, place.clone(), context),
                (None, Some(default)) => {
                    let scope = Scope { parameters: Some(&values), file, indices: Default::default() };
                    state.value(*default, place.clone(), &Context { scope, ..*context })
                }
                (None, None) => continue,
            };
            values.insert(name.clone(), value);
        }
        values
    }
}
