//! What `.zarray` (version 2) and `zarr.json` (version 3) say of an array.

use serde::Deserialize;
use serde_json::Value;

use super::codecs::Codecs;
use super::store::Store;
use crate::error::Result;
use crate::io::element::{Element, NUMPY_ORDERS, NUMPY_TYPES};
use crate::io::text;
use crate::io::text_data::bytes_of;

/// An array whose numbers fit together.
pub(super) struct Array {
    /// Slowest axis first.
    pub(super) shape: Vec<u64>,
    pub(super) chunk: Vec<u64>,
    pub(super) element: Element,
    /// One element in the machine's byte order: what chunks hold that are not there.
    pub(super) fill: Vec<u8>,
    pub(super) codecs: Codecs,
    /// Before the numbers of a chunk, and between them.
    prefix: &'static str,
    separator: String,
}

#[derive(Deserialize)]
struct Version2 {
    shape: Vec<u64>,
    chunks: Vec<u64>,
    dtype: Value,
    #[serde(default)]
    compressor: Value,
    #[serde(default)]
    filters: Value,
    #[serde(default)]
    fill_value: Value,
    order: String,
    dimension_separator: Option<String>,
}

#[derive(Deserialize)]
struct Version3 {
    node_type: String,
    shape: Vec<u64>,
    data_type: Value,
    chunk_grid: Named,
    chunk_key_encoding: Named,
    fill_value: Value,
    codecs: Vec<Named>,
}

/// An extension point of version 3.
#[derive(Deserialize)]
pub(super) struct Named {
    pub(super) name: String,
    #[serde(default)]
    pub(super) configuration: Value,
}

/// Type names of version 3.
const TYPES: &[(&str, Element)] = &[
    ("bool", Element::U8),
    ("uint8", Element::U8),
    ("int8", Element::I8),
    ("uint16", Element::U16),
    ("int16", Element::I16),
    ("uint32", Element::U32),
    ("int32", Element::I32),
    ("uint64", Element::U64),
    ("int64", Element::I64),
    ("float16", Element::F16),
    ("float32", Element::F32),
    ("float64", Element::F64),
];

/// Largest chunk, in bytes.
const MAX_CHUNK_BYTES: u64 = 1 << 30;

impl Array {
    /// The array under `path`; empty of the store's root.
    pub(super) fn read(store: &Store<'_>, path: &str) -> Result<Self> {
        let folder = match path {
            "" => String::new(),
            path => format!("{path}/"),
        };
        let key = format!("{folder}zarr.json");
        if let Some(header) = store.json::<Version3>(&key)? {
            return Self::version3(store, &key, header);
        }
        let key = format!("{folder}.zarray");
        match store.json::<Version2>(&key)? {
            Some(header) => Self::version2(store, &key, header),
            None => Err(store.bad(
                &key,
                "there is no array: no .zarray and no zarr.json".into(),
            )),
        }
    }

    fn version2(store: &Store<'_>, key: &str, header: Version2) -> Result<Self> {
        let path = store.path(key);
        let dtype = header.dtype.as_str().unwrap_or_default();
        let (order, name) = dtype.split_at_checked(1).unwrap_or(("", dtype));
        let endian = text::one_of(&path, "dtype: byte order", order, &NUMPY_ORDERS)?;
        let element = text::one_of(&path, "dtype", name, &NUMPY_TYPES)?;
        if header.filters.as_array().is_some_and(|f| !f.is_empty()) {
            return Err(store.bad(key, format!("filters {}: none are read", header.filters)));
        }
        let first_fastest =
            text::one_of(&path, "order", &header.order, &[("C", false), ("F", true)])?;
        let axes = header.shape.len();
        let compressor = header.compressor;
        let codecs = Codecs::version2(&path, &compressor, first_fastest, axes, endian)?;
        let array = Self {
            shape: header.shape,
            chunk: header.chunks,
            fill: fill(store, key, &header.fill_value, element)?,
            element,
            codecs,
            prefix: "",
            separator: header.dimension_separator.unwrap_or_else(|| ".".into()),
        };
        array.checked(store, key)
    }

    fn version3(store: &Store<'_>, key: &str, header: Version3) -> Result<Self> {
        let path = store.path(key);
        text::one_of(&path, "node_type", &header.node_type, &[("array", ())])?;
        let data_type = header.data_type.as_str().unwrap_or_default();
        let element = text::one_of(&path, "data_type", data_type, TYPES)?;
        text::one_of(
            &path,
            "chunk_grid",
            &header.chunk_grid.name,
            &[("regular", ())],
        )?;
        let encodings = [("default", ("c", "/")), ("v2", ("", "."))];
        let encoding = &header.chunk_key_encoding;
        let (prefix, separator) =
            text::one_of(&path, "chunk_key_encoding", &encoding.name, &encodings)?;
        let separator = encoding
            .configuration
            .get("separator")
            .and_then(Value::as_str)
            .unwrap_or(separator);
        let axes = header.shape.len();
        let array = Self {
            shape: header.shape,
            chunk: numbers(&header.chunk_grid.configuration, "chunk_shape"),
            fill: fill(store, key, &header.fill_value, element)?,
            element,
            codecs: Codecs::version3(&path, &header.codecs, axes)?,
            prefix,
            separator: separator.to_owned(),
        };
        array.checked(store, key)
    }

    /// Refuses chunks of another number of axes, empty ones, and larger ones than can be meant.
    fn checked(self, store: &Store<'_>, key: &str) -> Result<Self> {
        let bytes = volume_of(&self.chunk).and_then(|n| n.checked_mul(self.element.bytes()));
        let same = self.chunk.len() == self.shape.len();
        match bytes {
            Some(1..=MAX_CHUNK_BYTES) if same => Ok(self),
            _ => Err(store.bad(
                key,
                format!(
                    "chunks {:?} of shape {:?}: as many numbers above 0 are needed, and at most \
                     {MAX_CHUNK_BYTES} bytes of {} in a chunk",
                    self.chunk, self.shape, self.element
                ),
            )),
        }
    }

    /// The key of a chunk below the array's own.
    pub(super) fn chunk_key(&self, chunk: &[u64]) -> String {
        let numbers: Vec<String> = chunk.iter().map(u64::to_string).collect();
        let numbers = numbers.join(&self.separator);
        match self.prefix {
            "" => numbers,
            prefix => format!("{prefix}{}{numbers}", self.separator),
        }
    }
}

/// The product of some sizes.
pub(super) fn volume_of(sizes: &[u64]) -> Option<u64> {
    sizes.iter().try_fold(1u64, |n, &size| n.checked_mul(size))
}

/// A list of whole numbers; empty when it is none.
pub(super) fn numbers(configuration: &Value, key: &str) -> Vec<u64> {
    let list = configuration.get(key).and_then(Value::as_array);
    let numbers = list.and_then(|list| list.iter().map(Value::as_u64).collect());
    numbers.unwrap_or_default()
}

/// The bytes of `fill_value`; of none, 0.
fn fill(store: &Store<'_>, key: &str, value: &Value, element: Element) -> Result<Vec<u8>> {
    let digits = match value {
        Value::Null => "0".to_owned(),
        Value::Bool(bool) => u8::from(*bool).to_string(),
        // Whole numbers of integer arrays are written as floats now and then.
        Value::Number(number) => match number.as_f64() {
            Some(whole) if number.is_f64() && whole.fract() == 0.0 && whole.abs() < 1e15 => {
                (whole as i64).to_string()
            }
            _ => number.to_string(),
        },
        other => other.as_str().unwrap_or_default().to_owned(),
    };
    let bytes = match digits.strip_prefix("0x") {
        Some(bits) => bits_of(bits, element),
        None => bytes_of(&digits, element),
    };
    bytes.ok_or_else(|| store.bad(key, format!("fill_value {value} is no {element}")))
}

/// Bits of a float in hexadecimal digits.
fn bits_of(digits: &str, element: Element) -> Option<Vec<u8>> {
    let bits = u64::from_str_radix(digits, 16).ok()?;
    match element {
        Element::F16 => Some(u16::try_from(bits).ok()?.to_ne_bytes().to_vec()),
        Element::F32 => Some(u32::try_from(bits).ok()?.to_ne_bytes().to_vec()),
        Element::F64 => Some(bits.to_ne_bytes().to_vec()),
        _ => None,
    }
}
