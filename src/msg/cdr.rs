//! CDR, the encoding of ROS 2 messages: a four-byte header that names the byte order, then XCDR1.
//!
//! No length field is trusted: `cdr-encoding` takes bytes and strings as slices of the input, and serde reserves
//! at most a megabyte for a sequence before its elements have been read.

use crate::msg::{Message, Service, std_msgs::Header};
use byteorder::{BigEndian, LittleEndian};
use serde::{Serialize, de::DeserializeOwned};
use thiserror::Error;

/// Why bytes are not a message.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CdrError {
    /// Shorter than the header that names the byte order.
    #[error("{got} bytes are too short for a CDR message")]
    NoHeader {
        /// Bytes given.
        got: usize,
    },
    /// Neither of the two encodings that ROS 2 writes.
    #[error("the CDR encoding {kind:#06x} is not one that ROS 2 writes (0x0000 and 0x0001 are)")]
    UnknownEncoding {
        /// The header's first two bytes.
        kind: u16,
    },
    /// The bytes do not fit the type: cut off, a wrong length field, or another version of the type.
    #[error("the bytes are not a {type_name}: {problem}")]
    BadBytes {
        /// The type that was expected.
        type_name: &'static str,
        /// What the decoder met.
        problem: String,
    },
    /// A value that cannot be written.
    #[error("a {type_name} cannot be written: {problem}")]
    NotWritable {
        /// The type.
        type_name: &'static str,
        /// What the encoder met.
        problem: String,
    },
}

/// A message from its CDR bytes, in either byte order.
///
/// # Errors
/// When the bytes are not a `T`.
pub fn decode<T: Message>(bytes: &[u8]) -> Result<T, CdrError> {
    decode_as(bytes, T::TYPE)
}

/// Only the header of a message whose first field is one.
///
/// # Errors
/// When the bytes do not begin with a header.
pub fn decode_header(bytes: &[u8]) -> Result<Header, CdrError> {
    decode_as(bytes, Header::TYPE)
}

/// CDR bytes of a message, low byte first as all common machines write it.
///
/// # Errors
/// When a string or sequence is longer than CDR can say.
pub fn encode<T: Message>(message: &T) -> Result<Vec<u8>, CdrError> {
    encode_as(message, T::TYPE)
}

/// What a client asks of a service, from CDR bytes.
///
/// # Errors
/// When the bytes are not a request of `S`.
pub fn decode_request<S: Service>(bytes: &[u8]) -> Result<S::Request, CdrError> {
    decode_as(bytes, S::TYPE)
}

/// CDR bytes of what a client gets back.
///
/// # Errors
/// As [`encode`].
pub fn encode_response<S: Service>(response: &S::Response) -> Result<Vec<u8>, CdrError> {
    encode_as(response, S::TYPE)
}

/// How many bytes a value takes in CDR, with the header; nothing if it cannot be written.
pub fn encoded_len<T: Serialize>(value: &T) -> Option<usize> {
    encode_as(value, "").ok().map(|bytes| bytes.len())
}

fn encode_as<T: Serialize>(value: &T, type_name: &'static str) -> Result<Vec<u8>, CdrError> {
    let mut bytes = vec![0, 1, 0, 0];
    cdr_encoding::to_writer::<_, LittleEndian, _>(&mut bytes, value)
        .map_err(|e| CdrError::NotWritable { type_name, problem: e.to_string() })?;
    Ok(bytes)
}

fn decode_as<T: DeserializeOwned>(bytes: &[u8], type_name: &'static str) -> Result<T, CdrError> {
    let Some((&[kind_high, kind_low, _, _], payload)) = bytes.split_first_chunk() else {
        return Err(CdrError::NoHeader { got: bytes.len() });
    };
    let value = match (kind_high, kind_low) {
        (0, 0) => cdr_encoding::from_bytes::<T, BigEndian>(payload),
        (0, 1) => cdr_encoding::from_bytes::<T, LittleEndian>(payload),
        _ => {
            let kind = u16::from_be_bytes([kind_high, kind_low]);
            return Err(CdrError::UnknownEncoding { kind });
        }
    };
    match value {
        Ok((value, _)) => Ok(value),
        Err(e) => Err(CdrError::BadBytes { type_name, problem: e.to_string() }),
    }
}
