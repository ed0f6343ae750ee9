//! The types of numbers in VTK files.

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberType {
    /// Eight in a byte, the first in its highest bit.
    Bit,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// A type of a legacy file.
    pub fn legacy(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "bit" => Self::Bit,
            "char" | "signed_char" => Self::I8,
            "unsigned_char" => Self::U8,
            "short" => Self::I16,
            "unsigned_short" => Self::U16,
            // VTK writes its indices as ints, whatever their size in memory.
            "int" | "vtkidtype" => Self::I32,
            "unsigned_int" => Self::U32,
            "long" | "vtktypeint64" => Self::I64,
            "unsigned_long" | "vtktypeuint64" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    /// A type of an XML file.
    pub fn xml(name: &str) -> Option<Self> {
        Some(match name {
            "Int8" => Self::I8,
            "UInt8" => Self::U8,
            "Int16" => Self::I16,
            "UInt16" => Self::U16,
            "Int32" => Self::I32,
            "UInt32" => Self::U32,
            "Int64" => Self::I64,
            "UInt64" => Self::U64,
            "Float32" => Self::F32,
            "Float64" => Self::F64,
            _ => return None,
        })
    }

    /// The size of a number in bits.
    pub fn bits(self) -> u64 {
        match self {
            Self::Bit => 1,
            Self::I8 | Self::U8 => 8,
            Self::I16 | Self::U16 => 16,
            Self::I32 | Self::U32 | Self::F32 => 32,
            Self::I64 | Self::U64 | Self::F64 => 64,
        }
    }

    /// The whole numbers in some bytes.
    pub fn numbers(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        macro_rules! of {
            ($number:ty) => {{
                let chunks = bytes.as_chunks::<{ size_of::<$number>() }>().0.iter();
                let number = |bytes: &[u8; size_of::<$number>()]| match big_endian {
                    true => <$number>::from_be_bytes(*bytes),
                    false => <$number>::from_le_bytes(*bytes),
                };
                chunks.map(|bytes| number(bytes) as f64).collect()
            }};
        }
        match self {
            Self::Bit => {
                bytes.iter().flat_map(|byte| (0..8).map(move |k| f64::from(byte >> (7 - k) & 1))).collect()
            }
            Self::I8 => of!(i8),
            Self::U8 => of!(u8),
            Self::I16 => of!(i16),
            Self::U16 => of!(u16),
            Self::I32 => of!(i32),
            Self::U32 => of!(u32),
            Self::I64 => of!(i64),
            Self::U64 => of!(u64),
            Self::F32 => of!(f32),
            Self::F64 => of!(f64),
        }
    }
}
