//! Messages as the bytes they came as.

use serde::{Serialize, Serializer, ser::SerializeTuple};

/// A message of any type in CDR, without the four bytes that name the encoding.
///
/// RustDDS serialises it by writing the bytes as they are: eight at a time, at offsets that are multiples of eight,
/// so that CDR puts no padding between them.
#[derive(Clone, Debug)]
pub(in crate::ros) struct RawCdr(Vec<u8>);

impl RawCdr {
    /// From CDR bytes with their header; nothing if they are not in the byte order that DDS is told here.
    pub(super) fn from_little_endian(cdr: &[u8]) -> Option<Self> {
        match cdr {
            [0, 1, _, _, payload @ ..] => Some(Self(payload.to_vec())),
            _ => None,
        }
    }
}

impl Serialize for RawCdr {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (words, rest) = self.0.as_chunks::<8>();
        let mut tuple = serializer.serialize_tuple(words.len() + rest.len())?;
        for word in words {
            tuple.serialize_element(&u64::from_le_bytes(*word))?;
        }
        for byte in rest {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}
