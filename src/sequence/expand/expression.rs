//! The notation of expressions: `"= 2 * r + 1"`.

use super::super::decimal::is_decimal;
use super::super::fault::Fault;
use super::super::suggest::{listed, nearest, shortened};
use super::functions::{FUNCTIONS, Function};
use super::number::Number;
use std::ops::Range;

/// Most characters of an expression. They bound how deep its tree can be.
const LONGEST: usize = 1000;

/// Deepest brackets and signs.
const DEEPEST: usize = 50;

/// Names that expressions know without a definition.
pub const PI: &str = "pi";

/// The numbers of a copy of `Repeat`.
pub const INDICES: [&str; 3] = ["i", "j", "k"];

/// An expression. Places are bytes of all sources.
#[derive(Clone, Debug)]
pub enum Expression {
    Number(Number),
    /// A value with a name.
    Name(String, Range<usize>),
    Negative(Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>, Range<usize>),
    Call(&'static Function, Vec<Expression>, Range<usize>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl std::fmt::Debug for Function {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// Whether a text can be the name of a value: letters, digits and `_`, not beginning with a digit.
pub fn is_name(text: &str) -> bool {
    text.starts_with(is_first) && text.chars().all(is_letter)
}

/// Whether expressions use this name for something else.
pub fn is_reserved(name: &str) -> bool {
    name == PI || INDICES.contains(&name) || is_function(name)
}

pub fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|function| function.name == name)
}

fn is_first(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

fn is_letter(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

/// Parses a quoted expression with its quotes and its `=`, which begins at byte `at` of all sources.
///
/// # Errors
/// The first fault.
pub fn parse(quoted: &str, at: usize) -> Result<Expression, Fault> {
    let text = quoted.strip_prefix("\"=").and_then(|text| text.strip_suffix('"')).unwrap_or_default();
    let whole = at..at + quoted.len();
    if text.chars().count() > LONGEST {
        let title = format!("an expression has at most {LONGEST} characters");
        return Err(Fault::new(whole, title, "too long").help("give parts of it names in `let`"));
    }
    let mut parser = Parser { text, at: 0, start: at + 2, depth: 0 };
    let is_text =
        !text.trim_start().starts_with(|c: char| is_first(c) || c.is_ascii_digit() || "+-(.".contains(c));
    let expression = parser.sum().map_err(|fault| if is_text { as_text(fault, text) } else { fault })?;
    parser.blanks();
    match parser.rest().chars().next() {
        None => Ok(expression),
        Some(')') => Err(parser.fault("this bracket closes nothing", "remove it")),
        Some('=') => Err(parser.fault("an expression has one `=`, at its beginning", "not expected here")),
        Some(next) => {
            let fault =
                parser.fault("this expression goes on after its end", "an operator is missing before this");
            // Two names in a row are words.
            let follows_a_name = text[..parser.at].trim_end().ends_with(is_first);
            Err(if is_first(next) && follows_a_name { as_text(fault, text) } else { fault })
        }
    }
}

/// A fault of what may be meant as a text, with both ways to write it.
fn as_text(fault: Fault, text: &str) -> Fault {
    let text = shortened(text);
    fault.help(format!(
        "texts that begin with `=` are expressions, such as \"= 2*r + 1\"; to mean the text itself, write r\"={text}\""
    ))
}

struct Parser<'s> {
    text: &'s str,
    at: usize,
    /// The byte of all sources at which the text begins.
    start: usize,
    depth: usize,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    /// Skips blanks and one of these characters.
    fn take(&mut self, operators: &str) -> Option<char> {
        self.blanks();
        let next = self.rest().chars().next().filter(|c| operators.contains(*c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn span(&self, from: usize) -> Range<usize> {
        self.start + from..self.start + self.at
    }

    /// A fault at the next character, or at the closing quote.
    fn fault(&self, title: &str, label: &str) -> Fault {
        let (at, len) = (self.start + self.at, self.rest().chars().next().map_or(1, char::len_utf8));
        let fault = Fault::new(at..at + len, title, label);
        if self.text.contains('\\') { fault.help("expressions have no escapes") } else { fault }
    }

    fn sum(&mut self) -> Result<Expression, Fault> {
        self.chain("+-", Self::product)
    }

    fn product(&mut self) -> Result<Expression, Fault> {
        self.chain("*/", Self::signed)
    }

    /// Operands of operators that bind to the left.
    fn chain(
        &mut self,
        operators: &str,
        operand: fn(&mut Self) -> Result<Expression, Fault>,
    ) -> Result<Expression, Fault> {
        let mut left = operand(self)?;
        while let Some(c) = self.take(operators) {
            let place = self.span(self.at - 1);
            let operator = match c {
                '+' => Operator::Add,
                '-' => Operator::Subtract,
                '*' => Operator::Multiply,
                _ => Operator::Divide,
            };
            left = Expression::Binary(operator, Box::new(left), Box::new(operand(self)?), place);
        }
        Ok(left)
    }

    /// A power with any signs. `-2^2` is -4.
    fn signed(&mut self) -> Result<Expression, Fault> {
        self.deeper(|parser| match parser.take("+-") {
            Some('-') => Ok(Expression::Negative(Box::new(parser.signed()?))),
            Some(_) => parser.signed(),
            None => parser.power(),
        })
    }

    /// Powers bind to the right.
    fn power(&mut self) -> Result<Expression, Fault> {
        let base = self.atom()?;
        if self.take("^").is_none() {
            return Ok(base);
        }
        let place = self.span(self.at - 1);
        Ok(Expression::Binary(Operator::Power, Box::new(base), Box::new(self.signed()?), place))
    }

    fn deeper(
        &mut self,
        parse: impl FnOnce(&mut Self) -> Result<Expression, Fault>,
    ) -> Result<Expression, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault("this expression is nested too deeply", "give parts of it names in `let`"));
        }
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    fn atom(&mut self) -> Result<Expression, Fault> {
        self.blanks();
        let from = self.at;
        match self.rest().chars().next() {
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.close()?;
                Ok(inner)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if is_first(c) => {
                let rest = self.rest();
                let len = rest.find(|c| !is_letter(c)).unwrap_or(rest.len());
                let name = rest[..len].to_owned();
                self.at += len;
                let place = self.span(from);
                match self.take("(") {
                    Some(_) => self.call(&name, place),
                    None => Ok(Expression::Name(name, place)),
                }
            }
            None => {
                Err(self.fault("this expression ends too early", "expected a number or a name before this"))
            }
            Some(_) => Err(self.fault("expected a number, a name or `(`", "not understood here")),
        }
    }

    fn close(&mut self) -> Result<(), Fault> {
        match self.take(")") {
            Some(_) => Ok(()),
            None => Err(self.fault("a bracket of this expression is not closed", "expected `)` here")),
        }
    }

    fn number(&mut self) -> Result<Expression, Fault> {
        let (from, bytes) = (self.at, self.text.as_bytes());
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(|byte| byte.is_ascii_digit() || *byte == b'.' || *byte == b'_') {
                at += 1;
            }
            at
        };
        let mut end = digits(from);
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
                end = digits(end + 1 + sign);
            }
        }
        self.at = end;
        let text = &self.text[from..end];
        let number = Number::parse(text).map(Expression::Number);
        number.ok_or_else(|| match is_decimal(text) {
            true => Fault::new(self.span(from), "this number is too large", "numbers are below 1.8e308"),
            false => {
                Fault::new(self.span(from), "this is not a number", "write numbers like 2, 0.5 or 1.5e-3")
            }
        })
    }

    fn call(&mut self, name: &str, place: Range<usize>) -> Result<Expression, Fault> {
        let mut arguments = Vec::new();
        if self.take(")").is_none() {
            loop {
                arguments.push(self.deeper(Self::sum)?);
                if self.take(",").is_none() {
                    break;
                }
            }
            self.close()?;
        }
        let names = || FUNCTIONS.iter().map(|function| function.name);
        let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) else {
            let label = nearest(name, names())
                .map_or_else(|| "unknown".to_owned(), |near| format!("did you mean `{near}`?"));
            let fault = Fault::new(place, format!("there is no function `{}`", shortened(name)), label);
            return Err(fault.help(format!("known here: {}", listed(names()))));
        };
        if (function.least..=function.most).contains(&arguments.len()) {
            return Ok(Expression::Call(function, arguments, place));
        }
        let needs = match (function.least, function.most) {
            (1, 1) => "one number".to_owned(),
            (2, 2) => "two numbers".to_owned(),
            (least, most) => format!("{least} to {most} numbers"),
        };
        let label = format!("found {}", arguments.len());
        Err(Fault::new(place, format!("`{name}` takes {needs}"), label))
    }
}
