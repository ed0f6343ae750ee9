//! XML files in every encoding.

use super::*;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::io::Write;

/// The encodings of arrays in XML files.
#[derive(Clone, Copy, Debug)]
pub(super) struct Encoding {
    pub format: &'static str,
    pub base64: bool,
    pub compressor: &'static str,
    pub wide: bool,
    pub big: bool,
    /// Whether the header is encoded apart from the data.
    pub apart: bool,
}

impl Encoding {
    fn number(&self, value: u64) -> Vec<u8> {
        let mut bytes =
            if self.wide { value.to_le_bytes().to_vec() } else { (value as u32).to_le_bytes().to_vec() };
        if self.big {
            bytes.reverse();
        }
        bytes
    }

    /// An array with its header, not encoded yet: the header, and the data.
    fn payload(&self, data: &[u8]) -> [Vec<u8>; 2] {
        const BLOCK: usize = 16;
        if self.compressor.is_empty() {
            return [self.number(data.len() as u64), data.to_vec()];
        }
        let blocks: Vec<Vec<u8>> = data.chunks(BLOCK).map(|block| self.compressed(block)).collect();
        let numbers =
            [blocks.len(), BLOCK, data.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
        [numbers.flat_map(|number| self.number(number as u64)).collect(), blocks.concat()]
    }

    fn compressed(&self, block: &[u8]) -> Vec<u8> {
        if self.compressor == "vtkLZ4DataCompressor" {
            return lz4_flex::block::compress(block);
        }
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(block).expect("memory");
        encoder.finish().expect("memory")
    }

    fn bytes(&self, data: &[u8]) -> Vec<u8> {
        let [header, data] = self.payload(data);
        match (self.base64, self.apart) {
            (false, _) => [header, data].concat(),
            (true, true) => (STANDARD.encode(header) + &STANDARD.encode(data)).into_bytes(),
            (true, false) => STANDARD.encode([header, data].concat()).into_bytes(),
        }
    }
}

/// A tetrahedron of one cell in a `.vtu` file, with data.
pub(super) fn xml(encoding: Encoding) -> Vec<u8> {
    let points: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1];
    let heat: [f64; 4] = [0.5, 1.5, 2.5, -3.5];
    let mut appended = Vec::new();
    let mut array = |name: &str, kind: &str, components: usize, values: &[f64]| {
        let element =
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        let mut data = Vec::new();
        for value in values {
            let mut bytes = match kind {
                "Float64" => value.to_le_bytes().to_vec(),
                "Float32" => (*value as f32).to_le_bytes().to_vec(),
                "Int64" => (*value as i64).to_le_bytes().to_vec(),
                _ => vec![*value as u8],
            };
            if encoding.big {
                bytes.reverse();
            }
            data.extend(bytes);
        }
        let content = match encoding.format {
            "ascii" => values.iter().map(|value| format!("{value} ")).collect(),
            "binary" => String::from_utf8(encoding.bytes(&data)).expect("base64"),
            _ => {
                let element = format!("{element} format=\"appended\" offset=\"{}\"/>", appended.len());
                appended.extend(encoding.bytes(&data));
                return element;
            }
        };
        format!("{element} format=\"{}\">\n{content}\n</DataArray>", encoding.format)
    };
    let body = [
        "<PointData Scalars=\"heat &amp; more\">".to_owned(),
        array("heat &amp; more", "Float32", 1, &heat),
        "</PointData><CellData>".to_owned(),
        array("v", "Float64", 3, &[1.0, 2.0, 2.0]),
        "</CellData><Points>".to_owned(),
        array("Points", "Float64", 3, &points),
        "</Points><Cells>".to_owned(),
        array("connectivity", "Int64", 1, &[0.0, 1.0, 2.0, 3.0]),
        array("offsets", "Int64", 1, &[4.0]),
        array("types", "UInt8", 1, &[10.0]),
        "</Cells>".to_owned(),
    ]
    .join("\n");
    let mut file = format!(
        "<?xml version=\"1.0\"?>\n<!-- of a test -->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
         byte_order=\"{}Endian\" header_type=\"UInt{}\" compressor=\"{}\">\n<UnstructuredGrid>\n\
         <FieldData><DataArray type=\"String\" Name=\"s\" format=\"ascii\">1</DataArray></FieldData>\n\
         <Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n{body}\n</Piece>\n</UnstructuredGrid>\n",
        if encoding.big { "Big" } else { "Little" },
        if encoding.wide { 64 } else { 32 },
        encoding.compressor,
    )
    .into_bytes();
    if encoding.format == "appended" {
        let kind = if encoding.base64 { "base64" } else { "raw" };
        file.extend(format!("<AppendedData encoding=\"{kind}\">\n  _").bytes());
        file.extend(appended);
        file.extend(b"\n</AppendedData>\n");
    }
    file.extend(b"</VTKFile>\n");
    file
}

pub(super) const TEXT: Encoding =
    Encoding { format: "ascii", base64: false, compressor: "", wide: false, big: false, apart: false };

#[test]
fn xml_files_are_read_in_every_encoding() {
    let expected = good(&xml(TEXT));
    assert_eq!((expected.triangles.len(), volume(&expected)), (4, 0.1));
    assert_eq!(values(&expected, "heat & more", Centering::Points), [0.5, 1.5, 2.5, -3.5]);
    assert_eq!(values(&expected, "v", Centering::Cells), [[1.0, 2.0, 2.0]; 4].concat());
    for (format, base64) in [("binary", true), ("appended", true), ("appended", false)] {
        for compressor in ["", "vtkZLibDataCompressor", "vtkLZ4DataCompressor"] {
            for bits in 0..8 {
                let (wide, big, apart) = (bits & 1 > 0, bits & 2 > 0, bits & 4 > 0);
                let encoding = Encoding { format, base64, compressor, wide, big, apart };
                assert_eq!(good(&xml(encoding)), expected, "{encoding:?}");
            }
        }
    }
}

/// What a header states is checked before memory is taken.
#[test]
fn stated_sizes_are_bounded_by_the_file() {
    for (compressor, expected) in [
        ("", "its header states 18,446,744,073,709,551,615 bytes"),
        ("vtkZLibDataCompressor", "cannot hold the stated"),
        ("vtkLZ4DataCompressor", "cannot hold the stated"),
    ] {
        let encoding =
            Encoding { format: "appended", base64: false, compressor, wide: true, big: false, apart: false };
        let mut file = xml(encoding);
        let begin = file.windows(2).rposition(|pair| pair == b" _").expect("data") + 2;
        // The size of the array, or that of its blocks.
        let at = if compressor.is_empty() { begin } else { begin + 8 };
        file[at..at + 8].copy_from_slice(&[0xff; 8]);
        let found = fault(&file);
        assert!(
            found.contains(expected) && found.starts_with(&format!("byte {begin}: in the array")),
            "{found}"
        );
    }
}

/// Padding where a group of four begins, or too much of it.
#[test]
fn wrong_base64_ends_with_an_error() {
    for text in ["=", "====", "AAAA=", "AAAA=AAA", "A===", "AA=A", "AA==="] {
        let file = format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece><Points>\n<DataArray type=\"Float32\" Name=\"P\" \
             NumberOfComponents=\"3\" format=\"binary\">{text}</DataArray></Points></Piece></PolyData></VTKFile>"
        );
        let found = fault(file);
        assert!(found.starts_with("line 2: in the array `P`, the base64 is not valid"), "{text}: {found}");
    }
}

/// A file of a triangle whose points are these bytes, after a header.
fn compressed_points(header: &[u32], blocks: &[u8]) -> Vec<u8> {
    let bytes: Vec<u8> =
        header.iter().flat_map(|number| number.to_le_bytes()).chain(blocks.iter().copied()).collect();
    format!(
        "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"3\"><Points>\n\
         <DataArray type=\"Float32\" Name=\"P\" NumberOfComponents=\"3\" format=\"binary\">{}</DataArray></Points><Polys>\
         <DataArray type=\"Int8\" Name=\"connectivity\">0 1 2</DataArray><DataArray type=\"Int8\" Name=\"offsets\">3\
         </DataArray></Polys></Piece></PolyData></VTKFile>",
        STANDARD.encode(bytes)
    )
    .into_bytes()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    Encoding { compressor: "vtkZLibDataCompressor", ..TEXT }.compressed(bytes)
}

#[test]
fn block_headers_fit_their_blocks() {
    let points: Vec<u8> =
        [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let block = zlib(&points);
    let size = block.len() as u32;
    assert_eq!(good(&compressed_points(&[1, 36, 0, size], &block)).positions.len(), 3);
    assert_eq!(good(&compressed_points(&[1, 64, 36, size], &block)).positions.len(), 3);
    for (header, expected) in [
        ([1, 0, 36, size], "its header states blocks of 0 bytes, and a last one of 36"),
        ([1, 12, 36, size], "its header states blocks of 12 bytes, and a last one of 36"),
        ([1, 36, 0, size - 9], "block 0 cannot be decompressed"),
    ] {
        let found = fault(compressed_points(&header, &block));
        assert!(found.starts_with(&format!("line 2: in the array `P`, {expected}")), "{found}");
    }
    let longer = zlib(&[&points[..], &[0; 12]].concat());
    let found = fault(compressed_points(&[1, 36, 0, longer.len() as u32], &longer));
    assert!(
        found.ends_with("block 0 cannot be decompressed: it has more than the 36 bytes of a block"),
        "{found}"
    );
}

/// Nothing is decompressed if the piece states another number.
#[test]
fn counts_are_compared_before_anything_is_decompressed() {
    let found = fault(compressed_points(&[1, 48, 0, 12], &[0xff; 12]));
    assert_eq!(found, "line 2: `NumberOfPoints` is 3, but the array `P` has 12 numbers, 3 each");
}
