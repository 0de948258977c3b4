//! Axis-aligned rectangles in an image.

/// An axis-aligned rectangle in pixels; `x` to the right, `y` down, corners included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left side.
    pub x_min: f64,
    /// Upper side.
    pub y_min: f64,
    /// Right side.
    pub x_max: f64,
    /// Lower side.
    pub y_max: f64,
}

impl Rect {
    /// A rectangle from its corners, or nothing if they are not finite or not in order.
    pub fn new(x_min: f64, y_min: f64, x_max: f64, y_max: f64) -> Option<Self> {
        let finite = [x_min, y_min, x_max, y_max].iter().all(|v| v.is_finite());
        (finite && x_min < x_max && y_min < y_max).then_some(Self { x_min, y_min, x_max, y_max })
    }

    /// Centre `(x, y)`.
    pub fn center(&self) -> (f64, f64) {
        (0.5 * (self.x_min + self.x_max), 0.5 * (self.y_min + self.y_max))
    }

    /// Width along x.
    pub fn width(&self) -> f64 {
        self.x_max - self.x_min
    }

    /// Height along y.
    pub fn height(&self) -> f64 {
        self.y_max - self.y_min
    }

    /// Area in square pixels.
    pub fn area(&self) -> f64 {
        self.width() * self.height()
    }

    /// Whether a pixel lies in it, its sides included.
    pub fn contains(&self, x: f64, y: f64) -> bool {
        x >= self.x_min && x <= self.x_max && y >= self.y_min && y <= self.y_max
    }

    /// The part inside an image of `width` x `height` pixels, or nothing if there is none.
    pub fn clipped(&self, width: u32, height: u32) -> Option<Self> {
        let (right, bottom) = (f64::from(width) - 1.0, f64::from(height) - 1.0);
        Self::new(
            self.x_min.max(0.0),
            self.y_min.max(0.0),
            self.x_max.min(right),
            self.y_max.min(bottom),
        )
    }

    /// The common part of two rectangles.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        Self::new(
            self.x_min.max(other.x_min),
            self.y_min.max(other.y_min),
            self.x_max.min(other.x_max),
            self.y_max.min(other.y_max),
        )
    }

    /// Intersection over union.
    pub fn overlap(&self, other: &Self) -> f64 {
        let common = self.intersection(other).map_or(0.0, |r| r.area());
        common / (self.area() + other.area() - common)
    }
}
