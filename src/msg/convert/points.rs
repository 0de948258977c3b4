//! Coloured points for viewers.

use crate::msg::{
    sensor_msgs::{PointCloud2, PointField},
    std_msgs::Header,
};
use nalgebra::Point3;

/// `datatype` of a field of 32-bit floating point numbers.
const FLOAT32: u8 = 7;
/// Bytes of a point: three coordinates, and a colour as RViz packs it.
const POINT_BYTES: u32 = 16;

/// Points with red, green and blue.
pub fn point_cloud<'a>(
    header: Header,
    points: impl IntoIterator<Item = &'a (Point3<f64>, [u8; 3])>,
) -> PointCloud2 {
    let mut data = Vec::new();
    for (at, [r, g, b]) in points {
        data.extend([at.x, at.y, at.z].iter().flat_map(|c| (*c as f32).to_le_bytes()));
        data.extend([*b, *g, *r, 0]);
    }
    let count = data.len() as u32 / POINT_BYTES;
    let field = |(name, offset): (&str, u32)| PointField {
        name: name.to_owned(),
        offset,
        datatype: FLOAT32,
        count: 1,
    };
    PointCloud2 {
        header,
        height: 1,
        width: count,
        fields: [("x", 0), ("y", 4), ("z", 8), ("rgb", 12)].map(field).to_vec(),
        is_bigendian: false,
        point_step: POINT_BYTES,
        row_step: POINT_BYTES * count,
        data,
        is_dense: true,
    }
}
