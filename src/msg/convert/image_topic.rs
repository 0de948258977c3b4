//! What the names of image topics say, by the conventions of image_transport and image_proc.

/// Whether the images are rectified: `image_rect`, `image_rect_color`, `image_rect_raw`, …
pub fn is_rectified(topic: &str) -> bool {
    without_transport(topic).rsplit('/').next().is_some_and(|image| image.contains("_rect"))
}

/// The topic of the images themselves, without what image_transport appends for a compressed form.
pub fn without_transport(topic: &str) -> &str {
    ["/compressed", "/compressedDepth"]
        .iter()
        .find_map(|end| topic.strip_suffix(end))
        .unwrap_or(topic)
}
