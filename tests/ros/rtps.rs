//! RTPS messages, byte by byte: what a peer sends, and what only somebody who means harm does.
//!
//! OMG, *DDS Interoperability Wire Protocol* 2.5, sections 8.3 and 9.4. Little-endian throughout.

/// The reader and the writer that every participant has, by what they are for: section 9.3.1.5.
pub(crate) const PARTICIPANTS: [[u8; 4]; 2] = [[0, 1, 0, 0xc7], [0, 1, 0, 0xc2]];
pub(crate) const PUBLICATIONS: [[u8; 4]; 2] = [[0, 0, 3, 0xc7], [0, 0, 3, 0xc2]];
pub(crate) const SUBSCRIPTIONS: [[u8; 4]; 2] = [[0, 0, 4, 0xc7], [0, 0, 4, 0xc2]];

/// Who sends.
pub(crate) type Prefix = [u8; 12];

/// A message under construction.
pub(crate) struct Message(Vec<u8>);

impl Message {
    pub(crate) fn from(prefix: Prefix) -> Self {
        Self([b"RTPS".as_slice(), &[2, 4, 1, 16], &prefix].concat())
    }

    pub(crate) fn bytes(self) -> Vec<u8> {
        self.0
    }

    fn submessage(mut self, kind: u8, flags: u8, parts: &[&[u8]]) -> Self {
        let body = parts.concat();
        self.0.extend([kind, flags | 1]);
        self.0.extend((body.len() as u16).to_le_bytes());
        self.0.extend(body);
        self
    }

    pub(crate) fn data(self, [reader, writer]: [[u8; 4]; 2], number: i64, payload: &[u8]) -> Self {
        let parts = [&[0, 0, 16, 0], &reader, &writer, &sequence(number)[..], payload];
        self.submessage(0x15, 4, &parts)
    }

    /// Says which messages there are.
    pub(crate) fn heartbeat(
        self,
        [reader, writer]: [[u8; 4]; 2],
        numbers: [i64; 2],
        count: i32,
    ) -> Self {
        let [first, last] = numbers.map(sequence);
        self.submessage(0x07, 0, &[&reader, &writer, &first, &last, &count.to_le_bytes()])
    }

    /// Says which messages there will not be: from the first number to before the second.
    pub(crate) fn gap(self, [reader, writer]: [[u8; 4]; 2], numbers: [i64; 2]) -> Self {
        let [start, base] = numbers.map(sequence);
        self.submessage(0x08, 0, &[&reader, &writer, &start, &base, &0_u32.to_le_bytes()])
    }

    /// Asks for a message again, and has all before it.
    pub(crate) fn ack_nack(self, [reader, writer]: [[u8; 4]; 2], number: i64, count: i32) -> Self {
        let set = [&sequence(number)[..], &1_u32.to_le_bytes(), &(1_u32 << 31).to_le_bytes()];
        self.submessage(0x06, 0, &[&reader, &writer, &set.concat(), &count.to_le_bytes()])
    }

    /// Asks for a fragment again.
    pub(crate) fn nack_frag(
        self,
        [reader, writer]: [[u8; 4]; 2],
        number: i64,
        fragment: u32,
        count: i32,
    ) -> Self {
        let set = [fragment, 1, 1 << 31].map(u32::to_le_bytes).concat();
        let parts = [&reader[..], &writer, &sequence(number), &set, &count.to_le_bytes()];
        self.submessage(0x12, 0, &parts)
    }

    /// One fragment, the last of a message of so many bytes in fragments of so many.
    pub(crate) fn last_fragment(
        self,
        [reader, writer]: [[u8; 4]; 2],
        number: i64,
        [message, fragment]: [u32; 2],
    ) -> Self {
        let count = message.div_ceil(fragment);
        let parts = [
            &[0, 0, 28, 0],
            &reader,
            &writer,
            &sequence(number)[..],
            &count.to_le_bytes(),
            &1_u16.to_le_bytes(),
            &(fragment as u16).to_le_bytes(),
            &message.to_le_bytes(),
            &vec![7; (message - (count - 1) * fragment) as usize],
        ];
        self.submessage(0x16, 0, &parts)
    }

    /// Says where to answer: a list of so many addresses, of which one is there.
    pub(crate) fn reply_to(self, claimed: u32) -> Self {
        self.submessage(0x0f, 0, &[&claimed.to_le_bytes(), &locator(9)])
    }
}

fn sequence(number: i64) -> [u8; 8] {
    let [high, low] = [(number >> 32) as u32, number as u32];
    [high.to_le_bytes(), low.to_le_bytes()].concat().try_into().unwrap()
}

/// A port on the loopback interface.
fn locator(port: u32) -> Vec<u8> {
    [&1_u32.to_le_bytes()[..], &port.to_le_bytes(), &[0; 12], &[127, 0, 0, 1]].concat()
}

fn parameters(list: &[(u16, &[u8])]) -> Vec<u8> {
    let mut bytes = vec![0, 3, 0, 0];
    for (id, value) in list.iter().copied().chain([(1, &[][..])]) {
        bytes.extend(id.to_le_bytes());
        bytes.extend((value.len().next_multiple_of(4) as u16).to_le_bytes());
        bytes.extend(value);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}

fn text(words: &str) -> Vec<u8> {
    [&(words.len() as u32 + 1).to_le_bytes()[..], words.as_bytes(), &[0]].concat()
}

/// What a participant says of itself.
pub(crate) fn participant(prefix: Prefix) -> Vec<u8> {
    let guid = [&prefix[..], &[0, 0, 1, 0xc1]].concat();
    let lease = [20_u32, 0].map(u32::to_le_bytes).concat();
    parameters(&[
        (0x15, &[2, 4, 0, 0]),
        (0x16, &[1, 16, 0, 0]),
        (0x50, &guid),
        (0x58, &0xc3f_u32.to_le_bytes()),
        (0x32, &locator(9)),
        (0x31, &locator(9)),
        (0x02, &lease),
    ])
}

/// What it says of one that publishes on, or subscribes to, a topic.
pub(crate) fn endpoint(prefix: Prefix, id: [u8; 4], [topic, kind]: [&str; 2]) -> Vec<u8> {
    let guid = [&prefix[..], &id].concat();
    let reliable = [2_u32, 0, 0].map(u32::to_le_bytes).concat();
    parameters(&[
        (0x5a, &guid),
        (0x50, &[&prefix[..], &[0, 0, 1, 0xc1]].concat()),
        (0x05, &text(topic)),
        (0x07, &text(kind)),
        (0x1a, &reliable),
    ])
}
