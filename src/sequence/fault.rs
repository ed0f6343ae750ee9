//! A fault of a file: the place, the expected value, and suggestions.

use std::ops::Range;

/// A fault at one place of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Bytes of the source that the fault is about.
    pub span: Range<usize>,
    pub(super) title: Title,
    pub(super) label: String,
    pub(super) notes: Box<Notes>,
}

/// What messages say besides.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Notes {
    /// A related place.
    pub also: Option<(Range<usize>, String)>,
    /// The places that brought the faulty part into the sequence, from the inside out.
    pub uses: Vec<(Range<usize>, String)>,
    pub help: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Title {
    /// A complete sentence.
    Text(String),
    /// "`field`: expected `what`". The decoder of the field fills in its name.
    Expected { what: String, field: Option<String> },
}

impl Fault {
    pub fn new(span: Range<usize>, title: impl Into<String>, label: impl Into<String>) -> Self {
        Self::titled(span, Title::Text(title.into()), label.into())
    }

    /// A value that its field does not accept.
    pub fn expected(span: Range<usize>, what: impl Into<String>, found: impl Into<String>) -> Self {
        Self::titled(span, Title::Expected { what: what.into(), field: None }, found.into())
    }

    fn titled(span: Range<usize>, title: Title, label: String) -> Self {
        Self { span, title, label, notes: Box::default() }
    }

    /// Replaces the label at the place.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.notes.help.push(help.into());
        self
    }

    pub fn also(mut self, span: Range<usize>, label: impl Into<String>) -> Self {
        self.notes.also = Some((span, label.into()));
        self
    }

    /// Adds a place that uses the one before, or the faulty part.
    pub fn used(mut self, span: Range<usize>, label: impl Into<String>) -> Self {
        self.notes.uses.push((span, label.into()));
        self
    }

    /// The same fault at other places: `place` maps each of its spans. Adds the places that use it.
    pub fn relocated(
        self,
        place: impl Fn(Range<usize>) -> Range<usize>,
        uses: Vec<(Range<usize>, String)>,
    ) -> Self {
        let Notes { also, uses: own, help } = *self.notes;
        let also = also.map(|(span, label)| (place(span), label));
        let own = own.into_iter().map(|(span, label)| (place(span), label));
        let notes = Box::new(Notes { also, uses: own.chain(uses).collect(), help });
        Self { span: place(self.span), notes, ..self }
    }

    /// The same fault `by` bytes later.
    pub fn moved(self, by: usize) -> Self {
        self.relocated(|span| span.start + by..span.end + by, Vec::new())
    }

    /// Sets the field's name, unless an inner field has set it already.
    pub fn name_field(&mut self, name: &str) {
        if let Title::Expected { field: field @ None, .. } = &mut self.title {
            *field = Some(name.to_owned());
        }
    }

    /// The field's name, if the fault is a value that a field does not accept.
    pub fn field(&self) -> Option<&str> {
        match &self.title {
            Title::Expected { field, .. } => field.as_deref(),
            Title::Text(_) => None,
        }
    }

    /// The first line of the message.
    pub fn title(&self) -> String {
        match &self.title {
            Title::Text(text) => text.clone(),
            Title::Expected { what, field: None } => format!("expected {what}"),
            Title::Expected { what, field: Some(field) } => format!("`{field}`: expected {what}"),
        }
    }
}
