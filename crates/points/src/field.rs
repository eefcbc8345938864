//! The numbers of a point, as files declare and store them.

/// One number that every point of a file has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    /// Its name in the file, or the name that its place in the format stands for.
    pub(crate) name: String,
    /// How the file stores it.
    pub(crate) kind: Type,
    /// The name that the file gives it, where that is another.
    in_file: Option<String>,
    /// Whether it is passed over.
    left_out: bool,
}

impl Field {
    pub(crate) fn new(name: impl Into<String>, kind: Type) -> Self {
        Self { name: name.into(), kind, in_file: None, left_out: false }
    }

    /// One that is passed over.
    pub(crate) fn left_out(kind: Type) -> Self {
        Self { left_out: true, ..Self::new("", kind) }
    }

    /// Whether it is passed over.
    pub(crate) fn is_left_out(&self) -> bool {
        self.left_out
    }

    /// The same, with the name that the file gives it.
    pub(crate) fn called(self, in_file: &str) -> Self {
        Self { in_file: Some(in_file.to_owned()), ..self }
    }

    /// The name that the file gives it.
    pub(crate) fn original_name(&self) -> &str {
        self.in_file.as_deref().unwrap_or(&self.name)
    }
}

/// A number's type. As f64, in which values are handed on, all are exact but for integers of 64
/// bits beyond ±2^53.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Type {
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

impl Type {
    /// In bytes.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(crate) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Smallest and largest value of the type.
    pub(crate) fn limits(self) -> (f64, f64) {
        match self {
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U8 => (0.0, u8::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0.0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0.0, u32::MAX.into()),
            Self::I64 => (i64::MIN as f64, i64::MAX as f64),
            Self::U64 => (0.0, u64::MAX as f64),
            Self::F32 | Self::F64 => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// The number that starts a slice of at least its size.
    pub(crate) fn read<const BIG: bool>(self, bytes: &[u8]) -> f64 {
        macro_rules! read {
            ($type:ty) => {{
                let mut array = [0; size_of::<$type>()];
                array.copy_from_slice(&bytes[..size_of::<$type>()]);
                if BIG { <$type>::from_be_bytes(array) } else { <$type>::from_le_bytes(array) }
            }};
        }
        match self {
            Self::I8 => read!(i8).into(),
            Self::U8 => read!(u8).into(),
            Self::I16 => read!(i16).into(),
            Self::U16 => read!(u16).into(),
            Self::I32 => read!(i32).into(),
            Self::U32 => read!(u32).into(),
            Self::I64 => read!(i64) as f64,
            Self::U64 => read!(u64) as f64,
            Self::F32 => read!(f32).into(),
            Self::F64 => read!(f64),
        }
    }

    /// A word of a text file as the value that a binary file of this type would hold. Integers may
    /// be written as floats.
    pub(crate) fn parse(self, word: &[u8]) -> Option<f64> {
        let text = std::str::from_utf8(word).ok()?;
        match self {
            Self::F32 => text.parse::<f32>().map(f64::from).ok().or_else(|| not_finite(text)),
            Self::F64 => text.parse().ok().or_else(|| not_finite(text)),
            _ => {
                let (min, max) = self.limits();
                let value: f64 = text.parse().ok()?;
                (value >= min && value <= max && value.fract() == 0.0).then_some(value)
            }
        }
    }
}

/// The ways in which C libraries print what is not finite: `-nan(ind)`, `1.#QNAN`, `-1.#IND`,
/// `1.#INF`.
fn not_finite(text: &str) -> Option<f64> {
    let text = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if text.starts_with("nan") || text.starts_with("1.#") { Some(f64::NAN) } else { None }
}
