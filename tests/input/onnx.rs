//! ONNX models written byte by byte: networks that give the same whatever they see.

/// A field of bytes: `(number << 3) | 2`, length, content.
fn bytes(number: u64, content: &[u8]) -> Vec<u8> {
    let mut out = varint(number << 3 | 2);
    out.extend(varint(content.len() as u64));
    out.extend(content);
    out
}

fn number(field: u64, value: u64) -> Vec<u8> {
    let mut out = varint(field << 3);
    out.extend(varint(value));
    out
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut out = Vec::new();
    loop {
        let low = (value & 0x7f) as u8;
        value >>= 7;
        out.push(if value == 0 { low } else { low | 0x80 });
        if value == 0 {
            return out;
        }
    }
}

// Kinds of numbers in `TensorProto`.
const FLOAT: u64 = 1;
const INT64: u64 = 7;

/// `TensorProto` of 32-bit numbers.
pub(crate) fn tensor(name: &str, shape: &[u64], data: &[f32]) -> Vec<u8> {
    let mut out: Vec<u8> = shape.iter().flat_map(|side| number(1, *side)).collect();
    out.extend(number(2, FLOAT));
    out.extend(bytes(8, name.as_bytes()));
    let raw: Vec<u8> = data.iter().flat_map(|value| value.to_le_bytes()).collect();
    out.extend(bytes(9, &raw));
    out
}

/// `ValueInfoProto`; a side of zero is left open.
fn value(name: &str, shape: &[u64]) -> Vec<u8> {
    let dimension = |side: &u64| match side {
        0 => bytes(1, &bytes(2, b"open")),
        side => bytes(1, &number(1, *side)),
    };
    let dimensions: Vec<u8> = shape.iter().flat_map(dimension).collect();
    let tensor = [number(1, FLOAT), bytes(2, &dimensions)].concat();
    [bytes(1, name.as_bytes()), bytes(2, &bytes(1, &tensor))].concat()
}

fn node(operator: &str, inputs: &[&str], output: &str) -> Vec<u8> {
    let mut out: Vec<u8> = inputs.iter().flat_map(|name| bytes(1, name.as_bytes())).collect();
    out.extend(bytes(2, output.as_bytes()));
    out.extend(bytes(4, operator.as_bytes()));
    out
}

/// A network that takes an image of this shape and gives these tensors. The image only adds nothing to them: its largest
/// value is multiplied by zero, so that the network depends on it.
pub(crate) fn model(image: &[u64], outputs: &[(&[u64], Vec<f32>)]) -> Vec<u8> {
    // `keepdims` is 0: a scalar, which leaves shapes as they are.
    const INT: u64 = 2;
    let keep = [bytes(1, b"keepdims"), number(3, 0), number(20, INT)].concat();
    let largest = [node("ReduceMax", &["image"], "largest"), bytes(5, &keep)].concat();
    let mut graph = bytes(1, &largest);
    graph.extend(bytes(1, &node("Mul", &["largest", "zero"], "nothing")));
    let mut rest = bytes(5, &tensor("zero", &[1], &[0.0]));
    rest.extend(bytes(11, &value("image", image)));
    for (at, (shape, data)) in outputs.iter().enumerate() {
        let (constant, name) = (format!("constant{at}"), format!("output{at}"));
        graph.extend(bytes(1, &node("Add", &[&constant, "nothing"], &name)));
        rest.extend(bytes(5, &tensor(&constant, shape, data)));
        rest.extend(bytes(12, &value(&name, shape)));
    }
    with_graph(&[graph, bytes(2, b"made"), rest].concat())
}

/// `ModelProto` of a graph: version 8 of the format, version 17 of the operators.
fn with_graph(graph: &[u8]) -> Vec<u8> {
    [number(1, 8), bytes(7, graph), bytes(8, &number(2, 17))].concat()
}

/// A model with an entry of metadata more: fields of a message can stand in any order.
pub(crate) fn with_metadata(mut model: Vec<u8>, key: &str, text: &str) -> Vec<u8> {
    model.extend(bytes(14, &[bytes(1, key.as_bytes()), bytes(2, text.as_bytes())].concat()));
    model
}

/// A network that gives its image of `side` x `side` pixels in another shape.
pub(crate) fn reshaped_image(side: u64, shape: &[u64]) -> Vec<u8> {
    let to: Vec<u8> = shape.iter().flat_map(|side| (*side as i64).to_le_bytes()).collect();
    let to = [number(1, shape.len() as u64), number(2, INT64), bytes(8, b"to"), bytes(9, &to)];
    let graph = [
        bytes(1, &node("Reshape", &["image", "to"], "output")),
        bytes(2, b"made"),
        bytes(5, &to.concat()),
        bytes(11, &value("image", &[1, 3, side, side])),
        bytes(12, &value("output", shape)),
    ];
    with_graph(&graph.concat())
}

/// A network with a tensor that says it has this shape, and has four bytes.
pub(crate) fn claiming(shape: &[u64]) -> Vec<u8> {
    let graph = [
        bytes(1, &node("Add", &["image", "claimed"], "output")),
        bytes(2, b"made"),
        bytes(5, &tensor("claimed", shape, &[0.0])),
        bytes(11, &value("image", &[1, 3, 64, 64])),
        bytes(12, &value("output", shape)),
    ];
    with_graph(&graph.concat())
}
