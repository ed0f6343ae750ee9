//! Tables: what is read, and where faults are.

use super::*;
use proptest::prelude::*;
use std::fs::{self, File};

fn csv(text: &str) -> Result<Table, TableError> {
    Table::read(text.as_bytes(), TableFormat::Csv)
}

fn json(text: &str) -> Result<Table, TableError> {
    Table::read(text.as_bytes(), TableFormat::JsonLines)
}

#[test]
fn columns_have_names_and_rows_have_lines() {
    let table = csv("\u{feff}t, x ,name\r\n0,1e-3,a\r\n\r\n\"0.1\",-2,b\r\n0.2,3,\"c\nd\"\n0.3,4,e")
        .expect("a table");
    assert_eq!(table.names().collect::<Vec<_>>(), ["t", "x", "name"]);
    assert_eq!(table.column("t"), Ok(&[0.0, 0.1, 0.2, 0.3][..]));
    assert_eq!(table.column("x"), Ok(&[1e-3, -2.0, 3.0, 4.0][..]));
    assert_eq!(table.lines(), [2, 4, 5, 7]);
    assert!(table.has("name"));
}

#[test]
fn semicolons_and_tabs_separate() {
    let expected = csv("t,x\n0,1\n").expect("a table");
    for separator in [";", "\t"] {
        assert_eq!(csv(&"t,x\n0,1\n".replace(',', separator)), Ok(expected.clone()));
    }
    assert_eq!(csv("t\n0\n").expect("a table").column("t"), Ok(&[0.0][..]));
}

/// A quote inside of a cell is a character, as for the parser.
#[test]
fn quotes_open_at_the_begin_of_cells() {
    let table = csv("t,name\n0,5\" pipe\n1,\"a \"\"b\"\"\n\nc\"\n2,\"d\" e\"\n").expect("a table");
    assert_eq!(table.column("t"), Ok(&[0.0, 1.0, 2.0][..]));
}

#[test]
fn separators_in_quotes_do_not_count() {
    let table = csv("\"t, s\";\"x, m\";\"y, m\"\n0;1;2\n").expect("a table");
    assert_eq!(table.names().collect::<Vec<_>>(), ["t, s", "x, m", "y, m"]);
    assert_eq!(table.column("y, m"), Ok(&[2.0][..]));
}

/// Spreadsheets write separators behind the last column.
#[test]
fn columns_that_nothing_uses_may_have_equal_names() {
    let table = csv("t,x,x,,\n0,1,2,,\n").expect("a table");
    assert_eq!(table.column("t"), Ok(&[0.0][..]));
    let error = table.column("x").expect_err("a fault");
    assert_eq!(error.to_string(), "line 1: two columns are named \"x\"");
}

/// What is missing is written in many ways; anything else is a mistake.
#[test]
fn columns_may_lack_numbers() {
    let table = csv("t,a,b\n0,,1\n1,NaN,x\n2,na,2\n3,N/A,3\n4,null,4\n5,6,inf\n").expect("a table");
    let gaps = table.column_with_gaps("a").expect("numbers");
    assert!(gaps[..5].iter().all(|value| value.is_nan()) && gaps[5] == 6.0, "{gaps:?}");
    let strict = table.column("a").expect_err("a fault").to_string();
    assert_eq!(strict, "line 2, column \"a\": expected a finite number, found nothing");
    let fault = table.column_with_gaps("b").expect_err("a fault").to_string();
    assert_eq!(fault, "line 3, column \"b\": expected a finite number, found `x`");
    let table = json("{\"a\": null, \"b\": \"NaN\"}\n{\"b\": 2}\n{\"a\": 3, \"b\": 1}\n").expect("a table");
    let gaps = table.column_with_gaps("a").expect("numbers");
    assert!(gaps[..2].iter().all(|value| value.is_nan()) && gaps[2] == 3.0, "{gaps:?}");
    assert!(table.column_with_gaps("b").is_err());
}

#[test]
fn rows_grow_past_the_first_ones() {
    let text: String = (0..3 * FIRST_ROWS).map(|row| format!("{row},\n")).collect();
    let table = csv(&format!("t,x\n{text}")).expect("a table");
    let expected: Vec<f64> = (0..3 * FIRST_ROWS).map(|row| row as f64).collect();
    assert_eq!(table.column("t"), Ok(&expected[..]));
}

#[test]
fn json_lines_are_the_same_table() {
    let table =
        json("\u{feff}{\"t\": 0, \"x\": 0.1}\n\n{\"x\": 1e22, \"t\": 1, \"more\": [1]}\n").expect("a table");
    assert_eq!(table.column("t"), Ok(&[0.0, 1.0][..]));
    // Decimals are rounded correctly.
    assert_eq!(table.column("x"), Ok(&[0.1, 1e22][..]));
    assert_eq!(table.lines(), [1, 3]);
    let precise = json("{\"x\": 2.0000000000000004440892098500626}").expect("a table");
    assert_eq!(precise.column("x"), Ok(&[2.000_000_000_000_000_4][..]));
}

fn csv_fault(text: &str) -> String {
    csv(text).expect_err("a fault").to_string()
}

#[test]
fn faults_of_csv_name_their_line() {
    assert_eq!(csv_fault(""), "it is empty; the first line names the columns");
    assert_eq!(csv_fault("t,x\n"), "it has no rows");
    assert_eq!(
        csv_fault("\n \r\nt,x\n0,1\r\n\r\n0\n"),
        "line 6: expected 2 cells, as in the line of names, found 1"
    );
    assert_eq!(csv_fault("0,1\n1,2"), "line 1: expected the names of the columns, found `0,1`");
    assert_eq!(
        csv_fault("t,x\n0,1\n1,\"a\n2,3\n"),
        "line 3: a quote opens in this line, and is never closed"
    );
    assert_eq!(csv_fault("t,x\n\n0,\"a\"\"\n1,2"), "line 3: a quote opens in this line, and is never closed");
    assert_eq!(csv_fault("t,\"x\n0,1\n"), "line 1: a quote opens in this line, and is never closed");
    assert_eq!(csv_fault("t,x\n0\n1,\"2\n"), "line 2: expected 2 cells, as in the line of names, found 1");
    let utf16: Vec<u8> = "\u{feff}t,x\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for format in [TableFormat::Csv, TableFormat::JsonLines] {
        let error = Table::read(&utf16[..], format).expect_err("a fault");
        assert_eq!(error.to_string(), "it is UTF-16 text; tables are UTF-8");
    }
    assert_eq!(csv_fault("t,x\n0,1\n\n2"), "line 4: expected 2 cells, as in the line of names, found 1");
    let wide = vec!["c"; MAX_COLUMNS + 1].join(",");
    assert_eq!(csv_fault(&format!("{wide}\n")), "line 1: 1001 columns; 1000 are the most");
}

#[test]
fn faults_of_json_lines_name_their_line() {
    let fault = |text: &str| json(text).expect_err("a fault").to_string();
    assert_eq!(fault("\n"), "it is empty; every line holds an object such as {\"t\": 0, \"x\": 1}");
    assert_eq!(
        fault("{\"t\": 0}\n[1, 2]"),
        "line 2: expected an object such as {\"t\": 0, \"x\": 1}, found `[1, 2]`"
    );
    assert_eq!(fault("{\"t\": 0}\n\n{}"), "line 3: it has none of the columns of line 1");
    assert_eq!(
        fault("{\n\"t\": 0}"),
        "line 1: the object does not end in its line, `{`; every line holds a whole one"
    );
    assert_eq!(fault("{\"t\": }"), "line 1: expected value at character 7 in `{\"t\": }`");
}

#[test]
fn cells_are_checked_when_their_column_is_used() {
    let of = |table: &Table, name: &str| table.column(name).expect_err("a fault").to_string();
    let table = csv("t,x,y\n0,1,\n1,inf,2\nabc,3,4").expect("a table");
    assert_eq!(of(&table, "t"), "line 4, column \"t\": expected a finite number, found `abc`");
    assert_eq!(of(&table, "x"), "line 3, column \"x\": expected a finite number, found `inf`");
    assert_eq!(of(&table, "y"), "line 2, column \"y\": expected a finite number, found nothing");
    assert_eq!(of(&table, "z"), "it has no column `z`; its columns are `t`, `x` and `y`");
    let table = json("{\"t\": 0, \"x\": \"1\"}\n{\"x\": null}").expect("a table");
    assert_eq!(of(&table, "t"), "line 2, column \"t\": expected a finite number, found nothing");
    assert_eq!(of(&table, "x"), "line 1, column \"x\": expected a finite number, found `\"1\"`");
}

#[test]
fn the_extension_names_the_format() {
    let meter = LoadProgress::default();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("A.CSV");
    fs::write(&path, "t\n1\n").expect("a disk");
    assert_eq!(Table::load(&path, &meter).expect("a table").rows(), 1);
    let fault = |name: &str| Table::load(name.as_ref(), &meter).expect_err("a fault").to_string();
    assert_eq!(fault("a.xlsx"), "tables are read from .csv, .tsv, .jsonl and .ndjson files");
    assert_eq!(fault("no/such/file.csv"), "there is no such file");
}

/// A file of 10 GB is refused before anything of it is read.
#[test]
fn huge_files_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("huge.csv");
    File::create(&path).and_then(|file| file.set_len(10_000_000_000)).expect("a sparse file");
    let error = Table::load(&path, &LoadProgress::default()).expect_err("a fault");
    assert_eq!(error.to_string(), "it is larger than 2 GiB");
}

/// The line of every row, found by counting: rows of two cells between blank lines, with both ends of lines.
#[test]
fn lines_are_counted_through_blanks() {
    let mut random = crate::testing::Random(5);
    for _ in 0..200 {
        let (mut text, mut expected, mut line) = (String::from("a,b\n"), Vec::new(), 1);
        for _ in 0..20 {
            let end = if random.unit() < 0.5 { "\n" } else { "\r\n" };
            line += 1;
            if random.unit() < 0.4 {
                text += end;
            } else {
                text = text + "1,2" + end;
                expected.push(line);
            }
        }
        match csv(&text) {
            Ok(table) => assert_eq!(table.lines(), expected, "{text:?}"),
            Err(_) => assert!(expected.is_empty()),
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_a_table_or_an_error(
        pieces in prop::collection::vec(prop::sample::select(vec![
            "t", "x", ",", ";", "\t", "\n", "\r", "\"", "1", "-2.5e3", "nan", "{", "}", "\"t\": ", "[", "\u{0}", "é", " ",
        ]), 0..40),
    ) {
        let text: String = pieces.concat();
        for format in [TableFormat::Csv, TableFormat::JsonLines] {
            match Table::read(text.as_bytes(), format) {
                Ok(table) => {
                    prop_assert!(table.lines().is_sorted());
                    prop_assert_eq!(table.lines().len(), table.rows());
                    for name in table.names().map(str::to_owned).collect::<Vec<_>>() {
                        prop_assert!(table.column(&name).is_ok_and(|column| column.len() == table.rows())
                            || table.column(&name).is_err_and(|error| error.line.is_some()));
                    }
                }
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }
}
