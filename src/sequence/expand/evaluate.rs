//! The values of expressions.

use super::super::fault::Fault;
use super::super::suggest::{listed, nearest, shortened};
use super::expression::{Expression, INDICES, Operator, PI};
use super::number::Number;
use super::scope::Scope;
use std::ops::Range;

/// The value of an expression: a finite number.
///
/// # Errors
/// The first fault.
pub fn evaluate(expression: &Expression, scope: &Scope<'_>) -> Result<Number, Fault> {
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
                Operator::Divide if right.is_zero() => return Err(division(place)),
                Operator::Divide => left.over(right),
                Operator::Power if left.is_zero() && right.to_f64() < 0.0 => return Err(division(place)),
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
                Fault::new(place.clone(), title, format!("{}({listed}): {why}", function.name))
            })?;
            finite(value, place)
        }
    }
}

fn division(place: &Range<usize>) -> Fault {
    Fault::new(place.clone(), "division by 0", "what follows is 0")
}

fn finite(value: Number, place: &Range<usize>) -> Result<Number, Fault> {
    let float = value.to_f64();
    if float.is_finite() {
        return Ok(value);
    }
    let why = if float.is_nan() { "has no real value" } else { "is too large" };
    Err(Fault::new(place.clone(), format!("this part of the expression {why}"), "computed here"))
}

fn named(name: &str, place: &Range<usize>, scope: &Scope<'_>) -> Result<Number, Fault> {
    if let Some(index) = scope.indices.get(name) {
        return Ok(Number::whole(index.into()));
    }
    if name == PI {
        return Ok(Number::Float(std::f64::consts::PI));
    }
    match scope.value(name) {
        Some(value) => value.number.ok_or_else(|| {
            let label = format!("it is {}", shortened(value.fragment.text.trim()));
            let fault = Fault::new(place.clone(), format!("`{}` is not a number", shortened(name)), label);
            fault.also(value.place.clone(), "defined here").help("only numbers can be used in arithmetic")
        }),
        None => Err(unknown(name, place, scope)),
    }
}

/// The fault of a name without a value.
pub fn unknown(name: &str, place: &Range<usize>, scope: &Scope<'_>) -> Fault {
    let names = scope.names();
    let near = nearest(name, names.iter().copied());
    let label = near.map_or_else(|| "unknown".to_owned(), |near| format!("did you mean `{near}`?"));
    let fault = Fault::new(place.clone(), format!("there is no value `{}`", shortened(name)), label);
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
            fragment: Rc::new(Fragment { text: text.to_owned(), pieces: Vec::new() }),
            place: 0..0,
        };
        let values: Values = [("r", "2.5"), ("n", "12"), ("wood", "\"oak\"")]
            .map(|(name, text)| (name.to_owned(), value(text)))
            .into();
        let scope =
            Scope { values: [Some(&values), None], indices: Indices { numbers: [3, 0, 0], dimensions: 1 } };
        evaluate(&parse(&format!("\"={text}\""), 0)?, &scope).map(Number::text)
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
            ("asin(1)", "90"),
            ("acos(-1)", "180"),
            ("atan2(1, -1)", "135"),
            ("min(3, 1, 2) + max(0.1, 0.5)", "1.5"),
            ("abs(-0.1)", "0.1"),
            ("floor(-0.5)", "-1"),
            ("ceil(7/2)", "4"),
            ("round(2.5)", "3"),
            ("mod(7, 3) + mod(-1, 4)", "4"),
            ("pi", "3.141592653589793"),
        ] {
            assert_eq!(result(text).as_deref(), Ok(value), "{text}");
        }
    }

    #[test]
    fn wrong_expressions_are_refused() {
        for (text, title) in [
            ("1 / 0", "division by 0"),
            ("0 ^ -1", "division by 0"),
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
        assert_eq!(result(&format!("{}1", "1+".repeat(499))).as_deref(), Ok("500"));
    }
}
