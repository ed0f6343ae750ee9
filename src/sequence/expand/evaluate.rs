//! The values of expressions.

use super::super::decimal::is_decimal;
use super::super::fault::Fault;
use super::super::suggest::{listed, nearest, shortened};
use super::expression::{Expression, INDICES, Operator, PI, is_function};
use super::number::Number;
use super::scope::Scope;
use std::ops::Range;

/// Why an expression has no value.
pub enum Failure<'e> {
    Fault(Fault),
    /// There is no value with the name at this place. Its message names others, so it is made only where it is shown.
    Unknown(&'e str, &'e Range<usize>),
    /// It uses a value whose fault has been reported.
    Reported,
}

/// The value of an expression: a finite number.
///
/// # Errors
/// The first fault.
pub fn evaluate<'e>(expression: &'e Expression, scope: &Scope<'_>) -> Result<Number, Failure<'e>> {
    match expression {
        Expression::Number(number) => Ok(*number),
        Expression::Name(name, place) => named(name, place, scope),
        Expression::Negative(inner) => Ok(evaluate(inner, scope)?.negated()),
        Expression::Binary(operator, left, right, place) => {
            let (left, right) = (evaluate(left, scope)?, evaluate(right, scope)?);
            let value = match operator {
                Operator::Add => left.plus(right),
                Operator::Subtract => left.minus(right),
                Operator::Multiply => left.times(right),
                Operator::Divide if right.is_zero() => return Err(division(place, "what follows is 0")),
                Operator::Divide => left.over(right),
                Operator::Power if left.is_zero() && right.to_f64() < 0.0 => {
                    return Err(division(place, "0 has no negative powers"));
                }
                Operator::Power => left.power(right),
            };
            finite(value, place)
        }
        Expression::Call(function, arguments, place) => {
            let numbers =
                arguments.iter().map(|argument| evaluate(argument, scope)).collect::<Result<Vec<_>, _>>()?;
            let value = (function.value)(&numbers);
            let value = value.map_err(|why| {
                let listed = numbers.iter().map(|number| number.text()).collect::<Vec<_>>().join(", ");
                let title = format!("`{}` has no value here", function.name);
                let label = format!("{}({listed}): {why}", function.name);
                Failure::Fault(Fault::new(place.clone(), title, label))
            })?;
            finite(value, place)
        }
    }
}

fn division<'e>(place: &Range<usize>, why: &str) -> Failure<'e> {
    Failure::Fault(Fault::new(place.clone(), "division by 0", why))
}

fn finite<'e>(value: Number, place: &Range<usize>) -> Result<Number, Failure<'e>> {
    let float = value.to_f64();
    if float.is_finite() {
        return Ok(value);
    }
    let why = if float.is_nan() { "has no real value" } else { "is too large" };
    let title = format!("this part of the expression {why}");
    Err(Failure::Fault(Fault::new(place.clone(), title, "computed here")))
}

fn named<'e>(name: &'e str, place: &'e Range<usize>, scope: &Scope<'_>) -> Result<Number, Failure<'e>> {
    if let Some(index) = scope.indices.get(name) {
        return Ok(Number::whole(index.into()));
    }
    if name == PI {
        return Ok(Number::Float(std::f64::consts::PI));
    }
    match scope.value(name) {
        Some(value) if value.fragment.is_faulty => Err(Failure::Reported),
        Some(value) => value.number.ok_or_else(|| {
            let text = value.fragment.text.trim();
            let what = if is_decimal(text) { "too large a number" } else { "not a number" };
            let title = format!("`{}` is {what}", shortened(name));
            let fault = Fault::new(place.clone(), title, format!("it is {}", shortened(text)));
            let fault = fault.also(value.place.clone(), "defined here");
            Failure::Fault(fault.help("only numbers can be used in arithmetic"))
        }),
        None => Err(Failure::Unknown(name, place)),
    }
}

/// The first line of the message about a name without a value.
pub fn unknown_title(name: &str) -> String {
    match is_function(name) {
        true => format!("`{name}` is a function"),
        false => format!("there is no value `{}`", shortened(name)),
    }
}

/// The fault of a name without a value.
pub fn unknown(name: &str, place: &Range<usize>, scope: &Scope<'_>) -> Fault {
    if is_function(name) {
        return Fault::new(place.clone(), unknown_title(name), format!("write {name}(...)"));
    }
    let names = scope.names();
    let near = nearest(name, names.iter().copied());
    let label = near.map_or_else(|| "unknown".to_owned(), |near| format!("did you mean `{near}`?"));
    let fault = Fault::new(place.clone(), unknown_title(name), label);
    match names.as_slice() {
        _ if INDICES.contains(&name) => {
            fault.help("`i`, `j` and `k` are the numbers of the copies of a `Repeat`")
        }
        [] => fault.help("define values in `let: { \"name\": ... }`"),
        names => fault.help(format!("known here: {}", listed(names.iter().copied()))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::parse;
    use super::super::scope::{Indices, Value, Values};
    use super::super::writer::Fragment;
    use super::*;
    use std::rc::Rc;

    fn result(text: &str) -> Result<String, Fault> {
        let value = |text: &str| Value {
            number: Number::parse(text),
            fragment: Rc::new(Fragment { text: text.to_owned(), ..Fragment::default() }),
            place: 0..0,
        };
        let values: Values = [("r", "2.5"), ("n", "12"), ("wood", "\"oak\"")]
            .map(|(name, text)| (name.to_owned(), value(text)))
            .into();
        let indices = Indices { numbers: [3, 0, 0], dimensions: 1 };
        let scope = Scope { parameters: Some(&values), file: None, indices };
        let expression = parse(&format!("\"={text}\""), 0)?;
        let value = evaluate(&expression, &scope).map_err(|failure| match failure {
            Failure::Fault(fault) => fault,
            Failure::Unknown(name, place) => unknown(name, place, &scope),
            Failure::Reported => panic!("no value has a fault"),
        });
        value.map(Number::text)
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (text, value) in [
            ("1 + 2 * 3", "7"),
            ("(1 + 2) * 3", "9"),
            ("10 - 4 - 3", "3"),
            ("16 / 4 / 2", "2"),
            ("2 ^ 3 ^ 2", "512"),
            ("-2 ^ 2", "-4"),
            ("2 ^ -1", "0.5"),
            ("- -3", "3"),
            ("+.5e1", "5"),
            ("2*r + 1", "6"),
            ("i / n", "0.25"),
            ("0.1 + 0.2", "0.3"),
            ("1_000 / 8", "125"),
        ] {
            assert_eq!(result(text).as_deref(), Ok(value), "{text}");
        }
    }

    #[test]
    fn functions_take_degrees() {
        for (text, value) in [
            ("sin(90) + cos(180)", "0"),
            ("cos(90)", "0"),
            ("tan(180)", "0"),
            ("sqrt(16)", "4"),
            ("sqrt(2)", "1.4142135623730951"),
            ("tan(45) + 12*sin(30)", "7"),
            ("cos(60)", "0.5"),
            ("sin(45) - sqrt(0.5)", "0"),
            ("asin(0.5) + acos(-0.5)", "150"),
            ("asin(1)", "90"),
            ("acos(-1)", "180"),
            ("atan2(1, -1)", "135"),
            ("min(3, 1, 2) + max(0.1, 0.5)", "1.5"),
            ("abs(-0.1)", "0.1"),
            ("floor(-0.5)", "-1"),
            ("ceil(7/2)", "4"),
            ("round(2.5)", "3"),
            ("mod(7, 3) + mod(-1, 4)", "4"),
            ("mod(2^101, 7)", "4"),
            ("mod(0.7, 0.1)", "0"),
            ("pi", "3.141592653589793"),
        ] {
            assert_eq!(result(text).as_deref(), Ok(value), "{text}");
        }
    }

    #[test]
    fn wrong_expressions_are_refused() {
        for (text, title) in [
            ("1 / 0", "division by 0"),
            ("0 ^ -1", "0 has no negative powers"),
            ("1 / 1e999", "this number is too large"),
            ("min(1e999, 3)", "this number is too large"),
            ("sin", "write sin(...)"),
            ("sqrt(-1)", "sqrt(-1): "),
            ("asin(2)", "asin(2): "),
            ("tan(90)", "tan(90): "),
            ("mod(1, 0)", "mod(1, 0): "),
            ("1e300 * 1e300", "is too large"),
            ("(-8) ^ (1/3)", "has no real value"),
            ("q + 1", "there is no value `q`"),
            ("j", "there is no value `j`"),
            ("wood * 2", "`wood` is not a number"),
            ("sine(1)", "there is no function `sine`"),
            ("sin(1, 2)", "`sin` takes one number"),
            ("", "ends too early"),
            ("1 +", "ends too early"),
            ("(1", "is not closed"),
            ("1)", "closes nothing"),
            ("1 2", "goes on after its end"),
            ("1.2.3", "not a number"),
            ("2 * * 3", "expected a number"),
            ("=1", "expected a number"),
        ] {
            let fault = format!("{:?}", result(text).expect_err(text));
            assert!(fault.contains(title), "{text}: {fault}");
        }
        let deep = format!("{}1{}", "(".repeat(400), ")".repeat(400));
        assert!(format!("{:?}", result(&deep)).contains("nested too deeply"));
        assert!(format!("{:?}", result(&"1+".repeat(600))).contains("too long"));
        // Characters count, not bytes.
        assert!(format!("{:?}", result(&"ä".repeat(999))).contains("there is no value"));
        assert_eq!(result(&format!("{}1", "1+".repeat(499))).as_deref(), Ok("500"));
    }
}
